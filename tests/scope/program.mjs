// The program under test, as the scripts of this folder start it.
import {spawn} from 'node:child_process';

/** Starts the program. `said` is the last word of its first message with `word`, `over` resolves at its end, `out` is its stdout. */
export function startProgram(program, word, ...words) {
  const process_ = spawn(program, words, {stdio: ['ignore', 'pipe', 'pipe']});
  process_.out = '';
  process_.stdout.on('data', (data) => { process_.out += data; });
  process_.said = new Promise((resolve, reject) => {
    let text = '';
    process_.stderr.on('data', (data) => {
      text += data;
      const line = text.split('\n').slice(0, -1).find((one) => one.includes(`${word} `));
      if (line) {
        resolve(line.trim().split(' ').at(-1));
      }
    });
    process_.on('exit', () => reject(new Error(text)));
  });
  process_.said.catch(() => {});
  process_.over = new Promise((resolve) => { process_.on('exit', resolve); });
  return process_;
}
