// That nothing meets but what is told: step 3 of docs/certificates.md, for all contacts at every instant.
//
// Of each contact a time is kept up to which, and at which, it is shown not to meet (`clear`; null: never, on the flights
// of now). Only where that does not suffice, it is looked at with all bits.

import { lower, sign, upper } from './interval.mjs'
import { coarse } from './meetings.mjs'
import { Refuted, Undecided } from './outcome.mjs'

/** The contacts of a scene between instants. */
export class Sweep {
  constructor(check) {
    this.check = check
    this.scene = check.scene
    const { n, stride } = this.scene
    this.clear = new Array(n * stride).fill(null)
    this.least = new Array(n).fill(null) // of each row of `clear`: a lower bound
    this.grazes = new Map() // key -> when the two graze
    this.lasting = new Map() // key -> contact at gap zero for as long as its flights last
  }

  /** All contacts that there are. */
  *contacts() {
    for (let i = 0; i < this.scene.n; i++) yield* this.#row(i)
  }

  *#row(i) {
    const { n, walls, pockets } = this.scene
    for (let j = i + 1; j < n + walls.length; j++) if (this.scene.meets([i, j])) yield [i, j]
    for (let k = 0; k < pockets.length; k++) if (this.scene.meets([i, -1 - k])) yield [i, -1 - k]
  }

  *#contactsOf(i) {
    for (let j = 0; j < i; j++) if (this.scene.meets([j, i])) yield [j, i]
    yield* this.#row(i)
  }

  convert(from) {
    for (const [key, time] of this.grazes) this.grazes.set(key, from(time))
  }

  #set(key, clear) {
    this.clear[key] = clear
    const row = Math.floor(key / this.scene.stride)
    if (clear !== null && (this.least[row] === null || clear < this.least[row])) this.least[row] = clear
  }

  #never(key) {
    this.grazes.delete(key)
    this.#set(key, null)
  }

  /** What is known of a contact on its flights of now, with the arithmetic given. */
  #look(contact, geometry) {
    const key = this.scene.key(contact)
    const meeting = geometry.meeting(contact, this.check.flights)
    if (meeting.kind === 'never') this.#set(key, null)
    else if (meeting.kind === 'graze') {
      this.#set(key, null)
      if (geometry === this.check.fine) this.grazes.set(key, meeting.time)
      else this.#look(contact, this.check.fine)
    } else this.#set(key, geometry.clear(meeting))
    return meeting
  }

  // Before an instant

  #open(contact) {
    return this.scene.has(contact) && this.scene.meets(contact) && this.clear[this.scene.key(contact)] !== null
  }

  /** Doubts that witnesses `graze` and `still` resolve. */
  resolve(witnesses) {
    const { fine, flights, log } = this.check
    for (const contact of witnesses.contacts('graze')) {
      if (this.scene.isWall(contact) || !this.scene.meets(contact)) continue
      const key = this.scene.key(contact)
      const meeting = fine.meeting(contact, flights)
      const open = this.#open(contact) || this.grazes.has(key)
      if (!open || meeting.kind !== 'doubt' || sign(meeting.closing) !== -1) continue
      if (!witnesses.shows('graze', contact)) continue
      log.graze(contact)
      this.#set(key, null)
      this.grazes.set(key, fine.grazeTime(meeting))
    }
    for (const contact of witnesses.contacts('still')) {
      if (!this.#open(contact)) continue
      const meeting = this.#look(contact, fine)
      if (meeting.kind !== 'doubt' || sign(meeting.closing) !== undefined) continue
      const [i, j] = contact
      const other = this.scene.isPair(contact) ? flights[j] : flights[i]
      const later = other.at > flights[i].at ? other : flights[i]
      if (witnesses.shows('still', contact, { time: later.start }, false)) this.#never(this.scene.key(contact))
    }
  }

  /** When a contact hits. */
  hit(contact) {
    if (!this.#open(contact)) throw new Refuted(`[${contact}] does not meet`)
    const meeting = this.#look(contact, this.check.fine)
    if (meeting.kind === 'hit') return meeting.time
    if (meeting.kind === 'doubt') throw new Undecided(`whether [${contact}] hits`)
    throw new Refuted(`[${contact}] does not hit`)
  }

  /** When a contact grazes. */
  graze(contact) {
    if (!this.scene.has(contact)) throw new Refuted(`[${contact}] is no contact`)
    const key = this.scene.key(contact)
    if (this.#open(contact) && this.#look(contact, this.check.fine).kind === 'doubt') {
      throw new Undecided(`whether [${contact}] grazes`)
    }
    const time = this.grazes.get(key)
    if (!time) throw new Refuted(`[${contact}] does not graze`)
    return time
  }

  /** Shows that no contact but the listed ones meets up to a time, or at it. */
  pass(time, listed) {
    const bits = this.check.fine.fixed.bits
    const latest = -coarse(-upper(time), bits)
    this.check.work.spend(this.scene.n / 64)
    for (let i = 0; i < this.scene.n; i++) {
      if (this.least[i] !== null && this.least[i] < latest) this.#passRow(i, latest, time, listed)
    }
  }

  #passRow(i, latest, time, listed) {
    const { stride } = this.scene
    this.check.work.spend(stride / 8)
    let least = null
    for (let key = i * stride; key < (i + 1) * stride; key++) {
      let clear = this.clear[key]
      if (clear === null) continue
      if (clear < latest && !listed.has(key)) {
        this.#passOne(this.scene.contact(key), time)
        clear = this.clear[key]
      }
      if (clear !== null && (least === null || clear < least)) least = clear
    }
    this.least[i] = least
  }

  #passOne(contact, time) {
    const meeting = this.#look(contact, this.check.fine)
    if (meeting.kind === 'hit') {
      if (lower(meeting.time) > upper(time)) return
      if (upper(meeting.time) < lower(time)) throw new Refuted(`[${contact}] meets before that`)
    }
    if (['hit', 'doubt'].includes(meeting.kind) && !this.check.fine.notBy(meeting, time)) {
      throw new Undecided(`whether [${contact}] meets before that, then, later or never`)
    }
  }

  /** Contacts of two circles that may graze at a time and are not listed. */
  loose(time, listed) {
    const found = []
    for (const [key, when] of this.grazes) {
      if (listed.has(key)) continue
      if (upper(when) < lower(time)) this.grazes.delete(key)
      else if (lower(when) <= upper(time) && this.scene.isPair(this.scene.contact(key))) {
        found.push(this.scene.contact(key))
      }
    }
    return found
  }

  // After an instant

  /** Takes up the flights that an instant leaves: `changed` circles; `closed` contacts meet no more on them. */
  update(changed, closed) {
    const { captured, glance } = this.check
    for (const key of closed) this.#never(key)
    for (const i of changed) {
      for (const contact of this.#contactsOf(i)) {
        const key = this.scene.key(contact)
        if (contact[1] === i && changed.has(contact[0])) continue // it has had its turn, or will
        this.#never(key)
        if (closed.has(key) || this.scene.circlesOf(contact).some((j) => captured.has(j))) continue
        this.#look(contact, glance)
      }
    }
  }

  /** Shows that no contact ever meets. */
  quiet() {
    for (const contact of this.contacts()) {
      if (!this.#open(contact)) continue
      const { kind } = this.#look(contact, this.check.fine)
      if (kind === 'hit') throw new Refuted(`[${contact}] is still to meet`)
      if (kind === 'doubt') throw new Undecided(`whether [${contact}] ever meets`)
    }
  }
}
