// Measures the load of the page beside a stream in real time: measure.mjs PROGRAM SECONDS. Prints one JSON object.
import {mkdtempSync, readFileSync, readdirSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

import {browser, open} from './browser.mjs';
import {startProgram} from './program.mjs';

const [program, seconds] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'hertzline-scope-'));
const TICKS = 100;  // a second, of the system's clock for processes

const start = (word, ...words) => startProgram(program, word, ...words);

const fieldsOf = (pid) => { const text = readFileSync(`/proc/${pid}/stat`, 'utf8'); return text.slice(text.lastIndexOf(')') + 2).split(' '); };

/** Returns the process and its descendants. */
function family(pid) {
  const parents = readdirSync('/proc').filter((name) => /^\d+$/.test(name)).flatMap((name) => {
    try {
      return [[Number(name), Number(fieldsOf(name)[1])]];
    } catch {
      return [];
    }
  });
  const found = [pid];
  for (let size = 0; size < found.length;) {
    size = found.length;
    found.push(...parents.filter(([child, parent]) => found.includes(parent) && !found.includes(child)).map(([child]) => child));
  }
  return found;
}

function use(pid) {
  let cpu = 0;
  let bytes = 0;
  for (const one of family(pid)) {
    const fields = fieldsOf(one);
    cpu += (Number(fields[11]) + Number(fields[12])) / TICKS;
    bytes += Number(fields[21]) * 4096;
  }
  return {cpu, MiB: Number((bytes / 2 ** 20).toFixed(1))};
}

/** Returns the growth of memory in the last two thirds, with its standard error [MiB an hour]. @param points [hours, MiB] */
function growth(points) {
  const late = points.slice(Math.floor(points.length / 3));
  const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
  const [x, y] = [mean(late.map(([t]) => t)), mean(late.map(([, m]) => m))];
  const spread = late.reduce((sum, [t]) => sum + (t - x) ** 2, 0);
  const slope = late.reduce((sum, [t, m]) => sum + (t - x) * (m - y), 0) / spread;
  const rest = late.reduce((sum, [t, m]) => sum + (m - y - slope * (t - x)) ** 2, 0);
  return {MiB_per_hour: Number(slope.toFixed(2)), error: Number(Math.sqrt(rest / (late.length - 2) / spread).toFixed(2))};
}

const stream = start('endpoint', 'stream', 'paper-stream', '--bind', `ipc://${folder}/stream`, '--json');
await stream.said;
const scope = start('scope', 'scope', '--connect', `ipc://${folder}/stream`, '--http', '127.0.0.1:0');
const chromium = await browser();
try {
  const page = await open(chromium, await scope.said);
  await page.waitForFunction(() => window.hertzline.own.drawn > 60);
  const helpers = readdirSync('/proc').filter((name) => /^\d+$/.test(name) && (() => {
    try {
      return readFileSync(`/proc/${name}/cmdline`, 'utf8').includes('--remote-debugging-pipe') && Number(fieldsOf(name)[1]) === process.pid;
    } catch {
      return false;
    }
  })()).map(Number);
  const at = () => ({scope: use(scope.pid), browser: helpers.length > 0 ? use(helpers[0]) : null, stream: use(stream.pid)});
  const before = at();
  const drawn = await page.evaluate(() => { return window.hertzline.own.drawn; });
  const delays = [];
  const memory = {scope: [], browser: []};
  const begun = Date.now();
  while (Date.now() - begun < 1000 * seconds) {
    await page.waitForTimeout(Math.min(2000, 1000 * seconds));
    delays.push(...await page.evaluate(() => window.hertzline.own.delays.splice(0)));
    const now = at();
    for (const who of ['scope', 'browser']) {
      memory[who].push([(Date.now() - begun) / 3.6e6, now[who]?.MiB]);
    }
  }
  const elapsed = (Date.now() - begun) / 1000;
  const after = at();
  const end = await page.evaluate(() => ({drawn: window.hertzline.own.drawn, state: window.hertzline.state}));
  delays.sort((a, b) => a - b);
  const share = (who) => before[who] && Number(((after[who].cpu - before[who].cpu) / elapsed).toFixed(3));
  console.log(JSON.stringify({
    seconds: Math.round(elapsed),
    pictures_per_s: Number(((end.drawn - drawn) / elapsed).toFixed(1)),
    delay_ms: {p50: delays[Math.floor(0.5 * delays.length)], p99: delays[Math.floor(0.99 * delays.length)], n: delays.length},
    load: {scope: share('scope'), browser: share('browser'), stream: share('stream')},
    MiB: {scope: [before.scope.MiB, after.scope.MiB], browser: [before.browser?.MiB, after.browser?.MiB]},
    growth: seconds >= 60 ? {scope: growth(memory.scope), browser: growth(memory.browser)} : undefined,
    stream: {late_frames: end.state.meters.late_frames, dropped: end.state.meters.dropped, real_time_factor: end.state.meters.real_time_factor},
    heard: end.state.accounts.v_out,
  }, null, 2));
} finally {
  await chromium.close();
  scope.kill('SIGINT');
  stream.kill('SIGINT');
  await Promise.all([scope.over, stream.over]);
  rmSync(folder, {recursive: true});
}
