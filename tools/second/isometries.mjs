// Isometries: that they are what they claim to be, and which pasts they map to which.

import { Refuted } from './outcome.mjs'
import { ONE, exactlyZero } from './tower.mjs'

/** One motion of the plane with its map of circles, walls and pockets. */
export class Isometry {
  constructor(data, scene, log, where) {
    this.scene = scene
    this.log = log
    this.where = where
    this.corresponding = new Set()
    const q = scene.tower
    this.matrix = data.matrix.map((text) => scene.number(text, where))
    this.shift = data.shift.map((text) => scene.number(text, where))
    const [a, b, c, d] = this.matrix
    if (!q.equal(q.dot(a, c, a, c), ONE) || !q.equal(q.dot(b, d, b, d), ONE) || !exactlyZero(q.dot(a, c, b, d))) {
      throw new Refuted(`${where} is no isometry`)
    }
    this.map = new Map()
    for (const [i, j] of data.map) {
      if (this.map.has(i)) throw new Refuted(`${where} maps ${i} twice`)
      this.map.set(i, j)
      if (!this.#takes(i, j)) throw new Refuted(`${where} does not map ${i} to ${j}`)
    }
    if (new Set(this.map.values()).size !== this.map.size) throw new Refuted(`${where} maps two things to one`)
    this.isShift = q.equal(a, ONE) && q.equal(d, ONE) && exactlyZero(b) && exactlyZero(c)
  }

  #turn(x, y) {
    const q = this.scene.tower
    const [a, b, c, d] = this.matrix
    return [q.dot(a, b, x, y), q.dot(c, d, x, y)]
  }

  #image(x, y) {
    const q = this.scene.tower
    const [u, v] = this.#turn(x, y)
    return [q.add(u, this.shift[0]), q.add(v, this.shift[1])]
  }

  #takes(i, j) {
    const { tower: q, circles, walls, pockets, n } = this.scene
    const same = (pairs) => pairs.every(([x, y]) => q.equal(x, y))
    if (i < 0 || j < 0) {
      if (i >= 0 || j >= 0) return false
      const [from, to] = [pockets[-1 - i], pockets[-1 - j]]
      const [x, y] = this.#image(from.x, from.y)
      return same([[x, to.x], [y, to.y], [from.r, to.r]])
    }
    if (i >= n || j >= n) {
      if (i < n || j < n) return false
      const [from, to] = [walls[i - n], walls[j - n]]
      return [[from.x0, from.y0], [from.x1, from.y1]].every(([x, y]) => {
        const [u, v] = this.#image(x, y)
        return exactlyZero(q.dot(to.nx, to.ny, q.sub(u, to.x0), q.sub(v, to.y0)))
      })
    }
    const [from, to] = [circles[i], circles[j]]
    if (from.fixed !== to.fixed) return false
    const [x, y] = this.#image(from.x, from.y)
    const [vx, vy] = this.#turn(from.vx, from.vy)
    return (
      same([[x, to.x], [y, to.y], [vx, to.vx], [vy, to.vy], [from.r, to.r]]) && (from.fixed || q.equal(from.m, to.m))
    )
  }

  // Pasts

  #imageKey([i, j]) {
    const [k, m] = [this.map.get(i), this.map.get(j)]
    if (k === undefined || m === undefined) return null
    return this.scene.key(this.scene.isPair([k, m]) && k > m ? [m, k] : [k, m])
  }

  /** Whether two blocks correspond, with all that the definition asks of the blocks before them. */
  #correspond(first, second) {
    const seen = new Set()
    const stack = [[first, second]]
    while (stack.length) {
      const [a, b] = stack.pop()
      const pair = `${a.id},${b.id}`
      if (seen.has(pair) || this.corresponding.has(pair)) continue
      this.scene.tower.work.spend(4 * a.circles.length)
      seen.add(pair)
      if (a.kind !== b.kind || a.kind === 'capture' || a.circles.length !== b.circles.length) return false
      if (a.kind === 'round') {
        if (a.keys.size !== b.keys.size) return false
        if (!a.contacts.every((contact) => b.keys.has(this.#imageKey(contact)))) return false
      }
      for (const i of a.circles) {
        const k = this.map.get(i)
        const place = a.place.get(i)
        if (k === undefined || b.place.get(k) !== place) return false
        if (place > 0) stack.push([this.log.rows[i][place - 1], this.log.rows[k][place - 1]])
      }
    }
    for (const pair of seen) this.corresponding.add(pair)
    return true
  }

  /** Whether circle i is mapped to circle k with its past. */
  mapsPast(i, k) {
    if (this.map.get(i) !== k) return false
    if (!this.scene.movable(i)) return true
    const length = this.log.length(i)
    if (this.log.length(k) !== length) return false
    return length === 0 || this.#correspond(this.log.rows[i][length - 1], this.log.rows[k][length - 1])
  }

  /** Whether one contact is mapped to another, with the pasts of its circles. */
  mapsContact([i, j], [k, m]) {
    const pair = this.scene.isPair([i, j])
    if (pair !== this.scene.isPair([k, m])) return false
    if (!pair) return this.map.get(j) === m && this.mapsPast(i, k)
    return (this.mapsPast(i, k) && this.mapsPast(j, m)) || (this.mapsPast(i, m) && this.mapsPast(j, k))
  }

  /** Whether a circle is mapped to itself with its past, and the normal of a wall to its negative. */
  turnsWall(i, wall) {
    const q = this.scene.tower
    const { nx, ny } = this.scene.walls[wall]
    const [x, y] = this.#turn(nx, ny)
    return exactlyZero(q.add(x, nx)) && exactlyZero(q.add(y, ny)) && this.mapsPast(i, i)
  }

  /** Whether one of two circles is shifted to the other with its past. */
  shiftsPast([i, j]) {
    return this.isShift && (this.mapsPast(i, j) || this.mapsPast(j, i))
  }
}
