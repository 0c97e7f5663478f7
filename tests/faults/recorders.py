"""Disturbances by files that take samples: pipes without a reader, and long work when the user wants to end."""
import atexit
import json
import os
import pathlib
import re
import resource
import select
import signal
import subprocess
import sys
import time

import stand as stands
from stand import check, wait_until


def _fifo(stand):
    """Makes a FIFO whose open reader never reads. Returns its path and the reader's descriptor."""
    path = stand.folder / "fifo.csv"
    os.mkfifo(path)
    return path, os.open(path, os.O_RDONLY | os.O_NONBLOCK)


def recording_that_nobody_takes(stand):
    """More rows are due than may wait for the file. The stream continues, and the missing samples are counted."""
    path, _reader = _fifo(stand)
    waiting = 16 << 20  # bytes of rows, each of three numbers
    rows = waiting / 24
    with stand.stream("--record", path, exit_status=1, scene=stands.MANY_SAMPLES, may_hold=waiting) as stream:
        most = 0.1 if stand.sanitized else 1.5  # under sanitizers all rows would take minutes
        samples = stream.first_frame()["sample"] + most * rows
        wait_until(lambda: stream.first_frame()["sample"] > samples, "went on")
    summary = json.loads(stream.summary.read_text())
    (stuck,) = (recording for recording in summary["recordings"] if recording["file"] == str(path))
    check(stand.sanitized or stuck["missing_samples"] > rows, f"{stuck}")
    check(stuck["samples"] + stuck["missing_samples"] == summary["samples"], f"{stuck} of {summary['samples']}")


def listener_whose_file_nobody_takes(stand):
    path, _reader = _fifo(stand)
    with stand.stream() as stream:
        listener = stream._start([stand.program, "listen", "--connect", stream.endpoint, "-o", path],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _wait_for_its_handler(listener)
        time.sleep(2)
        _ends_within_a_second(stand, listener, signal.SIGINT)


def _ends_within_a_second(stand, process, by):
    begin = time.monotonic()
    process.send_signal(by)
    status, took = stands.timed_wait(process, begin)
    check(took <= stands.ENDS_WITHIN_S, f"{took:.2f} s from the signal to the end")
    check(status in (0, 1), f"exit status {status}")


def _popen(stand, *words, **how):
    """Starts the program. Returns when it catches signals."""
    process = subprocess.Popen([stand.program, *map(str, words)], stdin=subprocess.DEVNULL, **{
        "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, **how})
    atexit.register(process.kill)  # where a check fails
    _wait_for_its_handler(process)
    return process


def _wait_for_its_handler(process):
    """Waits until the process catches signals: before, a signal ends it at once."""
    wait_until(lambda: stands.catches(process.pid, signal.SIGINT), "caught signals")


def signal_during_the_set_up(stand):
    # millions of spheres: their set-up takes more than a second
    for by in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        run = _popen(stand, "run", "long-chain", "--set", "chain.spheres=2000000", "-o", stand.folder / "a.csv")
        time.sleep(0.3)
        check(run.poll() is None, "it ended by itself")
        _ends_within_a_second(stand, run, by)
        check(not list(stand.folder.glob("a.csv*")), "it left something behind")


def run_into_a_pipe_that_nobody_reads(stand):
    for by in (signal.SIGINT, signal.SIGTERM):
        reader, writer = os.pipe()
        run = _popen(stand, "run", "paper-stream", "-o", "/dev/stdout", "--set", "output.duration_s=0.5", stdout=writer)
        os.close(writer)
        time.sleep(2)
        check(run.poll() is None, "it ended by itself")
        _ends_within_a_second(stand, run, by)
        os.close(reader)


def summary_that_nobody_reads(stand):
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    while True:
        try:
            os.write(writer, b"x" * 4096)
        except BlockingIOError:
            break
    os.set_blocking(writer, True)
    stream = _popen(stand, "stream", *stands.PAPER.words, *stands.PAPER.pace, "--bind", f"ipc://{stand.folder}/socket",
                    stdout=writer)
    wait_until((stand.folder / "socket").exists, "began")
    time.sleep(0.5)
    _ends_within_a_second(stand, stream, signal.SIGINT)
    os.close(reader)


# Samples so far apart that a frame of the usual length, or a single sample, takes ten seconds to compute.
def frames_that_take_long(stand):
    for rate, integrator in ((30, "taylor8"), (30, "leapfrog"), (0.1, "taylor8")):
        socket = stand.folder / f"{rate}-{integrator}"
        stream = _popen(stand, "stream", "paper-stream", "--set", f"output.sample_rate_hz={rate}", "--set",
                        f"numerics.integrator={integrator}", "--pace", "flat-out", "--bind", f"ipc://{socket}")
        wait_until(socket.exists, "began")
        time.sleep(0.5)
        _ends_within_a_second(stand, stream, signal.SIGINT)


def rows_that_take_long(stand):
    run = _popen(stand, "run", "paper-stream", "--set", "output.sample_rate_hz=1", "--set", "output.duration_s=100",
                 "-o", stand.folder / "a.csv")
    wait_until(lambda: list(stand.folder.glob("a.csv*")), "began")
    time.sleep(0.5)
    _ends_within_a_second(stand, run, signal.SIGINT)
    check(not list(stand.folder.glob("a.csv*")), "it left something behind")


def replay_of_a_pipe_that_nobody_writes(stand):
    """The pipe has a writer, none, or one that is silent after some rows. Later data is left to other readers."""
    file, fifo = stand.folder / "a.csv", stand.folder / "fifo.csv"
    check(stand.run("run", "paper-wall", "-o", file).returncode == 0, "no recording")
    rows = file.read_bytes()[:select.PIPE_BUF]  # fit into the pipe
    os.mkfifo(fifo)
    socket = stand.folder / "socket"
    words = ["replay", fifo, "--bind", f"ipc://{socket}"]
    for metadata in (False, True):
        if metadata:
            (stand.folder / "fifo.csv-metadata.json").write_text((stand.folder / "a.csv-metadata.json").read_text())
        for writes in (None, b"") + ((rows,) if metadata else ()):
            socket.unlink(missing_ok=True)
            replay = _popen(stand, *words)
            writer = None
            if writes is not None:
                writer = os.open(fifo, os.O_RDWR)  # does not wait for the reader
                os.write(writer, writes)
            if writes:
                wait_until(socket.exists, "began")
            time.sleep(0.5)
            check(replay.poll() is None, f"it ended by itself, {replay.poll()}")
            _ends_within_a_second(stand, replay, signal.SIGINT)
            if writer is not None:
                time.sleep(0.05)
                os.write(writer, b"for the next one")
                time.sleep(0.05)
                check(select.select([writer], [], [], 0)[0], "a process still reads the pipe")
                os.close(writer)


def _run_that_loses(stand, file, *words, **how):
    """Runs into that file, whose closing fails."""
    loses = stand.with_shim(loses=str(file).replace("-meta", "-data") + ".partial-")
    done = stand.run("run", "paper-wall", "--json", "-o", file, *words, env={**os.environ, **loses}, **how)
    print(done.stderr)
    check(done.returncode == 1, f"{file}: exit status {done.returncode}: {done.stderr}")
    return done


def files_whose_closing_fails(stand):
    """Their contents are unknown, and no samples are claimed. The old files stay."""
    for ending in ("csv", "npy", "h5", "wav", "sigmf-meta"):
        file = stand.folder / f"a.{ending}"
        check(stand.run("run", "paper-wall", "-o", file).returncode == 0, "no recording")
        before = {path: path.read_bytes() for path in stand.folder.glob("a.*")}
        (recording,) = json.loads(_run_that_loses(stand, file).stdout)["recordings"]
        check(recording["samples"] == 0, f"{recording}")
        told = re.fullmatch(r"cannot write .*: Input/output error; it is unknown how much of it is in (\S+)",
                            recording["status"])
        check(told and ".partial-" in told[1] and os.path.exists(told[1]), f"{recording}")
        check({path: path.read_bytes() for path in before} == before, f"{file}: the old file is gone")
        for path in stand.folder.glob("a.*"):
            path.unlink()


def key_whose_closing_fails(stand):
    loses = stand.with_shim(loses=stand.folder / "alice.key_secret")
    made = stand.run("keys", stand.folder / "alice", env={**os.environ, **loses})
    check(made.returncode == 1 and "alice.key_secret: Input/output error" in made.stderr, f"{made}")
    check(not list(stand.folder.glob("alice*")), "it left something behind")


def files_whose_closing_fails_on_a_full_disk(stand):
    limit = 200_000
    full = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    for ending in ("csv", "npy", "wav", "sigmf-meta"):
        file = stand.folder / f"a.{ending}"
        told = _run_that_loses(stand, file, "--set", "output.duration_s=0.02", preexec_fn=full).stderr
        check("ended after 0 samples: cannot write" in told and "File too large; it is unknown how much of it is in" in told,
              told)


def recording_whose_closing_fails(stand):
    """A SigMF recording already has its final name."""
    file = stand.folder / "a.sigmf-meta"
    with stand.stream("--record", file, env=stand.with_shim(loses=stand.folder / "a.sigmf-data"), exit_status=1) as stream:
        time.sleep(1)
    recordings = json.loads(stream.summary.read_text())["recordings"]
    (lost,) = (recording for recording in recordings if recording["file"] == str(file))
    check(lost["samples"] == 0 and lost["status"].endswith(f"Input/output error; it is unknown how much of it is in {file}"),
          f"{lost}")
    check((stand.folder / "a.sigmf-data").stat().st_size > 0, "nothing is left of it")


def replay_of_a_damaged_file(stand):
    """The HDF5 library crashes on the one file, and does not return from the other."""
    for damaged in (pathlib.Path(__file__).parents[1] / "fuzz/regressions/recording_hdf5").iterdir():
        file = stand.folder / f"{damaged.name}.h5"
        file.write_bytes(damaged.read_bytes())
        done = stand.run("replay", file, "--bind", f"ipc://{stand.folder}/socket")
        check(done.returncode == 0 or (done.returncode == 1 and f"cannot read {file}: " in done.stderr), f"{damaged.name}: {done}")


if __name__ == "__main__":
    stands.main(sys.modules[__name__])
