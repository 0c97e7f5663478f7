#!/usr/bin/python3
"""Checks a Python client of an encrypted stream: with a listed key it receives every sample of `run`.

    curve_client.py PROGRAM NUMPY_CLIENT
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import zmq.auth

PATIENCE_S = 60


def make_keys(program, folder):
    """Makes keys: of a server and of alice by the program, of bob by pyzmq."""
    (folder / "clients").mkdir()
    for name in ("server", "clients/alice"):
        subprocess.run([program, "keys", folder / name], check=True, stdout=subprocess.DEVNULL)
    zmq.auth.create_certificates(folder / "clients", "bob")


def start_stream(program, folder):
    """Starts a stream of 2 ms that begins with the first subscriber. Returns the process and its endpoint."""
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


def received(client, endpoint, file, certificate, server_certificate):
    """Returns the samples of v_out that the client of apps/clients saves, as float32."""
    subprocess.run(["/usr/bin/python3", "-B", client, endpoint, "v_out", "20000", file, certificate, server_certificate],
                   check=True, stdout=subprocess.DEVNULL, timeout=PATIENCE_S)
    return np.fromfile(file, "<f4")


def run(program, folder):
    file = folder / "run.csv"
    subprocess.run([program, "run", "paper-stream", "--set", "output.duration_s=2e-3", "-o", file], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return np.genfromtxt(file, delimiter=",", names=True)["v_out_m_per_s"][:20_000].astype(np.float32)


def main():
    program, client = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        make_keys(program, folder)
        expected = run(program, folder)
        for owner in ("alice", "bob"):
            stream, endpoint = start_stream(program, folder)
            try:
                samples = received(client, endpoint, folder / "heard.f32",
                                   folder / "clients" / (owner + ".key_secret"), folder / "server.key")
            finally:
                stream.kill()
                stream.wait()
            assert len(samples) == 20_000, len(samples)
            assert np.array_equal(samples, expected), "samples differ from run's"


main()
