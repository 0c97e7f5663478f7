// The page: sends requests, takes updates, and draws.
import {MARGIN, colours, withUnit} from './axes.js';
import {Chain} from './chain.js';
import {ChannelChoice, streamOf} from './channels.js';
import {Knobs} from './knobs.js';
import {Link} from './link.js';
import {showMeasures, showMeters} from './meters.js';
import {listen} from './pointer.js';
import {protocol} from './protocol.js';
import {download, pngOf} from './save.js';
import {Spectrum} from './spectrum.js';
import {Waveform} from './waveform.js';

const $ = (id) => document.getElementById(id);
const LONGEST_SAMPLES = 0.9 * protocol.held_samples;
const LONGEST_SILENCE_S = 5;  // a scope tells its state ten times a second

const waveform = new Waveform($('waveform'));
const spectrum = new Spectrum($('spectrum'), $('waterfall'));
const chain = new Chain($('chain'), $('chain-text'));

const view = {channel: 'v_out', beside: [], choice: 0, trigger: 'burst', level: 0.1, slope: 'rising', hold_off_s: 5e-4, from_s: 0, span_s: 1e-3,
  mode: 'run', shot: 0, spectrum: true, spectrum_to_hz: 8e5, average: 1, columns: 1000, pictures_per_s: 60};
const own = {drawn: 0, replaced: 0, rate: 0, delay_ms: 0, delays: [], drawnAtSecond: 0};
let scene = null;
let pictured = null;  // the scene of the waveform, which may be held while another run begins
let knobsText = null;
let state = {};
let touched = false;  // the window was chosen by hand
const stale = {waveform: true, spectrum: true, chain: true};  // pictures that do not show the latest
let undrawn = false;

const link = new Link({
  update(pictures, text) {
    if (text.scene) {
      takeScene(text.scene);
    }
    if (text.choice === view.choice) {  // not of the channels before
      pictures.forEach(takePicture);
      showBurst(text);
    }
    take(text);
  },
  open() {
    asked = null;  // an answer that was on its way does not come
    ask();
    change();
  },
  async closed(tries) {
    const answers = await fetch(location.href, {cache: 'no-store'}).then(({ok}) => ok, () => false);
    if (answers && tries > 1) {
      showState('full', 'The scope answers, but takes no further page: as many are open as it serves. This page goes on when one is closed.');
    } else {
      showState('gone', answers ? 'The connection to the scope broke. This page connects again.'
        : 'The scope itself does not answer: hertzline scope was ended, or cannot be reached. '
          + 'This page goes on when it is back at this address; a scope that was started anew has another address.');
    }
  },
});

/** Pictures of another run, or of another channel, would stand under a wrong name. */
function forgetPictures() {
  waveform.beginAnew();
  chain.picture = null;
  forgetSpectrum();
}

function forgetSpectrum() {
  spectrum.forget();
  page.measures = null;
  $('measures').replaceChildren();
  redrawAll();
}

function takePicture(picture) {
  if (picture.kind === 'waveform') {
    own.replaced += undrawn && !document.hidden ? 1 : 0;
    undrawn = true;
    waveform.take(picture);
    pictured = picture.held ? pictured : scene;
  } else if (picture.kind === 'spectrum') {
    spectrum.take(picture);
  } else {
    chain.take(picture);
  }
  stale[picture.kind] = true;
}

// ---- requests

function redrawAll() {
  Object.assign(stale, {waveform: true, spectrum: true, chain: true});
}

let asking = null;
function ask() {
  redrawAll();
  asking ??= setTimeout(() => {
    asking = null;
    view.columns = waveform.columns();
    view.chain = $('chain-panel').open && !$('chain-panel').hidden ? $('chain-stream').value : undefined;  // left out: none
    view.spectrum = $('spectrum-panel').open;
    link.send({view});
  }, 15);
}

function setWindow(from, span) {
  const rate = scene?.fs ?? 1e7;
  view.span_s = Math.min(Math.max(span, 8 / rate), LONGEST_SAMPLES / rate);
  view.from_s = Math.min(Math.max(from, -LONGEST_SAMPLES / rate), 100);
  Object.assign(waveform.view, {from_s: view.from_s, span_s: view.span_s});
  $('from').value = Number((view.from_s * 1e6).toPrecision(7));
  $('span').value = Number((view.span_s * 1e6).toPrecision(7));
  ask();
}

/** The burst, and half of its length more, within its period. */
function showWholeBurst() {
  const drive = scene?.scene?.drive ?? {};
  const burst = drive.frequency_hz > 0 ? 1.5 * drive.cycles / drive.frequency_hz : 1e-3;
  const period = scene?.repetition_hz > 0 ? 1 / scene.repetition_hz : Infinity;
  setWindow(0, Math.min(burst, period));
}

function home() {
  touched = false;
  waveform.level = {low: null, high: null};
  $('low').value = $('high').value = '';
  showWholeBurst();
}

function setMode(mode) {
  view.mode = mode;
  view.shot += 1;
  for (const name of ['run', 'hold', 'single']) {
    $(name).setAttribute('aria-pressed', String(name === mode));
  }
  ask();
}

let placed = 'A';  // the cursor that a click or a tap places
function choosePlaced(name) {
  placed = name;
  $('cursor-a').setAttribute('aria-pressed', String(name === 'A'));
  $('cursor-b').setAttribute('aria-pressed', String(name === 'B'));
}

const act = {
  move(share) { touched = true; setWindow(view.from_s + share * view.span_s, view.span_s); },
  zoom(factor, share) {
    touched = true;
    const fixed = view.from_s + share * view.span_s;
    const before = view.span_s;
    setWindow(view.from_s, factor * view.span_s);
    setWindow(fixed - share * view.span_s, view.span_s);
    stale.waveform ||= before !== view.span_s;
  },
  zoomLevel(factor, at) {
    const {low, high} = waveform.shown;
    const share = Math.min(at * waveform.lanes(), 1);
    const fixed = high - share * (high - low);
    waveform.level = {low: fixed + (low - fixed) * factor, high: fixed + (high - fixed) * factor};
    $('low').value = Number(waveform.level.low.toPrecision(5));
    $('high').value = Number(waveform.level.high.toPrecision(5));
    stale.waveform = true;
  },
  home,
  cursor(name, share) { waveform.cursors[name] = view.from_s + share * view.span_s; stale.waveform = true; },
  place(share) { act.cursor(placed, share); },
  nudge(name, pixels) {
    if (waveform.cursors[name] !== null) {
      waveform.cursors[name] += pixels / ($('waveform').clientWidth - MARGIN.left) * view.span_s;
      stale.waveform = true;
    }
  },
  run() { setMode('run'); }, hold() { setMode(view.mode === 'hold' ? 'run' : 'hold'); }, single() { setMode('single'); },
};
listen($('waveform'), act);

$('run').onclick = act.run;
$('hold').onclick = () => setMode('hold');
$('single').onclick = act.single;
$('left').onclick = () => act.move(-0.25);
$('right').onclick = () => act.move(0.25);
$('zoom-in').onclick = () => act.zoom(0.5, 0.5);
$('zoom-out').onclick = () => act.zoom(2, 0.5);
$('home').onclick = home;
$('cursor-a').onclick = () => choosePlaced('A');
$('cursor-b').onclick = () => choosePlaced('B');
$('cursor-none').onclick = () => { waveform.cursors = {A: null, B: null}; stale.waveform = true; };

/** Calls take with the field's number, or null where it is empty; a text that is no number is marked and changes nothing. */
function onNumber(id, take) {
  const mark = () => {
    const wrong = $(id).validity.badInput;
    $(id).setAttribute('aria-invalid', String(wrong));
    $('view-fault').textContent = wrong ? `${$(id).labels[0].textContent.trim()}: found no number` : '';
    return wrong;
  };
  $(id).onchange = () => { if (!mark()) { take($(id).value === '' ? null : Number($(id).value)); } };
  // A browser reports no change from one text that is no number to another one.
  $(id).onblur = mark;
  $(id).onkeydown = ({key}) => { if (key === 'Enter') { mark(); } };
}
onNumber('from', (us) => { touched = true; setWindow((us ?? 0) / 1e6, view.span_s); });
onNumber('span', (us) => { touched = true; setWindow(view.from_s, us / 1e6 || view.span_s); });
for (const edge of ['low', 'high']) {
  onNumber(edge, (level) => {
    const wanted = {...waveform.level, [edge]: level};
    if (wanted.low !== null && wanted.high !== null && wanted.low >= wanted.high) {
      $(edge).setAttribute('aria-invalid', 'true');
      $('view-fault').textContent = `level: found ${wanted.low} to ${wanted.high}, allowed: from a smaller to a larger one`;
      return;
    }
    waveform.level = wanted;
    $('low').setAttribute('aria-invalid', 'false');
    $('high').setAttribute('aria-invalid', 'false');
    stale.waveform = true;
  });
}
/** The same of a number that a request has: the field then shows the number in use. @param used (number or null) */
function onRequested(id, used, take) {
  onNumber(id, (number) => {
    $(id).value = used(number);
    take(Number($(id).value));
  });
}
$('persistence').onchange = () => { waveform.persistence = Number($('persistence').value); stale.waveform = true; };
$('trigger').onchange = () => { waveform.trigger = view.trigger = $('trigger').value; $('level-trigger').hidden = view.trigger !== 'level'; ask(); };
onRequested('level', (level) => level ?? 0, (level) => { view.level = level; ask(); });
$('slope').onchange = () => { view.slope = $('slope').value; ask(); };
onRequested('hold-off', (us) => Math.max(us ?? 0, 0), (us) => { view.hold_off_s = us / 1e6; ask(); });
onRequested('average', (bursts) => Math.min(Math.max(Math.round(bursts ?? 1), 1), 1000), (bursts) => { view.average = bursts; ask(); });
onRequested('to-hz', (kHz) => Math.min(Math.max(kHz ?? 800, 1e-3), (scene?.fs ?? Infinity) / 2e3), (kHz) => { view.spectrum_to_hz = kHz * 1e3; ask(); });
onRequested('floor-db', (db) => Math.min(Math.max(db ?? -80, -200), -20), (db) => { spectrum.floor = db; stale.spectrum = true; });
$('chain-panel').ontoggle = ask;
$('chain-stream').onchange = ask;
$('spectrum-panel').ontoggle = ask;
new ResizeObserver(ask).observe($('waveform'));
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redrawAll);

// ---- channels

const channels = new ChannelChoice({stream: $('stream'), channel: $('channel'), beside: $('beside'), list: $('beside-list')}, (fault) => {
  if (channels.first !== view.channel) {
    forgetSpectrum();
    setMode('run');
  }
  Object.assign(view, {channel: channels.first, beside: channels.beside, choice: view.choice + 1});
  $('view-fault').textContent = fault;
  waveform.show(channels.all());
  for (const place of document.querySelectorAll('.stream-unit')) {
    place.textContent = waveform.channels[0].unit;
  }
  showLanes();
  ask();
});

function showLanes() {
  $('stack').hidden = view.beside.length === 0;
  $('stack').setAttribute('aria-pressed', String(waveform.stacked));
  document.documentElement.style.setProperty('--lanes', waveform.lanes());
  stale.waveform = true;
}
$('stack').onclick = () => { waveform.stacked = !waveform.stacked; showLanes(); };

/** Offers the channels of all streams but those of whole chains, which have a picture of their own. */
function offerChannels() {
  const streams = scene.streams ?? [];
  const whole = [...$('chain-stream').options].map(({value}) => value);
  channels.offer(streams.filter(({name}) => !whole.includes(name)), scene.latency_samples ? ['v_horn'] : []);  // the input of a live drive
  $('chain-panel').hidden = streams.length > 0 && !streams.some(({name}) => whole.includes(name));
}

// ---- knobs: one request is on its way at a time; of changes that wait in a row the newest value of a key counts

const LONGEST_REQUEST = 60000;  // characters: the scope takes no more
const waiting = [];  // requests in their order: {set: {key: value}} or {undo: true}
let asked = null;  // keys of the request that is on its way; null: none is
function change() {
  if (asked !== null || waiting.length === 0 || !link.isOpen()) {
    return;
  }
  const request = waiting.shift();
  asked = Object.keys(request.set ?? {});
  if (JSON.stringify(request).length > LONGEST_REQUEST) {
    showAnswer({to: request, answer: {faults: [{message: `found a list that is too long for this page, allowed: ${LONGEST_REQUEST} characters`}]}});
  } else {
    link.send(request);
  }
}
function set(key, value) {
  const last = waiting.at(-1);
  if (last?.set) {
    last.set[key] = value;
  } else {
    waiting.push({set: {[key]: value}});
  }
  change();
}
const knobs = new Knobs($('knobs'), set, (key) => asked?.includes(key) || waiting.some((request) => request.set && key in request.set));
$('undo').onclick = () => { waiting.push({undo: true}); change(); };

/** Shows whether the motion went on when the scene changed, below the keys that this page has changed, too. */
function showMotion() {
  const how = scene?.motion === 'goes on' ? 'went on' : 'began anew, from rest';
  const text = scene?.epoch > 0 && scene.motion ? `Epoch ${scene.epoch}, from sample ${scene.epoch_sample} on: the motion ${how}.` : '';
  $('motion').textContent = text;
  const {to, answer} = page.answer ?? {};
  knobs.note(text !== '' && answer?.epoch === scene.epoch ? Object.keys(to.set ?? {}) : [], text);
}

function showAnswer({to, answer}) {
  asked = null;
  const faults = answer?.faults;
  const keys = Object.keys(to.set ?? {});
  const what = to.undo ? 'undone' : Object.entries(to.set ?? {}).map(([key, value]) => `${key} = ${value}`).join(', ');
  $('knob-answer').classList.toggle('bad', Boolean(faults));
  if (faults) {
    knobs.refuse(keys, faults);
    $('knob-answer').textContent = keys.length > 0 && knobs.there ? `Refused: ${keys.join(', ')}.`
      : faults.map((fault) => fault.message ?? `${fault.key}: found ${fault.found}, allowed: ${fault.allowed}`).join(' ');
  } else {
    knobs.accept(keys, answer.epoch);
    const warnings = (answer.warnings ?? []).map((warning) => ` Warning: ${warning}`).join('');
    $('knob-answer').textContent = `${what}: from sample ${answer.applies_at_sample} on (epoch ${answer.epoch}).${warnings}`;
  }
  page.answer = {to, answer};
  showMotion();
  change();
}

// ---- saving

$('save-scene').onclick = () => link.send({scene: 'toml'});

/** Returns what a saved picture shows: stream, scene, time. */
function caption() {
  const {picture} = waveform;
  const shown = pictured ?? scene;
  const drive = shown?.scene?.drive;
  const chainOf = shown?.scene?.chain;
  const of = drive && chainOf ? `: ${chainOf.spheres} spheres of ${chainOf.material}, ${withUnit(drive.frequency_hz, 'Hz')}, `
    + `${withUnit(drive.amplitude_m, 'm')}` : '';
  return [
    `${view.channel}${view.beside.length > 0 ? ` beside ${view.beside.join(', ')},` : ''} from sample ${picture?.first ?? '\u2013'} on, epoch ${picture?.epoch ?? scene?.epoch ?? 0}, of ${state.endpoint ?? 'no stream'}`,
    `scene ${shown?.scene_hash ?? '\u2013'}${of}`,
    `run ${shown?.run ?? '\u2013'}, saved ${new Date().toISOString()}`,
  ];
}

/** A name that sorts by time: hertzline-v_out-0123abcd-20260131T120000.png; v_last_3 of v_last[3] */
function pictureName(ending) {
  const time = new Date().toISOString().replace(/[-:]/g, '').slice(0, 15);
  const channel = view.channel.replace('[', '_').replace(']', '');
  return `hertzline-${channel}-${((pictured ?? scene)?.scene_hash ?? 'none').slice(0, 8)}-${time}.${ending}`;
}

$('save-png').onclick = async () => {
  const png = await pngOf([$('waveform'), $('spectrum'), $('waterfall')], caption(), colours());
  download(pictureName('png'), 'image/png', png);
};
$('save-svg').onclick = () => download(pictureName('svg'), 'image/svg+xml', waveform.svg(1200, 500, caption()));
$('record').onclick = () => link.send(state.recording?.on
  ? {record: null} : {record: {stream: streamOf(view.channel), ending: $('record-ending').value}});

function showRecording(recording) {
  $('record').setAttribute('aria-pressed', String(recording.on));
  $('record').textContent = recording.on ? 'Stop recording' : 'Record';
  const missing = recording.missing_samples > 0 ? `, ${recording.missing_samples} missing, marked as a gap` : '';
  const text = recording.file !== '' ? `${recording.file}: ${recording.text}.` : `Saved by the scope in ${recording.folder === '.' ? 'the folder where it was started' : recording.folder}.`;
  if ($('record-text').textContent !== text) {  // which is read aloud
    $('record-text').textContent = text;
  }
  $('record-count').textContent = recording.file === '' ? '' : `${recording.samples} samples${missing}`;
}

// ---- updates

function showScene() {
  offerChannels();
  showMotion();
  spectrum.fundamental = scene.fundamental_hz;
  if (!touched) {
    showWholeBurst();
  } else {
    setWindow(view.from_s, view.span_s);
  }
}

function showState(name, text) {
  const words = {running: 'running', waiting: 'waiting for a stream', ended: 'the stream has ended', silent: 'the stream is gone',
    refused: 'refused', gone: 'the scope is gone', full: 'too many pages'};
  if ($('state').dataset.state !== name) {
    $('state').dataset.state = name;
    $('state').textContent = words[name];
  }
  $('trouble').hidden = text === '';
  if ($('trouble').textContent !== text) {
    $('trouble').textContent = text;
  }
}

function showBurst(text) {
  if (text.measures) {
    spectrum.measures = text.measures;
    stale.spectrum = true;  // shades the band
    page.measures = {...text.measures, ...text.measures_of};
    showMeasures($('measures'), text.measures, text.measures_of, waveform.channels[0].unit);
  }
}

function takeScene(newest) {
  const another = newest.run !== scene?.run;
  scene = newest;
  if (another) {
    forgetPictures();
  }
  showScene();
}

function take(text) {
  for (const reply of text.replies ?? []) {
    if (reply.scene_toml) {
      download('scene.toml', 'application/toml', reply.scene_toml);
    } else if (reply.to) {
      showAnswer(reply);
    } else if (reply.error) {
      $('view-fault').textContent = reply.error;
    }
  }
  if (text.knobs) {  // which may be newer than the replies, never older
    knobsText = text.knobs;
    $('knob-text').textContent = knobsText.text;
    $('undo').disabled = !knobsText.there;
  }
  if (text.knobs || text.scene) {
    knobs.show(knobsText, scene);
  }
  if (text.state) {
    state = text;
    showState(text.state, text.state_text);
    showRecording(text.recording);
  }
}

// ---- drawing

function showCursors() {
  const rows = Object.entries(waveform.cursors).filter(([, time]) => time !== null);
  $('cursors').hidden = rows.length === 0;
  const body = $('cursors').tBodies[0];
  const values = rows.map(([name, time]) => [name, time, waveform.at(time)]);
  const [{unit}] = waveform.channels;
  const cells = values.map(([name, time, at]) => [name, withUnit(time, 's', 6), withUnit(at?.low, unit), withUnit(at?.high, unit)]);
  if (values.length === 2) {
    const [[, a, atA], [, b, atB]] = values;
    cells.push([`B \u2212 A`, `${withUnit(b - a, 's', 6)} (${withUnit(1 / Math.abs(b - a), 'Hz')})`,
      withUnit(atB && atA ? atB.low - atA.low : NaN, unit), withUnit(atB && atA ? atB.high - atA.high : NaN, unit)]);
  }
  body.replaceChildren(...cells.map((texts) => {
    const row = document.createElement('tr');
    row.append(...texts.map((text, i) => Object.assign(document.createElement(i === 0 ? 'th' : 'td'), {textContent: text})));
    return row;
  }));
}

function draw() {
  requestAnimationFrame(draw);
  if (stale.waveform) {
    waveform.draw();
    showCursors();
  }
  if (stale.spectrum && $('spectrum-panel').open) {
    spectrum.draw();
  }
  if (stale.chain && $('chain-panel').open) {
    chain.draw();
  }
  Object.assign(stale, {waveform: false, spectrum: false, chain: false});
  if (undrawn) {
    undrawn = false;
    own.drawn += 1;
    if (waveform.picture && !waveform.picture.held && state.state === 'running') {
      own.delays.push(Date.now() - 1e3 * waveform.picture.received_at_s);
    }
    own.delays = own.delays.slice(-200);
  }
}
requestAnimationFrame(draw);

setInterval(() => {
  own.rate = 2 * (own.drawn - own.drawnAtSecond);
  own.drawnAtSecond = own.drawn;
  const sorted = [...own.delays].sort((a, b) => a - b);
  own.delay_ms = sorted[Math.floor(sorted.length / 2)];
  const silent_s = (Date.now() - link.heardAt) / 1000;
  if (link.isOpen() && silent_s > LONGEST_SILENCE_S) {
    showState('gone', `The scope has sent nothing for ${Math.round(silent_s)} s: it hangs, or the connection is dead. This page goes on when it answers.`);
  }
  if (state.state) {
    showMeters($('meters'), state, streamOf(view.channel), scene?.pace, own);
  }
}, 500);

/** The page's contents as numbers, for scripts and tests. */
const page = {waveform, spectrum, chain, view, own, act, knobs, measures: null, answer: null,
  get scene() { return scene; }, get state() { return state; }};
window.hertzline = page;
