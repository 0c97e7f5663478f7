// Meters of the stream, of the way to the scope and of this page.
import {withUnit} from './axes.js';

function entry(name, value, bad = false, title = '') {
  const pair = document.createElement('div');
  const term = document.createElement('dt');
  const what = document.createElement('dd');
  term.textContent = name;
  what.textContent = value;
  what.className = bad ? 'bad' : '';
  pair.title = title;
  pair.append(term, what);
  return pair;
}

const number = (value, digits = 3) => (Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : '\u2013');

export function showMeters(place, text, stream, pace, own) {
  const meters = text.meters ?? {};
  const account = text.accounts?.[stream] ?? {};
  const lost = (account.frames_lost_on_the_way ?? 0);
  const dropped = (meters.dropped ?? 0);
  place.replaceChildren(
    entry('load', `${number(100 * meters.load)} %`, meters.load > 1, 'simulating, share of the time'),
    entry('real time \u00d7', number(meters.real_time_factor), meters.real_time_factor < 0.99 * pace, 'simulated time over elapsed time'),
    entry('late', number(meters.late_frames, 6), meters.late_frames > 0, 'frames that the stream sent late'),
    entry('dropped', number(dropped, 6), dropped > 0, 'frames that the stream discarded'),
    entry('lost', number(lost, 6), lost > 0, 'frames that did not reach this scope'),
    entry('pictures/s', number(own.rate, 3), false, 'drawn by this page'),
    entry('left out', number((text.page?.left_out ?? 0) + own.replaced, 6), false,
      'pictures that this page was too slow for; the stream does not notice'),
    entry('delay', `${number(own.delay_ms, 3)} ms`, own.delay_ms > 200, 'from the newest sample\u2019s arrival to its pixel, median'),
  );
}

const MEASURES = [
  ['peak', 'peak', (m, unit) => withUnit(m.peak, unit)],
  ['THD', 'thd_r', (m) => `${number(100 * m.thd_r, 4)} %`],
  ['band at \u221220 dB', 'bandwidth_20db_hz', (m) => `${number(m.band_20db_low_hz / 1e3, 4)} to ${number(m.band_20db_high_hz / 1e3, 4)} kHz`],
  ['occupied', 'occupied_20db_hz', (m) => `${number(m.occupied_20db_hz / 1e3, 4)} kHz`],
  ['strongest', 'strongest_hz', (m) => `${number(m.strongest_hz / 1e3, 4)} kHz`],
  ['sub-harmonic', 'subharmonic_db', (m) => `${number(m.subharmonic_db)} dB`],
  ['harmonics', 'harmonics_db', (m) => `${m.harmonics_db.map((db) => db.toFixed(1)).join(' ')} dB`],
];

export function showMeasures(place, measures, of, unit) {
  place.replaceChildren(
    entry('burst', `${of.burst}, ${of.samples} samples, average of ${of.averaged}`),
    ...MEASURES.filter(([, key]) => measures[key] !== null && measures[key] !== undefined)
      .map(([name, , words]) => entry(name, words(measures, unit))));
}
