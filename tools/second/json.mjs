// A strict reader of JSON (RFC 8259, and less: no key twice, whole numbers of at most 15 digits, no deep nesting).
import { malformed } from './base.mjs';

const DEEPEST = 16; // a certificate nests 5 deep; a bound keeps the reader's recursion short
const ESCAPES = { '"': '"', '\\': '\\', '/': '/', b: '\b', f: '\f', n: '\n', r: '\r', t: '\t' };

/**
 * Objects become Maps, so that no key (as "__proto__") means anything to JavaScript.
 * @param {Uint8Array} bytes @returns {unknown}
 */
export function readJson(bytes) {
  let text;
  try { // ignoreBOM keeps a mark at the start in the text, where the grammar refuses it
    text = new TextDecoder('utf-8', { fatal: true, ignoreBOM: true }).decode(bytes);
  } catch { return malformed('not UTF-8'); }
  let at = 0;
  const bad = what => malformed(`not JSON as agreed: ${what} at character ${at}`);
  const skip = () => { while (' \t\n\r'.includes(text[at] ?? 'x')) at++; };

  function string() {
    let out = '', from = ++at;
    for (;; at++) {
      const c = text.charCodeAt(at);
      if (Number.isNaN(c)) bad('a string without an end');
      if (c < 32) bad('a control character');
      if (c === 34) { out += text.slice(from, at++); return out; }
      if (c !== 92) continue;
      out += text.slice(from, at);
      const e = text[++at];
      if (e === 'u') {
        const hex = text.slice(at + 1, at + 5);
        if (!/^[0-9a-fA-F]{4}$/.test(hex)) bad('an escape that is none');
        out += String.fromCharCode(parseInt(hex, 16));
        at += 4;
      } else out += Object.hasOwn(ESCAPES, e ?? '') ? ESCAPES[e] : bad('an escape that is none');
      from = at + 1;
    }
  }

  function number() {
    const from = at;
    if (text[at] === '-') at++;
    const digits = at;
    while (text[at] >= '0' && text[at] <= '9') at++;
    if (at === digits || at - digits > 15) bad('a number of no or more than 15 digits');
    if (text[digits] === '0' && at > digits + 1) bad('a number with a leading zero');
    if ('.eE'.includes(text[at] ?? ' ')) bad('a number that is not whole');
    return Number(text.slice(from, at)) + 0 || 0; // -0 becomes 0
  }

  function value(depth) {
    if (depth > DEEPEST) bad('too deep a nesting');
    skip();
    const c = text[at];
    if (c === '"') return string();
    if (c === '{') {
      const map = new Map();
      at++; skip();
      if (text[at] === '}') { at++; return map; }
      for (;;) {
        skip();
        if (text[at] !== '"') bad('no key');
        const key = string();
        if (map.has(key)) bad(`the key ${JSON.stringify(key.slice(0, 40))} comes twice, the second`);
        skip();
        if (text[at++] !== ':') bad('no colon');
        map.set(key, value(depth + 1));
        skip();
        const next = text[at++];
        if (next === '}') return map;
        if (next !== ',') bad('neither comma nor brace');
      }
    }
    if (c === '[') {
      const list = [];
      at++; skip();
      if (text[at] === ']') { at++; return list; }
      for (;;) {
        list.push(value(depth + 1));
        skip();
        const next = text[at++];
        if (next === ']') return list;
        if (next !== ',') bad('neither comma nor bracket');
      }
    }
    for (const [word, meaning] of [['true', true], ['false', false], ['null', null]]) {
      if (text.startsWith(word, at)) { at += word.length; return meaning; }
    }
    if (c === '-' || (c >= '0' && c <= '9')) return number();
    return bad('no value');
  }

  const result = value(0);
  skip();
  if (at < text.length) bad('something after the end');
  return result;
}
