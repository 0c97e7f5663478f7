// The line to the scope: pictures and states come, requests go. Comes back by itself.

const HEAD = 64;
const KINDS = {1: 'waveform', 2: 'spectrum', 3: 'chain'};

/** A picture's bytes, as scope/pictures/picture.hpp has them. */
export function readPicture(buffer) {
  const view = new DataView(buffer);
  const flags = view.getUint16(2, true);
  const columns = view.getUint32(4, true);
  const picture = {
    kind: KINDS[view.getUint8(0)], columns, rows: view.getUint32(8, true), epoch: view.getUint32(12, true),
    eachSample: (flags & 1) !== 0, untriggered: (flags & 2) !== 0, held: (flags & 4) !== 0, forces: (flags & 8) !== 0,
    trigger: Number(view.getBigInt64(16, true)), first: Number(view.getBigInt64(24, true)),
    samples: Number(view.getBigUint64(32, true)), burst: Number(view.getBigUint64(40, true)),
    rate: view.getFloat64(48, true), heardAt: view.getFloat64(56, true),
  };
  const numbers = new Float32Array(buffer, HEAD);
  if (picture.kind === 'waveform') {
    picture.low = numbers.subarray(0, columns);
    picture.high = picture.eachSample ? picture.low : numbers.subarray(columns, 2 * columns);
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
    url.protocol = 'ws:';
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
    this.socket.send(`{"ack":${text.turn}}`);  // the text is a turn's last part
    this.events.text(text);
  }

  say(request) {
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(JSON.stringify(request));
    }
  }
}
