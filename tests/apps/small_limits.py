#!/usr/bin/python3
"""Checks that commands that may have little address space or few descriptors end with a message that names the limit, or run; never
with a signal: small_limits.py PROGRAM"""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
LONG_ENOUGH_S = 100
MIB = 1 << 20

COMMANDS = [
    ("check", "paper-wall"),
    ("run", "paper-wall", "-o", "a.h5"),
    ("sweep", "paper-wall", "--vary", "chain.preload_n=0.1..0.2:4", "-o", "s.csv", "--jobs", "2"),
    ("optimise", "paper-wall", "--vary", "chain.preload_n=0.1..0.2", "--maximise", "thd_r", "--evaluations", "18", "-o", "o.csv"),
    ("stream", "paper-stream", "--duration", "0.01", "--bind", "ipc://s", "--control", "ipc://c", "--record", "r.sigmf-meta"),
    ("replay", "recorded.csv", "--pace", "flat-out", "--bind", "ipc://s"),
    ("listen", "--connect", "ipc://nobody", "--timeout", "0.1"),
    ("scope", "--connect", "ipc://nobody", "--http", "127.0.0.1:0"),
    ("get", "--connect", "ipc://nobody", "--timeout", "0.1"),
]


def run(words, kind, limit):
    """Runs a command with a limit. Returns its status and what it said."""
    for file in os.listdir():
        if file != "recorded.csv":
            os.remove(file)
    process = subprocess.Popen([PROGRAM, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: resource.setrlimit(kind, (limit, limit)))
    said = []
    for line in process.stderr:
        said.append(line)
        if "scope http" in line:
            process.terminate()
    return process.wait(LONG_ENOUGH_S), "".join(said)


def check(words, kind, limit, option):
    status, said = run(words, kind, limit)
    expected = {"listen": "no samples", "get": "ipc://nobody"}
    assert status >= 0, f"{' '.join(words)} with ulimit {option} {limit}: signal {-status}\n{said}"
    named = f"(ulimit {option})" in said or "available" in said or "Too many open files" in said
    assert status == 0 or named or expected.get(words[0], "nothing") in said, f"{' '.join(words)} with {option} {limit}: {said}"
    return named


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    subprocess.run([PROGRAM, "run", "paper-wall", "-o", "recorded.csv"], check=True, stdout=subprocess.DEVNULL, timeout=LONG_ENOUGH_S)
    refused = 0
    for words in COMMANDS:
        for mebibytes in range(48, 260, 12):
            refused += check(words, resource.RLIMIT_AS, mebibytes * MIB, "-v")
        for descriptors in range(4, 40, 2):
            refused += check(words, resource.RLIMIT_NOFILE, descriptors, "-n")
    assert refused > 20, refused
    print(f"{refused} commands named their limit")
