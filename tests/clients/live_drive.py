#!/usr/bin/python3
"""Drives running streams with samples: live_drive.py HERTZLINE"""
import json, signal, subprocess, sys, tempfile, time, unittest
import numpy as np
import zmq
from streaming import LONG_ENOUGH_S, Stream

PROGRAM = sys.argv[1]
RATE_HZ, FRAME, SAMPLES = 10e6, 256, 6000
LISTENED = ["v_out", "x_horn"]
SCENE = ["--set", f"output.frame_samples={FRAME}", "--set", "output.duration_s=600e-6", "--set", "drive.cycles=12"]


def burst(samples=4000, scale=3e-6):
    """A tone with a raised cosine, in metres."""
    t = np.arange(samples) / RATE_HZ
    return (scale / 2 * (1 - np.cos(2 * np.pi * 2.5e3 * t)) * np.sin(2 * np.pi * 73e3 * t)).astype("<f4")


class Driven:
    """A stream with a live drive, a sender and a listener."""

    def __init__(self, *words, socket=zmq.PUSH, drive="tcp://127.0.0.1:*", samples=SAMPLES, scene="paper-stream", listened=LISTENED):
        self.stream = Stream(PROGRAM, scene, "--drive", drive, *SCENE, "--duration", str(samples / RATE_HZ), *words)
        self.context = zmq.Context()
        self.sender = self.context.socket(socket)
        self.sender.linger = 0
        self.sender.sndtimeo = LONG_ENOUGH_S * 1000
        if drive.endswith("*"):
            self.sender.connect(self.stream.said.split("drive ")[1].split()[0])
        self.listener = self.context.socket(zmq.SUB)
        self.listener.rcvhwm = 0
        self.listener.rcvtimeo = LONG_ENOUGH_S * 1000
        self.listener.connect(self.stream.endpoint)
        for topic in ("meta", "end", *(f"{name}/np" for name in listened)):
            self.listener.subscribe(topic)
        self.meta = json.loads(self.listener.recv_multipart()[-1])
        self.latency = self.meta["latency_samples"]
        self.headers = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stream.__exit__()
        self.context.destroy(linger=0)

    def send(self, samples, cut=1000):
        for begin in range(0, len(samples), cut):
            self.sender.send(samples[begin:begin + cut].tobytes())

    def to_the_end(self):
        """Returns {stream: samples} and the summary."""
        heard = {}
        while True:
            topic, *parts = self.listener.recv_multipart()
            if topic == b"end":
                break
            if topic != b"meta":
                self.headers.append(json.loads(parts[0]))
                heard.setdefault(topic.decode().split("/")[0], []).append(np.frombuffer(parts[1], "<f4"))
        return {name: np.concatenate(frames) for name, frames in heard.items()}, json.loads(self.stream.summary())


def padded(samples, length=3 * SAMPLES):
    return np.concatenate([samples, np.zeros(max(0, length - len(samples)), "<f4")])


def heard_of(samples, *words, cut=1000, **more):
    with Driven("--wait-for-subscriber", *words, **more) as driven:
        driven.send(padded(samples), cut)
        heard, end = driven.to_the_end()
        return heard, end, driven


class LiveDrive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.heard, cls.end, cls.driven = heard_of(burst())

    def test_a_file_played_in_is_the_run_of_the_file(self):
        with tempfile.TemporaryDirectory() as folder:
            np.save(f"{folder}/drive.npy", padded(burst(), 9000).astype("<f4"))
            latency_s = self.driven.meta["scene"]["drive"]["start_s"]
            keys = ["drive.kind=file", f"drive.file={folder}/drive.npy", "drive.sample_rate_hz=1e7", f"drive.start_s={latency_s!r}",
                    "drive.frequency_hz=73e3", "drive.repetition_hz=0", f"numerics.step_s={self.end['step_s']!r}"]
            # the tolerance of the pieces is relative to the velocity that the scene tells, which the two know from different sides
            subprocess.run([PROGRAM, "run", "paper-stream", *SCENE, *(word for key in keys for word in ("--set", key)), "--columns",
                            "v_out,x_horn", "-o", f"{folder}/run.csv"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            run = np.loadtxt(f"{folder}/run.csv", delimiter=",", skiprows=1)[:SAMPLES, 1:]
        self.assertTrue(np.array_equal(self.heard["x_horn"], run[:, 1].astype("<f4")), "the horn's motion is the same, bit for bit")
        self.assertLess(np.abs(self.heard["v_out"] - run[:, 0]).max(), 1e-4 * np.abs(run[:, 0]).max())

    def test_the_first_sample_is_heard_where_the_header_says(self):
        for header in self.driven.headers:
            self.assertEqual(header["latency_samples"], self.driven.latency)
        self.assertEqual(np.flatnonzero(self.heard["x_horn"])[0], self.driven.latency + 1)  # the first sample is 0
        peak = np.abs(burst()).argmax()
        self.assertEqual(np.abs(self.heard["x_horn"]).argmax(), self.driven.latency + peak)
        self.assertLessEqual(self.driven.latency / RATE_HZ, 100e-6)

    def test_the_same_samples_in_any_cut_give_the_same_bits(self):
        for cut in (1, 7, 256, 18000):
            heard, end, _ = heard_of(burst(), cut=cut)
            self.assertEqual((end["drive_refused"], end["drive_lost"]), (0, 0))
            for name in LISTENED:
                self.assertTrue(np.array_equal(heard[name], self.heard[name]), f"{name} in messages of {cut}")

    def test_every_integrator_hears_it(self):
        for integrator, step in (("leapfrog", "20e-9"), ("chin4a", "50e-9"), ("taylor8", "300e-9"), ("taylor12", "600e-9")):
            heard, _, driven = heard_of(burst(), "--set", f"numerics.integrator={integrator}", "--set", f"numerics.step_s={step}")
            here, there = heard["v_out"][driven.latency:], self.heard["v_out"][self.driven.latency:]
            both = min(len(here), len(there))
            self.assertLess(np.abs(here[:both] - there[:both]).max(), 0.02 * np.abs(there).max(), integrator)

    def test_a_recording_is_run_again_bit_for_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            file = f"{folder}/out.sigmf-meta"
            heard, end, _ = heard_of(burst(), "--record", file, "--columns", "v_out")
            self.assertEqual(end["recordings"][0]["status"], "complete")
            subprocess.run([PROGRAM, "run", file, "--columns", "v_out", "-o", f"{folder}/again.sigmf-meta"], check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            first, again = (np.fromfile(f"{folder}/{name}.sigmf-data", "<f4") for name in ("out", "again"))
            self.assertTrue(np.array_equal(first, heard["v_out"]))
            self.assertTrue(np.array_equal(first, again))
            check = subprocess.run([PROGRAM, "check", file, "--json"], check=True, capture_output=True, text=True)
            self.assertEqual(json.loads(check.stdout)["record_sample_rate_hz"], RATE_HZ)

    def test_a_recording_whose_input_is_not_there_is_not_simulated_again_in_silence(self):
        with tempfile.TemporaryDirectory() as folder:
            def run(name):
                return subprocess.run([PROGRAM, "run", f"{folder}/{name}", "--columns", "v_out", "-o", f"{folder}/again.npy"],
                                      capture_output=True, text=True)

            heard_of(burst(), "--record", f"{folder}/out.csv", "--record", f"{folder}/out.h5", "--columns", "v_out")
            self.assertEqual(run("out.h5").returncode, 0)
            beside = subprocess.run([PROGRAM, "run", f"{folder}/out.h5", "-o", f"{folder}/out.csv-drive.sigmf-meta"],
                                    capture_output=True, text=True)
            self.assertEqual((beside.returncode, "read here" in beside.stderr), (2, True), beside.stderr)
            heard_of(burst() / 2, "--record", f"{folder}/out.csv", "--columns", "v_out")
            self.assertEqual(run("out.csv").returncode, 0)
            other = run("out.h5")  # names the input of out.csv, which is another now
            self.assertEqual((other.returncode, "of the run" in other.stderr), (1, True), other.stderr)
            with open(f"{folder}/out.csv-drive.sigmf-data", "r+b") as data:
                data.truncate(4 * 4000)
            short = run("out.csv")
            self.assertIn("ends early", short.stderr)
            first = np.loadtxt(f"{folder}/out.csv", delimiter=",", skiprows=1, usecols=1)
            again = np.load(f"{folder}/again.npy")["v_out_m_per_s"]
            self.assertTrue(1000 < len(again) < 4700 and np.array_equal(first[:len(again)], again), len(again))
            with Driven("--wait-for-subscriber", "--record", f"{folder}/none.csv", samples=300) as driven:
                driven.to_the_end()
            self.assertEqual(run("none.csv").returncode, 0, "its input is that of nothing")
            for ending in ("meta", "data"):
                done = subprocess.run([PROGRAM, "stream", "paper-stream", "--drive", "tcp://127.0.0.1:*", "--record", f"{folder}/a.csv",
                                       "--record", f"{folder}/a.csv-drive.sigmf-{ending}"], capture_output=True, text=True)
                self.assertEqual((done.returncode, "another name" in done.stderr), (2, True))

    def test_what_is_no_samples_is_counted_and_left_out(self):
        with Driven("--wait-for-subscriber") as driven:
            driven.send(burst()[:1000])
            driven.sender.send(b"odd")
            driven.sender.send(np.array([0, np.nan], "<f4").tobytes())
            driven.sender.send(np.array([np.inf], "<f4").tobytes())
            driven.sender.send(np.array([3.0], "<f4").tobytes())  # metres
            driven.sender.send_multipart([b"v_horn/np", b"{}", b"1234"])
            driven.sender.send(b"")
            driven.send(padded(burst())[1000:])
            heard, end = driven.to_the_end()
        self.assertEqual(end["drive_refused"], 5)
        for name in LISTENED:
            self.assertTrue(np.array_equal(heard[name], self.heard[name]), name)

    def test_lost_frames_are_seen_and_time_goes_on(self):
        samples = padded(burst())
        header = {"dtype": "<f4", "unit": "m", "stream": "x_horn", "burst": 0, "burst_sample": 0, "epoch": 0, "fs": RATE_HZ, "dropped": 0,
                  "run": "a"}
        with Driven("--wait-for-subscriber") as driven:
            for seq in range(len(samples) // 500):
                if seq != 3:
                    about = header | {"shape": [500, 1], "seq": seq, "sample": 500 * seq, "t": 500 * seq / RATE_HZ}
                    driven.sender.send_multipart([b"x_horn/np", json.dumps(about).encode(), samples[500 * seq:][:500].tobytes()])
            heard, end = driven.to_the_end()
        self.assertEqual((end["drive_lost"], end["drive_refused"]), (500, 0))
        samples[1500:2000] = 0
        expected, _, _ = heard_of(samples)
        self.assertTrue(np.array_equal(heard["v_out"], expected["v_out"]))

    def test_a_sender_that_stops_and_starts_loses_nothing(self):
        with Driven("--wait-for-subscriber") as driven:
            driven.send(burst()[:1500])
            address = driven.sender.last_endpoint
            driven.sender.close(linger=-1)
            time.sleep(0.5)
            driven.sender = driven.context.socket(zmq.PUSH)
            driven.sender.connect(address)
            driven.send(padded(burst())[1500:])
            heard, end = driven.to_the_end()
        self.assertGreaterEqual(end["drive_underruns"], 1)
        self.assertEqual(end["drive_zeros"], 0)
        for name in LISTENED:
            self.assertTrue(np.array_equal(heard[name], self.heard[name]), name)

    def test_zeros_take_the_place_of_late_samples(self):
        with tempfile.TemporaryDirectory() as folder:
            file = f"{folder}/out.sigmf-meta"
            with Driven("--wait-for-subscriber", "--set", "drive.on_underrun=zero", "--record", file) as driven:
                sent = burst()[:1500]
                driven.send(sent, cut=len(sent))
                heard, end = driven.to_the_end()
            self.assertGreaterEqual(end["drive_underruns"], 1)
            self.assertEqual(end["drive_samples"], 1500 + end["drive_zeros"])
            held = np.fromfile(f"{folder}/out-drive.sigmf-data", "<f4")
            self.assertEqual(len(held), end["drive_samples"])
            # zeros may also stand between samples that arrived together, where the thread that receives was held up
            self.assertTrue(np.array_equal(held[held != 0], sent[sent != 0]))
            expected, _, _ = heard_of(held)
            self.assertTrue(np.array_equal(heard["v_out"], expected["v_out"]))

    def test_a_flood_waits(self):
        with Driven("--wait-for-subscriber") as driven:
            driven.sender.send(padded(burst(), 20_000_000).tobytes())  # 80 MB at once
            heard, end = driven.to_the_end()
        # the ring of the stream lasts 50 ms, which the simulation may be ahead at the end
        self.assertLess(end["drive_samples"], end["samples"] + 1_000_000)
        self.assertTrue(np.array_equal(heard["v_out"], self.heard["v_out"]))

    def test_a_recording_replayed_drives_another_chain(self):
        with tempfile.TemporaryDirectory() as folder:
            file = f"{folder}/horn.sigmf-meta"
            subprocess.run([PROGRAM, "run", "paper-stream", "--set", "output.duration_s=2e-3", "--columns", "v_horn", "-o", file], check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            with Stream(PROGRAM, file, "--pace", "0.1", "--wait-for-subscriber", command="replay") as replay:
                with Driven("--wait-for-subscriber", "--set", "drive.socket=sub", "--set", "drive.column=v_horn",
                            drive=replay.endpoint, samples=8000, listened=["v_horn", "v_out"]) as driven:
                    heard, end = driven.to_the_end()
                    latency = driven.latency
            horn = np.fromfile(f"{folder}/horn.sigmf-data", "<f4")
        self.assertEqual((end["drive_lost"], end["drive_refused"], end["drive_zeros"]), (0, 0, 0))
        # joined to whatever of the stream was heard: its first frames may have been sent before
        self.assertLess(np.abs(heard["v_horn"][latency:] - horn[:8000 - latency]).max(), 1e-5 * np.abs(horn).max())

    def test_a_sender_that_falls_silent_is_told_of(self):
        with Driven("--wait-for-subscriber") as driven:
            driven.send(burst()[:1500])
            for line in driven.stream.process.stderr:
                if "for 2 s, the stream waits for more" in line:
                    break
            else:
                self.fail("the stream said nothing")
            driven.send(padded(burst())[1500:])
            heard, _ = driven.to_the_end()
        self.assertTrue(np.array_equal(heard["v_out"], self.heard["v_out"]))

    def test_ends_without_samples(self):
        with Driven() as driven:
            time.sleep(0.3)
            driven.stream.process.send_signal(signal.SIGINT)
            end = json.loads(driven.stream.summary())
        self.assertEqual(end["drive_samples"], 0)

    def test_what_does_not_go_with_it_is_refused(self):
        for words, expected in ((["--control", "tcp://127.0.0.1:*"], "--control"), (["--pace", "0.5"], "--pace"),
                                (["--set", "drive.lowpass_hz=9e6"], "drive.lowpass_hz"),
                                (["--on-overrun", "drop"], "--on-overrun"), (["--set", "drive.endpoint=\"\""], "endpoint")):
            done = subprocess.run([PROGRAM, "stream", "paper-stream", "--drive", "tcp://127.0.0.1:*", *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(expected, done.stderr)
        live = [PROGRAM, "run", "paper-stream", "--set", "drive.kind=live"]
        done = subprocess.run(live, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("stream --drive", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
