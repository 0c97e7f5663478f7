// Space and time: a line for each sphere, or each contact, the horn's on top. Blue is a velocity towards the horn, or an open contact;
// orange is a velocity away from it, or a force.
import {fit, withUnit} from './axes.js';

export class Chain {
  constructor(canvas, text) {
    this.canvas = canvas;
    this.text = text;
    this.context = canvas.getContext('2d');
    this.picture = null;
  }

  take(picture) {
    this.picture = picture;
    let largest = 0;
    for (const value of picture.values) {
      largest = Math.abs(value) > largest ? Math.abs(value) : largest;
    }
    this.largest = largest;
    const meaning = picture.forces
      ? `Orange is a force, up to ${withUnit(largest, 'N')}, blue an open contact or one that pulls. The last line is the chain's end.`
      : `Blue is a velocity towards the horn, orange away from it, up to ${withUnit(largest, 'm/s')}.`;
    this.text.textContent = `Burst ${picture.burst}: ${withUnit(picture.samples / picture.rate_hz, 's')}, ${picture.rows} `
      + `${picture.rows === 1 ? 'line' : 'lines'}, horn on top. ${meaning}`;
  }

  /** From white to blue or orange. */
  colour(value) {
    const open = this.picture.forces && value === 0;
    const share = open ? -1 : this.largest > 0 && !Number.isNaN(value) ? value / this.largest : 0;
    const size = Math.sqrt(Math.abs(share));
    const [red, green, blue] = share < 0 ? [0, 114, 178] : [230, 159, 0];
    return [255 + (red - 255) * size, 255 + (green - 255) * size, 255 + (blue - 255) * size, 255];
  }

  draw() {
    const {width, height} = fit(this.canvas);
    const {picture} = this;
    if (!picture) {
      return;
    }
    const image = new ImageData(picture.columns, picture.rows);
    picture.values.forEach((value, i) => image.data.set(this.colour(value), 4 * i));
    const small = new OffscreenCanvas(picture.columns, picture.rows);
    small.getContext('2d').putImageData(image, 0, 0);
    this.context.imageSmoothingEnabled = false;
    this.context.drawImage(small, 0, 0, width, height);
  }
}
