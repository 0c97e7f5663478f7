// Takes screenshots of the page for the documents: screenshots.mjs PROGRAM FOLDER [--pace X]. See scripts/scope_pictures.sh.
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

import {browser, open} from './browser.mjs';
import {startProgram} from './program.mjs';

const [program, out, ...paceOf] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'hertzline-scope-'));

const running = [];
/** Starts a stream with its scope. @returns the page's address */
function show(scene, ...words) {
  const [endpoint, control] = [`ipc://${folder}/${scene}`, `ipc://${folder}/${scene}-control`];
  running.push(startProgram(program, 'endpoint', 'stream', scene, '--bind', endpoint, '--control', control, ...words));
  running.push(startProgram(program, 'scope', 'scope', '--connect', endpoint, '--http', '127.0.0.1:0', '--control', control));
  return running.at(-1).said;
}
const end = () => running.splice(0).forEach((one) => one.kill('SIGINT'));

const chromium = await browser();
try {
  const url = await show('paper-stream', ...paceOf);
  for (const [name, options] of [['scope', {}], ['scope-dark-phone', {viewport: {width: 390, height: 844}, colorScheme: 'dark'}]]) {
    const page = await open(chromium, url, options);
    await page.waitForFunction(() => window.hertzline.own.drawn > 20 && window.hertzline.spectrum.picture);
    await page.waitForTimeout(6000);
    await page.click('#chain-panel summary');
    await page.waitForFunction(() => window.hertzline.chain.picture);
    await page.evaluate(() => { window.hertzline.act.cursor('A', 0.2693); window.hertzline.act.cursor('B', 0.4307); });
    await page.waitForTimeout(2000);
    await page.screenshot({path: join(out, `${name}.png`), fullPage: name === 'scope'});
    await page.context().close();
  }
  end();
  const page = await open(chromium, await show('seven-chains', '--set', 'array.coupling=none', '--set', 'drive.repetition_hz=500', '--set',
    'output.sample_rate_hz=2e6', '--set', 'array.focus_m=[10mm, 0, 40mm]', '--on-overrun', 'wait'));
  await page.waitForFunction(() => window.hertzline.own.drawn > 5);
  await page.selectOption('#stream', 'p_points');
  await page.selectOption('#channel', 'p_points[3]');
  await page.selectOption('#beside', {label: 'v_centre: all 7'});
  await page.click('#stack');
  await page.fill('#span', '150');
  await page.press('#span', 'Enter');
  await page.waitForFunction(() => {
    const {picture} = window.hertzline.waveform;
    return picture?.traces.every(({low}) => !low.some(Number.isNaN)) && window.hertzline.spectrum.picture;
  });
  await page.waitForTimeout(1000);
  await page.screenshot({path: join(out, 'scope-array.png')});
} finally {
  await chromium.close();
  end();
  rmSync(folder, {recursive: true});
}
