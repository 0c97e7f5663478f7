#!/usr/bin/env python3
"""The answers of hertzline completion: completions.py HERTZLINE [--sanitized]

apps/completion_in_SHELL tests the scripts of the shells.
"""
import pathlib
import re
import subprocess
import sys

program, sanitized = sys.argv[1], "--sanitized" in sys.argv


def completions(*words):
    """The kind of names in the file system that fit, too, and the words."""
    answer = subprocess.run([program, "completion", "zsh", "--", *words], check=True, capture_output=True, text=True).stdout
    kind, *lines = answer.splitlines()
    assert all(line.count("\t") == 1 and line.split("\t")[0].startswith(words[-1]) for line in lines), answer
    return kind, [line.split("\t")[0] for line in lines]


def expect(words, kind, some, others=()):
    found_kind, found = completions(*words)
    assert found_kind == kind, f"{words}: found {found_kind}, expected {kind}"
    assert set(some) <= set(found), f"{words}: found {found}, expected {some}"
    assert not set(others) & set(found), f"{words}: found {found}, not expected {others}"
    assert some or not found, f"{words}: found {found}, expected none"


expect(["s"], "none", ["sweep", "stream", "set", "scope", "scenes"], ["run"])
expect(["--v"], "none", ["--version"])
expect(["no-such", ""], "none", [])
expect(["run", "paper-"], "files", ["paper-wall", "paper-stream"], ["striker"])
expect(["run", "paper-wall", "--co"], "none", ["--columns"])
expect(["run", "paper-wall", ""], "none", ["--columns"])  # no other argument
expect(["run", "-o", ""], "files", [])
expect(["run", "--set", "chain.pre"], "none", ["chain.preload_n=", "chain.preload_tolerance="])
expect(["run", "--set", "end.material="], "none", ["end.material=pyrex"], ["end.material=water"])
expect(["run", "--set", "medium.material="], "none", ["medium.material=water"], ["medium.material=pyrex"])
expect(["run", "--set=end.kind=w"], "none", ["--set=end.kind=wall"])
expect(["run", "--set", "end.kind=plate,"], "none", [])
expect(["run", "--set", "chain.preload_n="], "none", [])
expect(["run", "--set", "chain.materials="], "none", [])
expect(["run", "--set", "no.such="], "none", [])
expect(["sweep", "x.toml", "--vary", "end.material=pyrex,"], "none", ["end.material=pyrex,acrylic"], ["end.material=pyrex,pyrex"])
expect(["run", "x", "--columns", "v_out,x_"], "none", ["v_out,x_chain", "v_out,x_horn"])
expect(["run", "x", "--columns", "v_out,v_"], "none", ["v_out,v_last"], ["v_out,v_out"])
expect(["run", "x", "--measure", ""], "none", ["v_plate"], ["v_chain"])
expect(["stream", "x", "--columns", "x_"], "none", ["x_horn"], ["x_chain"])
expect(["listen", "--stream", "x_"], "none", ["x_horn"], ["x_chain"])
expect(["sweep", "x", "--quantity", "thd_r,harm"], "none", ["thd_r,harmonics_db"])
expect(["optimise", "x", "--maximise", "harm"], "none", ["harmonics_db_3"])
expect(["optimise", "x", "--subject-to", "peak_v"], "none", ["peak_v_out_m_per_s"])
expect(["sweep", "--merge", "a.journal", ""], "files", [])
expect(["sweep", "--merge", "a.journal", "--so"], "none", ["--sobol"])
expect(["stream", "x", "--pace", ""], "none", ["realtime", "flat-out"])
expect(["stream", "x", "--on-overrun", ""], "none", ["drop", "wait"])
expect(["sweep", "x", "--shard", ""], "none", ["slurm", "mpi"], ["I/N"])
expect(["scope", "--record-to", ""], "folders", [])
expect(["set", "drive.kind=none", "--", "drive.amp"], "none", ["drive.amplitude_m="])
expect(["get", "chain.pre", "drive.amp"], "none", ["drive.amplitude_m"])
expect(["plot", "a.npy", ""], "files", [])
expect(["man", "sc"], "none", ["scene", "scope", "scenes"])
expect(["completion", ""], "none", ["bash", "fish", "zsh"])

# The values of each option and argument of each subcommand are known, or known to be free.
_, commands = completions("")
assert len(commands) > 10
for command in commands:
    _, options = completions(command, "-")
    usage = subprocess.run([program, command, "--help"], check=True, capture_output=True, text=True).stdout
    assert set(options) == set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", usage, re.MULTILINE)), (command, options)
    completions(command, "")
    for option in () if sanitized else options:  # a start with sanitizers takes half a second
        completions(command, option, "")

# The meaning of each output is that of the table of streams.
document = (pathlib.Path(__file__).parents[2] / "stream/README.md").read_text(encoding="utf-8").replace("`", "")
streams = subprocess.run([program, "completion", "fish", "--", "listen", "--stream", ""], check=True, capture_output=True, text=True).stdout
for name, unit, meaning in re.findall(r"^(\w+)\t\[(.*?)\] (.*)$", streams, re.MULTILINE):
    assert f"| {name} | {meaning} [{unit}]" in document, f"{name}: {meaning}"

wrong = subprocess.run([program, "completion", "tcsh"], capture_output=True, text=True)
assert wrong.returncode == 2 and 'SHELL: found "tcsh", allowed: bash, zsh or fish' in wrong.stderr, wrong.stderr

# A unit in brackets before a link stays as it is, and the link becomes its text.
meanings = subprocess.run([program, "completion", "zsh", "--", "run", "--set", "array.x_m"], check=True, capture_output=True, text=True).stdout
assert "array.x_m=\t[m] where the discs of several chains stand" in meanings, meanings
