// The check of a certificate, instant by instant: docs/certificates.md, "How to check".

import { Entries } from './entries.mjs'
import { decimalParts } from './format.mjs'
import { Rounds } from './impulses.mjs'
import { Fixed, apart, isZero, lower, sameSingle, sign, upper } from './interval.mjs'
import { Log } from './log.mjs'
import { Geometry } from './meetings.mjs'
import { Refuted, Undecided } from './outcome.mjs'
import { AT_SET_TIME, AT_START, metThen } from './replay.mjs'
import { Scene } from './scene.mjs'
import { Sweep } from './sweep.mjs'
import { Twister } from './twister.mjs'
import { Prover } from './witnesses.mjs'

/** Bits of a first look at a contact; where they do not tell, the certificate's own decide. */
const GLANCE = 96

/** The check of one certificate; `factor` multiplies the bits that it states. */
export class Check {
  constructor(data, work, factor = 1) {
    this.data = data
    this.work = work
    this.bits = new Map(data.bits.map(([k, bits]) => [k, bits * factor]))
    this.now = 'the scene'
    this.scene = new Scene(data, work)
    this.log = new Log(this.scene)
    this.side = (i, wall) => this.sides[i * this.scene.walls.length + wall]
    this.prover = new Prover(data, this.scene, this.log, this.side)
    this.events = 0
    this.reversed = null // {time, ...} of the reversal, once it has been
    this.captured = new Set()
    const seed = /seed=([0-9]+)/.exec(this.scene.policy)
    this.draws = seed ? new Twister(seed[1]) : null
  }

  /** Throws where the certificate does not hold. */
  run() {
    this.#walls()
    this.#setBits(0)
    this.now = 'start'
    this.#start(this.data.start)
    this.data.instants.forEach((told, k) => {
      this.now = `instant ${k + 1}`
      this.#instant(told, k + 1)
    })
    this.now = 'end'
    this.#finish()
  }

  // Numbers

  #setBits(k) {
    const bits = this.bits.get(k)
    const before = this.fine?.fixed.bits
    if (bits === undefined || bits === before) return
    const fixed = new Fixed(bits, this.work)
    this.fine = new Geometry(this.scene, fixed, this.side)
    this.glance = bits > GLANCE ? new Geometry(this.scene, new Fixed(GLANCE, this.work), this.side) : this.fine
    if (before === undefined) return
    const from = (x) => fixed.from(x, before)
    this.flights = this.flights.map(({ x, y, vx, vy, t, at, start }) => {
      return { x: from(x), y: from(y), vx: from(vx), vy: from(vy), t: from(t), at, start, bits }
    })
    if (this.reversed) this.reversed.time = from(this.reversed.time)
    this.last = { time: from(this.last.time), at: this.last.at }
    this.sweep.convert(from)
  }

  #enclose(x) {
    return this.scene.tower.enclose(x, this.fine.fixed)
  }

  /** On which side of each wall each circle starts. */
  #walls() {
    const { tower: q, circles, walls } = this.scene
    this.sides = new Int8Array(circles.length * walls.length)
    circles.forEach((circle, i) => {
      if (circle.fixed) return
      walls.forEach((wall, k) => {
        const side = q.sign(q.dot(wall.nx, wall.ny, q.sub(circle.x, wall.x0), q.sub(circle.y, wall.y0)))
        if (side === 0) throw new Refuted(`the centre of circle ${i} is on wall ${k}`)
        this.sides[i * walls.length + k] = side
      })
    })
  }

  /** That a value differs from a decimal by less than a unit of its last digit. */
  #decimal(text, value, what) {
    const [units, digits] = decimalParts(text)
    const { shift } = this.fine.fixed
    const scale = 10n ** BigInt(digits)
    const [low, high] = [lower(value) * scale, upper(value) * scale]
    const [least, most] = [(units - 1n) << shift, (units + 1n) << shift]
    if (low > least && high < most) return
    if (high <= least || low >= most) throw new Refuted(`${what} is not ${text}`)
    throw new Undecided(`whether ${what} is ${text}`)
  }

  // Time 0

  #start(told) {
    const { scene } = this
    const { bits, zero } = this.fine.fixed
    this.flights = scene.circles.map(({ x, y, vx, vy }) => {
      const [a, b, c, d] = [x, y, vx, vy].map((value) => this.#enclose(value))
      return { x: a, y: b, vx: c, vy: d, t: zero, at: 0, start: AT_START, bits }
    })
    this.last = { time: zero, at: 0 }
    this.sweep = new Sweep(this)
    const instant = this.#part({ at: 0, time: zero, node: AT_START, standing: new Map(), rims: new Map() }, told)
    for (const contact of this.sweep.contacts()) {
      const key = scene.key(contact)
      const gap = this.#gapAtStart(contact)
      if (gap < 0 && !scene.isPocket(contact)) throw new Refuted(`[${contact}] overlap`)
      if (gap < 0) instant.shut.add(key)
      else if (gap === 0 && scene.isPocket(contact)) instant.rims.set(key, contact)
      else if (gap === 0) instant.standing.set(key, { contact, sign: this.closing(contact, instant) })
    }
    this.#happen(instant, told, false)
  }

  #gapAtStart(contact) {
    for (const geometry of [this.glance, this.fine]) {
      const found = sign(geometry.gap(geometry.measures(contact, this.flights)))
      if (found !== undefined) return found
    }
    const { tower: q, circles, walls, pockets, n } = this.scene
    const [i, j] = contact
    const circle = circles[i]
    if (j >= n) {
      const { nx, ny, x0, y0, square } = walls[j - n]
      const height = q.dot(nx, ny, q.sub(circle.x, x0), q.sub(circle.y, y0))
      return q.sign(q.sub(q.mul(height, height), q.mul(square, q.mul(circle.r, circle.r))))
    }
    const other = j >= 0 ? circles[j] : pockets[-1 - j]
    const [dx, dy] = [q.sub(other.x, circle.x), q.sub(other.y, circle.y)]
    const reach = j >= 0 ? q.add(circle.r, other.r) : other.r
    return q.sign(q.sub(q.dot(dx, dy, dx, dy), q.mul(reach, reach)))
  }

  /** The sign of a closing speed on the flights of now. */
  closing(contact, { witnesses }) {
    const found = sign(this.fine.measures(contact, this.flights).closing)
    if (found !== undefined) return found
    if (witnesses.shows('still', contact, { time: this.flights[contact[0]].start })) return 0
    throw new Undecided(`the sign of the closing speed of [${contact}]`)
  }

  // An instant

  /** An instant, or its part after the reversal, with what is told of it. */
  #part(instant, { rounds = [], entries = [], zeros }) {
    const witnesses = this.prover.witnesses(zeros)
    return { loose: [], ...instant, rounds, entries, witnesses, pushed: new Set(), shut: new Set() }
  }

  #instant(told, at) {
    if (this.#limited()) throw new Refuted('it is told, and is beyond the limit of events')
    this.#setBits(at)
    const { arrive = [], grazes = [] } = told
    const [clock] = arrive
    const alone = arrive.length === 1 && !this.scene.isPocket(clock) ? [[clock]] : []
    const instant = this.#part({ at, standing: new Map(), rims: new Map() }, { ...told, rounds: told.rounds ?? alone })
    this.sweep.resolve(instant.witnesses)
    instant.time = clock ? this.sweep.hit(clock) : this.#setTime(told)
    instant.node = clock ? metThen(clock, this.log) : AT_SET_TIME
    this.#decimal(told.time, instant.time, 'its time')
    this.#beforeEnd(clock, instant)
    const due = this.#reachesSetTime(clock, instant)
    this.#gather(arrive, grazes, instant)
    const listed = new Set([...instant.standing.keys(), ...instant.rims.keys()])
    this.sweep.pass(instant.time, listed)
    instant.loose = this.sweep.loose(instant.time, listed)
    for (const [key, contact] of this.sweep.lasting) instant.standing.set(key, { contact, sign: 0 })
    this.last = { time: instant.time, at }
    this.#happen(instant, told, due)
  }

  /** The time of an instant at which nothing arrives. */
  #setTime({ grazes, rounds, entries }) {
    if (this.scene.reverseAt === undefined || this.reversed) throw new Refuted('nothing arrives, and no reversal is set')
    if (grazes?.length || rounds?.length || entries?.length) throw new Refuted('something happens where nothing arrives')
    return this.#enclose(this.scene.reverseAt)
  }

  /** -1 or 0 for the time of an instant and one that it must not exceed. */
  #upTo(limit, question, clock, { time, witnesses }, given) {
    if (upper(time) < lower(limit)) return -1
    if (lower(time) > upper(limit)) throw new Refuted(`it comes after the ${question === 'until' ? 'end' : 'set time'}`)
    if (sameSingle(time, limit) || witnesses.shows(question, clock, given)) return 0
    throw new Undecided(`whether it comes before the ${question === 'until' ? 'end' : 'set time'}, or at it`)
  }

  #beforeEnd(clock, instant) {
    const { scene, reversed } = this
    const { reason } = this.data.end
    if (reason === 'horizon' && !clock) {
      if (scene.tower.sign(scene.tower.sub(scene.until, scene.reverseAt)) < 0) throw new Refuted('it comes after the end')
    } else if (reason === 'horizon') {
      this.#upTo(this.#enclose(scene.until), 'until', clock, instant, { until: scene.until })
    } else if (reason === 'return' && reversed) {
      this.#upTo(this.fine.fixed.twice(reversed.time), 'until', clock, instant, {})
    }
  }

  /** Whether the reversal at a set time falls on the instant. */
  #reachesSetTime(clock, instant) {
    const { reverseAt } = this.scene
    if (reverseAt === undefined || this.reversed) return false
    return !clock || this.#upTo(this.#enclose(reverseAt), 'reverse', clock, instant, {}) === 0
  }

  /** Steps 1 and 2: what arrives and grazes, all at one time. */
  #gather(arrive, grazes, instant) {
    const { scene, sweep } = this
    const listed = new Map()
    const add = (contact, kind, time) => {
      const key = scene.key(contact)
      if (listed.has(key)) throw new Refuted(`[${contact}] is listed twice`)
      if (listed.size) this.#tie(contact, kind, time, instant, listed, arrive[0])
      listed.set(key, kind)
      if (scene.isPocket(contact)) instant.rims.set(key, contact)
      else instant.standing.set(key, { contact, sign: kind === 'hit' ? -1 : 0 })
    }
    for (const contact of arrive) add(contact, 'hit', sweep.hit(contact))
    for (const contact of grazes) {
      if (!scene.isPair(contact)) throw new Refuted(`[${contact}] is no contact of two circles, and grazes`)
      add(contact, 'graze', sweep.graze(contact))
    }
  }

  #tie(contact, kind, time, instant, listed, clock) {
    if (apart(time, instant.time)) throw new Refuted(`[${contact}] does not come at that time`)
    if (sameSingle(time, instant.time)) return
    const shown = instant.witnesses.shows('tie', contact, ({ other = clock }) => {
      const otherKind = this.scene.has(other) && listed.get(this.scene.key(other))
      return otherKind ? { kind, other, otherKind } : null
    })
    if (!shown) throw new Undecided(`whether [${contact}] comes at that time`)
  }

  // What happens at it

  /** Steps 4 to 7. */
  #happen(instant, told, setTime) {
    this.log.atZero.push(new Set(instant.standing.keys()))
    this.#settle(instant, instant.at === 0, false)
    const due = setTime || (!this.reversed && this.events >= this.scene.reverseAfter)
    const wanted = due && !this.#limited()
    if (wanted && !told.reversal) throw new Refuted('the reversal falls on it, and is not told')
    if (!wanted && told.reversal) throw new Refuted('a reversal is told that does not fall on it')
    const last = wanted ? this.#reverse(instant, told.reversal) : instant
    const changed = wanted ? this.movable() : instant.pushed
    const all = new Set(instant.at === 0 ? this.scene.circles.keys() : [...changed, ...this.captured])
    this.sweep.update(all, new Set([...instant.standing.keys(), ...instant.rims.keys(), ...last.shut]))
  }

  #settle(instant, all, afterReversal) {
    new Rounds(this, instant).run()
    this.#last(instant, all)
    new Entries(this, instant).run(afterReversal)
    if (instant.rounds.length) this.events++
  }

  #limited() {
    const { reason, limit } = this.data.end
    return reason === 'events' && this.events >= limit
  }

  /** The circles in play that move, or may. */
  movable() {
    return [...this.scene.circles.keys()].filter((i) => this.scene.movable(i) && !this.captured.has(i))
  }

  /** Step 5: which contacts last. */
  #last({ standing, pushed, witnesses }, all) {
    const { lasting } = this.sweep
    for (const [key, { contact, sign: closing }] of standing) {
      if (!all && !this.scene.circlesOf(contact).some((i) => pushed.has(i))) continue
      if (closing === 0 && this.#stays(contact, witnesses)) lasting.set(key, contact)
      else lasting.delete(key)
    }
  }

  #stays(contact, witnesses) {
    if (this.scene.isWall(contact)) return true
    const { vx, vy } = this.fine.measures(contact, this.flights)
    if (sign(vx) ** 2 === 1 || sign(vy) ** 2 === 1) return false
    if ((isZero(vx) && isZero(vy)) || witnesses.shows('together', contact)) return true
    throw new Undecided(`whether [${contact}] stay together`)
  }

  /** Step 7. */
  #reverse(instant, told) {
    const { time, at, node } = instant
    const { fixed } = this.fine
    const circles = this.movable()
    for (const i of circles) {
      const flight = this.flights[i]
      const [x, y] = this.fine.place(flight, time, at)
      const [vx, vy] = [fixed.neg(flight.vx), fixed.neg(flight.vy)]
      this.flights[i] = { x, y, vx, vy, t: time, at, start: node, bits: fixed.bits }
    }
    this.log.reversal(circles, at, node)
    this.reversed = { time }
    this.prover.reversal = node
    for (const [key, { contact, sign: closing }] of instant.standing) {
      if (this.scene.circlesOf(contact).some((i) => this.captured.has(i))) instant.standing.delete(key)
      else instant.standing.set(key, { contact, sign: -closing })
    }
    const after = this.#part({ ...instant, clock: node }, told)
    this.#settle(after, false, true)
    return after
  }

  // The end

  #finish() {
    const { end, final } = this.data
    const { scene, sweep } = this
    if (!['events', 'stopped'].includes(end.reason)) sweep.resolve(this.prover.witnesses(end.zeros))
    const setTime = this.reversed ? undefined : scene.reverseAt
    let last = this.last
    if (end.reason === 'quiet') {
      if (setTime) throw new Refuted('a reversal is still to come')
      sweep.quiet()
    } else if (end.reason === 'horizon') {
      if (setTime && scene.tower.sign(scene.tower.sub(setTime, scene.until)) <= 0) {
        throw new Refuted('the reversal comes before it, and is not told')
      }
      last = { time: this.#enclose(scene.until) }
    } else if (end.reason === 'return') {
      if (!this.reversed) throw new Refuted('there is no reversal')
      last = { time: this.fine.fixed.twice(this.reversed.time) }
    } else if (end.reason === 'events' && this.events !== end.limit) {
      throw new Refuted(`${this.events} events are told, not ${end.limit}`)
    }
    if (last !== this.last) sweep.pass(last.time, new Set())
    this.#decimal(final.time, last.time, 'the final time')
    this.flights.forEach((flight, i) => {
      const place = this.fine.place(flight, last.time, last.at)
      const state = [...place, flight.vx, flight.vy]
      state.forEach((value, k) => this.#decimal(final.circles[i][k], value, `${['x', 'y', 'vx', 'vy'][k]} of circle ${i}`))
    })
  }
}
