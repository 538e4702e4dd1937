// The scene of a certificate in exact numbers, and its contacts.

import { exactNumber } from './format.mjs'
import { Balls, Forms, ONE, isNone } from './forms.mjs'
import { Fixed, sign } from './interval.mjs'
import { NoCertificate, Refuted, Undecided } from './outcome.mjs'

/** A contact as a key of sets and maps. */
export const keyOf = ([i, j]) => `${i},${j}`

/** Things above zero; what is not is said to be no certificate. */
function above(ball, where) {
  const found = sign(ball)
  if (found === undefined) throw new Undecided(`${where} may not be positive`)
  if (found < 1) throw new NoCertificate(`${where} is not positive`)
}

export class Scene {
  constructor(data, work, bits) {
    this.forms = new Forms(work)
    this.balls = new Balls(new Fixed(bits, work))
    data.roots.forEach((text, k) => {
      const square = this.number(text, `roots[${k}]`)
      const ball = this.balls.of(square)
      above(ball, `roots[${k}]`)
      this.forms.squares.push(square)
      this.balls.roots.push(this.balls.sqrt(ball))
    })
    const { circles, walls = [], pockets = [] } = data.scene
    const read = (thing, keys, where) => Object.fromEntries(keys.map((key) => [key, this.number(thing[key], `${where}.${key}`)]))
    this.circles = circles.map((circle, k) => read(circle, ['x', 'y', 'vx', 'vy', 'r', 'w'], `circles[${k}]`))
    this.pockets = pockets.map((pocket, k) => read(pocket, ['x', 'y', 'r'], `pockets[${k}]`))
    const { forms } = this
    this.walls = walls.map((wall, k) => {
      const { x0, y0, x1, y1, length } = read(wall, ['x0', 'y0', 'x1', 'y1', 'length'], `walls[${k}]`)
      const [nx, ny] = [forms.sub(y0, y1), forms.sub(x1, x0)]
      const off = forms.sub(forms.add(forms.mul(nx, nx), forms.mul(ny, ny)), forms.mul(length, length))
      if (!isNone(off)) throw new NoCertificate(`walls[${k}] has another length`)
      return { x: x0, y: y0, nx, ny, length }
    })
    this.n = circles.length
    this.capture = data.scene.capture ?? false
    this.limits = new Map()
    if (data.scene.reverse_at !== undefined) this.limits.set('reverse', this.number(data.scene.reverse_at, 'reverse_at'))
    if (data.end.reason === 'horizon') this.limits.set('until', this.number(data.end.until, 'until'))
    this.#check()
    this.#meets()
  }

  number(text, where) {
    return exactNumber(text, this.forms, where)
  }

  #check() {
    this.circles.forEach(({ r, w, vx, vy }, k) => {
      if (isNone(w) && !(isNone(vx) && isNone(vy))) throw new NoCertificate(`circles[${k}] is fixed and moves`)
      if (!isNone(r)) above(this.balls.of(r), `circles[${k}].r`)
      if (!isNone(w)) above(this.balls.of(w), `circles[${k}].w`)
    })
    for (const [name, things, key] of [['walls', this.walls, 'length'], ['pockets', this.pockets, 'r']]) {
      things.forEach((thing, k) => above(this.balls.of(thing[key]), `${name}[${k}].${key}`))
    }
    for (const [name, time] of this.limits) above(this.balls.of(time), name)
  }

  #meets() {
    const { n, forms } = this
    this.sides = new Map()
    this.byCircle = this.circles.map(() => [])
    const add = (contact, ...circles) => circles.forEach((i) => this.byCircle[i].push(contact))
    for (let i = 0; i < n; i++) {
      for (let j = i + 1; j < n; j++) {
        const sized = !isNone(this.circles[i].r) || !isNone(this.circles[j].r)
        if (sized && (this.movable(i) || this.movable(j))) add([i, j], i, j)
      }
      if (!this.movable(i)) continue
      this.walls.forEach(({ x, y, nx, ny }, k) => {
        const { x: u, y: v } = this.circles[i]
        const side = forms.add(forms.mul(nx, forms.sub(u, x)), forms.mul(ny, forms.sub(v, y)))
        const found = sign(this.balls.of(side))
        if (found === undefined) throw new Undecided(`on which side of walls[${k}] circles[${i}] is`)
        if (found === 0) throw new Refuted(`the centre of circles[${i}] is on walls[${k}]`)
        this.sides.set(keyOf([i, n + k]), found)
        add([i, n + k], i)
      })
      this.pockets.forEach((_, k) => add([i, -1 - k], i))
    }
  }

  movable(i) {
    return i >= 0 && i < this.n && !isNone(this.circles[i].w)
  }

  side(contact) {
    return this.sides.get(keyOf(contact))
  }

  /** Whether two can meet at all. */
  has([i, j]) {
    return i >= 0 && i < this.n && this.byCircle[i].some((other) => other[0] === i && other[1] === j)
  }

  /** The circles of a contact. */
  circlesOf([i, j]) {
    return j >= 0 && j < this.n ? [i, j] : [i]
  }

  // Isometries

  /** One of the list: {matrix, images, kept}; `kept` are the circles whose flights it maps. */
  isometry(told, where) {
    const { forms, n } = this
    const [a, b, c, d] = told.matrix.map((text) => this.number(text, where))
    const [p, q] = told.shift.map((text) => this.number(text, where))
    const two = (s, x, t, y) => forms.add(forms.mul(s, x), forms.mul(t, y))
    const turned = (x, y) => [two(a, x, b, y), two(c, x, d, y)]
    const moved = (x, y) => turned(x, y).map((z, k) => forms.add(z, [p, q][k]))
    const zeros = [forms.sub(two(a, a, c, c), ONE), forms.sub(two(b, b, d, d), ONE), two(a, b, c, d)]
    const images = new Map(told.map)
    const same = (one, other) => one.forEach((x, k) => zeros.push(forms.sub(x, other[k])))
    for (const [i, j] of images) {
      if (i >= n && j >= n) {
        const [wall, image] = [this.walls[i - n], this.walls[j - n]]
        const [nx, ny] = turned(wall.nx, wall.ny)
        const [x, y] = moved(wall.x, wall.y)
        zeros.push(forms.sub(forms.mul(nx, image.ny), forms.mul(ny, image.nx)))
        zeros.push(two(forms.sub(x, image.x), image.nx, forms.sub(y, image.y), image.ny))
      } else if (i < 0 && j < 0) {
        const [pocket, image] = [this.pockets[-1 - i], this.pockets[-1 - j]]
        same([...moved(pocket.x, pocket.y), pocket.r], [image.x, image.y, image.r])
      } else if (i >= 0 && j >= 0 && i < n && j < n) {
        const [one, image] = [this.circles[i], this.circles[j]]
        same(
          [...moved(one.x, one.y), ...turned(one.vx, one.vy), one.r, one.w],
          [image.x, image.y, image.vx, image.vy, image.r, image.w],
        )
      } else throw new Refuted(`${where} maps one kind to another`)
    }
    if (new Set(images.values()).size < told.map.length || !zeros.every(isNone)) {
      throw new Refuted(`${where} does not map what it says`)
    }
    return { matrix: [a, b, c, d], images, kept: new Set([...images.keys()].filter((i) => i >= 0 && i < n)) }
  }
}
