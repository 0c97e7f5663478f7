// The waveform: each column of the picture is a pixel, from its smallest to its largest sample.
import {CanvasPen, MARGIN, SvgPen, colours, fit, prefixFor, ticks, withUnit} from './axes.js';
import {protocol} from './protocol.js';

export class Waveform {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.picture = null;
    this.older = [];
    this.persistence = 0;
    this.view = {from_s: 0, span_s: 1e-3};
    this.unit = '';
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
  }

  forget() {
    this.picture = null;
    this.older = [];
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
    for (const picture of [this.picture, ...this.older]) {
      for (let i = 0; picture && i < picture.columns; ++i) {
        low = picture.low[i] < low ? picture.low[i] : low;
        high = picture.high[i] > high ? picture.high[i] : high;
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

  x(time) { return this.box.left + (time - this.view.from_s) / this.view.span_s * this.box.width; }
  y(value) { return this.box.top + (this.shown.high - value) / (this.shown.high - this.shown.low) * this.box.height; }

  draw() {
    const {width, height, scale} = fit(this.canvas);
    this.choose();
    this.paint(new CanvasPen(this.context, scale), width, height, scale, colours());
  }

  paint(pen, width, height, scale, colour) {
    const [left, top, below] = [MARGIN.left * scale, MARGIN.top * scale, MARGIN.below * scale];
    this.box = {left, top, width: width - left, height: height - top - below, right: width, bottom: height - below};
    pen.rect(0, 0, width, height, colour.paper);
    this.paintGrid(pen, scale, colour);
    for (const [i, picture] of this.older.entries()) {
      if (pen instanceof CanvasPen) {
        pen.context.globalAlpha = 0.1 + 0.3 * (i + 1) / this.older.length;
      }
      this.paintTrace(pen, picture, scale, colour.trace);
    }
    if (pen instanceof CanvasPen) {
      pen.context.globalAlpha = 1;
    }
    if (this.picture) {
      this.paintTrace(pen, this.picture, scale, colour.trace);
    }
    // The labels have room of their own, which the trace does not enter.
    for (const [x, y, w, h] of [[0, 0, left, height], [0, 0, width, top], [0, this.box.bottom, width, below]]) {
      pen.rect(x, y, w, h, colour.paper);
    }
    this.paintLabels(pen, scale, colour);
    this.paintCursors(pen, scale, colour);
    const note = this.note();
    if (note) {
      pen.text(width - 8 * scale, 12 * scale, note, colour.second, 'end');
    }
  }

  note() {
    if (!this.picture) {
      return 'no samples yet';
    }
    return this.picture.held ? 'held' : this.picture.untriggered && this.trigger !== 'free' ? 'no trigger: running freely' : '';
  }

  times(scale) { return ticks(this.view.from_s, this.view.from_s + this.view.span_s, this.box.width / scale / 110); }
  levels(scale) { return ticks(this.shown.low, this.shown.high, this.box.height / scale / 45); }

  paintGrid(pen, scale, colour) {
    const {left, top, right, bottom} = this.box;
    for (const time of this.times(scale)) {
      pen.line([[this.x(time), top], [this.x(time), bottom]], colour.line, time === 0 ? 2 : 1);
    }
    for (const value of this.levels(scale)) {
      pen.line([[left, this.y(value)], [right, this.y(value)]], colour.line, value === 0 ? 2 : 1);
    }
  }

  paintLabels(pen, scale, colour) {
    const {left, right, bottom} = this.box;
    for (const time of this.times(scale)) {
      pen.text(Math.min(Math.max(this.x(time), left), right - 30 * scale), bottom + 14 * scale, withUnit(time, 's'), colour.faint, 'middle');
    }
    const [factor, prefix] = prefixFor(Math.max(Math.abs(this.shown.low), Math.abs(this.shown.high)), this.unit);
    for (const value of this.levels(scale)) {
      pen.text(left - 5 * scale, this.y(value) + 4 * scale, withUnit(value / factor, ''), colour.faint, 'end');
    }
    pen.text(2 * scale, 11 * scale, prefix + this.unit, colour.faint);
  }

  paintTrace(pen, picture, scale, stroke) {
    if (picture.each_sample) {
      this.paintSamples(pen, picture, scale, stroke);
      return;
    }
    let before = null;
    for (let i = 0; i < picture.columns; ++i) {
      const low = picture.low[i];
      const high = picture.high[i];
      if (Number.isNaN(low)) {
        before = null;
        continue;
      }
      const x = this.x(Waveform.timeOf(picture, i));
      const next = this.x(Waveform.timeOf(picture, i + 1));
      if (next > this.box.left && x < this.box.right) {
        // Neighbouring columns touch, as the samples on both sides of their border are joined by a line.
        const top = this.y(before ? Math.max(high, before.low) : high);
        const bottom = this.y(before ? Math.min(low, before.high) : low);
        pen.rect(x, top - 0.6 * scale, Math.max(next - x, 1), bottom - top + 1.2 * scale, stroke);
      }
      before = {low, high};
    }
  }

  paintSamples(pen, picture, scale, stroke) {
    const spacing = this.box.width / (this.view.span_s * picture.rate_hz);
    let line = [];
    const end = () => {
      if (line.length > 0) {
        pen.line(line, stroke, 1.5);
      }
      line = [];
    };
    for (let i = 0; i < picture.columns; ++i) {
      if (Number.isNaN(picture.low[i])) {
        end();
        continue;
      }
      const point = [this.x((picture.first - picture.trigger + i) / picture.rate_hz), this.y(picture.low[i])];
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
