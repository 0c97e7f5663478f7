// Numbers, units, ticks and colours, which all pictures share.

const PREFIXES = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, '\u00b5'], [1e-9, 'n'], [1e-12, 'p']];

/** Colours of channels beside the first one, which repeat after these: variables of style.css. */
export const BESIDE = ['third', 'fourth', 'fifth', 'sixth', 'ink'];

/** The room for labels around a plot [CSS pixels]. */
export const MARGIN = {left: 46, top: 16, below: 18};

/** Returns factor and prefix that suit a value; a unit that has a prefix, as kg/s, takes no other one. */
export function prefixFor(value, unit) {
  if (value === 0 || unit === '' || unit.startsWith('kg')) {
    return [1, ''];
  }
  return PREFIXES.find(([size]) => Math.abs(value) >= 0.9999995 * size) ?? PREFIXES.at(-1);
}

/** Returns a number in few characters: 1e9, 0.25. */
function plain(value, digits) {
  const number = Number(value.toPrecision(digits));
  const size = Math.abs(number);
  return number !== 0 && (size >= 1e6 || size < 1e-3) ? number.toExponential().replace('e+', 'e') : String(number);
}

/** Returns a number with its unit: 3.4e-4 s is "340 µs". */
export function withUnit(value, unit, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) {
    return '\u2013';
  }
  const [factor, prefix] = prefixFor(value, unit);
  return `${plain(value / factor, digits)} ${prefix}${unit}`.trim();
}

/** Returns about `count` round numbers in [low, high]. */
export function ticks(low, high, count) {
  const rough = (high - low) / Math.max(count, 1);
  if (!(rough > 0) || !Number.isFinite(rough)) {
    return [];
  }
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough) * power;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    found.push(Math.abs(k * step) < 1e-9 * step ? 0 : k * step);
  }
  return found;
}

export function colours() {
  const style = getComputedStyle(document.documentElement);
  const of = (name) => style.getPropertyValue(`--${name}`).trim();
  return {paper: of('paper'), ink: of('ink'), faint: of('faint'), line: of('line'), trace: of('trace'),
    second: of('second'), third: of('third'), shade: of('shade'), beside: BESIDE.map(of)};
}

/** Gives the canvas as many pixels as the screen has there. @returns {width, height, scale} in those pixels */
export function fit(canvas) {
  const scale = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.max(Math.round(canvas.clientWidth * scale), 1);
  const height = Math.max(Math.round(canvas.clientHeight * scale), 1);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  return {width, height, scale};
}

/** Draws as a canvas does, into an SVG. */
export class SvgPen {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.parts = [];
  }
  rect(x, y, width, height, fill) {
    this.parts.push(`<rect x="${x}" y="${y}" width="${width}" height="${height}" fill="${fill}"/>`);
  }
  line(points, stroke, width = 1, dash = '') {
    const path = points.map(([x, y]) => `${x.toFixed(2)},${y.toFixed(2)}`).join(' ');
    this.parts.push(`<polyline points="${path}" fill="none" stroke="${stroke}" stroke-width="${width}"${dash && ` stroke-dasharray="${dash}"`}/>`);
  }
  text(x, y, words, fill, anchor = 'start') {
    const safe = String(words).replaceAll('&', '&amp;').replaceAll('<', '&lt;');
    this.parts.push(`<text x="${x}" y="${y}" fill="${fill}" font-size="12" font-family="sans-serif" text-anchor="${anchor}">${safe}</text>`);
  }
  widthOf(words) { return 6.6 * words.length; }  // about
  /** Paints what lies in a rectangle. */
  within(x, y, width, height, paint) {
    const outside = this.parts;
    this.parts = [];
    paint();
    outside.push(`<svg x="${x}" y="${y}" width="${width}" height="${height}" viewBox="${x} ${y} ${width} ${height}">${this.parts.join('')}</svg>`);
    this.parts = outside;
  }
  toString(caption, colour) {
    const [drawn, above] = [this.parts, 18 * caption.length + 6];
    this.parts = [];
    this.rect(0, 0, this.width, this.height + above, colour.paper);
    caption.forEach((line, i) => this.text(8, 18 * (i + 1), line, colour.ink));
    const height = this.height + above;
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${this.width}" height="${height}" viewBox="0 0 ${this.width} ${height}">${this.parts.join('')}`
      + `<g transform="translate(0 ${above})">${drawn.join('')}</g></svg>`;
  }
}

/** The same on a canvas. */
export class CanvasPen {
  constructor(context, scale) {
    this.context = context;
    this.scale = scale;
  }
  rect(x, y, width, height, fill) {
    this.context.fillStyle = fill;
    this.context.fillRect(x, y, width, height);
  }
  line(points, stroke, width = 1, dash = '') {
    const {context} = this;
    context.strokeStyle = stroke;
    context.lineWidth = width * this.scale;
    context.setLineDash(dash ? dash.split(' ').map((length) => Number(length) * this.scale) : []);
    context.beginPath();
    points.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.stroke();
  }
  within(x, y, width, height, paint) {
    const {context} = this;
    context.save();
    context.beginPath();
    context.rect(x, y, width, height);
    context.clip();
    paint();
    context.restore();
  }
  widthOf(words) {
    this.context.font = `${12 * this.scale}px system-ui, sans-serif`;
    return this.context.measureText(words).width;
  }
  text(x, y, words, fill, anchor = 'start') {
    const {context} = this;
    context.fillStyle = fill;
    context.font = `${12 * this.scale}px system-ui, sans-serif`;
    context.textAlign = anchor === 'middle' ? 'center' : anchor;
    context.fillText(words, x, y);
  }
}
