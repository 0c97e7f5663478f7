// Takes screenshots of the page for the documents: screenshots.mjs PROGRAM FOLDER [--pace X]. See scripts/scope_pictures.sh.
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

import {browser, open} from './browser.mjs';
import {startProgram} from './program.mjs';

const [program, out, ...paceOf] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'hertzline-scope-'));
const endpoint = `ipc://${folder}/stream`;
const control = `ipc://${folder}/control`;

const stream = startProgram(program, 'endpoint', 'stream', 'paper-stream', '--bind', endpoint, '--control', control, ...paceOf);
const scope = startProgram(program, 'scope', 'scope', '--connect', endpoint, '--http', '127.0.0.1:0', '--control', control);
const chromium = await browser();
try {
  const url = await scope.said;
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
} finally {
  await chromium.close();
  stream.kill('SIGINT');
  scope.kill('SIGINT');
  rmSync(folder, {recursive: true});
}
