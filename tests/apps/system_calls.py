#!/usr/bin/python3
"""Checks by strace that the simulating thread makes no system call but to sleep and to wake, while two streams are sent.

    system_calls.py PROGRAM

Exit status 77 (skipped) where the system allows no tracing.
"""
import collections
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import zmq

SLEEP = {"futex", "restart_syscall"}  # a semaphore


def trace(program, log):
    """Streams a second to a subscriber under strace, slowly enough for that. Returns the summary and the trace's lines."""
    stream = subprocess.Popen(
        ["strace", "--follow-forks", "--output", log, "--string-limit=32", program, "stream", "paper-stream", "--json",
         "--bind", "tcp://127.0.0.1:*", "--duration", "0.02", "--pace", "0.02", "--wait-for-subscriber"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    said = []
    for line in stream.stderr:
        said.append(line)
        if "ptrace" in line and "not permitted" in line:
            print("skipped: the system allows no tracing")
            sys.exit(77)
        if line.startswith("info: endpoint "):
            break
    else:
        sys.exit("the stream did not start: " + "".join(said))
    with zmq.Context() as context, context.socket(zmq.SUB) as socket:
        socket.connect(line.split()[-1])
        for topic in ("end", "v_out/raw", "v_chain/np"):
            socket.subscribe(topic)
        while socket.recv_multipart()[0] != b"end":
            pass
    summary = json.loads(stream.communicate(timeout=60)[0])
    return summary, pathlib.Path(log).read_text(encoding="utf-8").splitlines()


def calls_of_the_simulating_thread(lines):
    """Counts the thread's system calls from its naming to its last sleep; the C library makes the later ones to end the thread."""
    named = re.compile(r'(\d+) +prctl\(PR_SET_NAME, "simulating"')
    thread = next((match[1] for match in map(named.match, lines) if match), None)
    if thread is None:
        sys.exit("no thread named itself simulating")
    call = re.compile(rf"{thread} +(\w+)\(")
    calls = [match[1] for match in map(call.match, lines) if match]
    last_sleep = max((i for i, name in enumerate(calls) if name in SLEEP), default=0)
    return collections.Counter(calls[calls.index("prctl") + 1:last_sleep + 1])


def main():
    with tempfile.TemporaryDirectory() as folder:
        summary, lines = trace(sys.argv[1], folder + "/trace")
    calls = calls_of_the_simulating_thread(lines)
    print(f"{summary['samples']} samples; the simulating thread called {dict(calls)}")
    if summary["samples"] < 200000 or not calls:  # on a busy machine in fewer frames, each of more samples
        sys.exit("that is too little to mean anything")
    if set(calls) - SLEEP:
        sys.exit(f"other than to sleep and to wake: {sorted(set(calls) - SLEEP)}")


if __name__ == "__main__":
    main()
