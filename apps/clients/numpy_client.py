#!/usr/bin/python3
"""Collects samples of a running hertzline stream: numpy_client.py [ENDPOINT [STREAM [SAMPLES [FILE [KEY SERVER_KEY]]]]]

An encrypted stream needs our KEY (NAME.key_secret, as hertzline keys makes it) and the stream's public SERVER_KEY.
"""
import json, sys
import numpy as np, zmq
from zmq.auth import load_certificate

usual = ["tcp://127.0.0.1:5573", "v_out", "10000", "", "", ""]
endpoint, stream, samples, file, key, server_key = sys.argv[1:] + usual[len(sys.argv) - 1:]
socket = zmq.Context().socket(zmq.SUB)
if key:
    socket.curve_publickey, socket.curve_secretkey = load_certificate(key)
    socket.curve_serverkey, _ = load_certificate(server_key)
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
