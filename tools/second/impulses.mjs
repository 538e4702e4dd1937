// Rounds of impulses at one instant: step 4 of docs/certificates.md.

import { bitLength, Refuted, Undecided } from './outcome.mjs'
import { isZero, sign } from './interval.mjs'
import { AT_START, metThen } from './replay.mjs'

/** Groups of contacts that hang together through circles, fixed ones included; contacts in the scene order. */
function groups(contacts, scene) {
  const parent = new Map()
  const find = (i) => {
    while (parent.get(i) !== i) {
      parent.set(i, parent.get(parent.get(i)))
      i = parent.get(i)
    }
    return i
  }
  for (const contact of contacts) {
    const circles = scene.circlesOf(contact)
    for (const i of circles) if (!parent.has(i)) parent.set(i, i)
    if (circles.length === 2) parent.set(find(circles[0]), find(circles[1]))
  }
  const found = new Map()
  for (const contact of contacts) {
    const root = find(contact[0])
    if (!found.has(root)) found.set(root, [])
    found.get(root).push(contact)
  }
  return [...found.values()]
}

/** The rounds of one instant, or of its part after the reversal. */
export class Rounds {
  /** `instant`: {at, time, standing, rounds, witnesses, loose, pushed, clock}; `standing` is key -> {contact, sign}. */
  constructor(check, instant) {
    this.check = check
    this.instant = instant
    this.scene = check.scene
    this.fixed = check.fine.fixed
    this.next = 0
  }

  /** Carries out all rounds of the log, and shows that they are those that the policy asks for. */
  run() {
    const { standing, rounds, loose } = this.instant
    const all = [...standing.values()].filter(({ contact }) => !this.scene.isPocket(contact))
    all.sort((a, b) => this.scene.key(a.contact) - this.scene.key(b.contact))
    const least = (group) => group.find((contact) => this.#sign(contact) < 0)
    const active = groups(all.map(({ contact }) => contact), this.scene).filter(least)
    active.sort((a, b) => this.scene.key(least(a)) - this.scene.key(least(b)))
    for (const group of active) {
      const circles = new Set(group.flatMap((contact) => this.scene.circlesOf(contact)))
      for (const contact of loose) {
        if (this.scene.circlesOf(contact).some((i) => circles.has(i))) {
          throw new Undecided(`whether [${contact}] grazes at this instant`)
        }
      }
      this.#group(group, circles, least(group))
    }
    if (this.next < rounds.length) throw new Refuted('impulses where nothing approaches')
  }

  #sign(contact) {
    return this.instant.standing.get(this.scene.key(contact)).sign
  }

  #group(group, circles, least) {
    const { at, time, rounds } = this.instant
    const { flights } = this.check
    this.when = this.instant.clock ?? (at === 0 ? AT_START : metThen(least, this.check.log))
    this.places = new Map([...circles].map((i) => [i, this.check.fine.place(flights[i], time, at)]))
    this.speeds = new Map([...circles].map((i) => [i, [flights[i].vx, flights[i].vy]]))
    this.armsOf = new Map()
    const pushed = new Set()
    for (;;) {
      const approaching = group.filter((contact) => this.#sign(contact) < 0)
      if (!approaching.length) break
      if (this.next === rounds.length) throw new Refuted(`[${approaching[0]}] approaches, and no impulse follows`)
      this.#round(group, approaching, rounds[this.next++], pushed)
    }
    for (const i of pushed) {
      const [[x, y], [vx, vy]] = [this.places.get(i), this.speeds.get(i)]
      flights[i] = { x, y, vx, vy, t: time, at, bits: this.fixed.bits, start: this.when }
      this.instant.pushed.add(i)
    }
  }

  #round(group, approaching, push, pushed) {
    const keys = new Set(push.map((contact) => this.scene.key(contact)))
    const keysApproaching = new Set(approaching.map((contact) => this.scene.key(contact)))
    if (keys.size < push.length) throw new Refuted('a contact pushes twice in one round')
    for (const contact of push) {
      if (!this.scene.has(contact) || !keysApproaching.has(this.scene.key(contact))) {
        throw new Refuted(`[${contact}] is said to push, and does not approach`)
      }
    }
    const ordered = this.scene.policy !== 'simultaneous'
    if (ordered) {
      const chosen = this.#chosen(approaching)
      if (push.length > 1 || !keys.has(this.scene.key(chosen))) throw new Refuted(`[${chosen}] is the one to push`)
    }
    const arms = push.map((contact) => this.#arms(contact))
    const impulses = this.#impulses(push, arms)
    impulses.forEach((s, k) => {
      const found = sign(s)
      if (found === undefined) throw new Undecided(`the sign of the impulse at [${push[k]}]`)
      if (found < 1) throw new Refuted(`the impulse at [${push[k]}] is not positive`)
    })
    if (!ordered) {
      for (const contact of approaching) {
        if (!keys.has(this.scene.key(contact))) this.#slack(contact, push, arms, impulses)
      }
    }
    this.check.log.round(ordered ? push : approaching, push, this.instant.at, this.when)
    const struck = this.#apply(arms, impulses)
    for (const i of struck) pushed.add(i)
    for (const contact of group) {
      if (!this.scene.circlesOf(contact).some((i) => struck.has(i))) continue
      const key = this.scene.key(contact)
      // A contact that pushed parts at -u; one with slack at no less.
      const parts = ordered ? keys.has(key) : keysApproaching.has(key)
      this.instant.standing.get(key).sign = parts ? 1 : this.#signed(contact)
    }
  }

  #chosen(approaching) {
    const { draws } = this.check
    return approaching[draws && approaching.length > 1 ? draws.below(approaching.length) : 0]
  }

  /** The sign of a closing speed. */
  #signed(contact) {
    const { witnesses } = this.instant
    const found = sign(this.#speed(this.#arms(contact)))
    if (found !== undefined) return found
    if (witnesses.shows('still', contact, { time: this.when })) return 0
    throw new Undecided(`the sign of the closing speed of [${contact}]`)
  }

  #slack(contact, push, arms, impulses) {
    const { witnesses } = this.instant
    const f = this.fixed
    const own = this.#arms(contact)
    let slack = f.twice(this.#speed(own))
    arms.forEach((other, k) => {
      slack = f.add(slack, f.mul(this.#coupling(own, other), impulses[k]))
    })
    const found = sign(slack)
    if (found < 0) throw new Refuted(`[${contact}] would part more slowly than it approached`)
    if (found !== undefined || witnesses.shows('slack', contact, { push, time: this.when })) return
    throw new Undecided(`whether [${contact}] parts as fast as it approached`)
  }

  #apply(arms, impulses) {
    const f = this.fixed
    const struck = new Set()
    arms.forEach((arm, k) => {
      for (const { i, x, y } of arm.ends) {
        if (!this.scene.movable(i)) continue
        struck.add(i)
        const change = f.mul(this.check.fine.constants.w[i], impulses[k])
        const [vx, vy] = this.speeds.get(i)
        this.speeds.set(i, [f.add(vx, f.mul(change, x)), f.add(vy, f.mul(change, y))])
      }
    })
    return struck
  }

  // J, u and G

  /** J of a contact, times a power of two that makes short arms longer, and its entry in the diagonal of G. */
  #arms(contact) {
    const key = this.scene.key(contact)
    if (!this.armsOf.has(key)) this.armsOf.set(key, this.#newArms(contact))
    return this.armsOf.get(key)
  }

  #newArms([i, j]) {
    const f = this.fixed
    const { r, w, walls } = this.check.fine.constants
    let ends, square, weight
    if (j < this.scene.n) {
      const [[px, py], [qx, qy]] = [this.places.get(i), this.places.get(j)]
      const [x, y] = [f.sub(qx, px), f.sub(qy, py)]
      ends = [{ i, x: f.neg(x), y: f.neg(y) }, { i: j, x, y }]
      square = f.square(f.add(r[i], r[j]))
      weight = f.add(w[i], w[j])
    } else {
      const [x, y] = this.check.fine.normal(i, j - this.scene.n)
      ends = [{ i, x, y }]
      square = walls[j - this.scene.n].square
      weight = w[i]
    }
    const up = BigInt(Math.max(0, Math.ceil((f.bits - bitLength(square.m)) / 2)))
    return {
      ends: ends.map((end) => ({ i: end.i, x: f.shifted(end.x, up), y: f.shifted(end.y, up) })),
      diagonal: f.mul(weight, f.shifted(square, 2n * up)),
    }
  }

  #speed({ ends }) {
    const f = this.fixed
    const speed = ({ i, x, y }) => f.dot(x, y, ...this.speeds.get(i))
    return ends.map(speed).reduce((sum, part) => f.add(sum, part))
  }

  #coupling(a, b) {
    if (a === b) return a.diagonal
    const f = this.fixed
    let sum = f.zero
    for (const end of a.ends) {
      const other = b.ends.find(({ i }) => i === end.i)
      if (other) sum = f.add(sum, f.mul(this.check.fine.constants.w[end.i], f.dot(end.x, end.y, other.x, other.y)))
    }
    return sum
  }

  /** The solution of G s = -2u. */
  #impulses(push, arms) {
    const f = this.fixed
    const rows = arms.map((a) => [...arms.map((b) => this.#coupling(a, b)), f.neg(f.twice(this.#speed(a)))])
    const exact = rows.every((row) => row.every((x) => x.r === 0n))
    const n = rows.length
    let last = f.whole(1)
    for (let k = 0; k < n; k++) {
      const pivot = rows[k][k]
      if (sign(pivot) !== 1) throw new Undecided(`whether the impulses of [${push[k]}] are unique`)
      for (let i = k + 1; i < n; i++) {
        const factor = rows[i][k]
        for (let j = k + 1; j <= n; j++) {
          // Without fractions (Bareiss) what is exact stays so; where nothing is, they cost fewer bits.
          const product = f.mul(factor, rows[k][j])
          if (exact) rows[i][j] = f.div(f.sub(f.mul(pivot, rows[i][j]), product), last)
          else if (!isZero(product)) rows[i][j] = f.sub(rows[i][j], f.div(product, pivot))
        }
      }
      last = pivot
    }
    const s = []
    for (let k = n - 1; k >= 0; k--) {
      let right = rows[k][n]
      for (let j = k + 1; j < n; j++) right = f.sub(right, f.mul(rows[k][j], s[j]))
      s[k] = f.div(right, rows[k][k])
    }
    return s
  }
}
