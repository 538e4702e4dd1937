// Runs the second checker again and again in one process, which takes a tenth of a process for each.
// Asked a line at a time, as JSON: [PROGRAM, FILE...]; answers [exit code, what it printed].
import { createInterface } from 'node:readline';
import { pathToFileURL } from 'node:url';

const say = console.log, errors = console.error;
let times = 0;
for await (const line of createInterface({ input: process.stdin })) {
  const [program, ...files] = JSON.parse(line), printed = [];
  process.argv = [process.argv[0], program, ...files];
  process.exitCode = 0;
  console.log = text => printed.push(String(text));
  console.error = console.log;
  try {
    await import(`${pathToFileURL(program)}?${++times}`);  // begun anew each time, as a process would
  } catch (e) {
    printed.push(`the program failed: ${e?.stack ?? e}`);
    process.exitCode = 70;
  }
  console.log = say;
  console.error = errors;
  say(JSON.stringify([process.exitCode, printed]));
}
process.exitCode = 0;
