// The waveform: each column of the picture is a pixel, from its smallest to its largest sample. Further channels lie beside the first
// one, or in lanes below it.
import {CanvasPen, MARGIN, SvgPen, colours, fit, prefixFor, ticks, withUnit} from './axes.js';
import {protocol} from './protocol.js';

export class Waveform {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.picture = null;
    this.channels = [{name: '', stream: '', unit: ''}];  // the chosen ones, the one with the trigger first
    this.stacked = false;  // each in a lane of its own
    this.older = [];
    this.isOfEarlierRun = false;
    this.persistence = 0;
    this.view = {from_s: 0, span_s: 1e-3};
    this.trigger = 'burst';
    this.level = {low: null, high: null};  // null: as the picture needs
    this.shown = {low: -1, high: 1};
    this.cursors = {A: null, B: null};     // seconds after the trigger
  }

  /** @returns the number of columns of a picture */
  columns() {
    const width = this.canvas.clientWidth - MARGIN.left;
    return Math.min(Math.max(Math.round(width * Math.min(window.devicePixelRatio || 1, 2)), 16), protocol.max_columns);
  }

  take(picture) {
    if (this.picture && this.persistence > 0 && !picture.held) {
      this.older.push(this.picture);
    }
    while (this.older.length > this.persistence) {
      this.older.shift();
    }
    this.picture = picture;
    this.isOfEarlierRun &&= picture.held;
  }

  /** Another run has begun: only what is held stays. */
  beginAnew() {
    if (this.picture?.held) {
      this.isOfEarlierRun = true;
    } else {
      this.show(this.channels);
    }
  }

  /** Shows other channels. Pictures of the ones before are forgotten. */
  show(channels) {
    this.channels = channels;
    this.picture = null;
    this.older = [];
    this.isOfEarlierRun = false;
  }

  /** The time of a column's left edge [s after the trigger]. */
  static timeOf(picture, column) {
    return (picture.first - picture.trigger + Math.floor(column * picture.samples / picture.columns)) / picture.rate_hz;
  }

  /** Smallest and largest sample in the pixel at a time; null: none. */
  at(time) {
    const {picture} = this;
    if (!picture) {
      return null;
    }
    const sample = time * picture.rate_hz + picture.trigger - picture.first;
    const column = picture.each_sample ? Math.round(sample) : Math.floor(sample * picture.columns / picture.samples);
    if (column < 0 || column >= picture.columns || Number.isNaN(picture.low[column])) {
      return null;
    }
    return {low: picture.low[column], high: picture.high[column]};
  }

  choose() {
    let low = Infinity;
    let high = -Infinity;
    const alike = this.picture?.traces.filter((_, i) => this.sharesScale(i)) ?? [];
    for (const trace of [...alike, ...this.older]) {
      for (let i = 0; i < trace.low.length; ++i) {
        low = trace.low[i] < low ? trace.low[i] : low;
        high = trace.high[i] > high ? trace.high[i] : high;
      }
    }
    if (!(low <= high)) {
      [low, high] = [this.shown.low, this.shown.high];
    } else {
      const room = Math.max(0.08 * (high - low), 1e-3 * Math.max(Math.abs(low), Math.abs(high)), 1e-15);
      [low, high] = [low - room, high + room];
      // An automatic scale that moves with each picture cannot be read.
      const fits = low >= this.shown.low && high <= this.shown.high && high - low > 0.6 * (this.shown.high - this.shown.low);
      if (fits) {
        [low, high] = [this.shown.low, this.shown.high];
      }
    }
    this.shown = {low: this.level.low ?? low, high: this.level.high ?? high};
    if (!(this.shown.high > this.shown.low)) {
      this.shown.high = this.shown.low + 1e-12;
    }
  }

  /** Whether a row of the picture has the scale of the first one: channels of one stream have one scale. */
  sharesScale(row) { return this.channels[row].stream === this.channels[0].stream; }

  /** The scale of a row: that of its stream, whose largest size fills it. */
  scaleOf(row) {
    if (this.sharesScale(row)) {
      return this.shown;
    }
    let size = 0;
    const alike = this.picture?.traces.filter((_, i) => this.channels[i].stream === this.channels[row].stream) ?? [];
    for (const {low, high} of alike) {
      for (let i = 0; i < low.length; ++i) {
        size = Math.max(size, Math.abs(low[i]) || 0, Math.abs(high[i]) || 0);
      }
    }
    return {low: -1.05 * (size || 1), high: 1.05 * (size || 1)};
  }

  /** The number of rows that lie one above the other. */
  lanes() { return this.stacked ? this.channels.length : 1; }

  /** The place of a row of the picture: its part of the window, and its scale. */
  placeOf(row) {
    const height = this.box.height / this.lanes();
    const top = this.box.top + (this.stacked ? row * height : 0);
    const {low, high} = this.scaleOf(row);
    return {top, height, y: (value) => top + (high - value) / (high - low) * height, low, high};
  }

  x(time) { return this.box.left + (time - this.view.from_s) / this.view.span_s * this.box.width; }

  draw() {
    const {width, height, scale} = fit(this.canvas);
    this.choose();
    this.paint(new CanvasPen(this.context, scale), width, height, scale, colours());
  }

  paint(pen, width, height, scale, colour) {
    const [left, top, below] = [MARGIN.left * scale, MARGIN.top * scale, MARGIN.below * scale];
    this.box = {left, top, width: width - left, height: height - top - below, right: width, bottom: height - below};
    pen.rect(0, 0, width, height, colour.paper);
    const places = this.channels.map((_, row) => this.placeOf(row));
    this.paintGrid(pen, scale, colour, places);
    for (const row of [...places.keys()].reverse()) {  // the first one above all others
      pen.within(left, places[row].top, this.box.width, places[row].height, () => this.paintRow(pen, row, places[row], scale, colour));
    }
    this.paintLabels(pen, scale, colour, places[0]);
    this.paintNames(pen, scale, colour, places);
    this.paintCursors(pen, scale, colour);
    const note = this.note();
    if (note) {
      pen.text(width - 8 * scale, 12 * scale, note, colour.second, 'end');
    }
  }

  paintRow(pen, row, place, scale, colour) {
    const older = row === 0 ? this.older : [];
    for (const [i, picture] of older.entries()) {
      if (pen instanceof CanvasPen) {
        pen.context.globalAlpha = 0.1 + 0.3 * (i + 1) / older.length;
      }
      this.paintTrace(pen, picture, picture, place, scale, colour.trace);
    }
    if (pen instanceof CanvasPen) {
      pen.context.globalAlpha = 1;
    }
    if (this.picture) {
      this.paintTrace(pen, this.picture, this.picture.traces[row], place, scale, Waveform.colourOf(row, colour));
    }
  }

  static colourOf(row, colour) { return row === 0 ? colour.trace : colour.beside[(row - 1) % colour.beside.length]; }

  note() {
    if (!this.picture) {
      return 'no samples yet';
    }
    if (this.picture.held) {
      return this.isOfEarlierRun ? 'held, of an earlier run' : 'held';
    }
    return this.picture.untriggered && this.trigger !== 'free' ? 'no trigger: running freely' : '';
  }

  times(scale) { return ticks(this.view.from_s, this.view.from_s + this.view.span_s, this.box.width / scale / 110); }
  levels(scale, {height, low, high}) { return ticks(low, high, height / scale / 45); }

  paintGrid(pen, scale, colour, places) {
    const {left, top, right, bottom} = this.box;
    for (const time of this.times(scale)) {
      pen.line([[this.x(time), top], [this.x(time), bottom]], colour.line, time === 0 ? 2 : 1);
    }
    for (const value of this.levels(scale, places[0])) {
      pen.line([[left, places[0].y(value)], [right, places[0].y(value)]], colour.line, value === 0 ? 2 : 1);
    }
    for (const place of this.stacked ? places.slice(1) : []) {
      pen.line([[left, place.top], [right, place.top]], colour.line, 2);
      pen.line([[left, place.y(0)], [right, place.y(0)]], colour.line);
    }
  }

  paintLabels(pen, scale, colour, place) {
    const {left, right, bottom} = this.box;
    for (const time of this.times(scale)) {
      pen.text(Math.min(Math.max(this.x(time), left), right - 30 * scale), bottom + 14 * scale, withUnit(time, 's'), colour.faint, 'middle');
    }
    const [{unit}] = this.channels;
    const [factor, prefix] = prefixFor(Math.max(Math.abs(place.low), Math.abs(place.high)), unit);
    const belowUnit = 22 * scale;
    for (const value of this.levels(scale, place).filter((level) => place.y(level) >= belowUnit)) {
      pen.text(left - 5 * scale, place.y(value) + 4 * scale, withUnit(value / factor, ''), colour.faint, 'end');
    }
    pen.text(2 * scale, 11 * scale, prefix + unit, colour.faint);
  }

  /** The size that fills the scale of a stream that has not that of the axis. */
  sizeText(row, place) {
    return this.picture && !this.sharesScale(row) ? `: \u00b1${withUnit(Number(place.high.toPrecision(3)), this.channels[row].unit)}` : '';
  }

  /** The names of the channels in their colours: each at the end of its lane, or one after the other above the picture. */
  paintNames(pen, scale, colour, places) {
    let [x, y] = [this.box.left + 6 * scale, 12 * scale];
    for (const [row, {name, stream}] of this.channels.length > 1 ? this.channels.entries() : []) {
      const follows = this.channels[row - 1]?.stream === stream;
      const last = this.channels[row + 1]?.stream !== stream;
      if (this.stacked && row > 0) {
        const words = name + (follows ? '' : this.sizeText(row, places[row]));
        pen.text(this.box.right - 6 * scale, places[row].top + 13 * scale, words, Waveform.colourOf(row, colour), 'end');
        continue;
      }
      const words = (follows ? name.slice(stream.length) : name) + (last ? this.sizeText(row, places[row]) : '');
      const width = pen.widthOf(words);
      if (x + width > this.box.right) {
        [x, y] = [this.box.left + 6 * scale, y + 14 * scale];
      }
      pen.text(x, y, words, Waveform.colourOf(row, colour));
      x += width + (last ? 10 : 3) * scale;
    }
  }

  /** @param trace a row of the picture */
  paintTrace(pen, picture, trace, place, scale, stroke) {
    if (picture.each_sample) {
      this.paintSamples(pen, picture, trace, place, scale, stroke);
      return;
    }
    let before = null;
    for (let i = 0; i < picture.columns; ++i) {
      const low = trace.low[i];
      const high = trace.high[i];
      if (Number.isNaN(low)) {
        before = null;
        continue;
      }
      const x = this.x(Waveform.timeOf(picture, i));
      const next = this.x(Waveform.timeOf(picture, i + 1));
      if (next > this.box.left && x < this.box.right) {
        // Neighbouring columns touch, as the samples on both sides of their border are joined by a line.
        const top = place.y(before ? Math.max(high, before.low) : high);
        const bottom = place.y(before ? Math.min(low, before.high) : low);
        pen.rect(x, top - 0.6 * scale, Math.max(next - x, 1), bottom - top + 1.2 * scale, stroke);
      }
      before = {low, high};
    }
  }

  paintSamples(pen, picture, trace, place, scale, stroke) {
    const spacing = this.box.width / (this.view.span_s * picture.rate_hz);
    let line = [];
    const end = () => {
      if (line.length > 0) {
        pen.line(line, stroke, 1.5);
      }
      line = [];
    };
    for (let i = 0; i < picture.columns; ++i) {
      if (Number.isNaN(trace.low[i])) {
        end();
        continue;
      }
      const point = [this.x((picture.first - picture.trigger + i) / picture.rate_hz), place.y(trace.low[i])];
      line.push(point);
      if (spacing > 8 * scale) {
        pen.rect(point[0] - 2 * scale, point[1] - 2 * scale, 4 * scale, 4 * scale, stroke);
      }
    }
    end();
  }

  paintCursors(pen, scale, colour) {
    const {left, top, right, bottom} = this.box;
    for (const [name, time] of Object.entries(this.cursors)) {
      const x = time === null ? NaN : this.x(time);
      if (x >= left && x <= right) {
        pen.line([[x, top], [x, bottom]], colour.second, 1.5, name === 'A' ? '' : '6 4');
        pen.text(x, 12 * scale, name, colour.second, 'middle');
      }
    }
  }

  /** @param caption lines above the picture */
  svg(width, height, caption) {
    const pen = new SvgPen(width, height);
    this.paint(pen, width, height, 1, colours());
    return pen.toString(caption, colours());
  }
}
