// Follows a certificate: docs/certificates.md, "How to check".

import { decimalParts } from './format.mjs'
import { isNone } from './forms.mjs'
import { sign } from './interval.mjs'
import { NoCertificate, Refuted, Undecided } from './outcome.mjs'
import { Scene, keyOf } from './scene.mjs'
import { Twister } from './twister.mjs'
import { shows, stillMapped } from './witnesses.mjs'
import { World } from './world.mjs'

const order = ([a, b], [c, d]) => a - c || b - d
const isPocket = ([, j]) => j < 0

/** A sign that has to be 1. */
function demand(found, text) {
  if (found === undefined) throw new Undecided(text)
  if (found !== 1) throw new Refuted(text)
}

export class Check {
  constructor(data, work, factor = 1) {
    this.data = data
    this.now = 'in the scene'
    this.events = 0
    this.scene = new Scene(data, work, data.bits * factor)
    this.balls = new World(this.scene, this.scene.balls)
    this.forms = new World(this.scene, this.scene.forms)
    this.worlds = [this.balls, this.forms]
    this.isometries = data.isometries.map((told, k) => this.scene.isometry(told, `isometries[${k}]`))
    const { tie_policy: policy } = data.scene
    this.simultaneous = policy === 'simultaneous'
    this.draw = policy.includes(':seed=') ? new Twister(policy.split('=')[1]) : null
    this.lastEvent = data.end.reason === 'events' ? data.end.limit : null
    this.age = -1
    this.due = false // whether the reversal falls on the instant just told
    this.wayBack = false
    this.out = [] // instants of the way out with impulses that are not undone: what pushed, and what stood at gap zero
    this.known = new Map() // contacts at gap zero, with the signs of closing
    this.parted = new Map() // contacts that do not meet again on the flights of now
    this.lasting = new Map()
    this.gone = new Set()
  }

  run() {
    for (const entry of this.data.instants) this.#instant(entry)
    this.#end(this.data.end)
  }

  // Signs

  #take(entry, now) {
    this.now = now
    this.met = new Map()
    this.rows = new Map()
    this.clock = undefined
    this.witnesses = new Map()
    for (const [question, contact, how, other] of entry.zeros ?? []) {
      const key = `${question} ${keyOf(contact)}`
      if (!this.witnesses.has(key)) this.witnesses.set(key, [])
      this.witnesses.get(key).push([how, other])
    }
  }

  #told(question, contact) {
    return this.witnesses.get(`${question} ${contact ? keyOf(contact) : ''}`) ?? []
  }

  #zero(question, contact, law) {
    if (isNone(law(this.forms))) return true
    return this.#told(question, contact).some(([how, other]) => shows(this, question, contact, how, other))
  }

  #sign(question, contact, law = (world) => world.meeting(contact, this.age)[question]) {
    const found = sign(law(this.balls))
    if (found !== undefined) return found
    if (this.#zero(question, contact, law)) return 0
    const text = `${question} of [${contact}] may be zero, and no witness shows it`
    throw this.#told(question, contact).length ? new Refuted(text) : new Undecided(text)
  }

  // Flights

  /** Two do not meet from the later start of their flights to the instant `age`, or ever if that is null. */
  #clear(contact, age, last = false) {
    if (this.parted.has(keyOf(contact)) || this.#isGone(contact)) return
    const { ring } = this.balls
    const start = this.balls.start(contact)
    const m = this.balls.meeting(contact, start)
    const [gap, closing] = [sign(m.gap), sign(m.closing)]
    if (gap === -1 && isPocket(contact)) return
    if (gap === -1) throw new Refuted(`[${contact}] overlap`)
    if (gap === 1 && closing >= 0) return
    const disc = sign(m.disc())
    if (gap === 1 && disc === -1) return
    let away = true
    if (age === null) {
      if (closing === -1 && disc === 1) throw new Refuted(`[${contact}] meet`)
    } else {
      const wait = ring.sub(this.balls.times[age], this.balls.times[start])
      const end = this.balls.meeting(contact, age)
      const there = ring.add(m.gap, ring.twice(ring.mul(m.closing, wait)))
      const back = ring.sub(end.gap, ring.twice(ring.mul(end.closing, wait)))
      away = sign(end.gap) === 1
      if (gap === 1 && (sign(there) === 1 || (away && sign(back) === 1))) return
      const through = closing === -1 && disc === 1 && sign(end.closing) === 1
      if (sign(end.gap) === -1 || through) throw new Refuted(`[${contact}] meet before it`)
    }
    if (gap === 1 && (last || away)) {
      for (const question of ['closing', 'disc']) {
        const law = (world) => (question === 'disc' ? world.meeting(contact, start).disc() : world.meeting(contact, start).closing)
        if (this.#zero(question, contact, law)) return
      }
    }
    throw new Undecided(`whether [${contact}] meet before it`)
  }

  #isGone(contact) {
    return this.scene.circlesOf(contact).some((i) => this.gone.has(i))
  }

  /** Circles have met nothing but what is known, as their flights end. */
  #settle(circles) {
    const done = new Set()
    for (const i of circles) {
      for (const contact of this.scene.byCircle[i]) {
        const key = keyOf(contact)
        if (done.has(key) || this.known.has(key)) continue
        done.add(key)
        this.#clear(contact, this.age)
      }
    }
  }

  // Instants

  #time(entry, met) {
    for (const world of this.worlds) {
      if (entry.turn) world.times.push(world.times.at(-1))
      else if (entry.exact !== undefined) world.times.push(world.ring.of(this.scene.number(entry.exact, 'exact')))
      else if (met.length) world.times.push(world.hit(met[0]))
      else throw new NoCertificate('an instant with neither `met` nor `exact` nor `turn`')
    }
  }

  #instant(entry) {
    this.age++
    const { age, scene } = this
    const met = entry.met ?? []
    const turn = entry.turn ?? false
    this.#take(entry, `instant ${age}`)
    if (this.due !== turn || this.events === this.lastEvent) throw new Refuted('the reversal falls on it, or not, or the end')
    if (entry.exact !== undefined && (turn || age === 0)) throw new Refuted('it has a time already')
    for (const contact of met) this.#possible(contact, entry)
    if (new Set(met.map(keyOf)).size < met.length) throw new Refuted('a contact is listed twice')
    if (age > 0) this.#time(entry, met)
    const { times, ring } = this.balls
    this.#said(times[age], entry.time)
    if (age > 0 && !turn) demand(sign(ring.sub(times[age], times[age - 1])), 'it comes later than the one before')
    for (const contact of met) this.#arrive(contact, entry)
    this.known = turn
      ? new Map([...this.known].map(([key, { contact, closing }]) => [key, { contact, closing: -closing }]))
      : new Map([...this.lasting].map(([key, contact]) => [key, { contact, closing: 0 }]))
    for (const contact of met) this.known.set(keyOf(contact), { contact, closing: this.met.get(keyOf(contact)) })
    if (turn) this.#turn()
    this.due = false
    for (const name of [...this.balls.limits.keys()]) {
      const wait = this.#sign(name, this.clock, (world) => world.ring.sub(world.limits.get(name), world.times[age]))
      if (wait < 0) throw new Refuted('the end, or the reversal, comes before it')
      if (name === 'reverse' && wait === 0) this.due = true
    }
    if (age > 0 && !met.length && !turn && !this.due) throw new Refuted('nothing falls on it')
    this.#resolve(entry, turn ? scene.circles.map((_, i) => i).filter((i) => scene.movable(i)) : [])
    if (!this.wayBack && this.events > 0 && this.events === this.data.scene.reverse_after) this.due = true
  }

  #possible(contact, entry) {
    const comes = this.scene.has(contact) && !this.#isGone(contact) && !this.lasting.has(keyOf(contact))
    if (!comes || entry.turn) throw new Refuted(`[${contact}] cannot meet`)
  }

  #arrive(contact, entry) {
    const key = keyOf(contact)
    this.clock ??= contact
    const found = this.met.size > 0 || entry.exact !== undefined || this.age === 0
    if (found && this.#sign('gap', contact) !== 0) throw new Refuted(`[${contact}] do not meet at it`)
    const closing = this.#sign('closing', contact)
    if (this.age > 0 && closing > 0) this.#clear(contact, null, true) // only a pocket is left, by what was in it
    this.met.set(key, closing)
  }

  #turn() {
    this.wayBack = true
    const all = this.scene.circles.map((_, i) => i).filter((i) => this.scene.movable(i))
    this.#settle(all)
    for (const world of this.worlds) {
      const { ring } = world
      world.redirect(all, this.age, (_, v) => ring.neg(v))
      world.limits.delete('reverse')
      if (this.data.end.reason === 'return') world.limits.set('until', ring.twice(world.times[this.age]))
    }
  }

  /** All that hangs together with a contact through circles. */
  #group(first) {
    const group = new Map()
    const circles = new Set()
    const todo = [...this.scene.circlesOf(first)]
    while (todo.length) {
      const i = todo.pop()
      if (circles.has(i)) continue
      circles.add(i)
      for (const [key, { contact }] of this.known) {
        if (!this.scene.circlesOf(contact).includes(i)) continue
        group.set(key, contact)
        todo.push(...this.scene.circlesOf(contact))
      }
    }
    return { group: [...group.values()], circles }
  }

  #approaching(contacts) {
    return contacts.filter((c) => !isPocket(c) && this.known.get(keyOf(c)).closing < 0).sort(order)
  }

  #resolve(entry, turned) {
    const rounds = [...(entry.rounds ?? [])]
    const pushes = new Map()
    const moved = new Set(turned)
    if (rounds.length) this.events++
    for (;;) {
      const [first] = this.#approaching([...this.known.values()].map(({ contact }) => contact))
      if (!first) break
      const { group, circles } = this.#group(first)
      this.#settle(circles)
      for (let coming = this.#approaching(group); coming.length; coming = this.#approaching(group)) {
        if (!this.simultaneous) {
          coming = [coming[this.draw && coming.length > 1 ? this.draw.below(coming.length) : 0]]
        }
        const push = this.#round(rounds.shift() ?? [], coming)
        this.#note(this.rows, coming)
        this.#note(pushes, push)
        const hit = new Set(push.flatMap((c) => this.scene.circlesOf(c)).filter((i) => this.scene.movable(i)))
        for (const i of hit) moved.add(i)
        for (const contact of group) {
          if (!this.scene.circlesOf(contact).some((i) => hit.has(i))) continue
          this.known.get(keyOf(contact)).closing = this.#sign('closing', contact)
        }
      }
    }
    if (rounds.length) throw new Refuted('rounds of impulses where nothing approaches')
    this.#enter(entry, moved)
    this.#after(pushes, moved)
  }

  /** One round; what pushes. */
  #round(told, coming) {
    const push = told.map(([i, j]) => [i, j])
    const keys = new Set(push.map(keyOf))
    const all = new Set(coming.map(keyOf))
    if (!push.length || keys.size < push.length || [...keys].some((key) => !all.has(key))) {
      throw new Refuted(`[${push.join('], [')}] cannot push`)
    }
    const others = coming.filter((c) => !keys.has(keyOf(c)))
    const s = told.filter((one) => one.length > 2).map((one) => this.scene.number(one[2], 'impulse'))
    if (s.length && s.length < push.length) throw new NoCertificate('some impulses of a round are told, and some not')
    const [impulses] = this.worlds.map((world) => world.blow(this.age, push, others, s))
    if (s.length && !this.forms.rest.slice(0, push.length).every(isNone)) throw new Refuted('the impulses are others')
    impulses.forEach((impulse, k) => demand(sign(impulse), `[${push[k]}] pushes`))
    others.forEach((contact, k) => {
      const law = (world) => world.rest[push.length + k]
      if (this.#sign('slack', contact, law) < 0) throw new Refuted(`[${contact}] pushes too`)
    })
    return push
  }

  /** Notes for each movable circle which contacts of a round are its own. */
  #note(rows, contacts) {
    const round = new Map()
    for (const contact of contacts) {
      for (const i of this.scene.circlesOf(contact).filter((k) => this.scene.movable(k))) {
        if (!round.has(i)) round.set(i, [])
        round.get(i).push(contact)
      }
    }
    for (const [i, own] of round) rows.set(i, [...(rows.get(i) ?? []), own.sort(order)])
  }

  #enter(entry, moved) {
    const entered = [...this.known.values()].filter(({ contact, closing }) => isPocket(contact) && closing < 0)
    const found = new Set(entered.map(({ contact }) => keyOf(contact)))
    const told = (entry.enter ?? []).map(keyOf)
    if (found.size !== told.length || [...found].some((key) => !told.includes(key))) {
      throw new Refuted(`there enter [${[...found].join('], [')}]`)
    }
    if (!this.scene.capture || !found.size) return
    const taken = new Set(entered.map(({ contact }) => contact[0]))
    this.#settle(taken)
    for (const world of this.worlds) world.redirect(taken, this.age, (ring) => ring.zero)
    for (const i of taken) this.gone.add(i)
    for (const [key, { contact }] of this.known) if (this.#isGone(contact)) this.known.delete(key)
  }

  /** What lasts and what has parted; what isometries still map; the way back. */
  #after(pushes, moved) {
    const still = (contact) => !this.scene.circlesOf(contact).some((i) => moved.has(i))
    const lasting = new Map()
    for (const [key, { contact, closing }] of this.known) {
      const before = this.lasting.has(key) && still(contact)
      if (before || (closing === 0 && this.#sign('speed', contact) === 0)) lasting.set(key, contact)
    }
    this.lasting = lasting
    this.parted = new Map([...this.parted].filter(([, contact]) => still(contact)))
    for (const [key, { contact }] of this.known) this.parted.set(key, contact)
    for (const g of this.isometries) {
      const left = [...stillMapped(g, this.rows, this.scene)]
      g.kept = new Set(left.filter((i) => !this.gone.has(i) && !this.gone.has(g.images.get(i))))
    }
    const text = (rows, turned) => JSON.stringify([...rows].sort(order).map(([i, row]) => [i, turned ? [...row].reverse() : row]))
    if (!this.wayBack && (pushes.size || this.age === 0)) {
      const solid = [...this.known].filter(([, { contact }]) => !isPocket(contact)).map(([key]) => key)
      this.out.push({ undone: text(pushes, true), known: new Set(solid) })
    }
    if (this.wayBack && pushes.size) {
      if (this.out.at(-1)?.undone === text(pushes, false)) this.out.pop()
      else this.out = []
    }
  }

  // The end

  /** A number is within one unit of the last digit of a decimal. */
  #said(value, text) {
    const [units, digits] = decimalParts(text)
    const scale = 10n ** BigInt(digits)
    const shift = this.scene.balls.fixed.shift
    const off = value.m * scale - (units << shift)
    const wide = value.r * scale
    const one = 1n << shift
    const far = off < 0n ? -off : off
    if (far + wide < one) return
    const short = text.slice(0, 40)
    throw far - wide >= one ? new Refuted(`a number is not ${short}`) : new Undecided(`whether a number is ${short}`)
  }

  #end(end) {
    this.#take(end, 'at the end')
    const { limits, ring } = this.balls
    if (this.lastEvent !== null && this.lastEvent !== this.events) throw new Refuted(`there are ${this.events} events`)
    if ((this.lastEvent === null && this.due) || (end.reason === 'return' && !this.wayBack)) throw new Refuted('no reversal')
    const whole = end.reason !== 'events' && end.reason !== 'stopped'
    if (whole && limits.has('reverse')) {
      const later = limits.has('until') ? sign(ring.sub(limits.get('reverse'), limits.get('until'))) : 0
      demand(later, 'the reversal comes after the end')
    }
    if (limits.has('until')) {
      this.age++
      for (const world of this.worlds) world.times.push(world.limits.get('until'))
    }
    this.known = new Map()
    this.scene.byCircle.forEach((contacts, i) => {
      for (const contact of contacts) {
        if (contact[0] === i) this.#clear(contact, end.reason === 'quiet' ? null : this.age, true)
      }
    })
    this.#said(this.balls.times[this.age], this.data.final.time)
    this.data.final.circles.forEach((row, i) => {
      const { x, y, vx, vy } = this.balls.put(i, this.age)
      ;[x, y, vx, vy].forEach((value, k) => this.#said(value, row[k]))
    })
  }
}
