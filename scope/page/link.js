// The connection to the scope: receives pictures and states, sends requests, and connects again when it breaks.

import {protocol} from './protocol.js';  // made by the scope: see scope/pictures/picture.hpp

const kinds = Object.fromEntries(Object.entries(protocol.kinds).map(([name, number]) => [number, name]));

/** Reads a picture: the members of its head, its flags as booleans, its numbers; of a waveform the first row again as its own. */
export function readPicture(buffer) {
  const view = new DataView(buffer);
  const picture = Object.fromEntries(protocol.head.map(([name, type, place]) => [name, Number(view[`get${type}`](place, true))]));
  for (const [flag, bit] of Object.entries(protocol.flags)) {
    picture[flag] = (picture.flags & bit) !== 0;
  }
  picture.kind = kinds[picture.kind];
  const numbers = new Float32Array(buffer, protocol.head_bytes);
  if (picture.kind === 'waveform') {
    const row = (number) => numbers.subarray(number * picture.columns, (number + 1) * picture.columns);
    picture.traces = Array.from({length: picture.rows}, (_, i) => ({low: row(i), high: row(picture.each_sample ? i : picture.rows + i)}));
    Object.assign(picture, picture.traces[0]);
  } else {
    picture.values = numbers;
  }
  return picture;
}

export class Link {
  /** @param events {update(pictures, text), open(), closed(tries)} */
  constructor(events) {
    this.events = events;
    this.tries = 0;
    this.heardAt = 0;  // the time of the last message [ms]
    this.connect();
  }

  isOpen() { return this.socket.readyState === WebSocket.OPEN; }

  connect() {
    const url = new URL('socket', location.href);
    url.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    this.socket = new WebSocket(url);
    this.pictures = [];  // of the update whose text has not come yet
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => { this.tries = 0; this.heardAt = Date.now(); this.events.open(); };
    this.socket.onmessage = ({data}) => this.take(data);
    this.socket.onclose = () => {
      this.tries += 1;
      this.events.closed(this.tries);
      setTimeout(() => this.connect(), Math.min(500 * this.tries, 3000));
    };
  }

  take(data) {
    this.heardAt = Date.now();
    if (typeof data !== 'string') {
      this.pictures.push(readPicture(data));
      return;
    }
    const text = JSON.parse(data);
    this.socket.send(`{"ack":${text.update}}`);  // the text is the last part of an update
    this.events.update(this.pictures.splice(0), text);
  }

  send(request) {
    if (this.isOpen()) {
      this.socket.send(JSON.stringify(request));
    }
  }
}
