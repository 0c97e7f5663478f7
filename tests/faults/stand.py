"""The stand on which faults are tried: a running stream, a well-behaved listener beside it from sample 0 on, and what
must hold after the fault.

    with stand.stream() as stream:     # runs, the listener hears it
        ...                            # the fault
                                       # here every promise is checked
"""
import argparse
import inspect
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import numpy
import zmq

class Scene:
    def __init__(self, name, sample_rate_hz, pace, **settings):
        settings = {"output.sample_rate_hz": sample_rate_hz, "output.frame_samples": 128, **settings}
        self.words = [name, *(word for key, value in settings.items() for word in ("--set", f"{key}={value}"))]
        self.sample_rate_hz, self.pace = sample_rate_hz, ["--pace", str(pace)]


# 50 000 samples a second in 400 frames, which any machine can follow.
PAPER = Scene("paper-stream", 1e6, 0.05)
# 14 MB in each second for those who subscribe to everything.
BUSY = Scene("paper-stream", 1e6, 0.2)
# In 12 frames: with four blocks in its ring the sending thread may be held up for 0.3 s before a frame is dropped.
LARGE_FRAMES = Scene("paper-stream", 1e6, 0.05, **{"output.frame_samples": 4096})
LONG_CHAIN = Scene("long-chain", 1e8, 0.001, **{"chain.spheres": 1000})  # the wave arrives after a second and a half

LONG_ENOUGH_S = 60  # for a loaded machine with sanitizers
# What an allocator may keep of the memory that was given back to it, for the next who ask: several sizes of blocks for
# each thread. Ten seconds are more than it takes to decide that nobody does.
KEPT_BY_ALLOCATOR = 4 << 20


def wait_until(condition, what, limit_s=LONG_ENOUGH_S):
    """The first value of condition() that is true."""
    end = time.monotonic() + limit_s
    while time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.01)
    raise AssertionError(f"never {what}")


def check(holds, message):
    if not holds:
        raise AssertionError(message)


class Stand:
    def __init__(self, program, folder, shim, sanitized):
        self.program, self.folder, self.shim, self.sanitized = program, pathlib.Path(folder), shim, sanitized

    def stream(self, *words, **how):
        return Stream(self, *words, **how)

    def run(self, *words, **how):
        """The program from start to end."""
        return subprocess.run([self.program, *words], text=True, timeout=LONG_ENOUGH_S, **{
            "stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **how})

    def with_shim(self):
        """The environment in which the program hears SIGUSR1 and SIGUSR2 as shim.cpp says."""
        order = "verify_asan_link_order=0:" + os.environ.get("ASAN_OPTIONS", "")
        return {"LD_PRELOAD": self.shim, "ASAN_OPTIONS": order}


class Stream:
    """hertzline stream, until it is interrupted."""

    def __init__(self, stand, *words, endpoint="tcp://127.0.0.1:*", scene=PAPER, recorded=True, listener="hertzline",
                 before_exec=None, env=None, exit_status=0, **stdio):
        """recorded: then the stream falls behind where it would drop a frame, so that a busy machine fails no test.
        listener: who the well-behaved one is, the project's own or one that knows pyzmq only.
        stdio: instead of stdout=a file, stderr=a file."""
        self.stand, self.scene, self.exit_status, self.interrupted = stand, scene, exit_status, None
        self.messages, self.summary = stand.folder / "messages", stand.folder / "summary"
        self.heard = stand.folder / ("heard.csv" if listener == "hertzline" else "heard.npy")
        command = [stand.program, "stream", *scene.words, *scene.pace, "--bind", endpoint, "--wait-for-subscriber", "--json",
                   *words]
        self.recording = stand.folder / "recording.csv" if recorded else None
        if recorded:
            command += ["--record", self.recording]
        self.peers = []
        self.process = self._start(command, preexec_fn=before_exec, env={**os.environ, **(env or {})}, **{
            "stdin": subprocess.DEVNULL, "stdout": self.summary.open("wb"), "stderr": self.messages.open("wb"), **stdio})
        self.endpoint = endpoint if "*" not in endpoint else self._bound_endpoint()
        self.listener_kind = listener

    def _start(self, command, **how):
        process = subprocess.Popen(command, **how)
        self.peers.append(process)
        return process

    def _lives(self):
        status = self.process.poll()
        check(status is None, f"the stream ended, {status}: {self.messages.read_text()}")
        return True

    def _bound_endpoint(self):
        def said():
            self._lives()
            lines = self.messages.read_text().splitlines(keepends=True)
            return [line.split()[-1] for line in lines if " endpoint " in line and line.endswith("\n")]
        return wait_until(said, "said where it publishes")[0]

    @property
    def address(self):
        host, port = self.endpoint.removeprefix("tcp://").split(":")
        return host, int(port)

    def peer(self, *words):
        """Another subscriber, that needs not behave: subscriber.py with these words."""
        script = pathlib.Path(__file__).with_name("subscriber.py")
        return self._start([sys.executable, script, self.endpoint, *map(str, words)], stdout=subprocess.PIPE, text=True)

    def first_of(self, topic):
        """A newcomer's first message of the topic: its JSON."""
        with zmq.Context() as context, context.socket(zmq.SUB) as socket:
            socket.linger = 0
            socket.connect(self.endpoint)
            socket.subscribe(topic)
            wait_until(lambda: self._lives() and socket.poll(100), "sent a newcomer anything")
            return json.loads(socket.recv_multipart()[1])

    def first_frame(self):
        return self.first_of("v_out/np")

    def footprint(self):
        """Descriptors, and memory of its own [bytes]."""
        proc = pathlib.Path(f"/proc/{self.process.pid}")
        memory = next((line for line in (proc / "status").read_text().splitlines() if line.startswith("RssAnon:")), None)
        if memory is None:  # it is ending right now
            self.process.wait(LONG_ENOUGH_S)
            self._lives()
        return len(os.listdir(proc / "fd")), 1024 * int(memory.split()[1])

    def __enter__(self):
        try:
            if self.listener_kind == "hertzline":
                self.listener = self._start([self.stand.program, "listen", "--json", "--connect", self.endpoint,
                                             "-o", self.heard], stdout=subprocess.PIPE, text=True)
            else:
                self.listener = self.peer("--save", self.heard)
            # By the meters, which do not start the stream: that is left to the listener. Then peers have come and gone and
            # buffers have filled: what that costs for good is no fault's.
            wait_until(lambda: self.first_of("meters")["wall_s"] > 0.3, "began")
            self.first_frame()
            self.before = wait_until(self._settled_footprint, "settled")
            return self
        except BaseException:
            self._kill()
            raise

    def _settled_footprint(self):
        first = self.footprint()
        time.sleep(0.1)
        return first if self.footprint()[0] == first[0] else None

    def __exit__(self, kind, *_):
        try:
            if kind is None:
                if self.interrupted is None:
                    self._check_it_is_as_before()
                    self.interrupt()
                self._check_the_end()
                self._check_the_samples()
        finally:
            self._kill()

    def _kill(self):
        for process in self.peers:
            if process.poll() is None:
                process.kill()
            process.wait()

    def _check_it_is_as_before(self):
        sample = self.first_frame()["sample"]
        wait_until(lambda: self.first_frame()["sample"] > sample + 10_000, "went on")
        descriptors, memory = self.before

        def is_as_before():
            now = self.footprint()
            more = now[1] - memory
            return now[0] == descriptors and (self.stand.sanitized or more < KEPT_BY_ALLOCATOR)
        try:
            wait_until(is_as_before, "", 10)  # seconds
        except AssertionError:
            raise AssertionError(f"descriptors and bytes were {self.before}, are {self.footprint()}") from None

    def interrupt(self):
        self.interrupted = self.interrupted or time.monotonic()
        self.process.send_signal(signal.SIGINT)

    def _check_the_end(self):
        status = self.process.wait(LONG_ENOUGH_S)
        took = time.monotonic() - self.interrupted
        check(status == self.exit_status, f"exit status {status}: {self.messages.read_text()}")
        check(took <= (10 if self.stand.sanitized else 1), f"{took:.2f} s from Ctrl-C to the end")

    def _check_the_samples(self):
        account = json.loads(self.listener.communicate(timeout=LONG_ENOUGH_S)[0].splitlines()[-1])
        expected = {"first_sample": 0, "missing_samples": 0, "ended_by": "end of run"}
        check({key: account[key] for key in expected} == expected, f"the listener heard {account}")
        if self.summary.stat().st_size > 0:
            check(json.loads(self.summary.read_text())["samples"] == account["samples"], "listener and summary differ")
        own = self.stand.folder / "run.csv"
        duration = f"output.duration_s={account['samples'] / self.scene.sample_rate_hz!r}"
        done = self.stand.run("run", *self.scene.words, "--set", duration, "-o", own)
        check(done.returncode == 0, done.stderr)
        heard = samples_of(self.heard) if self.heard.suffix == ".csv" else numpy.load(self.heard)
        # run saves the sample at its end, too
        check(self.recording is None or self.recording.read_text().splitlines() == own.read_text().splitlines()[:-1],
              "the recording is not that of run")
        check(numpy.array_equal(heard, samples_of(own)[:-1]), "the samples are not those of run")


def samples_of(csv):
    """v_out as float32, in which it is streamed."""
    return numpy.loadtxt(csv, delimiter=",", skiprows=1, usecols=-1).astype(numpy.float32)


def main(module):
    """Tries the fault named on the command line: one of the module's public functions."""
    faults = {name: function for name, function in vars(module).items()
              if inspect.isfunction(function) and function.__module__ == module.__name__ and not name.startswith("_")}
    parser = argparse.ArgumentParser()
    parser.add_argument("fault", choices=faults)
    parser.add_argument("--program", required=True)
    parser.add_argument("--shim", required=True)
    parser.add_argument("--sanitized", action="store_true")
    words = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        faults[words.fault](Stand(words.program, folder, words.shim, words.sanitized))
