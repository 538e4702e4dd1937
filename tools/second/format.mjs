// The shape of a certificate: docs/certificates.md, "The format". Whatever does not have it is no certificate.

import { NoCertificate } from './outcome.mjs'
import { ONE, whole } from './tower.mjs'

const FORMAT = 'truebreak/certificate-1'
export const MAX_BYTES = 16 * 1024 * 1024
const MAX_CIRCLES = 1000
const MAX_ROOTS = 12
const MAX_BITS = 1_048_576
const MAX_PAIRS = 2 ** 22
const MAX_SIZE = 2 ** 30
const DECIMAL = /^-?[0-9]{1,400}(\.[0-9]{1,400})?$/
const TERM = /([+-]?)([0-9]+)(?:\/([0-9]+))?((?:\*r[0-9]{1,2})*)/y
const POLICY = /^(simultaneous|sequential(:order=scene|:seed=[0-9]{1,18})?)$/
const QUESTIONS = new Set(['tie', 'graze', 'still', 'together', 'slack', 'rim', 'until', 'reverse'])

function fail(where, what) {
  throw new NoCertificate(`${where}: ${what}`)
}

// Kinds of values: functions (value, where) that fail or return.

const text = (value, where) => typeof value === 'string' || fail(where, 'text is expected')
const flag = (value, where) => typeof value === 'boolean' || fail(where, 'true or false is expected')

function number(value, where) {
  text(value, where)
  if (value.length > 20_000) fail(where, 'a number of more than 20,000 characters')
  TERM.lastIndex = 0
  for (let at = 0; at < value.length || at === 0; at = TERM.lastIndex) {
    if (!TERM.test(value) || (at > 0 && !'+-'.includes(value[at]))) fail(where, 'no exact number')
  }
}

function decimal(value, where) {
  if (typeof value !== 'string' || !DECIMAL.test(value)) fail(where, 'no decimal')
}

function integer(least, most = Number.MAX_SAFE_INTEGER) {
  return (value, where) => {
    if (!Number.isSafeInteger(value) || value < least || value > most) fail(where, `no whole number from ${least} on`)
  }
}

function list(item, least = 0, most = Infinity) {
  return (value, where) => {
    if (!Array.isArray(value)) fail(where, 'a list is expected')
    if (value.length < least || value.length > most) fail(where, `a list of ${value.length}`)
    value.forEach((entry, k) => item(entry, `${where}[${k}]`))
  }
}

function tuple(...items) {
  return (value, where) => {
    if (!Array.isArray(value) || value.length !== items.length) fail(where, `a list of ${items.length} is expected`)
    items.forEach((item, k) => item(value[k], `${where}[${k}]`))
  }
}

function object(required, optional = {}) {
  return (value, where) => {
    if (value === null || typeof value !== 'object' || Array.isArray(value)) fail(where, 'an object is expected')
    for (const key of Object.keys(required)) if (!(key in value)) fail(where, `"${key}" is missing`)
    for (const key of Object.keys(value)) {
      const item = Object.hasOwn(required, key) ? required[key] : Object.hasOwn(optional, key) && optional[key]
      if (item) item(value[key], `${where}.${key}`) // keys that the page does not name are of no effect
    }
  }
}

const contact = tuple(integer(0), integer(Number.MIN_SAFE_INTEGER))

function witness(value, where) {
  if (!Array.isArray(value) || value.length < 3 || value.length > 4) fail(where, 'a list of 3 or 4 is expected')
  if (!QUESTIONS.has(value[0])) fail(where, 'no such question')
  contact(value[1], where)
  if (value[2] !== 'exact' && value[2] !== 'back') integer(0)(value[2], where)
  if (value.length === 4) contact(value[3], where)
}

const part = { rounds: list(list(contact, 1)), entries: list(contact), zeros: list(witness) }
const start = { ...part, reversal: object({}, part) }
const instant = { ...start, arrive: list(contact, 1), grazes: list(tuple(integer(0), integer(0))) }
const ENDS = { quiet: {}, horizon: { until: number }, return: {}, events: { limit: integer(1) }, stopped: {} }

function end(value, where) {
  object({ reason: text })(value, where)
  if (!Object.hasOwn(ENDS, value.reason)) fail(where, 'no such reason')
  object({ reason: text, ...ENDS[value.reason] }, { zeros: part.zeros })(value, where)
}

const place = { id: text, x: number, y: number, r: number }
const scene = object(
  {
    tie_policy: (value, where) => (typeof value === 'string' && POLICY.test(value)) || fail(where, 'no such policy'),
    circles: list(
      object({ ...place, vx: number, vy: number, m: (m, at) => m === 'oo' || number(m, at) }),
      1,
      MAX_CIRCLES,
    ),
  },
  {
    name: text,
    digest: text,
    reverse_after: integer(1),
    reverse_at: number,
    capture: flag,
    walls: list(object({ id: text, x0: number, y0: number, x1: number, y1: number })),
    pockets: list(object(place)),
  },
)
const certificate = object(
  {
    format: text,
    roots: list(number, 0, MAX_ROOTS),
    scene,
    isometries: list(
      object({
        matrix: tuple(number, number, number, number),
        shift: tuple(number, number),
        map: list(tuple(integer(Number.MIN_SAFE_INTEGER), integer(Number.MIN_SAFE_INTEGER))),
      }),
    ),
    bits: list(tuple(integer(0), integer(1, MAX_BITS)), 1),
    start: object({}, start),
    instants: list(object({ time: decimal }, instant)),
    end,
    final: object({ time: decimal, circles: list(tuple(decimal, decimal, decimal, decimal)) }),
  },
  { writer: text },
)

/** Checks the shape of everything, and that isometries map things that there are. */
export function checkShape(data) {
  if (data?.format !== FORMAT) fail('format', `not ${FORMAT}`)
  certificate(data, 'certificate')
  const { circles, walls = [], pockets = [] } = data.scene
  const [n, w, p] = [circles.length, walls.length, pockets.length]
  const pairs = n * (n + w + p)
  if (pairs > MAX_PAIRS) fail('scene', 'too many circles, walls and pockets')
  if (pairs * data.bits[0][1] > MAX_SIZE) fail('bits', 'too many for so many circles, walls and pockets')
  if (data.scene.reverse_after !== undefined && data.scene.reverse_at !== undefined) fail('scene', 'two reversals')
  if (data.final.circles.length !== n) fail('final', `${data.final.circles.length} circles of ${n}`)
  const ids = [...circles, ...walls, ...pockets].map((thing) => thing.id)
  if (new Set(ids).size !== ids.length) fail('scene', 'an id is used twice')

  data.isometries.forEach(({ map }, k) => {
    for (const index of map.flat()) if (index < -p || index >= n + w) fail(`isometries[${k}]`, `${index} is no index`)
  })
  let [at, most] = [-1, MAX_BITS]
  for (const [k, bits] of data.bits) {
    if (k <= at || bits > most || (at === -1 && k !== 0)) fail('bits', `[${k},${bits}] is out of order`)
    ;[at, most] = [k, bits]
  }
}

/** An exact number from its text; `roots` are the numbers that r1, r2, ... stand for. */
export function exactNumber(value, tower, roots, where) {
  TERM.lastIndex = 0
  let sum = whole(0)
  for (let found = TERM.exec(value); found; found = TERM.exec(value)) {
    const [, minus, numerator, denominator = '1', factors] = found
    if (BigInt(denominator) === 0n) fail(where, 'a denominator is zero')
    let term = tower.fraction(BigInt((minus === '-' ? '-' : '') + numerator), BigInt(denominator))
    let product = ONE
    for (const name of factors.split('*').slice(1)) {
      const root = roots[Number(name.slice(1)) - 1]
      if (!root) fail(where, `there is no root ${name} here`)
      product = tower.mul(product, root)
    }
    sum = tower.add(sum, tower.mul(term, product))
    if (TERM.lastIndex === value.length) break
  }
  return sum
}

/** A decimal as [whole number of units, digits after the point]. */
export function decimalParts(value) {
  const [before, after = ''] = value.split('.')
  return [BigInt(before + after), after.length]
}
