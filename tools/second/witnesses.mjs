// What proves a number zero: an isometry, or the way back.

import { ONE, isNone } from './forms.mjs'
import { NoCertificate } from './outcome.mjs'
import { keyOf } from './scene.mjs'

const sameSets = (one, other) => one.length === other.length && one.every((set, k) => set.join(' ') === other[k].join(' '))

/** The image of a contact, or undefined. */
export function imageOf(images, [i, j], n) {
  const [a, b] = [images.get(i), images.get(j)]
  if (a === undefined || b === undefined) return undefined
  return j >= 0 && j < n && a > b ? [b, a] : [a, b]
}

/** The circles that an isometry still maps, with what hit them at this instant: `rows` maps circles to rounds. */
export function stillMapped({ images, kept }, rows, scene) {
  let left = kept
  for (;;) {
    const strays = [...left].filter((i) => {
      const row = rows.get(i) ?? []
      const image = row.map((round) => round.map((contact) => String(imageOf(images, contact, scene.n))).sort())
      const like = (rows.get(images.get(i)) ?? []).map((round) => round.map(String).sort())
      const others = row.flat().flatMap((contact) => scene.circlesOf(contact))
      return !sameSets(image, like) || others.some((k) => scene.movable(k) && !left.has(k))
    })
    if (!strays.length) return left
    left = new Set([...left].filter((i) => !strays.includes(i)))
  }
}

/** Whether a witness shows the number that a question is about to be zero. `state` is the Check at hand. */
export function shows(state, question, contact, how, other = state.clock) {
  const { scene, met } = state
  const [i, j] = contact
  if (how === 'back') {
    const last = state.out.at(-1)
    if (!state.wayBack || !last || !other || !(met.get(keyOf(other)) < 0)) return false
    const whole = question === 'until' && state.data.end.reason === 'return' && state.out.length === 1
    return (question === 'gap' || whole) && last.known.has(keyOf(contact)) && last.known.has(keyOf(other))
  }
  const g = state.isometries[how]
  if (!g) throw new NoCertificate(`there is no isometry ${how}`)
  const kept = stillMapped(g, state.rows, scene)
  const { matrix: [a, b, c, d], images } = g
  const image = imageOf(images, contact, scene.n)
  if (image && other && keyOf(image) === keyOf(other) && met.has(keyOf(other))) {
    const touch = question === 'closing' && state.rows.size === 0 && met.get(keyOf(other)) === 0
    if (question === 'gap' || touch) return scene.circlesOf(contact).every((k) => kept.has(k))
  }
  const { forms } = scene
  if (j >= scene.n) {
    const { nx, ny } = scene.walls[j - scene.n]
    const off = (s, t, n) => forms.add(forms.add(forms.mul(s, nx), forms.mul(t, ny)), n)
    const mirrored = isNone(off(a, b, nx)) && isNone(off(c, d, ny))
    return question === 'closing' && mirrored && images.get(i) === i && kept.has(i)
  }
  if (question !== 'closing' && question !== 'speed') return false
  const unturned = [forms.sub(a, ONE), b, c, forms.sub(d, ONE)].every(isNone)
  return unturned && [[i, j], [j, i]].some(([k, m]) => images.get(k) === m && kept.has(k))
}
