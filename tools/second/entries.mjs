// Which centres enter pockets at an instant: step 6 of docs/certificates.md.

import { sign } from './interval.mjs'
import { Refuted, Undecided } from './outcome.mjs'

/** The entries of one instant, or of its part after the reversal. */
export class Entries {
  constructor(check, instant) {
    this.check = check
    this.instant = instant
  }

  /** Shows that those told are those that happen, and takes captured circles out of play. */
  run(afterReversal) {
    const { check, instant } = this
    const { scene } = check
    const entered = new Set()
    for (const i of check.movable()) {
      const struck = afterReversal || instant.pushed.has(i)
      scene.pockets.forEach((_, k) => {
        const contact = [i, -1 - k]
        const onRim = struck ? this.#onRim(contact) : instant.rims.has(scene.key(contact))
        if (!onRim) return
        const arrives = !struck && instant.at > 0
        if (arrives || check.closing(contact, instant) < 0) entered.add(`${i},${k}`)
      })
    }
    const told = new Set(instant.entries.map(String))
    if (told.size < instant.entries.length) throw new Refuted('an entry is told twice')
    for (const entry of entered) if (!told.has(entry)) throw new Refuted(`the entry [${entry}] is not told`)
    for (const entry of told) if (!entered.has(entry)) throw new Refuted(`the entry [${entry}] does not happen`)
    if (!scene.capture) return
    for (const [i] of instant.entries) if (!check.captured.has(i)) this.#capture(i)
  }

  /** Whether a centre with a new velocity is on a rim; a contact that cannot meet on the new flight is shut. */
  #onRim(contact) {
    const { rims, shut, witnesses } = this.instant
    const { scene, fine, flights } = this.check
    const key = scene.key(contact)
    if (rims.has(key)) return true
    const found = fine.measures(contact, flights)
    const gap = sign(fine.gap(found))
    if (gap === 1) return false
    shut.add(key)
    if (gap === -1) return false
    const given = { time: flights[contact[0]].start }
    const closing = sign(found.closing)
    if (closing >= 0 || (closing === undefined && witnesses.shows('still', contact, given))) return false
    if (gap === 0 || witnesses.shows('rim', contact, given)) return true
    throw new Undecided(`whether the centre of circle ${contact[0]} is on the rim of pocket ${-1 - contact[1]}`)
  }

  #capture(i) {
    const { time, at, node } = this.instant
    const { scene, fine, flights, captured, log, sweep } = this.check
    const { zero, bits } = fine.fixed
    const [x, y] = fine.place(flights[i], time, at)
    flights[i] = { x, y, vx: zero, vy: zero, t: time, at, start: node, bits }
    captured.add(i)
    log.capture(i, at, node)
    for (const [key, contact] of sweep.lasting) {
      if (scene.circlesOf(contact).includes(i)) sweep.lasting.delete(key)
    }
  }
}
