// JSON, read strictly and within bounds: no key twice, whole numbers only, nested 12 deep at most.

import { NoCertificate } from './outcome.mjs'

const DEPTH = 12
const INTEGER = /-?(?:0|[1-9][0-9]{0,14})(?![0-9.eE])/y
const SPACE = /[ \t\n\r]*/y

/** The value of a JSON text. Objects have no prototype. */
export function parse(text) {
  let at = 0

  function fail(what) {
    throw new NoCertificate(`not JSON as certificates are: ${what} at character ${at}`)
  }
  function match(pattern) {
    pattern.lastIndex = at
    const found = pattern.exec(text)
    if (found) at = pattern.lastIndex
    return found
  }
  function string() {
    const start = at
    if (text[at] !== '"') fail('a string is expected')
    let end = at + 1
    for (; ; end++) {
      const code = text.charCodeAt(end)
      if (Number.isNaN(code) || code < 32) fail('a string without end')
      if (code === 34) break
      if (code === 92) end++
    }
    at = end + 1
    try {
      return JSON.parse(text.slice(start, at))
    } catch {
      return fail('a string with a false escape')
    }
  }
  function listed(close, item) {
    at++
    match(SPACE)
    if (text[at] === close) {
      at++
      return
    }
    for (;;) {
      item()
      match(SPACE)
      const next = text[at++]
      if (next === close) return
      if (next !== ',') {
        at--
        fail(`"," or "${close}" is expected`)
      }
      match(SPACE)
    }
  }
  function value(depth) {
    match(SPACE)
    const first = text[at]
    if (depth === DEPTH && (first === '[' || first === '{')) fail('nested too deeply')
    if (first === '"') return string()
    if (first === '[') {
      const list = []
      listed(']', () => list.push(value(depth + 1)))
      return list
    }
    if (first === '{') {
      const object = Object.create(null)
      listed('}', () => {
        const key = string()
        if (key in object) fail(`key ${JSON.stringify(key.slice(0, 40))} for the second time`)
        match(SPACE)
        if (text[at++] !== ':') fail('":" is expected')
        object[key] = value(depth + 1)
      })
      return object
    }
    for (const [word, meaning] of [['true', true], ['false', false], ['null', null]]) {
      if (text.startsWith(word, at)) {
        at += word.length
        return meaning
      }
    }
    const number = match(INTEGER)
    if (!number) fail('no value, or a number that is not whole or too long')
    return Number(number[0])
  }

  const result = value(0)
  match(SPACE)
  if (at !== text.length) fail('something after the end')
  return result
}
