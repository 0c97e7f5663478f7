// The spectrum of the last burst, or of an average, and a waterfall of them.
import {CanvasPen, MARGIN, colours, fit, ticks, withUnit} from './axes.js';

const LEVEL_OF_BAND = -20;

export class Spectrum {
  constructor(canvas, waterfall) {
    this.canvas = canvas;
    this.waterfall = waterfall;
    this.context = canvas.getContext('2d');
    this.falls = waterfall.getContext('2d', {willReadFrequently: true});
    this.picture = null;
    this.measures = null;
    this.fundamental = 0;
    this.floor = -80;
  }

  take(picture) {
    this.picture = picture;
    this.fall(picture);
  }

  forget() {
    this.picture = null;
    this.measures = null;
    this.clearWaterfall();
  }

  clearWaterfall() { this.falls.clearRect(0, 0, this.waterfall.width, this.waterfall.height); }

  /** From black over blue and orange to white: brightness alone tells the level. */
  static shade(share) {
    const s = Math.min(Math.max(share, 0), 1);
    return [255 * Math.min(1, Math.max(0, 2.2 * s - 0.7)), 255 * s ** 1.2, 255 * Math.min(1, s < 0.5 ? 1.4 * s : 0.7 + (s - 0.75) * 1.2)];
  }

  fall(picture) {
    const {width, height} = fit(this.waterfall);
    const axes = `${picture.columns * picture.rate_hz} ${this.floor}`;
    if (axes !== this.axesOfRows) {  // the rows before have others
      this.axesOfRows = axes;
      this.clearWaterfall();
    }
    const rows = 2;
    if (height > rows) {
      this.falls.drawImage(this.waterfall, 0, 0, width, height - rows, 0, rows, width, height - rows);
    }
    const line = this.falls.createImageData(width, rows);
    for (let x = 0; x < width; ++x) {
      const level = picture.values[Math.floor(x * picture.columns / width)];
      const [red, green, blue] = Spectrum.shade(Number.isNaN(level) ? 0 : 1 - level / this.floor);
      for (let row = 0; row < rows; ++row) {
        line.data.set([red, green, blue, 255], 4 * (row * width + x));
      }
    }
    this.falls.putImageData(line, 0, 0);
  }

  draw() {
    const {width, height, scale} = fit(this.canvas);
    const colour = colours();
    const pen = new CanvasPen(this.context, scale);
    const [left, top, bottom] = [MARGIN.left * scale, MARGIN.top * scale, height - MARGIN.below * scale];
    pen.rect(0, 0, width, height, colour.paper);
    if (!this.picture) {
      pen.text(8 * scale, 20 * scale, 'Waiting for a whole burst.', colour.faint);
      return;
    }
    const to = this.picture.columns * this.picture.rate_hz;
    const x = (hz) => left + hz / to * (width - left);
    const y = (db) => top + Math.min(db / this.floor, 1) * (bottom - top);
    const low = this.measures?.band_20db_low_hz;
    const high = this.measures?.band_20db_high_hz;
    if (Number.isFinite(low) && Number.isFinite(high)) {
      pen.rect(x(low), top, Math.min(x(high), width) - x(low), bottom - top, colour.shade);
      pen.line([[x(low), y(LEVEL_OF_BAND)], [x(high), y(LEVEL_OF_BAND)]], colour.third, 2);
    }
    for (const hz of ticks(0, to, (width - left) / scale / 90)) {
      pen.line([[x(hz), top], [x(hz), bottom]], colour.line);
      pen.text(Math.min(Math.max(x(hz), left), width - 30 * scale), bottom + 14 * scale, withUnit(hz, 'Hz'), colour.faint, 'middle');
    }
    for (const db of ticks(this.floor, 0, 5)) {
      pen.line([[left, y(db)], [width, y(db)]], colour.line);
      pen.text(left - 5 * scale, y(db) + 4 * scale, String(db), colour.faint, 'end');
    }
    pen.text(2 * scale, 11 * scale, 'dB', colour.faint);
    for (let k = 1; this.fundamental > 0 && k <= 10 && k * this.fundamental < to; ++k) {
      pen.line([[x(k * this.fundamental), top], [x(k * this.fundamental), top + 6 * scale]], colour.second, 2);
      pen.text(x(k * this.fundamental), 12 * scale, String(k), colour.second, 'middle');
    }
    const line = [];
    this.picture.values.forEach((db, i) => {
      if (!Number.isNaN(db)) {
        line.push([left + (i + 0.5) / this.picture.columns * (width - left), y(db)]);
      }
    });
    pen.line(line, colour.trace, 1.3);
  }
}
