// The waveform: each column of the picture is a pixel, from its smallest to its largest sample.
import {CanvasPen, SvgPen, colours, fit, ticks, withUnit} from './axes.js';
import {protocol} from './protocol.js';

const MARGIN_BELOW = 18;

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
    return Math.min(Math.max(Math.round(this.canvas.clientWidth * Math.min(window.devicePixelRatio || 1, 2)), 16), protocol.max_columns);
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

  x(time, width) { return (time - this.view.from_s) / this.view.span_s * width; }
  y(value, height) { return (this.shown.high - value) / (this.shown.high - this.shown.low) * height; }
  time(x, width) { return this.view.from_s + x / width * this.view.span_s; }

  draw() {
    const {width, height, scale} = fit(this.canvas);
    this.choose();
    const pen = new CanvasPen(this.context, scale);
    this.paint(pen, width, height - MARGIN_BELOW * scale, scale, colours());
  }

  paint(pen, width, height, scale, colour) {
    pen.rect(0, 0, width, height + MARGIN_BELOW * scale, colour.paper);
    this.paintAxes(pen, width, height, scale, colour);
    for (const [i, picture] of this.older.entries()) {
      if (pen instanceof CanvasPen) {
        pen.context.globalAlpha = 0.1 + 0.3 * (i + 1) / this.older.length;
      }
      this.paintTrace(pen, picture, width, height, scale, colour.trace);
    }
    if (pen instanceof CanvasPen) {
      pen.context.globalAlpha = 1;
    }
    if (this.picture) {
      this.paintTrace(pen, this.picture, width, height, scale, colour.trace);
    }
    this.paintCursors(pen, width, height, scale, colour);
    const note = this.note();
    if (note) {
      pen.text(width - 8 * scale, 14 * scale, note, colour.second, 'end');
    }
  }

  note() {
    if (!this.picture) {
      return 'no samples yet';
    }
    return this.picture.held ? 'held' : this.picture.untriggered && this.trigger !== 'free' ? 'no trigger: running freely' : '';
  }

  paintAxes(pen, width, height, scale, colour) {
    for (const time of ticks(this.view.from_s, this.view.from_s + this.view.span_s, width / scale / 110)) {
      const x = this.x(time, width);
      pen.line([[x, 0], [x, height]], colour.line, time === 0 ? 2 : 1);
      pen.text(Math.min(Math.max(x, 24 * scale), width - 30 * scale), height + 14 * scale, withUnit(time, 's'), colour.faint, 'middle');
    }
    for (const value of ticks(this.shown.low, this.shown.high, height / scale / 45)) {
      const y = this.y(value, height);
      pen.line([[0, y], [width, y]], colour.line, value === 0 ? 2 : 1);
      pen.text(4 * scale, y - 3 * scale, withUnit(value, this.unit), colour.faint);
    }
  }

  paintTrace(pen, picture, width, height, scale, stroke) {
    if (picture.each_sample) {
      this.paintSamples(pen, picture, width, height, scale, stroke);
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
      const x = this.x(Waveform.timeOf(picture, i), width);
      const next = this.x(Waveform.timeOf(picture, i + 1), width);
      if (next > 0 && x < width) {
        // Neighbouring columns touch, as the samples on both sides of their border are joined by a line.
        const top = this.y(before ? Math.max(high, before.low) : high, height);
        const bottom = this.y(before ? Math.min(low, before.high) : low, height);
        pen.rect(x, top - 0.6 * scale, Math.max(next - x, 1), bottom - top + 1.2 * scale, stroke);
      }
      before = {low, high};
    }
  }

  paintSamples(pen, picture, width, height, scale, stroke) {
    const spacing = width / (this.view.span_s * picture.rate_hz);
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
      const point = [this.x((picture.first - picture.trigger + i) / picture.rate_hz, width), this.y(picture.low[i], height)];
      line.push(point);
      if (spacing > 8 * scale) {
        pen.rect(point[0] - 2 * scale, point[1] - 2 * scale, 4 * scale, 4 * scale, stroke);
      }
    }
    end();
  }

  paintCursors(pen, width, height, scale, colour) {
    for (const [name, time] of Object.entries(this.cursors)) {
      if (time !== null) {
        const x = this.x(time, width);
        pen.line([[x, 0], [x, height]], colour.second, 1.5, name === 'A' ? '' : '6 4');
        pen.text(x + 4 * scale, 14 * scale, name, colour.second);
      }
    }
  }

  svg(width, height) {
    const pen = new SvgPen(width, height);
    this.paint(pen, width, height - MARGIN_BELOW, 1, colours());
    return pen.toString();
  }
}
