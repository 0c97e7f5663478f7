// The connection to the scope: receives pictures and states, sends requests, and connects again when it breaks.

import {protocol} from './protocol.js';  // made by the scope: see scope/pictures/picture.hpp

const kinds = Object.fromEntries(Object.entries(protocol.kinds).map(([name, number]) => [number, name]));

/** Reads a picture: the members of its head, its flags as booleans, its numbers. */
export function readPicture(buffer) {
  const view = new DataView(buffer);
  const picture = Object.fromEntries(protocol.head.map(([name, type, place]) => [name, Number(view[`get${type}`](place, true))]));
  for (const [flag, bit] of Object.entries(protocol.flags)) {
    picture[flag] = (picture.flags & bit) !== 0;
  }
  picture.kind = kinds[picture.kind];
  const numbers = new Float32Array(buffer, protocol.head_bytes);
  if (picture.kind === 'waveform') {
    picture.low = numbers.subarray(0, picture.columns);
    picture.high = picture.each_sample ? picture.low : numbers.subarray(picture.columns);
  } else {
    picture.values = numbers;
  }
  return picture;
}

export class Link {
  /** @param events {picture(p), text(json), open(), closed(tries)} */
  constructor(events) {
    this.events = events;
    this.tries = 0;
    this.connect();
  }

  connect() {
    const url = new URL('socket', location.href);
    url.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    this.socket = new WebSocket(url);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => { this.tries = 0; this.events.open(); };
    this.socket.onmessage = ({data}) => this.take(data);
    this.socket.onclose = () => {
      this.tries += 1;
      this.events.closed(this.tries);
      setTimeout(() => this.connect(), Math.min(500 * this.tries, 3000));
    };
  }

  take(data) {
    if (typeof data !== 'string') {
      this.events.picture(readPicture(data));
      return;
    }
    const text = JSON.parse(data);
    this.socket.send(`{"ack":${text.update}}`);  // the text is the last part of an update
    this.events.text(text);
  }

  send(request) {
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(JSON.stringify(request));
    }
  }
}
