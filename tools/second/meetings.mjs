// When two straight flights meet: the table of docs/certificates.md ("Numbers") in intervals.
//
// A gap is convex in time, so it falls through zero at most once. The gap of two flights at their later start is never
// negative, but for a centre inside a pocket; that is shown by the steps before, and used here.

import { lower, sign, upper } from './interval.mjs'
import { bitLength } from './outcome.mjs'
import { Constants } from './scene.mjs'

/** Bits after the point of times of which only a lower bound is kept. */
export const CLEAR_BITS = 64

/** Flights and their meetings, in one arithmetic. */
export class Geometry {
  constructor(scene, fixed, sides) {
    this.scene = scene
    this.fixed = fixed
    this.sides = sides
    this.constants = new Constants(scene, fixed)
  }

  /** A flight in this arithmetic; it is remembered with the flight. */
  #here(flight) {
    if (flight.bits === this.fixed.bits) return flight
    if (flight.other?.bits === this.fixed.bits) return flight.other
    const { x, y, vx, vy, t, at } = flight
    const from = (value) => this.fixed.from(value, flight.bits)
    flight.other = { x: from(x), y: from(y), vx: from(vx), vy: from(vy), t: from(t), at, bits: this.fixed.bits }
    return flight.other
  }

  /** Where a flight is at a time; `at` is the number of the instant that this is, if it is one. */
  place(flight, time, at) {
    const { x, y, vx, vy, t, at: start } = this.#here(flight)
    if (start === at) return [x, y]
    const f = this.fixed
    const since = f.sub(time, t)
    return [f.add(x, f.mul(vx, since)), f.add(y, f.mul(vy, since))]
  }

  /** The normal of a wall, turned to the side of circle i. */
  normal(i, wall) {
    const { nx, ny } = this.constants.walls[wall]
    return this.sides(i, wall) > 0 ? [nx, ny] : [this.fixed.neg(nx), this.fixed.neg(ny)]
  }

  /**
   * What the table needs, at the later start t; of a wall the gap and the closing speed, else d, v, the reach and d.v.
   * Slow flights are seen in a faster unit of time, 2**up of the scene's, lest the squares of their speeds lose bits.
   */
  measures([i, j], flights) {
    const f = this.fixed
    const first = this.#here(flights[i])
    if (j >= this.scene.n) {
      const wall = j - this.scene.n
      const [nx, ny] = this.normal(i, wall)
      const { x, y, length } = this.constants.walls[wall]
      const height = f.dot(nx, ny, f.sub(first.x, x), f.sub(first.y, y))
      const gap = f.sub(height, f.mul(this.constants.r[i], length))
      return { t: first.t, up: 0n, gap, closing: f.dot(nx, ny, first.vx, first.vy) }
    }
    const second = j >= 0 ? this.#here(flights[j]) : this.constants.pockets[-1 - j]
    const later = j >= 0 && second.at > first.at ? second : first
    const { t, at } = later
    const [px, py] = this.place(first, t, at)
    const [qx, qy] = j >= 0 ? this.place(second, t, at) : [second.x, second.y]
    const [dx, dy] = [f.sub(qx, px), f.sub(qy, py)]
    const slow = j >= 0 ? [f.sub(second.vx, first.vx), f.sub(second.vy, first.vy)] : [f.neg(first.vx), f.neg(first.vy)]
    const up = BigInt(Math.max(0, f.bits - Math.max(...slow.map((v) => bitLength(v.m)))))
    const [vx, vy] = slow.map((v) => f.shifted(v, up))
    const reach = j >= 0 ? f.add(this.constants.r[i], this.constants.r[j]) : second.r
    return { t, up, dx, dy, vx, vy, reach, closing: f.dot(dx, dy, vx, vy) }
  }

  /** The gap of what has been measured. */
  gap({ gap, dx, dy, reach }) {
    const f = this.fixed
    return gap ?? f.sub(f.add(f.square(dx), f.square(dy)), f.square(reach))
  }

  /** {kind, time, ...measures}: `never`, `hit`, `graze` (time: when), or `doubt`. */
  meeting(contact, flights) {
    const f = this.fixed
    const found = this.measures(contact, flights)
    const closing = sign(found.closing)
    if (closing >= 0) return { kind: 'never' }
    if (this.scene.isWall(contact)) {
      if (closing === undefined) return { kind: 'doubt', ...found }
      return { kind: 'hit', ...found, time: f.sub(found.t, f.div(found.gap, found.closing)) }
    }
    const { t, up, dx, dy, vx, vy, reach } = found
    found.speed = f.add(f.square(vx), f.square(vy))
    const square = f.square(reach)
    const cross = f.sub(f.mul(dx, vy), f.mul(dy, vx))
    const discriminant = f.sub(f.mul(found.speed, square), f.square(cross))
    if (sign(discriminant) === -1) return { kind: 'never' }
    found.gap = this.gap(found)
    if (contact[1] < 0 && sign(found.gap) === -1) return { kind: 'never' }
    if (closing === undefined) return { kind: 'doubt', ...found }
    if (sign(discriminant) === 1) {
      const rate = f.sub(f.sqrt(discriminant), found.closing)
      const time = f.add(t, f.div(f.shifted(found.gap, up), rate))
      return { kind: 'hit', ...found, time }
    }
    if (sign(discriminant) === 0) return { kind: 'graze', ...found, time: this.grazeTime(found) }
    return { kind: 'doubt', ...found }
  }

  /** When two flights that graze do so, closing < 0. */
  grazeTime({ t, up, closing, speed }) {
    return this.fixed.sub(t, this.fixed.div(this.fixed.shifted(closing, up), speed))
  }

  /** A bound with CLEAR_BITS: nothing meets from the start up to it and at it. */
  clear(meeting) {
    const f = this.fixed
    if (meeting.kind === 'hit') return coarse(lower(meeting.time), f.bits) - 1n
    const gap = lower(meeting.gap)
    if (gap <= 0n) return -1n
    const speed = fastest(meeting.closing)
    if (speed === 0n) return null
    // gap - 2 |closing| s > 0 for all s below gap / (2 |closing|)
    return coarse(lower(meeting.t) + (gap << (f.shift + meeting.up)) / (2n * speed), f.bits) - 1n
  }

  /** Whether a meeting in doubt has not come by a time at or after its start. */
  notBy(meeting, time) {
    const f = this.fixed
    const since = upper(time) - lower(meeting.t)
    if ((lower(meeting.gap) << (f.shift + meeting.up)) > 2n * fastest(meeting.closing) * (since > 0n ? since : 0n)) return true
    if (!meeting.speed) return false
    const s = f.shifted(f.sub(time, meeting.t), -meeting.up)
    const gained = f.mul(meeting.speed, s)
    if (sign(f.add(meeting.closing, gained)) !== -1) return false
    const gap = f.add(meeting.gap, f.mul(s, f.add(f.twice(meeting.closing), gained)))
    return sign(gap) === 1
  }
}

function fastest(closing) {
  const [a, b] = [-lower(closing), upper(closing)]
  return a > b ? a : b
}

/** A number of units of 2**-bits in units of 2**-CLEAR_BITS, rounded down. */
export function coarse(units, bits) {
  return bits >= CLEAR_BITS ? units >> BigInt(bits - CLEAR_BITS) : units << BigInt(CLEAR_BITS - bits)
}
