// Numbers of a run computed again from the scene, exactly. A flight is a line {x, y, vx, vy}: the circle is at
// (x, y) + (vx, vy) t at every time t of the flight.

import { Undecided } from './outcome.mjs'
import { ZERO, exactlyZero } from './tower.mjs'

/** Times of blocks: the start, the set time of the reversal, or when a contact met on the flights of then. */
export const AT_START = { kind: 'start' }
export const AT_SET_TIME = { kind: 'set' }
export const metThen = (contact, log) => ({
  kind: 'hit',
  contact,
  lengths: log.scene.circlesOf(contact).map((i) => log.length(i)),
})

/** One question's replay: its own roots above those of the scene, and what needs none of its own is kept in `known`. */
export class Replay {
  constructor(scene, log, sides, known) {
    this.scene = scene
    this.log = log
    this.sides = sides
    this.known = known
    this.tower = scene.tower.copy()
    this.base = scene.tower.roots.length
    this.found = new Map()
  }

  // Blocks and times, each after what it rests on

  #get(node) {
    return this.known.get(node) ?? this.found.get(node)
  }

  #ensure(nodes) {
    const stack = nodes.filter((node) => !this.#get(node))
    while (stack.length) {
      const node = stack[stack.length - 1]
      this.scene.tower.work.spend(1)
      const missing = this.#needs(node).filter((need) => !this.#get(need))
      if (missing.length) stack.push(...missing)
      else {
        stack.pop()
        if (!this.#get(node)) this.#keep(node, node.circles ? this.#afterBlock(node) : this.#timeOf(node))
      }
    }
  }

  #keep(node, value) {
    const plain = (x) => typeof x.t === 'bigint' || x.t.k < this.base
    const numbers = value instanceof Map ? [...value.values()].flatMap(Object.values) : [value]
    const store = numbers.every(plain) ? this.known : this.found
    store.set(node, value)
  }

  #needs(node) {
    if (node.circles) return [...node.circles.flatMap((i) => this.#last(i, node.place.get(i))), node.time]
    if (node.kind !== 'hit') return []
    return this.scene.circlesOf(node.contact).flatMap((i, k) => this.#last(i, node.lengths[k]))
  }

  #last(i, length) {
    return length > 0 ? [this.log.rows[i][length - 1]] : []
  }

  /** The line of circle i after so many blocks of its row. */
  #line(i, length) {
    if (length > 0) return this.#get(this.log.rows[i][length - 1]).get(i)
    return this.scene.circles[i]
  }

  #timeOf(node) {
    if (node.kind === 'start') return ZERO
    if (node.kind === 'set') return this.scene.reverseAt
    const lines = this.scene.circlesOf(node.contact).map((i, k) => this.#line(i, node.lengths[k]))
    return this.#hit(node.contact, lines)
  }

  #afterBlock(block) {
    const q = this.tower
    const time = this.#get(block.time)
    const before = new Map(block.circles.map((i) => [i, this.#line(i, block.place.get(i))]))
    const after = this.#velocities(block, before, time)
    const lines = new Map()
    for (const [i, { x, y, vx, vy }] of before) {
      const [wx, wy] = after.get(i)
      const line = { vx: wx, vy: wy }
      line.x = q.add(x, q.mul(q.sub(vx, wx), time))
      line.y = q.add(y, q.mul(q.sub(vy, wy), time))
      lines.set(i, line)
    }
    return lines
  }

  #velocities(block, before, time) {
    const q = this.tower
    const result = new Map()
    for (const [i, { vx, vy }] of before) {
      result.set(i, block.kind === 'reversal' ? [q.neg(vx), q.neg(vy)] : [ZERO, ZERO])
    }
    if (block.kind !== 'round') return result
    const { arms, impulses } = this.#impulses(block.push, (i) => before.get(i) ?? this.scene.circles[i], time)
    for (const [i, { vx, vy }] of before) {
      let [wx, wy] = [vx, vy]
      arms.forEach((arm, k) => {
        const j = arm.find((end) => end.i === i)
        if (!j) return
        const change = q.mul(this.scene.circles[i].w, impulses[k])
        wx = q.add(wx, q.mul(change, j.x))
        wy = q.add(wy, q.mul(change, j.y))
      })
      result.set(i, [wx, wy])
    }
    return result
  }

  // The laws

  /** The J of a contact: a list of {i, x, y} by circle. */
  #arms([i, j], line, time) {
    const q = this.tower
    if (j >= this.scene.n) {
      const [x, y] = this.#normal(i, j - this.scene.n)
      return [{ i, x, y }]
    }
    const [dx, dy] = this.#between([i, j], line, time)
    return [{ i, x: q.neg(dx), y: q.neg(dy) }, { i: j, x: dx, y: dy }]
  }

  #normal(i, wall) {
    const { nx, ny } = this.scene.walls[wall]
    return this.sides(i, wall) > 0 ? [nx, ny] : [this.tower.neg(nx), this.tower.neg(ny)]
  }

  #between([i, j], line, time) {
    const q = this.tower
    const at = ({ x, y, vx, vy }) => [q.add(x, q.mul(vx, time)), q.add(y, q.mul(vy, time))]
    const [px, py] = at(line(i))
    const [qx, qy] = j >= 0 ? at(line(j)) : [this.scene.pockets[-1 - j].x, this.scene.pockets[-1 - j].y]
    return [q.sub(qx, px), q.sub(qy, py)]
  }

  #speed(arms, line) {
    const q = this.tower
    return arms.reduce((sum, { i, x, y }) => q.add(sum, q.dot(x, y, line(i).vx, line(i).vy)), ZERO)
  }

  /** The entry of G for two contacts. */
  #coupling(a, b) {
    const q = this.tower
    let sum = ZERO
    for (const end of a) {
      const other = b.find(({ i }) => i === end.i)
      if (other) sum = q.add(sum, q.mul(this.scene.circles[end.i].w, q.dot(end.x, end.y, other.x, other.y)))
    }
    return sum
  }

  /** The impulses s with G s = -2u of the contacts that push. */
  #impulses(push, line, time) {
    const q = this.tower
    const arms = push.map((contact) => this.#arms(contact, line, time))
    const rows = arms.map((a) => {
      const u = this.#speed(a, line)
      return [...arms.map((b) => this.#coupling(a, b)), q.neg(q.add(u, u))]
    })
    const n = rows.length
    for (let k = 0; k < n; k++) {
      const pivot = rows.findIndex((row, i) => i >= k && !exactlyZero(row[k]))
      if (pivot < 0) throw new Undecided('a round whose impulses are not unique', false)
      ;[rows[k], rows[pivot]] = [rows[pivot], rows[k]]
      const inverse = q.inverse(rows[k][k])
      rows[k] = rows[k].map((x) => q.mul(x, inverse))
      for (let i = 0; i < n; i++) {
        const factor = rows[i][k]
        if (i !== k && !exactlyZero(factor)) rows[i] = rows[i].map((x, j) => q.sub(x, q.mul(factor, rows[k][j])))
      }
    }
    return { arms, impulses: rows.map((row) => row[n]) }
  }

  /** d, v, v.v and the discriminant of two lines; d as it would be at time 0. */
  #relative([i, j], lines) {
    const q = this.tower
    const other = j >= 0 ? lines[1] : { ...this.scene.pockets[-1 - j], vx: ZERO, vy: ZERO }
    const [dx, dy] = [q.sub(other.x, lines[0].x), q.sub(other.y, lines[0].y)]
    const [vx, vy] = [q.sub(other.vx, lines[0].vx), q.sub(other.vy, lines[0].vy)]
    const reach = this.#reach([i, j])
    const speed = q.dot(vx, vy, vx, vy)
    const cross = q.sub(q.mul(dx, vy), q.mul(dy, vx))
    const discriminant = q.sub(q.mul(speed, q.mul(reach, reach)), q.mul(cross, cross))
    return { dx, dy, vx, vy, speed, discriminant }
  }

  #reach([i, j]) {
    const { circles, pockets } = this.scene
    return j >= 0 ? this.tower.add(circles[i].r, circles[j].r) : pockets[-1 - j].r
  }

  /** When lines meet, falling: (-d.v - sqrt(discriminant)) / v.v, with d as it would be at time 0. */
  #hit([i, j], lines) {
    const q = this.tower
    if (j >= this.scene.n) {
      const wall = this.scene.walls[j - this.scene.n]
      const [nx, ny] = this.#normal(i, j - this.scene.n)
      const [line] = lines
      const height = q.dot(nx, ny, q.sub(line.x, wall.x0), q.sub(line.y, wall.y0))
      const gap = q.sub(height, q.mul(this.scene.circles[i].r, q.sqrt(wall.square)))
      return q.neg(q.div(gap, q.dot(nx, ny, line.vx, line.vy)))
    }
    const { dx, dy, vx, vy, speed, discriminant } = this.#relative([i, j], lines)
    return q.neg(q.div(q.add(q.dot(dx, dy, vx, vy), q.sqrt(discriminant)), speed))
  }

  // Questions, about the flights of now

  #now(contact) {
    const circles = this.scene.circlesOf(contact)
    this.#ensure(circles.flatMap((i) => this.#last(i, this.log.length(i))))
    return circles.map((i) => this.#line(i, this.log.length(i)))
  }

  #time(node) {
    this.#ensure([node])
    return this.#get(node)
  }

  /** When the two meet: a hit, or a graze. */
  meetingTime(contact, kind) {
    const lines = this.#now(contact)
    if (kind === 'hit') return this.#hit(contact, lines)
    const q = this.tower
    const { dx, dy, vx, vy, speed } = this.#relative(contact, lines)
    return q.neg(q.div(q.dot(dx, dy, vx, vy), speed))
  }

  sameTime(contact, kind, other, otherKind) {
    return this.tower.equal(this.meetingTime(contact, kind), this.meetingTime(other, otherKind))
  }

  /** Whether a contact meets at twice the reversal's time. */
  atReturn(contact, reversal) {
    const twice = this.tower.add(this.#time(reversal), this.#time(reversal))
    return this.tower.equal(this.meetingTime(contact, 'hit'), twice)
  }

  atTime(contact, time) {
    return this.tower.equal(this.meetingTime(contact, 'hit'), time)
  }

  grazes(contact) {
    return exactlyZero(this.#relative(contact, this.#now(contact)).discriminant)
  }

  together(contact) {
    const { vx, vy } = this.#relative(contact, this.#now(contact))
    return exactlyZero(vx) && exactlyZero(vy)
  }

  /** Whether the closing speed is zero; `time` is that at which it is asked. */
  still(contact, time) {
    const q = this.tower
    const [i, j] = contact
    const lines = this.#now(contact)
    if (j >= this.scene.n) {
      const [nx, ny] = this.#normal(i, j - this.scene.n)
      return exactlyZero(q.dot(nx, ny, lines[0].vx, lines[0].vy))
    }
    const { dx, dy, vx, vy, speed } = this.#relative(contact, lines)
    if (exactlyZero(speed)) return true
    return exactlyZero(q.add(q.dot(dx, dy, vx, vy), q.mul(speed, this.#time(time))))
  }

  /** Whether a centre is on a rim at a time. */
  onRim(contact, time) {
    const q = this.tower
    const lines = this.#now(contact)
    const [dx, dy] = this.#between(contact, () => lines[0], this.#time(time))
    const reach = this.#reach(contact)
    return exactlyZero(q.sub(q.dot(dx, dy, dx, dy), q.mul(reach, reach)))
  }

  /** Whether 2u + G s is zero for a contact, s the impulses of those that push. */
  slack(contact, push, time) {
    const q = this.tower
    const circles = new Set([contact, ...push].flatMap((c) => this.scene.circlesOf(c)))
    const lines = new Map([...circles].map((i) => [i, this.#lineNow(i)]))
    const line = (i) => lines.get(i)
    const when = this.#time(time)
    const arms = this.#arms(contact, line, when)
    const solved = this.#impulses(push, line, when)
    const u = this.#speed(arms, line)
    const sum = solved.arms.reduce(
      (total, other, k) => q.add(total, q.mul(this.#coupling(arms, other), solved.impulses[k])),
      q.add(u, u),
    )
    return exactlyZero(sum)
  }

  #lineNow(i) {
    this.#ensure(this.#last(i, this.log.length(i)))
    return this.#line(i, this.log.length(i))
  }
}
