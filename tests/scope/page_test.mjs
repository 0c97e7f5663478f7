// Tests the page in a real browser: page_test.mjs PROGRAM FOLDER. Prints a line for each promise that holds.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';

import {browser, open} from './browser.mjs';
import {startProgram} from './program.mjs';

const [program, folder] = process.argv.slice(2);
const endpoint = `ipc://${folder}/stream`;
const control = `ipc://${folder}/control`;
const PERIOD = 10000;
const RATE = 1e7;

const running = new Set();
function start(word, ...words) {
  const process_ = startProgram(program, word, ...words);
  running.add(process_);
  process_.on('exit', () => running.delete(process_));
  return process_;
}
const startStream = () => start('endpoint', 'stream', 'paper-stream', '--bind', endpoint, '--pace', '0.05', '--control', control,
  '--on-overrun', 'wait');  // a loaded machine's stream falls behind, and drops nothing

/** Returns the samples of `run`, as float32. */
function samplesOfRun(count) {
  const file = `${folder}/run.npy`;
  execFileSync(program, ['run', 'paper-stream', '--columns', 'v_out', '-o', file, '--set', `output.duration_s=${(count - 1) / RATE}`],
    {stdio: 'ignore'});
  const bytes = readFileSync(file);
  const data = bytes.subarray(10 + bytes.readUInt16LE(8));
  const rows = new Float64Array(data.buffer.slice(data.byteOffset, data.byteOffset + 16 * count));  // time, v_out
  return Float32Array.from({length: count}, (_, i) => rows[2 * i + 1]);
}

const pictureIn = (page) => page.evaluate(() => {
  const {picture} = window.hertzline.waveform;
  return picture && {...picture, low: [...picture.low], high: [...picture.high]};
});
const until = (page, condition, argument) => page.waitForFunction(condition, argument, {polling: 50});

function check(picture) {
  const samples = samplesOfRun(picture.first + picture.samples);
  for (let column = 0; column < picture.columns; ++column) {
    const edge = (k) => picture.first + Math.floor(k * picture.samples / picture.columns);
    const window = samples.subarray(edge(column), edge(column + 1));
    assert.equal(picture.low[column], window.reduce((a, b) => Math.min(a, b)));
    assert.equal(picture.high[column], window.reduce((a, b) => Math.max(a, b)));
  }
}

const scope = start('scope', 'scope', '--connect', endpoint, '--http', '127.0.0.1:0', '--record-to', folder, '--control', control);
const url = await scope.said;
const chromium = await browser();

const promises = {
  async 'says that there is no stream, and finds it when it begins'() {
    this.page = await open(chromium, url);
    await until(this.page, () => document.getElementById('trouble').textContent.includes('hertzline stream'));
    this.stream = startStream();
    await until(this.page, () => document.getElementById('state').dataset.state === 'running' && window.hertzline.own.drawn > 5);
    assert.equal(await this.page.isHidden('#trouble'), true);
    assert.deepEqual(await this.page.locator('.stream-unit').allTextContents(), ['m/s', 'm/s']);
  },
  async 'shows every pixel\u2019s smallest and largest sample'() {
    await this.page.click('#hold');
    await until(this.page, () => window.hertzline.waveform.picture.held);
    const picture = await pictureIn(this.page);
    assert.equal(picture.trigger % PERIOD, 0);
    assert.ok(picture.columns > 500 && picture.samples > 2 * picture.columns, 'an envelope');
    check(picture);
    // A column of pixels on the canvas reaches from its largest sample to its smallest.
    const painted = await this.page.evaluate(() => {
      const {waveform} = window.hertzline;
      const {context, shown, box} = waveform;
      const [column] = [...waveform.picture.high.keys()].sort((a, b) =>
        (waveform.picture.high[b] - waveform.picture.low[b]) - (waveform.picture.high[a] - waveform.picture.low[a]));
      const x = Math.floor(box.left + (column + 0.5) * box.width / waveform.picture.columns);
      const pixels = context.getImageData(x, 0, 1, box.bottom).data;
      const blue = [...Array(box.bottom).keys()].filter((y) => pixels[4 * y + 2] > pixels[4 * y] + 60);
      const y = (value) => box.top + (shown.high - value) / (shown.high - shown.low) * box.height;
      return {top: blue[0], bottom: blue.at(-1), high: y(waveform.picture.high[column]), low: y(waveform.picture.low[column])};
    });
    assert.ok(painted.top <= painted.high + 1 && painted.bottom >= painted.low - 1, JSON.stringify(painted));
  },
  async 'zooms into what is held, down to single samples'() {
    const before = await pictureIn(this.page);
    const box = await this.page.locator('#waveform').boundingBox();
    await this.page.mouse.move(box.x + box.width / 3, box.y + box.height / 2);
    for (let turn = 0; turn < 20; ++turn) {
      await this.page.mouse.wheel(0, -100);
    }
    await until(this.page, () => window.hertzline.waveform.picture.each_sample);
    const close = await pictureIn(this.page);
    assert.equal(close.trigger, before.trigger);
    const samples = samplesOfRun(close.first + close.samples);
    assert.deepEqual(close.low, [...samples.subarray(close.first, close.first + close.samples)]);
  },
  async 'has cursors with differences, by mouse and by keys'() {
    await this.page.click('#home');
    await this.page.click('#waveform', {position: {x: 200, y: 100}});
    await this.page.click('#waveform', {position: {x: 400, y: 100}, modifiers: ['Shift']});
    await until(this.page, () => document.querySelectorAll('#cursors tbody tr').length === 3);
    const {a, b} = await this.page.evaluate(() => ({a: window.hertzline.waveform.cursors.A, b: window.hertzline.waveform.cursors.B}));
    await this.page.focus('#waveform');
    await this.page.keyboard.press('b');
    await this.page.keyboard.press('.');
    const moved = await this.page.evaluate(() => window.hertzline.waveform.cursors.B);
    assert.ok(b > a && moved > a && moved !== b);
  },
  async 'keeps the labels of its axes off the trace'() {
    await this.page.fill('#low', '-1e-9');  // the trace leaves the plot above and below
    await this.page.fill('#high', '1e-9');
    await this.page.keyboard.press('Enter');
    await until(this.page, () => window.hertzline.waveform.shown.high === 1e-9);
    const blue = await this.page.evaluate(() => {
      window.hertzline.waveform.draw();
      const {context, box, canvas} = window.hertzline.waveform;
      const count = (x, y, width, height) => {
        const {data} = context.getImageData(x, y, width, height);
        return [...Array(width * height).keys()].filter((i) => data[4 * i + 2] > data[4 * i] + 100).length;
      };
      return {left: count(0, 0, box.left, canvas.height), above: count(0, 0, canvas.width, box.top),
        below: count(0, box.bottom, canvas.width, canvas.height - box.bottom), plot: count(box.left, box.top, box.width, box.height)};
    });
    assert.deepEqual([blue.left, blue.above, blue.below], [0, 0, 0]);
    assert.ok(blue.plot > 1000, JSON.stringify(blue));
    await this.page.click('#home');
  },
  async 'marks a text that is no number'() {
    await this.page.focus('#low');
    await this.page.keyboard.type('+-0.');
    await this.page.keyboard.press('Enter');
    await until(this.page, () => document.getElementById('low').getAttribute('aria-invalid') === 'true');
    assert.match(await this.page.textContent('#view-fault'), /level from: found no number/);
    await this.page.fill('#low', '0');
    await this.page.fill('#low', '');
    await this.page.keyboard.press('Enter');
    await until(this.page, () => document.getElementById('low').getAttribute('aria-invalid') === 'false');
  },
  async 'says what a field of the view allows, or shows the number in use'() {
    const enter = async (id, text) => {
      await this.page.fill(id, text);
      await this.page.press(id, 'Enter');
    };
    await enter('#low', '1');
    await enter('#high', '-1');
    assert.match(await this.page.textContent('#view-fault'), /level: found 1 to -1, allowed: from a smaller to a larger one/);
    await enter('#high', '');
    await enter('#low', '');
    assert.equal(await this.page.textContent('#view-fault'), '');
    await this.page.selectOption('#trigger', 'level');
    for (const [id, text, used] of [['#average', '2.4', '2'], ['#average', '-1', '1'], ['#to-hz', '1e9', '5000'], ['#to-hz', '', '800'],
      ['#floor-db', '5', '-20'], ['#floor-db', '', '-80'], ['#hold-off', '-3', '0'], ['#hold-off', '500', '500']]) {
      await enter(id, text);
      assert.equal(await this.page.inputValue(id), used, `${id} ${text}`);
    }
    await this.page.selectOption('#trigger', 'burst');
  },
  async 'triggers on a level'() {
    await this.page.click('#run');
    await this.page.selectOption('#trigger', 'level');
    await this.page.fill('#level', '0.2');
    await this.page.keyboard.press('Enter');
    const drawn = await this.page.evaluate(() => window.hertzline.own.drawn);
    await until(this.page, (before) => window.hertzline.own.drawn > before + 10 && !window.hertzline.waveform.picture.held, drawn);
    const picture = await pictureIn(this.page);
    const samples = samplesOfRun(picture.first + picture.samples);
    assert.ok(samples[picture.trigger] >= Math.fround(0.2) && samples[picture.trigger - 1] < Math.fround(0.2), JSON.stringify(
      {...picture, low: samples[picture.trigger - 1], high: samples[picture.trigger]}));
    await this.page.selectOption('#trigger', 'burst');
  },
  async 'shows the measures of run, a spectrum and a waterfall'() {
    await until(this.page, () => window.hertzline.measures && window.hertzline.spectrum.picture);
    const said = JSON.parse(execFileSync(program, ['run', 'paper-stream', '--json', '--set', `output.duration_s=${(PERIOD - 1) / RATE}`],
      {stdio: ['ignore', 'pipe', 'ignore']}));
    const measures = await this.page.evaluate(() => window.hertzline.measures);
    for (const [k, db] of said.harmonics_db.entries()) {  // a later burst begins with the motion that the previous one has left
      assert.ok(Math.abs(measures.harmonics_db[k] - db) < 0.3, `harmonic ${k + 1}: ${measures.harmonics_db[k]}, run has ${db}`);
    }
    assert.match(await this.page.textContent('#measures'), /harmonics/);
    const rows = () => this.page.evaluate(() => {
      const {waterfall, falls} = window.hertzline.spectrum;
      const {data} = falls.getImageData(0, 0, 1, waterfall.height);
      return [...Array(waterfall.height).keys()].filter((y) => data[4 * y + 3] > 0).length;
    });
    await until(this.page, () => window.hertzline.spectrum.falls.getImageData(0, 20, 1, 1).data[3] > 0);
    await this.page.fill('#to-hz', '2000');
    await this.page.press('#to-hz', 'Enter');
    await until(this.page, () => window.hertzline.spectrum.axesOfRows.startsWith('2'));
    assert.ok(await rows() < 20, 'rows of another axis');
    await this.page.fill('#to-hz', '800');
    await this.page.press('#to-hz', 'Enter');
  },
  async 'shows other channels beside it'() {
    const rows = (count) => until(this.page, (wanted) => {
      const {picture} = window.hertzline.waveform;
      return picture?.rows === wanted && picture.traces.every(({low}) => !low.some(Number.isNaN));
    }, count);
    assert.equal(await this.page.isVisible('#channel'), false, 'v_out has one');
    assert.equal(await this.page.isVisible('#stack'), false);
    await this.page.selectOption('#beside', 'f_last');
    await rows(2);
    assert.equal(await this.page.locator('#beside-list button').count(), 0, 'the list shows a single one');
    await this.page.selectOption('#beside', 'v_horn');
    await rows(3);
    assert.deepEqual(await this.page.evaluate(() => window.hertzline.waveform.channels),
      [['v_out', 'm/s'], ['v_horn', 'm/s'], ['f_last', 'N']].map(([name, unit]) => ({name, stream: name, unit})));
    const {sizes, places} = await this.page.evaluate(() => {
      const {waveform} = window.hertzline;
      return {sizes: waveform.picture.traces.map(({low, high}) => Math.max(...high, -Math.min(...low))), places: [1, 2].map((row) => waveform.placeOf(row))};
    });
    places.forEach(({high}, i) => assert.ok(high >= sizes[i + 1] && high < 1.2 * sizes[i + 1], 'each stream fills the window'));
    await this.page.click('#beside-list button:has-text("v_horn")');
    await rows(2);
    await this.page.selectOption('#beside', '');
    await rows(1);
  },
  async 'shows the chain'() {
    await this.page.click('#chain-panel summary');
    await until(this.page, () => window.hertzline.chain.picture?.rows === 6);
    await this.page.selectOption('#chain-stream', 'f_chain');
    await until(this.page, () => window.hertzline.chain.picture?.rows === 7);
    assert.match(await this.page.textContent('#chain-text'), /up to .*N, blue an open contact/);
    const colours = await this.page.evaluate(() => [0, 0.1].map((force) => window.hertzline.chain.colour(force)));
    assert.ok(colours[0][2] > colours[0][0] && colours[1][0] > colours[1][2], 'an open contact is blue, a force is not');
    await this.page.selectOption('#chain-stream', 'v_chain');
    await this.page.click('#chain-panel summary');
  },
  async 'turns a knob, and sees it from the sample on that the answer named'() {
    const knob = this.page.locator('[id="knob-drive.amplitude_m"]');
    await until(this.page, () => !document.getElementById('knob-drive.amplitude_m').disabled);
    assert.equal(await this.page.locator('[id="knob-drive.envelope"] option').count(), 3);
    assert.ok(await this.page.locator('[id="knob-chain.spheres"]').isDisabled(), 'no stream can change it');
    assert.equal(await this.page.locator('[id="limits-chain.spheres"]').textContent(), 'fixed while the stream runs');
    assert.equal(await this.page.locator('[id="knob-drive.file"]').isVisible(), false, 'a tone has no file');
    const peak = () => this.page.evaluate(() => Math.max(...window.hertzline.waveform.picture.high));
    const before = await peak();
    await knob.fill('-1');
    await knob.press('Enter');
    await until(this.page, () => document.getElementById('knob-answer').classList.contains('bad'));
    await knob.fill('1.5e-6');
    await knob.press('Enter');
    // The peak of the first burst that begins after the change that was answered last, and later than the one with `epoch`.
    const peakAfter = async (epoch) => {
      await until(this.page, (last) => window.hertzline.answer?.answer.epoch > last, epoch);
      const {answer} = await this.page.evaluate(() => window.hertzline.answer);
      await until(this.page, (sample) => window.hertzline.waveform.picture.trigger >= sample, answer.applies_at_sample);
      assert.equal((await pictureIn(this.page)).epoch, answer.epoch);
      return {epoch: answer.epoch, peak: await peak()};
    };
    const {epoch, peak: changed} = await peakAfter(0);
    assert.ok(changed < 0.8 * before, `${changed} after ${before}`);
    await this.page.click('#undo');
    const {peak: undone} = await peakAfter(epoch);
    assert.ok(Math.abs(undone - before) < 0.1 * before, `${undone} after ${before}`);
  },
  async 'says below a field why its value was refused, and beside it the value in use'() {
    const knob = this.page.locator('[id="knob-drive.cycles"]');
    const text = (part) => this.page.textContent(`[id="${part}-drive.cycles"]`);
    await knob.fill('500');
    await knob.press('Enter');
    await until(this.page, () => document.getElementById('fault-drive.cycles').textContent !== '');
    assert.equal(await knob.getAttribute('aria-invalid'), 'true');
    assert.equal(await knob.inputValue(), '500');
    assert.equal(await text('use'), '25 in use');
    assert.equal(await this.page.getAttribute('[id="fault-drive.cycles"]', 'aria-live'), 'polite');
    assert.ok((await knob.getAttribute('aria-describedby')).includes('fault-drive.cycles'));
    const [field, fault] = [await knob.boundingBox(), await this.page.locator('[id="fault-drive.cycles"]').boundingBox()];
    assert.ok(fault.y >= field.y + field.height && fault.y < field.y + 100, 'far away from its field');
    await this.page.evaluate(() => document.activeElement.blur());
    assert.equal(await knob.inputValue(), '25');  // as it plays
    assert.equal(await knob.getAttribute('aria-invalid'), null);
    await knob.fill('25.0');
    await knob.press('Enter');
    assert.equal(await text('fault'), '', 'what is in use is not refused');
    await knob.fill('24');
    await knob.press('Enter');
    await until(this.page, () => document.getElementById('use-drive.cycles').textContent === '24 in use');
    assert.equal(await text('fault'), '');
    await this.page.click('#undo');
    await until(this.page, () => document.getElementById('use-drive.cycles').textContent === '25 in use');
  },
  async 'takes an optional number back when its field is emptied'() {
    const knob = this.page.locator('[id="knob-drive.sweep_to_hz"]');
    for (const [text, used] of [['80 kHz', '80 kHz in use'], ['', '\u2013 in use']]) {
      await knob.fill(text);
      await knob.press('Enter');
      await until(this.page, (wanted) => document.getElementById('use-drive.sweep_to_hz').textContent === wanted, used);
    }
    await knob.fill('70');
    await knob.press('Escape');
    assert.equal(await knob.inputValue(), '');
  },
  async 'takes units with prefixes, and names those of the key'() {
    const knob = this.page.locator('[id="knob-drive.amplitude_m"]');
    await this.page.evaluate(() => document.activeElement.blur());
    assert.equal(await knob.inputValue(), '3 \u00b5m');
    for (const [typed, wanted] of [['2.5 um', 2.5e-6], ['2400nm', 2.4e-6], ['3\u00b5m', 3e-6]]) {
      await knob.fill(typed);
      await knob.press('Enter');
      await until(this.page, (value) => window.hertzline.scene.scene.drive.amplitude_m === value, wanted);
    }
    await knob.fill('3 mN');
    await knob.press('Enter');
    await until(this.page, () => document.getElementById('fault-drive.amplitude_m').textContent.includes('with any prefix, as um or mm'));
    await this.page.evaluate(() => document.activeElement.blur());
  },
  async 'says what its sliders cover'() {
    await until(this.page, () => document.getElementById('use-drive.amplitude_m').textContent === '3 \u00b5m in use');
    const limits = (key) => this.page.textContent(`[id="limits-${key}"]`);
    await until(this.page, () => document.getElementById('limits-drive.amplitude_m').textContent
      === 'slider: 750 nm to 12 \u00b5m; allowed: 0 m to 1 m');
    assert.match(await limits('drive.frequency_hz'), /^slider: 18.25 kHz to 292 kHz; allowed: 1 mHz to 1 GHz$/);
    assert.match(await limits('drive.cycles'), /allowed: 0.001 to 1e9$/);
  },
  async 'shows what is where a change was refused, and where a slider was not moved'() {
    const kind = this.page.locator('[id="knob-end.kind"]');
    await this.page.evaluate(() => document.querySelectorAll('#knobs details').forEach((box) => { box.open = true; }));
    await kind.selectOption('wall');
    await until(this.page, () => window.hertzline.answer?.answer.faults?.[0].key === 'end.kind');
    assert.equal(await kind.inputValue(), 'plate');
    const needed = this.page.locator('[id="knob-chain.damping_alpha"]');
    assert.equal(await needed.isVisible(), false);
    await this.page.selectOption('[id="knob-chain.damping_law"]', 'tsuji');
    await until(this.page, () => window.hertzline.answer?.answer.faults?.[0].key === 'chain.damping_alpha');
    assert.equal(await needed.isVisible(), true, 'the key that the law needs');
    const zeroSlider = this.page.locator('.knob:has([id="knob-chain.preload_n"]) input[type=range]');
    for (const [text, visible] of [['0', false], ['0.1', true]]) {
      await this.page.fill('[id="knob-chain.preload_n"]', text);
      await this.page.press('[id="knob-chain.preload_n"]', 'Enter');
      await until(this.page, (value) => window.hertzline.scene.scene.chain.preload_n === value, Number(text));
      await zeroSlider.waitFor({state: visible ? 'visible' : 'hidden'});
    }
    const before = await this.page.evaluate(() => window.hertzline.scene.scene.drive.amplitude_m);
    const slider = this.page.locator('.knob:has([id="knob-drive.amplitude_m"]) input[type=range]');
    await slider.click();  // in the middle, where it is
    await this.page.evaluate(() => {  // a slow stream: the value in use is older than the last turn
      const {send} = WebSocket.prototype;
      WebSocket.prototype.send = function sendLate(text) {
        setTimeout(() => send.call(this, text), text.includes('"set"') ? 1500 : 0);
      };
      window.sendAtOnce = () => { WebSocket.prototype.send = send; };
    });
    for (let i = 0; i < 10; ++i) {
      await slider.press('ArrowRight');
      await this.page.waitForTimeout(i === 4 ? 2500 : 0);
    }
    const turned = before * 2 ** 0.2;
    await until(this.page, (wanted) => Math.abs(window.hertzline.scene.scene.drive.amplitude_m / wanted - 1) < 0.01, turned);
    await this.page.evaluate(() => document.activeElement.blur());
    const other = await open(chromium, url);
    await until(other, () => document.getElementById('use-drive.cycles')?.textContent === '25 in use');
    await this.page.fill('[id="knob-drive.amplitude_m"]', String(before));
    await this.page.press('[id="knob-drive.amplitude_m"]', 'Enter');
    const cycles = async (text) => {
      await other.fill('[id="knob-drive.cycles"]', text);
      await other.press('[id="knob-drive.cycles"]', 'Enter');
      await until(this.page, (value) => document.getElementById('use-drive.cycles').textContent === `${value} in use`, text);
    };
    await cycles('24');  // new values come while the change of this page has no answer yet
    await until(this.page, (wanted) => window.hertzline.scene.scene.drive.amplitude_m === wanted, before);
    await until(this.page, () => document.getElementById('limits-drive.amplitude_m').textContent.startsWith('slider: 750 nm to 12 \u00b5m'));
    await this.page.evaluate(() => window.sendAtOnce());
    await cycles('25');
    await other.context().close();
  },
  async 'saves scene and pictures'() {
    for (const [button, beginning] of [['#save-scene', '# The scene'], ['#save-png', '\x89PNG'], ['#save-svg', '<svg']]) {
      const [download] = await Promise.all([this.page.waitForEvent('download'), this.page.click(button)]);
      const file = `${folder}/${download.suggestedFilename()}`;
      await download.saveAs(file);
      assert.equal(readFileSync(file, 'latin1').slice(0, beginning.length), beginning);
      if (button === '#save-scene') {
        continue;
      }
      const {hash, run} = await this.page.evaluate(() => ({hash: window.hertzline.scene.scene_hash, run: window.hertzline.scene.run}));
      assert.match(download.suggestedFilename(), new RegExp(`^hertzline-v_out-${hash.slice(0, 8)}-\\d{8}T\\d{6}\\.`));
      if (button === '#save-svg') {
        const svg = readFileSync(file, 'utf8');
        for (const text of [/v_out from sample \d+ on, epoch \d+, of ipc:/, `scene ${hash}: 6 spheres of`, `run ${run}, saved 20`]) {
          assert.ok(svg.match(text), `${text} is not in the picture`);
        }
      }
    }
  },
  async 'loses the stream and finds it again'() {
    this.stream.kill('SIGKILL');
    await until(this.page, () => document.getElementById('state').dataset.state === 'silent');
    const runNow = () => this.page.evaluate(() => window.hertzline.scene.run);
    const killed = await runNow();
    const slow = start('endpoint', 'stream', 'striker', '--bind', endpoint, '--pace', '1e-6');  // its first frame takes a minute
    await until(this.page, (before) => window.hertzline.scene.run !== before, killed);
    assert.deepEqual(await this.page.evaluate(() => [window.hertzline.waveform.picture, window.hertzline.spectrum.picture, window.hertzline.measures]),
      [null, null, null], 'pictures of another run');
    assert.equal(await this.page.textContent('#measures'), '');
    const run = await runNow();
    slow.kill('SIGINT');
    await slow.over;
    await until(this.page, () => document.getElementById('state').dataset.state === 'ended');
    this.stream = startStream();
    await until(this.page, (before) => document.getElementById('state').dataset.state === 'running' && window.hertzline.scene.run !== before, run);
    await until(this.page, () => window.hertzline.waveform.picture?.trigger < 2e6);
    check(await pictureIn(this.page));
  },
  async 'says that the scope hangs, and goes on when it does'() {
    scope.kill('SIGSTOP');
    await until(this.page, () => document.getElementById('trouble').textContent.includes('The scope has sent nothing for'));
    assert.equal(await this.page.getAttribute('#state', 'data-state'), 'gone');
    scope.kill('SIGCONT');
    await until(this.page, () => document.getElementById('state').dataset.state === 'running');
  },
  async 'serves eight pages at once, each with its own view, and the listener loses nothing'() {
    const pages = await Promise.all([...Array(8).keys()].map(() => open(chromium, url)));
    for (const [k, page] of pages.entries()) {
      await page.evaluate((to) => { window.hertzline.act.zoom(to, 0); }, 0.5 + 0.05 * k);
    }
    for (const page of pages) {
      await until(page, () => window.hertzline.own.drawn > 10 && window.hertzline.state.pages === 9);
    }
    const account = await this.page.evaluate(() => window.hertzline.state.accounts.v_out);
    assert.equal(account.frames_lost_on_the_way, 0, JSON.stringify(account));
    check(await pictureIn(pages[7]));
    await Promise.all(pages.map((page) => page.context().close()));
  },
  async 'fits a phone, and a dark room'() {
    const page = await open(chromium, url, {viewport: {width: 390, height: 800}, colorScheme: 'dark', hasTouch: true});
    await until(page, () => window.hertzline.own.drawn > 3);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), 'wider than the phone');
    assert.notEqual(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), 'rgb(253, 253, 251)');
    // A knob is on the screen together with the waveform that it changes.
    await page.click('#jump a');
    await page.locator('[id="knob-drive.frequency_hz"]').scrollIntoViewIfNeeded();
    const [picture, knob] = [await page.locator('#waveform').boundingBox(), await page.locator('[id="knob-drive.frequency_hz"]').boundingBox()];
    assert.ok(picture.y >= 0 && knob.y >= picture.y + picture.height && knob.y + knob.height <= 800, JSON.stringify({picture, knob}));
    assert.deepEqual(page.faults, []);
    await page.context().close();
  },
  async 'zooms with two fingers and places both cursors by touch'() {
    const page = await open(chromium, url, {viewport: {width: 360, height: 740}, hasTouch: true, isMobile: true});
    await until(page, () => window.hertzline.own.drawn > 3);
    assert.deepEqual(await page.locator('.hint.mouse, .hint.touch').evaluateAll((hints) => hints.map((hint) => hint.checkVisibility())), [false, true]);
    const place = async (name, x) => {
      await page.tap(`#cursor-${name.toLowerCase()}`);
      await page.evaluate(() => document.getElementById('waveform').scrollIntoView());
      const waveform = await page.$('#waveform');
      await waveform.waitForElementState('stable');  // texts above it may still come
      const box = await waveform.boundingBox();
      await page.touchscreen.tap(box.x + x, box.y + 60);
      await until(page, (cursor) => window.hertzline.waveform.cursors[cursor] !== null, name);
      return box;
    };
    await place('A', 120);
    const box = await place('B', 220);
    const cursors = await page.evaluate(() => ({...window.hertzline.waveform.cursors}));
    assert.ok(cursors.B > cursors.A);
    const before = await page.evaluate(() => window.hertzline.view.span_s);
    const line = await page.context().newCDPSession(page);
    const touch = (type, ...xs) => line.send('Input.dispatchTouchEvent',
      {type, touchPoints: xs.map((x, id) => ({x: box.x + x, y: box.y + 80, id}))});
    await touch('touchStart', 150);
    await touch('touchStart', 150, 200);
    for (let step = 1; step <= 5; ++step) {
      await touch('touchMove', 150 - 10 * step, 200 + 10 * step);
    }
    await touch('touchEnd');
    await until(page, (span) => window.hertzline.view.span_s < span / 2.8 && window.hertzline.view.span_s > span / 3.2, before);  // 150 apart in place of 50
    assert.deepEqual(await page.evaluate(() => ({...window.hertzline.waveform.cursors})), cursors);
    assert.deepEqual(page.faults, []);
    await page.context().close();
  },
  async 'shows a point beside the elements of an array, on a phone, and goes on when a change restarts it'() {
    const file = `${folder}/array.toml`;
    writeFileSync(file, '[drive]\nrepetition_hz = 1000\n[array]\nx_m = [-12e-3, 0, 12e-3]\ny_m = [0, 0, 0]\ncoupling = "none"\n'
      + '[end]\nmodel = "modal"\n[output]\npoints_m = [[0, 0, 20e-3], [5e-3, 0, 20e-3]]\nsample_rate_hz = 1e6\n');
    const [stream, knobs] = [`ipc://${folder}/array`, `ipc://${folder}/array-control`];
    start('endpoint', 'stream', file, '--bind', stream, '--pace', '0.05', '--control', knobs, '--on-overrun', 'wait');
    const page = await open(chromium, await start('scope', 'scope', '--connect', stream, '--http', '127.0.0.1:0', '--control', knobs).said,
      {viewport: {width: 360, height: 740}, hasTouch: true, isMobile: true});
    await until(page, () => window.hertzline.own.drawn > 3);
    assert.equal(await page.evaluate(() => window.hertzline.view.channel), 'v_out[1]');
    assert.equal(await page.isVisible('#chain-panel'), false, 'an array has no stream of a whole chain');
    await page.selectOption('#stream', 'p_points');
    await page.selectOption('#channel', 'p_points[2]');
    await page.selectOption('#beside', {label: 'v_last: all 3'});
    await until(page, () => window.hertzline.waveform.picture?.rows === 4);
    assert.deepEqual(await page.locator('#beside-list button').allTextContents(), ['v_last[1] \u00d7', '[2] \u00d7', '[3] \u00d7']);
    await page.click('#beside-list [title="without v_last[2]"]');
    await until(page, () => window.hertzline.waveform.picture?.rows === 3);
    assert.deepEqual(await page.evaluate(() => window.hertzline.waveform.channels.map(({name}) => name)), ['p_points[2]', 'v_last[1]', 'v_last[3]']);
    await page.click('#stack');
    const painted = await page.evaluate(() => {
      const {waveform} = window.hertzline;
      waveform.draw();
      const {box, context} = waveform;
      return [0, 1, 2].map((row) => {  // colours of the trace in its own lane, and of the others there
        const {top, height} = waveform.placeOf(row);
        const {data} = context.getImageData(box.left, top + 2, box.width / 2, height - 4);
        const of = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
        const count = (hex) => [...Array(data.length / 4).keys()].filter((i) => of(hex).every((part, k) => data[4 * i + k] === part)).length;
        return ['#0072b2', '#00795c', '#a0408c'].map(count);
      });
    });
    painted.forEach((counts, row) => counts.forEach((count, colour) => assert.ok(row === colour ? count > 50 : count === 0, JSON.stringify(painted))));
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), 'wider than the phone');
    await page.evaluate(() => document.querySelectorAll('#knobs details').forEach((box) => { box.open = true; }));
    const set = async (text, epoch) => {
      const field = page.locator('[id="knob-array.focus_m"]');
      await field.fill(text);
      await field.press('Enter');
      await until(page, (wanted) => window.hertzline.answer?.answer.epoch === wanted, epoch);
      const sample = await page.evaluate(() => window.hertzline.answer.answer.applies_at_sample);
      await until(page, (from) => window.hertzline.waveform.picture.trigger >= from, sample);
      const noted = `Epoch ${epoch}, from sample ${sample} on: the motion began anew, from rest.`;
      await until(page, (text_) => document.getElementById('noted-array.focus_m').textContent === text_, noted);
      assert.equal(await page.textContent('#motion'), noted);
      assert.ok(await page.evaluate(() => window.hertzline.waveform.picture.traces.every(({high}) => Math.max(...high) > 0)), 'it draws on');
    };
    await set('[3mm, 0, 20 mm]', 1);
    await until(page, () => document.getElementById('use-array.focus_m').textContent === '[3 mm, 0 m, 20 mm] in use');
    await set('', 2);
    await until(page, () => document.getElementById('use-array.focus_m').textContent === '\u2013 in use');
    await page.fill('[id="knob-array.preloads_n"]', '[0.1, 0.2]');
    await page.press('[id="knob-array.preloads_n"]', 'Enter');
    await until(page, () => document.getElementById('fault-array.preloads_n').textContent.includes('found 2 entries with 3 of array.x_m'));
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save-svg')]);
    await download.saveAs(`${folder}/array.svg`);
    assert.match(download.suggestedFilename(), /^hertzline-p_points_2-/);
    const svg = readFileSync(`${folder}/array.svg`, 'utf8');
    for (const words of ['p_points[2] beside v_last[1], v_last[3], from sample', '>v_last[1]: \u00b1', '>v_last[3]<']) {
      assert.ok(svg.includes(words), `${words} is not in the picture`);
    }
    assert.deepEqual(page.faults, []);
    await page.context().close();
  },
  async 'has texts with a contrast of 4.5 and borders with one of 3, in light and in dark'() {
    for (const colorScheme of ['light', 'dark']) {
      const page = await open(chromium, url, {colorScheme});
      await until(page, () => window.hertzline.own.drawn > 3 && document.querySelector('.knob'));
      const weak = await page.evaluate(() => {
        document.querySelectorAll('details').forEach((box) => { box.open = true; });
        document.querySelectorAll('[hidden]').forEach((part) => { part.hidden = false; });
        const numbers = (colour) => colour.match(/[\d.]+/g).map(Number);
        const brightness = (colour) => numbers(colour).slice(0, 3).map((c) => c / 255)
          .map((c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)).reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
        const contrast = (a, b) => (Math.max(brightness(a), brightness(b)) + 0.05) / (Math.min(brightness(a), brightness(b)) + 0.05);
        const behind = (part) => {
          const colour = getComputedStyle(part).backgroundColor;
          return (numbers(colour)[3] ?? 1) > 0 || !part.parentElement ? colour : behind(part.parentElement);
        };
        const found = [];
        for (const part of document.querySelectorAll('body *')) {
          const style = getComputedStyle(part);
          const words = [...part.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.data.trim() !== '');
          const control = part.matches('input:not([type=range]), select, button');
          if ((words || control) && !part.matches('option') && contrast(style.color, behind(part)) * Number(style.opacity) < 4.5) {
            found.push([part.outerHTML.slice(0, 80), style.color, behind(part)]);
          }
          if (control && !part.matches('[aria-pressed=true]') && contrast(style.borderTopColor, behind(part.parentElement)) < 3) {
            found.push([part.outerHTML.slice(0, 80), 'border', style.borderTopColor, behind(part.parentElement)]);
          }
        }
        return found;
      });
      assert.deepEqual(weak, []);
      await page.context().close();
    }
  },
  async 'refuses a page of another origin'() {
    const page = await open(chromium, url);
    const refused = () => page.evaluate((socket) => new Promise((resolve) => {
      const line = new WebSocket(socket);
      line.onopen = () => resolve(false);
      line.onerror = () => resolve(true);
    }), `${url.replace('http', 'ws')}socket`);
    assert.equal(await refused(), false, 'its own page is served');
    await page.goto('about:blank');
    assert.equal(await refused(), true);
    await page.context().close();
  },
  async 'nothing went wrong in the page meanwhile'() {
    assert.deepEqual(this.page.faults, []);
  },
};

let failed = 0;
const shared = {};
for (const [name, promise] of Object.entries(promises)) {
  const begun = Date.now();
  try {
    await promise.call(shared);
    console.log(`ok   ${name} (${Date.now() - begun} ms)`);
  } catch (error) {
    failed += 1;
    console.log(`FAIL ${name}: ${error.stack}`);
  }
}
await chromium.close();
for (const process_ of running) {
  process_.kill('SIGINT');
}
process.exitCode = failed > 0 ? 1 : 0;
