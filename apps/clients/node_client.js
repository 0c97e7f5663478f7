// Collects samples of a running hertzline stream: node_client.js [ENDPOINT [STREAM [SAMPLES [FILE]]]]
const fs = require("fs");
const zmq = require("zeromq");

const [endpoint = "tcp://127.0.0.1:5573", stream = "v_out", samples = 10000, file] = process.argv.slice(2);

async function main() {
  const socket = new zmq.Subscriber();
  socket.connect(endpoint);
  socket.subscribe(`${stream}/np`);
  const frames = [];
  let first, end, head;
  for await (const [topic, header, data] of socket) {
    head = JSON.parse(header);
    first ??= head.sample;
    if (end !== undefined && head.sample !== end) {
      throw new Error(`${head.sample - end} samples are missing before sample ${head.sample}`);
    }
    end = head.sample + head.shape[0];
    frames.push(data);
    if (end - first >= samples) break;
  }
  const bytes = Buffer.concat(frames).subarray(0, 4 * samples * head.shape[1]);
  const v = Float32Array.from({ length: bytes.length / 4 }, (_, i) => bytes.readFloatLE(4 * i)); // [sample][channel]
  const peak = v.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
  console.log(`${samples} samples of ${stream} at ${head.fs} Hz, peak ${peak.toPrecision(4)} ${head.unit}`);
  if (file) fs.writeFileSync(file, bytes);
}

main();
