#!/usr/bin/env node
// A checker of certificates, written from docs/certificates.md alone: node tools/verify.mjs FILE...
//
// Exit codes: 0 verified; 1 refuted; 2 no certificate; 4 not decided with the bits that the certificate states.

import { closeSync, constants, fstatSync, openSync, readSync } from 'node:fs'
import { Check } from './second/check.mjs'
import { MAX_BYTES, checkShape } from './second/format.mjs'
import { parse } from './second/json.mjs'
import { NoCertificate, Refuted, Undecided, Work } from './second/outcome.mjs'

/** Units of work that a check may take, unless --work=N says otherwise. */
const WORK = 5e8
const FACTORS = [2, 4, 8]

function read(path) {
  let file
  try {
    file = openSync(path, constants.O_RDONLY | constants.O_NONBLOCK)
  } catch (error) {
    throw new NoCertificate(`cannot be read (${error.code})`)
  }
  try {
    if (!fstatSync(file).isFile()) throw new NoCertificate('not a regular file')
    const buffer = Buffer.alloc(Math.min(fstatSync(file).size, MAX_BYTES) + 1)
    let size = 0
    for (let got = -1; got !== 0 && size < buffer.length; size += got) got = readSync(file, buffer, size, buffer.length - size, null)
    if (size > MAX_BYTES) throw new NoCertificate(`more than ${MAX_BYTES} bytes`)
    return new TextDecoder('utf-8', { fatal: true, ignoreBOM: true }).decode(buffer.subarray(0, size))
  } catch (error) {
    if (error.code === 'ERR_ENCODING_INVALID_ENCODED_DATA') throw new NoCertificate('not UTF-8')
    throw error
  } finally {
    closeSync(file)
  }
}

/** How many bits would do, found by trying. */
function enough(data, work) {
  const { bits } = data
  for (const factor of FACTORS) {
    try {
      new Check(data, work, factor).run()
      return `${bits * factor} bits in the place of ${bits} would do`
    } catch (error) {
      if (error instanceof Undecided && !error.bits) return `more than ${(bits * factor) / 2} bits cannot be tried`
      if (!(error instanceof Undecided)) return `with ${bits * factor} bits: ${error.message}`
    }
  }
  return `${bits * FACTORS.at(-1)} bits would not do either`
}

/** The verdict on one file: [exit code, one line]. */
function verdict(path, limit) {
  let check
  let data
  try {
    data = parse(read(path))
    checkShape(data)
    check = new Check(data, new Work(limit))
    check.run()
  } catch (error) {
    const where = check ? `${check.now}: ` : ''
    const line = error.message.slice(0, 250)
    if (error instanceof NoCertificate) return [2, `no certificate: ${line}`]
    if (error instanceof Refuted) return [1, `refuted: ${where}${line}`]
    if (!(error instanceof Undecided)) throw error
    return [4, `not decided: ${where}${line}${error.bits ? `; ${enough(data, new Work(limit))}` : ''}`]
  }
  return [0, `verified: ${check.events} events, to the end: ${data.end.reason}`]
}

function main(args) {
  const paths = args.filter((arg) => !arg.startsWith('--'))
  const options = args.filter((arg) => arg.startsWith('--'))
  const limit = options.length ? Number(/^--work=([0-9.e]+)$/.exec(options[0])?.[1]) : WORK
  if (!paths.length || options.length > 1 || !(limit > 0)) {
    console.log('usage: verify.mjs [--work=N] FILE...')
    return 2
  }
  let worst = 0
  for (const path of paths) {
    const [code, line] = verdict(path, limit)
    console.log(line)
    worst = Math.max(worst, code)
  }
  return worst
}

process.exitCode = main(process.argv.slice(2))
