// What has happened, as blocks: rounds of impulses (or parts of one that hang together), reversals and captures.

/** The rows of the circles, what stood at gap zero, and what is undone on the way back. */
export class Log {
  constructor(scene) {
    this.scene = scene
    this.rows = scene.circles.map(() => [])
    this.atZero = [] // of each instant: the keys of the contacts at gap zero in its step 4
    this.grazed = new Map() // key of a contact -> lengths of the rows at which it grazed, before the reversal
    this.levels = null
    this.count = 0
  }

  /** How many blocks circle i has; a fixed circle has none. */
  length(i) {
    return this.rows[i].length
  }

  #append(block) {
    block.id = this.count++
    block.place = new Map()
    for (const i of block.circles) {
      block.place.set(i, this.rows[i].length)
      this.rows[i].push(block)
    }
    return block
  }

  /** A round: the contacts that approach (under an order, the chosen one) and those that push; `time` says when. */
  round(approaching, pushing, at, time) {
    const pushes = new Set(pushing.map((contact) => this.scene.key(contact)))
    for (const contacts of this.#parts(approaching)) {
      const keys = new Set(contacts.map((contact) => this.scene.key(contact)))
      const circles = new Set()
      for (const c of contacts) for (const i of this.scene.circlesOf(c)) if (this.scene.movable(i)) circles.add(i)
      const push = contacts.filter((contact) => pushes.has(this.scene.key(contact)))
      const block = { kind: 'round', contacts, keys, push, circles: [...circles], at, time }
      if (this.levels) this.#undo(block)
      this.#append(block)
    }
  }

  /** Contacts in parts that hang together through movable circles. */
  #parts(contacts) {
    const part = new Map()
    const find = (i) => {
      while (part.get(i) !== i) i = part.get(i)
      return i
    }
    const movable = (contact) => this.scene.circlesOf(contact).filter((i) => this.scene.movable(i))
    for (const contact of contacts) {
      const circles = movable(contact)
      for (const i of circles) if (!part.has(i)) part.set(i, i)
      if (circles.length === 2) part.set(find(circles[0]), find(circles[1]))
    }
    const parts = new Map()
    for (const contact of contacts) {
      const root = find(movable(contact)[0])
      if (!parts.has(root)) parts.set(root, [])
      parts.get(root).push(contact)
    }
    return parts.values()
  }

  reversal(circles, at, time) {
    this.levels = this.rows.map((row) => row.length)
    for (const i of circles) this.#append({ kind: 'reversal', circles: [i], at, time })
  }

  capture(i, at, time) {
    if (this.levels) this.levels[i] = null
    this.#append({ kind: 'capture', circles: [i], at, time })
  }

  // The way back

  /** The last block of circle i that is not undone, or null if there is none. */
  #standing(i) {
    return this.levels[i] > 0 ? this.rows[i][this.levels[i] - 1] : null
  }

  #undo(block) {
    const undone = block.circles.every((i) => this.levels[i] !== null) ? this.#standing(block.circles[0]) : null
    const same =
      undone?.kind === 'round' &&
      block.circles.every((i) => this.#standing(i) === undone) &&
      undone.circles.length === block.circles.length &&
      undone.push.length === block.push.length &&
      new Set([...undone.push, ...block.push].map((contact) => this.scene.key(contact))).size === block.push.length
    for (const i of block.circles) this.levels[i] = same ? undone.place.get(i) : null
  }

  /** The instant of the way out at which a contact parted, or null if it is not known to have. */
  parted(contact) {
    const circles = this.scene.circlesOf(contact).filter((i) => this.scene.movable(i))
    if (!this.levels || circles.some((i) => this.levels[i] === null)) return null
    const at = Math.max(0, ...circles.map((i) => this.#standing(i)?.at ?? 0))
    return this.atZero[at].has(this.scene.key(contact)) ? at : null
  }

  #lengths(contact) {
    return this.scene.circlesOf(contact).map((i) => this.length(i))
  }

  /** Notes that the two graze on their flights of now. */
  graze(contact) {
    if (this.levels) return
    const key = this.scene.key(contact)
    this.grazed.set(key, [...(this.grazed.get(key) ?? []), this.#lengths(contact).join()])
  }

  /** Whether the two grazed on the way out on the flights that they have again. */
  grazedBefore(contact) {
    if (!this.levels) return false
    const levels = this.scene.circlesOf(contact).map((i) => this.levels[i])
    if (levels.includes(null)) return false
    return (this.grazed.get(this.scene.key(contact)) ?? []).includes(levels.join())
  }
}
