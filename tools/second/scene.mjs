// The scene in exact numbers, and its constants as intervals.

import { exactNumber } from './format.mjs'
import { sign } from './interval.mjs'
import { NoCertificate } from './outcome.mjs'
import { ONE, Tower, ZERO, exactlyZero } from './tower.mjs'

/** What a certificate's `roots` and `scene` say, exactly. Contacts are [i, j] as the page numbers them. */
export class Scene {
  constructor(data, work) {
    const tower = new Tower(work)
    const roots = []
    data.roots.forEach((text, k) => {
      const radicand = exactNumber(text, tower, roots, `roots[${k}]`)
      if (tower.sign(radicand) <= 0) throw new NoCertificate(`roots[${k}]: not positive`)
      roots.push(tower.sqrt(radicand))
    })
    this.tower = tower
    this.number = (text, where) => exactNumber(text, tower, roots, where)
    const { circles, walls = [], pockets = [], capture = false } = data.scene
    const read = (thing, keys, where) =>
      Object.fromEntries(keys.map((key) => [key, this.number(thing[key], `${where}.${key}`)]))
    this.circles = circles.map((circle, k) => this.#circle(circle, read, `circles[${k}]`))
    this.walls = walls.map((wall, k) => this.#wall(read(wall, ['x0', 'y0', 'x1', 'y1'], `walls[${k}]`), k))
    this.pockets = pockets.map((pocket, k) => {
      const found = read(pocket, ['x', 'y', 'r'], `pockets[${k}]`)
      return this.#positive(found, 'r', `pockets[${k}].r`)
    })
    this.capture = capture
    this.policy = data.scene.tie_policy
    this.reverseAfter = data.scene.reverse_after
    const set = data.scene.reverse_at
    this.reverseAt = set === undefined ? undefined : this.#setTime(set, 'reverse_at')
    this.until = data.end.reason === 'horizon' ? this.#setTime(data.end.until, 'until') : undefined
    this.n = circles.length
    this.stride = this.n + walls.length + pockets.length
  }

  #setTime(text, where) {
    return this.#positive({ t: this.number(text, where) }, 't', where).t
  }

  #positive(thing, key, where) {
    if (this.tower.sign(thing[key]) <= 0) throw new NoCertificate(`scene: ${where} is not positive`)
    return thing
  }

  #circle(circle, read, where) {
    const found = read(circle, ['x', 'y', 'r', 'vx', 'vy'], where)
    if (this.tower.sign(found.r) < 0) throw new NoCertificate(`scene: ${where}.r is negative`)
    found.fixed = circle.m === 'oo'
    if (found.fixed && !(exactlyZero(found.vx) && exactlyZero(found.vy))) {
      throw new NoCertificate(`scene: ${where} is fixed and moves`)
    }
    found.m = found.fixed ? null : this.number(circle.m, `${where}.m`)
    if (!found.fixed) this.#positive(found, 'm', `${where}.m`)
    found.w = found.fixed ? ZERO : this.tower.div(ONE, found.m)
    return found
  }

  #wall({ x0, y0, x1, y1 }, k) {
    const [nx, ny] = [this.tower.sub(y0, y1), this.tower.sub(x1, x0)]
    const square = this.tower.dot(nx, ny, nx, ny)
    if (exactlyZero(square)) throw new NoCertificate(`scene: walls[${k}] is one point`)
    return { x0, y0, x1, y1, nx, ny, square }
  }

  // Contacts

  /** Whether there is such a contact. */
  has([i, j]) {
    const [n, walls, pockets] = [this.n, this.walls.length, this.pockets.length]
    return i < n && (j < 0 ? j >= -pockets : j < n ? i < j : j < n + walls)
  }

  isPocket([, j]) {
    return j < 0
  }

  isWall([, j]) {
    return j >= this.n
  }

  isPair([, j]) {
    return j >= 0 && j < this.n
  }

  /** A contact as one whole number; the order of keys is the scene order among circles and walls. */
  key([i, j]) {
    return i * this.stride + (j < 0 ? this.stride - 1 - (-1 - j) : j)
  }

  contact(key) {
    const j = key % this.stride
    const walls = this.n + this.walls.length
    return [Math.floor(key / this.stride), j < walls ? j : j - this.stride]
  }

  /** The circles of a contact. */
  circlesOf([i, j]) {
    return j >= 0 && j < this.n ? [i, j] : [i]
  }

  movable(i) {
    return !this.circles[i].fixed
  }

  /** Whether the two can meet at all. */
  meets([i, j]) {
    const a = this.circles[i]
    if (j < 0 || j >= this.n) return !a.fixed
    const b = this.circles[j]
    return !(a.fixed && b.fixed) && !(exactlyZero(a.r) && exactlyZero(b.r))
  }
}

/** The constants of a scene as intervals in one arithmetic. */
export class Constants {
  constructor(scene, fixed) {
    const { tower } = scene
    const enclose = (x) => tower.enclose(x, fixed)
    this.r = scene.circles.map((circle) => enclose(circle.r))
    this.w = scene.circles.map((circle) => enclose(circle.w))
    this.walls = scene.walls.map((wall) => ({
      x: enclose(wall.x0),
      y: enclose(wall.y0),
      nx: enclose(wall.nx),
      ny: enclose(wall.ny),
      square: enclose(wall.square),
      length: rootOf(tower, wall.square, fixed),
    }))
    this.pockets = scene.pockets.map(({ x, y, r }) => ({ x: enclose(x), y: enclose(y), r: enclose(r) }))
  }
}

/** The square root of an exact positive number, which may be too small for the arithmetic's own bits. */
function rootOf(tower, square, fixed) {
  for (let bits = fixed.bits; ; bits *= 2) {
    const finer = new fixed.constructor(bits, fixed.work)
    const found = tower.enclose(square, finer)
    if (sign(found) === 1) return fixed.from(finer.sqrt(found), bits)
  }
}
