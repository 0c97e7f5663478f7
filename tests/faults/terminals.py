"""Disturbances of the program by terminals: they differ, pause, and go away."""
import atexit
import contextlib
import fcntl
import json
import os
import pty
import re
import subprocess
import sys
import termios
import threading
import time

import stand as stands
from stand import check, wait_until

COLOUR = re.compile(r"\x1b\[[0-9;]*m")
TERMINAL = {**os.environ, "TERM": "xterm-256color"}


def nobody_listens_to_messages(stand):
    with open("/dev/full", "wb") as full, stand.stream(endpoint=f"ipc://{stand.folder}/socket", stderr=full):
        time.sleep(0.3)


def terminal_paused(stand):
    """The terminal is paused, as by Ctrl-S, until after the end."""
    ours, terminal = pty.openpty()
    with stand.stream(endpoint=f"ipc://{stand.folder}/socket", stderr=terminal, env={"TERM": "xterm-256color"}):
        termios.tcflow(terminal, termios.TCOOFF)
        time.sleep(1)
    os.close(terminal)
    os.close(ours)


def terminal_vanishes(stand):
    """The terminal is gone, as for a background job of a session that has ended."""
    ours, terminal = pty.openpty()
    with stand.stream(endpoint=f"ipc://{stand.folder}/socket", stderr=terminal, env={"TERM": "xterm-256color"}):
        os.close(terminal)
        time.sleep(0.5)
        os.close(ours)
        time.sleep(1)


def _with_terminal(stand, *words, controls=True):
    """Starts the program on a terminal of its own, with a pipe as stdout."""
    ours, terminal = pty.openpty()
    take_control = (lambda: fcntl.ioctl(2, termios.TIOCSCTTY, 0)) if controls else None
    process = subprocess.Popen([stand.program, *map(str, words)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True,
                               stderr=terminal, env=TERMINAL, start_new_session=True, preexec_fn=take_control)
    os.close(terminal)
    atexit.register(process.kill)  # where a check fails
    return process, ours


def _summary_of(process):
    out = process.communicate(timeout=stands.LONG_ENOUGH_S)[0]
    check(process.returncode == 0, f"exit status {process.returncode}")
    return json.loads(out)


def terminal_hangs_up_on_a_stream(stand):
    csv, sigmf = stand.folder / "a.csv", stand.folder / "a.sigmf-data"
    process, ours = _with_terminal(stand, "stream", *stands.PAPER.words, *stands.PAPER.pace, "--json", "--bind",
                                   f"ipc://{stand.folder}/socket", "--record", csv, "--record", sigmf)
    wait_until(sigmf.exists, "began")
    time.sleep(1)
    os.close(ours)  # the system sends SIGHUP
    samples = _summary_of(process)["samples"]
    check(samples > 10_000 / stands.SLOWER, f"{samples} samples")
    check(len(csv.read_text().splitlines()) == samples + 1, "not all samples are in the CSV")
    check(sigmf.stat().st_size == samples * 12, "not all samples are in the SigMF recording")


def terminal_hangs_up_on_a_listener(stand):
    heard = stand.folder / "other.csv"
    with stand.stream() as stream:
        process, ours = _with_terminal(stand, "listen", "--json", "--connect", stream.endpoint, "-o", heard)
        wait_until(lambda: list(stand.folder.glob("other.csv*")), "began")
        time.sleep(1)
        os.close(ours)
        summary = _summary_of(process)
        check(summary["ended_by"] == "stopped" and summary["samples"] > 0, f"{summary}")
    check(len(heard.read_text().splitlines()) == summary["samples"] + 1, "not all samples are in the CSV")


def terminal_vanishes_during_a_run(stand):
    file = stand.folder / "run.csv"
    process, ours = _with_terminal(stand, "run", "paper-stream", "--json", "--set", f"output.duration_s={0.2 / stands.SLOWER}",
                                   "-o", file, controls=False)
    os.read(ours, 1)  # a progress line
    os.close(ours)
    check(_summary_of(process)["rows"] == len(file.read_text().splitlines()) - 1, "not all rows are in the file")


def _on_a_terminal(stand, **env):
    """Returns the output of a stream to its terminal in half a second and until it is interrupted."""
    ours, terminal = pty.openpty()
    seen = bytearray()

    def read():
        with contextlib.suppress(OSError):  # the other end is closed
            while piece := os.read(ours, 4096):
                seen.extend(piece)
    reader = threading.Thread(target=read)
    environment = {"TERM": "xterm-256color", "NO_COLOR": "", "COLORTERM": "", **env}
    with stand.stream(endpoint=f"ipc://{stand.folder}/socket", stderr=terminal, env=environment):
        os.close(terminal)
        reader.start()
        time.sleep(0.7)
    reader.join()
    os.close(ours)
    return seen.decode()


def terminal(stand):
    text = _on_a_terminal(stand)
    check(COLOUR.search(text) and "x real time" in text, f"no colour or progress: {text!r}")


def terminal_with_no_color(stand):
    text = _on_a_terminal(stand, NO_COLOR="1")
    check(not COLOUR.search(text) and "x real time" in text, f"colour, or no progress: {text!r}")


def dumb_terminal(stand):
    text = _on_a_terminal(stand, TERM="dumb")
    check("endpoint" in text and "\x1b" not in text, f"it cannot show that: {text!r}")


def no_terminal(stand):
    with stand.stream(env={"TERM": "xterm-256color"}) as stream:
        time.sleep(0.7)
    text = stream.messages.read_text()
    check("\x1b" not in text and "\r" not in text and "x real time" not in text, f"for a terminal: {text!r}")


if __name__ == "__main__":
    stands.main(sys.modules[__name__])
