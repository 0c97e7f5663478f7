#!/usr/bin/python3
"""A Python client of an encrypted stream: with a listed key it gets every sample that `run` makes, without it none.

    curve_client.py PROGRAM
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import zmq
import zmq.auth

PATIENCE_MS = 60_000


def make_keys(program, folder):
    """Of a server and of alice by the program, of bob by pyzmq."""
    (folder / "clients").mkdir()
    for name in ("server", "clients/alice"):
        subprocess.run([program, "keys", folder / name], check=True, stdout=subprocess.DEVNULL)
    zmq.auth.create_certificates(folder / "clients", "bob")


def start_stream(program, folder):
    """2 ms that begin with the first subscriber; the process and its endpoint."""
    stream = subprocess.Popen(
        [program, "stream", "paper-stream", "--pace", "flat-out", "--duration", "2e-3", "--wait-for-subscriber",
         "--bind", "tcp://127.0.0.1:*", "--curve-key", folder / "server.key_secret", "--allow-clients",
         folder / "clients"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    said = []
    for line in stream.stderr:
        said.append(line)
        if line.startswith("info: endpoint "):
            return stream, line.split()[-1]
    sys.exit("the stream did not start: " + "".join(said))


def received(context, endpoint, server_certificate, certificate):
    """All samples of v_out, as float32."""
    frames = []
    with context.socket(zmq.SUB) as socket:
        socket.linger = 0
        socket.rcvtimeo = PATIENCE_MS
        socket.curve_publickey, socket.curve_secretkey = zmq.auth.load_certificate(certificate)
        socket.curve_serverkey, _ = zmq.auth.load_certificate(server_certificate)
        socket.connect(endpoint)
        for topic in ("end", "v_out/np"):
            socket.subscribe(topic)
        while True:
            topic, *parts = socket.recv_multipart()
            if topic == b"end":
                return np.concatenate(frames)
            header = json.loads(parts[0])
            assert header["sample"] == sum(map(len, frames)), "a gap"
            frames.append(np.frombuffer(parts[1], header["dtype"]))


def run(program, folder):
    file = folder / "run.csv"
    subprocess.run([program, "run", "paper-stream", "--set", "output.duration_s=2e-3", "-o", file], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return np.genfromtxt(file, delimiter=",", names=True)["v_out_m_per_s"][:20_000].astype(np.float32)


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as name, zmq.Context() as context:
        folder = pathlib.Path(name)
        make_keys(program, folder)
        expected = run(program, folder)
        for client in ("alice", "bob"):
            stream, endpoint = start_stream(program, folder)
            try:
                samples = received(context, endpoint, folder / "server.key",
                                   folder / "clients" / (client + ".key_secret"))
            finally:
                stream.kill()
                stream.wait()
            assert len(samples) == 20_000, len(samples)
            assert np.array_equal(samples, expected), "samples differ from run's"


main()
