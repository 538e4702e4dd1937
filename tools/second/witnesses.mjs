// Witnesses: how it is known of a number that it is zero.

import { Refuted } from './outcome.mjs'
import { Isometry } from './isometries.mjs'
import { Replay } from './replay.mjs'

/** Answers for all witnesses of a certificate. */
export class Prover {
  constructor(data, scene, log, sides) {
    this.scene = scene
    this.log = log
    this.sides = sides
    this.known = new Map()
    this.reversal = null // the time of the reversal, once it has been
    this.isometries = data.isometries.map((found, k) => new Isometry(found, scene, log, `isometries[${k}]`))
  }

  /** The witnesses of one part of the log. */
  witnesses(zeros = []) {
    return new Witnesses(this, zeros)
  }

  /** Whether a witness shows its number to be zero; `given` is what the question needs beside the contact. */
  shows(question, contact, how, given) {
    if (question === 'graze' && this.scene.isWall(contact)) return false
    if (question === 'together' && !this.scene.isPair(contact)) return false
    if (how === 'exact') return this.#exact(question, contact, given)
    if (how === 'back') return this.#back(question, contact, given)
    const isometry = this.isometries[how]
    if (!isometry) return false
    if (question === 'tie') return given.kind === given.otherKind && isometry.mapsContact(contact, given.other)
    if (question === 'still' && this.scene.isWall(contact)) {
      return isometry.turnsWall(contact[0], contact[1] - this.scene.n)
    }
    return (question === 'still' || question === 'together') && this.scene.isPair(contact) && isometry.shiftsPast(contact)
  }

  #exact(question, contact, given) {
    const replay = new Replay(this.scene, this.log, this.sides, this.known)
    switch (question) {
      case 'tie':
        return replay.sameTime(contact, given.kind, given.other, given.otherKind)
      case 'graze':
        return replay.grazes(contact)
      case 'still':
        return replay.still(contact, given.time)
      case 'together':
        return replay.together(contact)
      case 'slack':
        return replay.slack(contact, given.push, given.time)
      case 'rim':
        return replay.onRim(contact, given.time)
      case 'until':
        return given.until ? replay.atTime(contact, given.until) : replay.atReturn(contact, this.reversal)
      default:
        return replay.atTime(contact, this.scene.reverseAt)
    }
  }

  #back(question, contact, given) {
    if (question === 'tie') {
      const parted = this.log.parted(contact)
      return parted !== null && parted === this.log.parted(given.other)
    }
    if (question === 'until') return !given.until && this.log.parted(contact) === 0
    return question === 'graze' && this.log.grazedBefore(contact)
  }
}

/** The witnesses at hand; one that nothing asks is of no effect. */
class Witnesses {
  constructor(prover, zeros) {
    this.prover = prover
    this.byQuestion = new Map()
    for (const [question, contact, how, other] of zeros) {
      if (!prover.scene.has(contact)) continue // nothing asks about it
      const name = `${question} ${contact}`
      if (!this.byQuestion.has(name)) this.byQuestion.set(name, [])
      this.byQuestion.get(name).push({ question, contact, how, other })
    }
  }

  #of(question, contact) {
    return this.byQuestion.get(`${question} ${contact}`) ?? []
  }

  /** The contacts of a question's witnesses. */
  contacts(question) {
    return [...this.byQuestion.values()].filter(([first]) => first.question === question).map(([first]) => first.contact)
  }

  /**
   * Whether a witness shows the number to be zero; `given`, or what it returns for a witness, is as in `Prover`, or null
   * for one that can show nothing. Where there are witnesses, one of them must, or else the certificate is false.
   */
  shows(question, contact, given = {}, must = true) {
    const witnesses = this.#of(question, contact)
    for (const witness of witnesses) {
      const facts = typeof given === 'function' ? given(witness) : given
      if (facts && this.prover.shows(question, contact, witness.how, facts)) return true
    }
    if (must && witnesses.length) throw new Refuted(`the witness ${question} of [${contact}] shows nothing`)
    return false
  }
}
