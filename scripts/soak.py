#!/usr/bin/python3
"""Streams for a long time to subscribers of all kinds, on busy processors, and counts all frames.

    scripts/soak.py --program build/release/hertzline --seconds 1800

One subscriber listens from the first sample to the last: it must receive each sent frame or count it as missing. Another is too
slow from beginning to end. Others come and go: some listen for a while, some record, some are killed. A controller changes the scene
every second, and a page watches the stream in its scope. The program's memory and file descriptors are sampled. Prints the figures, then the failed demands; exit status 1 if there are any. Debian: python3-zmq
python3-numpy.
"""
import argparse
import json
import multiprocessing
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np
import zmq

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests/scope"))
from page_socket import PageSocket, Picture  # noqa: E402

STREAMS = ["v_out", "v_last", "v_plate"]
SETTLED_S = 600          # queues are full and the heap has settled: memory is judged from here on
LONG_ENOUGH_S = 1200     # shortest run whose memory is judged; shorter ones print its growth after their first third
MOST_MIB_PER_HOUR = 1
VISITORS_AT_A_TIME = 3
FRAMES_AT_A_TIME = 250   # frames that the slow subscriber receives
NAP_S = 0.05             # before it sleeps: half of ten thousand frames a second
CHANGE_EVERY_S = 1       # a stream keeps the latest 500 changes: their memory is taken before SETTLED_S


def busy():
    """Keeps a processor busy, at a lower priority than the tested programs."""
    os.nice(10)
    while True:
        pass


def slow_subscriber(endpoint, frames):
    """Falls behind and stays there; counts received frames, and by their numbers the missed ones."""
    socket = zmq.Context().socket(zmq.SUB)
    socket.set_hwm(100)
    socket.connect(endpoint)
    socket.subscribe("v_out/np")
    first = None
    while True:
        for _ in range(FRAMES_AT_A_TIME):
            header = socket.recv_multipart()[1]
        seq = json.loads(header)["seq"]
        first = seq - FRAMES_AT_A_TIME + 1 if first is None else first  # its queue was empty then
        frames[0] += FRAMES_AT_A_TIME
        frames[1] = seq - first + 1 - frames[0]
        time.sleep(NAP_S)


def page(address, pictures):
    """Watches the stream as a browser does, and counts the pictures."""
    with PageSocket(address) as socket:
        while True:
            pictures[0] += isinstance(socket.receive(), Picture)
            pictures[1] = int(time.monotonic())


class Stream:
    """The program under test."""

    def __init__(self, program, scene, folder):
        said = pathlib.Path(folder, "stderr")
        with said.open("w", encoding="utf-8") as file:
            self.process = subprocess.Popen(
                [program, "stream", scene, "--json", "--bind", "tcp://127.0.0.1:*", "--wait-for-subscriber",
                 "--control", "tcp://127.0.0.1:*", "--scope-http", "127.0.0.1:0"],
                stdout=subprocess.PIPE, stderr=file, text=True)
        while self.process.poll() is None:
            lines = said.read_text(encoding="utf-8").splitlines()
            found = {name: line.split()[-1] for line in lines for name in ("endpoint", "control", "scope")
                     if line.startswith(f"info: {name} ")}
            if len(found) == 3:
                self.endpoint, self.control, self.page = found["endpoint"], found["control"], found["scope"]
                return
            time.sleep(0.05)
        sys.exit("soak.py: the stream did not start: " + said.read_text(encoding="utf-8"))

    def memory_mib(self):
        """Returns the resident memory. Reading smaps_rollup instead would delay the program by milliseconds."""
        pages = pathlib.Path(f"/proc/{self.process.pid}/statm").read_text(encoding="ascii").split()[1]
        return int(pages) * os.sysconf("SC_PAGE_SIZE") / 2**20

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def must_run(self):
        if self.process.poll() is not None:
            sys.exit(f"soak.py: the stream is over, with status {self.process.returncode}")

    def end(self):
        """Sends Ctrl-C. Returns the summary and the time until the end [s]."""
        began = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        out, _ = self.process.communicate(timeout=60)
        if self.process.returncode != 0:
            sys.exit(f"soak.py: the stream ended with status {self.process.returncode}")
        return json.loads(out), time.monotonic() - began


class Visitors:
    """Subscribers that come and go: each third one records, each third one is killed."""

    def __init__(self, program, endpoint, folder):
        self.listen = [program, "listen", "--json", "--connect", endpoint]
        self.folder = pathlib.Path(folder)
        self.present = []  # (process, when it is killed or None, its file or None)
        self.random = random.Random(1)
        self.came = self.killed = self.recordings = self.odd = self.frames = self.lost = 0

    def come(self):
        """Starts one more, unless there are enough."""
        if len(self.present) == VISITORS_AT_A_TIME:
            return
        self.came += 1
        stay_s = self.random.uniform(0.2, 3)
        kill_at, file, end = None, None, ["--duration", str(stay_s)]
        if self.came % 3 == 0:
            kill_at, end = time.monotonic() + stay_s, []
        elif self.came % 3 == 1:
            file = self.folder / f"{self.came}.csv"
            end = ["--duration", "0.02", "-o", file]
        process = subprocess.Popen([*self.listen, "--stream", self.random.choice(STREAMS), *end],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.present.append((process, kill_at, file))

    def see_off(self):
        """Kills those that are due, and counts the frames of those that have ended."""
        for visitor in list(self.present):
            process, kill_at, file = visitor
            if kill_at and time.monotonic() > kill_at:
                process.kill()
                self.killed += 1
            elif process.poll() is None:
                continue
            self.present.remove(visitor)
            out, _ = process.communicate()
            if not kill_at:
                self.take(json.loads(out), file)

    def take(self, summary, file):
        """Adds a visitor's counts; its recording must hold as many samples."""
        self.frames += summary["frames"]
        self.lost += summary["frames_lost_on_the_way"]
        sound = summary["ended_by"] == "duration" and is_in_order(summary)
        if file:
            self.recordings += 1
            with file.open("rb") as rows:
                sound = sound and sum(1 for _ in rows) == summary["samples"] + 1
            file.unlink()
        self.odd += not sound


class Controller:
    """Changes the scene, and takes each fourth change back."""

    def __init__(self, program, endpoint):
        self.command = [program, "set", "--json", "--connect", endpoint]
        self.next_s = time.monotonic()
        self.process = None
        self.asked = self.applied = 0

    def act(self):
        """Asks for the next change when it is due and the last one is answered."""
        if self.process is not None and self.process.poll() is None:
            return
        self.see_answer()
        if time.monotonic() < self.next_s:
            return
        self.next_s = time.monotonic() + CHANGE_EVERY_S
        self.asked += 1
        amplitude_m = 1e-6 * (1 + self.asked % 7)
        words = ["--undo"] if self.asked % 4 == 0 else [f"drive.amplitude_m={amplitude_m:g}"]
        self.process = subprocess.Popen([*self.command, *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

    def see_answer(self):
        """Waits for the answer to the last change, and counts it."""
        if self.process is not None:
            out, _ = self.process.communicate(timeout=60)
            self.applied += self.process.returncode == 0 and "applies_at_sample" in json.loads(out)
            self.process = None


def is_in_order(heard):
    return not any(heard[name] for name in
                   ["frames_repeated", "frames_out_of_order", "frames_inconsistent", "messages_malformed"])


def growth(memory):
    """Returns the slope of the memory [MiB/h] and the half width of its 95 % interval, by least squares through the medians of
    twenty parts. ZeroMQ's queue of a slow subscriber swings between half and full in seconds, and a visitor's may be long for a
    moment; a leak stays."""
    medians = [np.median(part, axis=0) for part in np.array_split(np.array(memory), 20)]
    hours, mib = np.transpose(medians) / [[3600], [1]]
    slope, offset = np.polyfit(hours, mib, 1)
    rest = mib - (slope * hours + offset)
    error = np.sqrt(rest @ rest / (len(hours) - 2) / np.sum((hours - hours.mean()) ** 2))
    return slope, 2.1 * error


def settled(memory):
    """Returns the samples without the beginning, during which queues fill."""
    start = min(SETTLED_S, memory[-1][0] / 3)  # [s]
    return [sample for sample in memory if sample[0] >= start]


def until(holds, patience_s):
    deadline = time.monotonic() + patience_s
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.1)


def soak(arguments, folder):
    """Runs the stream and all subscribers. Returns the observations by name."""
    stream = Stream(arguments.program, arguments.scene, folder)
    steady = subprocess.Popen([arguments.program, "listen", "--json", "--connect", stream.endpoint],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    time.sleep(1)  # so that its subscription starts the stream
    slow = multiprocessing.Array("q", 2)
    pictures = multiprocessing.Array("q", 2)
    watcher = multiprocessing.Process(target=page, args=(stream.page, pictures), daemon=True)
    helpers = [watcher, multiprocessing.Process(target=slow_subscriber, args=(stream.endpoint, slow), daemon=True)]
    helpers += [multiprocessing.Process(target=busy, daemon=True) for _ in range(os.cpu_count())]
    for helper in helpers:
        helper.start()
    until(lambda: slow[0] > 0 and pictures[0] > 0, 60)
    before = stream.descriptors()

    visitors = Visitors(arguments.program, stream.endpoint, folder)
    controller = Controller(arguments.program, stream.control)
    began = time.monotonic()
    memory = [(0, stream.memory_mib())]
    descriptors = [before]
    while memory[-1][0] < arguments.seconds:
        stream.must_run()
        visitors.come()
        descriptors.append(stream.descriptors())
        for _ in range(10):
            visitors.see_off()
            controller.act()
            time.sleep(0.1)
            memory.append((time.monotonic() - began, stream.memory_mib()))
    controller.see_answer()
    last_picture_s = time.monotonic() - pictures[1]
    watcher.kill()
    until(lambda: visitors.see_off() or not visitors.present, 60)
    until(lambda: stream.descriptors() == before, 20)  # a broken connection is noticed with a delay
    after = stream.descriptors()
    summary, ending_s = stream.end()
    heard = json.loads(steady.communicate(timeout=60)[0])
    for helper in helpers:
        helper.kill()
    return {"summary": summary, "heard": heard, "slow": list(slow), "visitors": visitors, "ending_s": ending_s,
            "controller": controller, "pictures": pictures[0], "last_picture_s": last_picture_s,
            "memory": settled(memory), "long_enough": memory[-1][0] >= LONG_ENOUGH_S,
            "descriptors": (before, max(descriptors), after)}


def account(seen):
    """Returns the figures to print, and the failed demands."""
    summary, heard, visitors = seen["summary"], seen["heard"], seen["visitors"]
    sent, dropped = summary["v_out_np_sent"], summary["v_out_np_dropped"]
    # A frame that a change of the scene begins or ends is shorter: counts of frames and of samples are balanced each by itself.
    lost = heard["frames_lost_on_the_way"]
    unaccounted = sent - heard["frames"] - lost
    samples_unaccounted = summary["samples"] - heard["samples"] - heard["missing_samples"]
    slope, error = growth(seen["memory"])
    before, most, after = seen["descriptors"]
    mib = [sample[1] for sample in seen["memory"]]
    figures = {
        "streamed": f"{summary['simulated_s']:.1f} s, real-time factor {summary['real_time_factor']:.5f}",
        "frames sent": sent,
        "dropped by the program": dropped,
        "late": f"{summary['late_frames']}, by {1e3 * summary['largest_lateness_s']:.1f} ms at most",
        "received from first to last": heard["frames"],
        "lost on the way": lost,
        "unaccounted": f"{unaccounted}; samples {samples_unaccounted}",
        "slow subscriber": f"received {seen['slow'][0]}, knows of {seen['slow'][1]} missing",
        "visitors": f"{visitors.came}, of them {visitors.killed} killed, {visitors.recordings} recording; "
                    f"received {visitors.frames}, lost on the way {visitors.lost}",
        "controller": f"asked for {seen['controller'].asked} changes, {seen['controller'].applied} applied",
        "page": f"received {seen['pictures']} pictures, the last {seen['last_picture_s']:.0f} s before the end",
        "memory": f"{np.mean(mib):.1f} MiB ({min(mib):.1f} to {max(mib):.1f}), growing by {slope:.2f} +- {error:.2f} MiB/h"
                  + ("" if seen["long_enough"] else ", too short to judge"),
        "file descriptors": f"{before} before the visitors, {most} at most, {after} after them",
        "ended after": f"{seen['ending_s']:.2f} s",
    }
    demands = {
        "frames are unaccounted for": unaccounted == 0 and samples_unaccounted == 0 and heard["frames_dropped_by_sender"] == dropped,
        "the steady listener did not receive the end": heard["ended_by"] == "end of run" and heard["first_sample"] == 0,
        "frames came twice, late or contradictory": is_in_order(heard),
        f"{visitors.odd} visitors received too little or wrong data": visitors.odd == 0 and not visitors.present,
        "the slow subscriber was not slow": seen["slow"][0] > 0 and seen["slow"][1] > 0,
        "changes were not applied": seen["controller"].asked > 0 and seen["controller"].applied == seen["controller"].asked,
        "the page stood still": seen["last_picture_s"] < 10,
        f"memory grows by more than {MOST_MIB_PER_HOUR} MiB/h": slope - error < MOST_MIB_PER_HOUR or not seen["long_enough"],
        "file descriptors were left open": after == before,
        "the end took more than a second": seen["ending_s"] < 1,
    }
    return figures, [fault for fault, held in demands.items() if not held]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="build/release/hertzline", help="the hertzline to run (%(default)s)")
    parser.add_argument("--seconds", type=float, default=1800, help="how long (%(default)s)")
    parser.add_argument("--scene", default="paper-stream", help="scene to stream (%(default)s)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        figures, faults = account(soak(arguments, folder))
    for name, value in figures.items():
        print(f"{name:28} {value}")
    for fault in faults:
        print(f"soak.py: {fault}", file=sys.stderr)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
