"""A subscriber made of pyzmq alone. Receives frames of v_out until the stream's end and prints its counts as JSON."""
import argparse
import json
import time

import numpy
import zmq

parser = argparse.ArgumentParser()
parser.add_argument("endpoint")
parser.add_argument("--everything", action="store_true", help="subscribe to every topic, not to v_out alone")
parser.add_argument("--chain", action="store_true", help="subscribe to the samples of every sphere, too")
parser.add_argument("--save", metavar="NPY", help="two columns: index of the sample, v_out")
parser.add_argument("--slow", type=float, default=0, help="for the first seconds take only 50 frames in each")
parser.add_argument("--queue", type=int, default=100_000, help="frames that may wait to be received")
words = parser.parse_args()

socket = zmq.Context().socket(zmq.SUB)
socket.rcvhwm = words.queue
socket.connect(words.endpoint)
for topic in ("",) if words.everything else ("v_out/np", "end") + words.chain * ("v_chain/raw",):
    socket.subscribe(topic)
headers, samples, begin = [], [], time.monotonic()
while True:
    topic, header, *data = socket.recv_multipart()
    if topic == b"end":
        summary = json.loads(header)
        break
    if topic != b"v_out/np":
        continue
    if not headers:
        print("hears", flush=True)
    headers.append(json.loads(header))
    if words.save:
        values = numpy.frombuffer(data[0], "<f4")
        samples.append(numpy.column_stack((headers[-1]["sample"] + numpy.arange(len(values)), values)))
    if time.monotonic() < begin + words.slow:
        time.sleep(0.02)

if words.save:
    numpy.save(words.save, numpy.concatenate(samples))
first = headers[0]["sample"]
got = sum(h["shape"][0] for h in headers)
dropped = summary[f'{headers[0]["stream"]}_np_dropped'] - headers[0]["dropped"]
behind_the_last = -(-(summary["samples"] - headers[-1]["sample"] - headers[-1]["shape"][0]) // headers[0]["shape"][0])
due = headers[-1]["seq"] + 1 + behind_the_last - headers[0]["seq"]
print(json.dumps({"first_sample": first, "samples": got, "missing_samples": summary["samples"] - first - got,
                  "frames": len(headers), "frames_dropped_by_sender": dropped,
                  "frames_lost_on_the_way": due - dropped - len(headers), "ended_by": "end of run"}))
