"""The stand for tests of faults: a running stream, a well-behaved listener from sample 0 on, and the checks after the fault.

    with stand.stream() as stream:     # runs, and the listener receives it
        ...                            # the fault
                                       # here every promise is checked

The control runs beside it: the same stream without peers. The machine causes the lateness of the control's frames; the fault causes
any further lateness.
"""
import argparse
import inspect
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import numpy
import zmq

SLOWER = 3 if "--sanitized" in sys.argv else 1  # there a CSV's line takes ten times as long


class Scene:
    def __init__(self, name, sample_rate_hz, pace, **settings):
        # the step is given: run shortens the one that a stream takes, where errors grow over a long run
        settings = {"output.sample_rate_hz": sample_rate_hz, "output.frame_samples": 128, "numerics.step_s": 5e-7, **settings}
        self.words = [name, *(word for key, value in settings.items() for word in ("--set", f"{key}={value}"))]
        self.sample_rate_hz, self.pace = sample_rate_hz, ["--pace", str(pace / SLOWER)]
        self.frame_samples = settings["output.frame_samples"]


# 50 000 samples a second in 400 frames, which any machine can follow.
PAPER = Scene("paper-stream", 1e6, 0.05)
# 16 MB a second for a subscriber of all streams, in as few frames.
BUSY = Scene("paper-stream", 1e6, 0.05, **{"chain.spheres": 40})
# In 12 frames: with four blocks in its ring the sending thread may be held up for 0.3 s before a frame is dropped.
LARGE_FRAMES = Scene("paper-stream", 1e6, 0.05, **{"output.frame_samples": 4096})
# Seven seconds fill the 16 MiB of rows that may wait for a file, in step with the clock: a faint burst is less work.
MANY_SAMPLES = Scene("paper-stream", 1e5, 1, **{"drive.amplitude_m": 1e-9})
LONG_CHAIN = Scene("long-chain", 1e8, 0.001, **{"chain.spheres": 1000})  # the wave arrives after a second and a half

LONG_ENOUGH_S = 60 * SLOWER  # for a loaded machine
ENDS_WITHIN_S = 4 * SLOWER  # a second is promised; a busy machine may take longer, a program that hangs takes for ever
# Freed memory that an allocator may keep for later requests: several sizes of blocks for each thread.
KEPT_BY_ALLOCATOR = 4 << 20
# A fault may delay the sending thread by this time, and by this multiple of the control's lateness. (Measured with 16 processes on
# two cores: 0.06 s, and 1.2 of the busy scene; beside a build both are late by more than 2 s.)
LATENESS_S, LATENESS_OF_CONTROL = 0.5, 5


def wait_until(condition, what, limit_s=LONG_ENOUGH_S):
    """Waits for a true value of condition(), and returns it."""
    end = time.monotonic() + limit_s
    while time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.01)
    raise AssertionError(f"never {what}")


def catches(pid, signal_number):
    """Whether the process has a handler for the signal. A process that has ended has none."""
    caught = re.search(r"^SigCgt:\s*(\w+)", pathlib.Path(f"/proc/{pid}/status").read_text(), re.MULTILINE)
    return int(caught[1], 16) >> (signal_number - 1) & 1


def check(holds, message):
    if not holds:
        raise AssertionError(message)


class Stand:
    def __init__(self, program, folder, shim, sanitized, dropping):
        self.program, self.folder, self.shim, self.sanitized = program, pathlib.Path(folder), shim, sanitized
        self.dropping = dropping

    def stream(self, *words, **how):
        return Stream(self, *words, **how)

    def run(self, *words, **how):
        """Runs the program to its end."""
        return subprocess.run([self.program, *words], text=True, timeout=4 * LONG_ENOUGH_S, **{
            "stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **how})

    def with_shim(self, loses=None):
        """Returns an environment that loads shim.cpp, for SIGUSR1 and SIGUSR2. loses: beginning of the paths of files whose closing
        fails."""
        order = "verify_asan_link_order=0:" + os.environ.get("ASAN_OPTIONS", "")
        return {"LD_PRELOAD": self.shim, "ASAN_OPTIONS": order, **({"HERTZLINE_LOSES": str(loses)} if loses else {})}


class Stream:
    """hertzline stream, until it is interrupted."""

    def __init__(self, stand, *words, endpoint="tcp://127.0.0.1:*", scene=PAPER, recorded=True, listener="hertzline",
                 before_exec=None, env=None, exit_status=0, may_hold=0, **stdio):
        """recorded: the stream records, and falls behind where it would drop a frame. A stand that drops records nothing.
        listener: the well-behaved listener: the project's own, or one made of pyzmq only.
        may_hold: memory that may be left in use [bytes].
        stdio: replaces stdout=a file, stderr=a file."""
        self.stand, self.scene, self.exit_status, self.interrupted = stand, scene, exit_status, None
        self.may_hold = may_hold
        self.messages, self.summary = stand.folder / "messages", stand.folder / "summary"
        self.heard = stand.folder / ("heard.csv" if listener == "hertzline" else "heard.npy")
        command = [stand.program, "stream", *scene.words, *scene.pace, "--bind", endpoint, "--wait-for-subscriber", "--json",
                   *words]
        self.recording = stand.folder / "recording.csv" if recorded and not stand.dropping else None
        if self.recording:
            command += ["--record", self.recording]
        if stand.dropping:
            command += ["--on-overrun", "drop"]
        self.peers = []
        self.process = self._start(command, preexec_fn=before_exec, env={**os.environ, **(env or {})}, **{
            "stdin": subprocess.DEVNULL, "stdout": self.summary.open("wb"), "stderr": self.messages.open("wb"), **stdio})
        self.endpoint = endpoint if "*" not in endpoint else self._bound_endpoint()
        self.listener_kind = listener
        self.control = None if stand.sanitized else self._start(
            [stand.program, "stream", *scene.words, *scene.pace, "--bind", f"ipc://{stand.folder}/control", "--json"],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

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
        """Starts another subscriber, which may misbehave: subscriber.py with these words."""
        script = pathlib.Path(__file__).with_name("subscriber.py")
        return self._start([sys.executable, script, self.endpoint, *map(str, words)], stdout=subprocess.PIPE, text=True)

    def first_of(self, topic):
        """Returns the JSON of a new subscriber's first message of the topic."""
        with zmq.Context() as context, context.socket(zmq.SUB) as socket:
            socket.linger = 0
            socket.connect(self.endpoint)
            socket.subscribe(topic)
            wait_until(lambda: self._lives() and socket.poll(100), "sent a newcomer anything")
            return json.loads(socket.recv_multipart()[1])

    def first_frame(self):
        return self.first_of("v_out/np")

    def footprint(self):
        """Returns the number of file descriptors and the private memory [bytes]."""
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
            # Waits by the meters, which do not start the stream: the listener does. By then peers have come and gone and buffers
            # have filled, so that their permanent memory is not counted as the fault's.
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
                self._check_the_pace()
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
            return now[0] == descriptors and (self.stand.sanitized or more < KEPT_BY_ALLOCATOR + self.may_hold)
        try:
            wait_until(is_as_before, "")
        except AssertionError:
            raise AssertionError(f"descriptors and bytes were {self.before}, are {self.footprint()}") from None

    def interrupt(self):
        self.interrupted = self.interrupted or time.monotonic()
        self.process.send_signal(signal.SIGINT)

    def _check_the_end(self):
        status, took = timed_wait(self.process, self.interrupted)
        check(status == self.exit_status, f"exit status {status}: {self.messages.read_text()}")
        check(took <= ENDS_WITHIN_S, f"{took:.2f} s from Ctrl-C to the end")

    def _check_the_pace(self):
        """Checks lateness, except under sanitizers, which delay any thread."""
        if self.stand.sanitized or self.summary.stat().st_size == 0:
            return
        self.control.send_signal(signal.SIGINT)
        control = json.loads(self.control.communicate(timeout=LONG_ENOUGH_S)[0])
        own = json.loads(self.summary.read_text())
        for name in ("largest_lateness_s", "real_time_factor", "late_frames", "frames"):
            print(f"{name}: {own[name]:.4g}, of the control: {control[name]:.4g}")
        late, machine = own["largest_lateness_s"], control["largest_lateness_s"]
        allowed = LATENESS_S + LATENESS_OF_CONTROL * machine
        check(late <= allowed, f"late by {late:.3f} s, the control by {machine:.3f} s")
        check(own["real_time_factor"] > control["real_time_factor"] / 2, "half as fast as the control")

    def _check_the_samples(self):
        account = json.loads(self.listener.communicate(timeout=LONG_ENOUGH_S)[0].splitlines()[-1])
        expected = {"first_sample": 0, "frames_lost_on_the_way": 0, "ended_by": "end of run"}
        if self.recording:
            expected["missing_samples"] = 0
        check({key: account[key] for key in expected} == expected, f"the listener received {account}")
        if self.summary.stat().st_size > 0:
            self._check_every_frame_is_accounted_for(json.loads(self.summary.read_text()), account)
        own = self.stand.folder / "run.csv"
        due = account["samples"] + account["missing_samples"]
        done = self.stand.run("run", *self.scene.words, "--set",
                              f"output.duration_s={due / self.scene.sample_rate_hz!r}", "-o", own)
        check(done.returncode == 0, done.stderr)
        # run saves the sample at its end, too
        check(self.recording is None or self.recording.read_text().splitlines() == own.read_text().splitlines()[:-1],
              "the recording is not that of run")
        indices, heard = self._heard_samples()
        check(len(heard) == account["samples"] and (numpy.diff(indices) > 0).all(), "the listener saved other samples")
        check(numpy.array_equal(heard, samples_of(own)[1][indices]), "the samples are not those of run")

    def _check_every_frame_is_accounted_for(self, summary, account):
        check(summary["samples"] == account["samples"] + account["missing_samples"], "listener and summary differ")
        sent, dropped = summary["v_out_np_sent"], summary["v_out_np_dropped"]
        check((account["frames"], account["frames_dropped_by_sender"]) == (sent, dropped),
              f"sent {sent} frames and dropped {dropped}; received {account}")
        check(sent + dropped == -(-summary["samples"] // self.scene.frame_samples), f"frames without account: {summary}")

    def _heard_samples(self):
        if self.heard.suffix == ".npy":
            indices, values = numpy.load(self.heard).T
        else:
            times, values = samples_of(self.heard)
            indices = numpy.rint(times * self.scene.sample_rate_hz)
        return indices.astype(int), values.astype(numpy.float32)


def samples_of(csv):
    """Returns times, and v_out as float32, the type of the stream."""
    times, values = numpy.loadtxt(csv, delimiter=",", skiprows=1, usecols=(0, -1), unpack=True)
    return times, values.astype(numpy.float32)


def timed_wait(process, begin):
    """Waits for the end. Returns the exit status and the seconds since `begin` in which this process could run.

    Each rest of a few milliseconds counts as twice as long at most, however late the machine wakes us up."""
    elapsed = time.monotonic() - begin
    while process.poll() is None:
        rest = time.monotonic()
        check(rest < begin + LONG_ENOUGH_S, "it does not end")
        time.sleep(0.005)
        elapsed += min(time.monotonic() - rest, 0.01)
    return process.returncode, elapsed


def main(module):
    """Runs the fault named on the command line: one of the module's public functions."""
    faults = {name: function for name, function in vars(module).items()
              if inspect.isfunction(function) and function.__module__ == module.__name__ and not name.startswith("_")}
    parser = argparse.ArgumentParser()
    parser.add_argument("fault", choices=faults)
    parser.add_argument("--program", required=True)
    parser.add_argument("--shim", required=True)
    parser.add_argument("--sanitized", action="store_true")
    parser.add_argument("--dropping", action="store_true", help="late frames are dropped, and nothing is recorded")
    words = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        faults[words.fault](Stand(words.program, folder, words.shim, words.sanitized, words.dropping))
