// The shape of a certificate: docs/certificates.md, "The format". Whatever does not have it is no certificate.

import { NoCertificate } from './outcome.mjs'
import { ZERO, fraction } from './forms.mjs'

const FORMAT = 'truebreak/certificate-2'
export const MAX_BYTES = 16 * 1024 * 1024
const MAX_CIRCLES = 1000
const MAX_ROOTS = 99
const MAX_BITS = 1_048_576
const MAX_PAIRS = 2 ** 22
const MAX_SIZE = 2 ** 30
const DECIMAL = /^-?[0-9]+(\.[0-9]+)?$/
const LONG = /[0-9]{100001}/
const TERM = /([+-]?)([0-9]+)(?:\/([0-9]+))?((?:\*r[1-9][0-9]?)*)/y
const POLICY = /^(simultaneous|sequential(:order=scene|:seed=[0-9]{1,18})?)$/
const QUESTIONS = new Set(['gap', 'closing', 'disc', 'speed', 'slack', 'until', 'reverse'])

function fail(where, what) {
  throw new NoCertificate(`${where}: ${what}`)
}

// Kinds of values: functions (value, where) that fail or return.

const text = (value, where) => typeof value === 'string' || fail(where, 'text is expected')
const flag = (value, where) => typeof value === 'boolean' || fail(where, 'true or false is expected')

function number(value, where) {
  text(value, where)
  if (LONG.test(value)) fail(where, 'a whole number of more than 100,000 digits')
  TERM.lastIndex = 0
  for (let at = 0; at < value.length || at === 0; at = TERM.lastIndex) {
    if (!TERM.test(value) || (at > 0 && !'+-'.includes(value[at]))) fail(where, 'no exact number')
  }
}

function decimal(value, where) {
  if (typeof value !== 'string' || !DECIMAL.test(value) || LONG.test(value)) fail(where, 'no decimal')
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
      if (!item) fail(where, `there is no key ${JSON.stringify(key.slice(0, 40))}`)
      item(value[key], `${where}.${key}`)
    }
  }
}

const contact = tuple(integer(0), integer(Number.MIN_SAFE_INTEGER))

function witness(value, where) {
  if (!Array.isArray(value) || value.length < 3 || value.length > 4) fail(where, 'a list of 3 or 4 is expected')
  if (!QUESTIONS.has(value[0])) fail(where, 'no such question')
  contact(value[1], where)
  if (value[2] !== 'back') integer(0)(value[2], where)
  if (value.length === 4) contact(value[3], where)
}

function pushed(value, where) {
  if (!Array.isArray(value) || value.length < 2 || value.length > 3) fail(where, 'a list of 2 or 3 is expected')
  contact(value.slice(0, 2), where)
  if (value.length === 3) number(value[2], where)
}

const instant = {
  met: list(contact, 1),
  rounds: list(list(pushed, 1)),
  enter: list(contact),
  zeros: list(witness),
  exact: number,
  turn: (value, where) => value === true || fail(where, 'true is expected'),
}
const REASONS = new Set(['quiet', 'horizon', 'return', 'events', 'stopped'])

function end(value, where) {
  object({ reason: text }, { until: number, limit: integer(1), zeros: instant.zeros })(value, where)
  if (!REASONS.has(value.reason)) fail(where, 'no such reason')
  for (const [reason, key] of [['horizon', 'until'], ['events', 'limit']]) {
    if (value.reason === reason && !(key in value)) fail(where, `"${key}" is missing`)
  }
}

const place = { id: text, x: number, y: number, r: number }
const scene = object(
  {
    tie_policy: (value, where) => (typeof value === 'string' && POLICY.test(value)) || fail(where, 'no such policy'),
    circles: list(
      object({ ...place, vx: number, vy: number, w: number }),
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
    walls: list(object({ id: text, x0: number, y0: number, x1: number, y1: number, length: number })),
    pockets: list(object(place)),
  },
)
const certificate = object({
  format: text,
  writer: text,
  roots: list(number, 0, MAX_ROOTS),
  scene,
  isometries: list(
    object({
      matrix: tuple(number, number, number, number),
      shift: tuple(number, number),
      map: list(tuple(integer(Number.MIN_SAFE_INTEGER), integer(Number.MIN_SAFE_INTEGER))),
    }),
  ),
  bits: integer(1, MAX_BITS),
  instants: list(object({ time: decimal }, instant), 1),
  end,
  final: object({ time: decimal, circles: list(tuple(decimal, decimal, decimal, decimal)) }),
})

/** Checks the shape of everything, and that isometries map things that there are. */
export function checkShape(data) {
  if (data?.format !== FORMAT) fail('format', `not ${FORMAT}`)
  certificate(data, 'certificate')
  const { circles, walls = [], pockets = [] } = data.scene
  const [n, w, p] = [circles.length, walls.length, pockets.length]
  const pairs = n * (n + w + p)
  if (pairs > MAX_PAIRS) fail('scene', 'too many circles, walls and pockets')
  if (pairs * data.bits > MAX_SIZE) fail('bits', 'too many for so many circles, walls and pockets')
  if (data.scene.reverse_after !== undefined && data.scene.reverse_at !== undefined) fail('scene', 'two reversals')
  if (data.final.circles.length !== n) fail('final', `${data.final.circles.length} circles of ${n}`)
  const ids = [...circles, ...walls, ...pockets].map((thing) => thing.id)
  if (new Set(ids).size !== ids.length) fail('scene', 'an id is used twice')

  data.isometries.forEach(({ map }, k) => {
    for (const index of map.flat()) if (index < -p || index >= n + w) fail(`isometries[${k}]`, `${index} is no index`)
  })
}

/** An exact number from its text, in the roots that the forms have so far. */
export function exactNumber(value, forms, where) {
  TERM.lastIndex = 0
  let sum = ZERO
  for (let found = TERM.exec(value); found; found = TERM.exec(value)) {
    const [, minus, numerator, denominator = '1', factors] = found
    if (BigInt(denominator) === 0n) fail(where, 'a denominator is zero')
    let term = fraction(BigInt((minus === '-' ? '-' : '') + numerator), BigInt(denominator))
    for (const name of factors.split('*').slice(1)) {
      const root = forms.root(Number(name.slice(1)) - 1)
      if (!root) fail(where, `there is no root ${name} here`)
      term = forms.mul(term, root)
    }
    sum = forms.add(sum, term)
    if (TERM.lastIndex === value.length) break
  }
  return sum
}

/** A decimal as [whole number of units, digits after the point]. */
export function decimalParts(value) {
  const [before, after = ''] = value.split('.')
  return [BigInt(before + after), after.length]
}
