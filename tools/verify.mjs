// Checks certificates of runs of hard discs: node verify.mjs FILE... [--work=N], a line for each
// Exit code 0: verified, 1: refuted, 2: no certificate, 4: not decided, or declined; of several files, the greatest.
import { closeSync, constants, fstatSync, openSync, readSync } from 'node:fs';
import { Verdict, TooMuch, Work, malformed } from './second/base.mjs';
import { readJson } from './second/json.mjs';
import { readCertificate } from './second/shape.mjs';
import { Run } from './second/run.mjs';

const MOST_BYTES = 2 ** 24, MOST_PARTS = 4e6;

function read(path) {
  let file;
  try {
    file = openSync(path, constants.O_RDONLY | constants.O_NONBLOCK);
    const status = fstatSync(file);
    if (!status.isFile()) malformed('no regular file');
    const bytes = Buffer.alloc(Math.min(status.size, MOST_BYTES) + 1);
    let length = 0;
    for (let n; length < bytes.length && (n = readSync(file, bytes, length, bytes.length - length, null)) > 0;) length += n;
    if (length > MOST_BYTES) malformed('over 16 MiB');
    return bytes.subarray(0, length);
  } catch (e) {
    throw e instanceof Verdict ? e : new Verdict(2, `unreadable (${e.code})`);
  } finally { if (file !== undefined) closeSync(file); }
}

/** A file of too many parts would take too much memory. */
function count(bytes) {
  let parts = 0;
  for (const b of bytes) if (b === 0x2c || b === 0x3a || b === 0x5b || b === 0x7b) parts++; // , : [ {
  if (parts > MOST_PARTS) throw new TooMuch(MOST_PARTS, 'parts');
}

/** @returns {[number, string]} exit code and line */
function verify(path, limit) {
  let work;
  const attempt = (certificate, factor) => {
    const verdict = e => e instanceof Verdict ? e : new Verdict(4, `the checker failed: ${String(e).slice(0, 200)}`);
    work.kept = 0;
    try {
      return new Verdict(0, new Run(certificate, certificate.bits * factor, work).check());
    } catch (e) { return verdict(e); }
  };
  let certificate;
  const open = e => [4, `${e instanceof TooMuch ? 'declined' : 'not decided'}: ${e.message}`];
  try {
    const bytes = read(path);
    work = new Work(limit, bytes.length);
    if (limit === undefined) count(bytes);
    certificate = readCertificate(readJson(bytes), work);
  } catch (e) {
    if (e instanceof Verdict) return e.code === 2 ? [2, `no certificate: ${e.message}`] : open(e);
    throw e;
  }
  const first = attempt(certificate, 1);
  if (first.code === 0) return [0, `verified: ${first.message}`];
  if (first.code === 1) return [1, `refuted: ${first.message}`];
  if (first.code === 2) return [2, `no certificate: ${first.message}`];
  let more = '';
  for (const factor of first instanceof TooMuch ? [] : [2, 4]) {
    const { code } = attempt(certificate, factor);
    if (code > 1) continue;
    more = `; with ${certificate.bits * factor} bits it is ${code ? 'refuted' : 'verified'}`;
    break;
  }
  return first instanceof TooMuch ? open(first) : [4, `not decided: ${first.message}${more}`];
}

const args = process.argv.slice(2), options = args.filter(a => a.startsWith('--')), files = args.filter(a => !a.startsWith('--'));
const given = options.map(a => /^--work=([0-9]{1,15})$/.exec(a)?.[1]);
const asked = files.length > 0 && options.length <= 1 && !given.includes(undefined);
if (!asked) console.log('no certificate: usage: node verify.mjs FILE... [--work=N]');
let worst = asked ? 0 : 2;
for (const file of asked ? files : []) {
  let code, line;
  try { [code, line] = verify(file, given.length ? Number(given[0]) : undefined); } catch (e) {
    // nothing may pass for a verdict on the certificate that is none
    [code, line] = [4, `not decided: the checker failed: ${String(e)}`];
  }
  console.log(line.replace(/[^\x20-\x7e²]/g, '?').slice(0, 500));
  worst = Math.max(worst, code);
}
process.exitCode = worst;
