#!/usr/bin/python3
"""Collects samples of a running hertzline stream: numpy_client.py [ENDPOINT [STREAM [SAMPLES [FILE]]]]"""
import json, sys
import numpy as np, zmq

endpoint, stream, samples, file = sys.argv[1:] + ["tcp://127.0.0.1:5573", "v_out", "10000", ""][len(sys.argv) - 1:]
socket = zmq.Context().socket(zmq.SUB)
socket.connect(endpoint)
socket.subscribe("meta")
meta = json.loads(socket.recv_multipart()[1])  # waited for, before the first frame
socket.unsubscribe("meta")
socket.subscribe(f"{stream}/np")
frames, end = [], None
while sum(map(len, frames)) < int(samples):
    topic, header, data = socket.recv_multipart()
    head = json.loads(header)
    if end not in (None, head["sample"]):
        sys.exit(f"{head['sample'] - end} samples are missing before sample {head['sample']}")
    frames.append(np.frombuffer(data, head["dtype"]).reshape(head["shape"]))  # [sample][channel]
    end = head["sample"] + len(frames[-1])
v = np.concatenate(frames)[:int(samples)]
print(f"{len(v)} samples of {stream} at {head['fs']:g} Hz, peak {np.abs(v).max():.4g} {head['unit']}, "
      f"from a chain of {meta['scene']['chain']['spheres']} spheres")
if file:
    v.astype("<f4").tofile(file)
