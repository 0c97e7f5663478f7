"""Streams: every sample arrives, and missing ones raise an exception or are marked."""
import copy
import json
import os
import pickle
import sys
import threading
import unittest

import numpy as np
import zmq
from support import PROGRAM, InAFolder

import hertzline

sys.path.insert(0, os.environ["HERTZLINE_CLIENTS"])
from streaming import Stream, samples_of_run  # noqa: E402

SCENE, RATE_HZ, SAMPLES = "paper-stream", 10e6, 30_000


class Publisher:
    """Sends frames of v_out that the test makes up: [(seq, sample, dropped, n)]."""

    def __init__(self, frames, end, channels=1):
        self.channels = channels
        self.socket = zmq.Context.instance().socket(zmq.XPUB)
        port = self.socket.bind_to_random_port("tcp://127.0.0.1")
        self.endpoint = f"tcp://127.0.0.1:{port}"
        self.frames, self.end = frames, end
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        while (topic := self.socket.recv()) != b"\x01v_out/np":
            if topic == b"\x01meta":
                self.send("meta", {"streams": [{"name": "v_out", "channels": self.channels}], "version": "9"})
        for seq, sample, dropped, n in self.frames:
            header = {"dtype": "<f4", "shape": [n, self.channels], "unit": "m/s", "stream": "v_out", "seq": seq, "sample": sample,
                      "fs": 1e6, "t": sample / 1e6, "dropped": dropped, "run": "r", "burst": 0, "burst_sample": sample, "epoch": seq // 2}
            samples = np.arange(sample, sample + n, dtype="<f4")[:, None] + 1000 * np.arange(self.channels, dtype="<f4")
            self.socket.send_multipart([b"v_out/np", json.dumps(header).encode(), samples.tobytes()])
        self.send("end", {"run": "r", "samples": self.end, "dropped_frames": 0})
        self.socket.close(linger=2000)

    def send(self, topic, message):
        self.socket.send_multipart([topic.encode(), json.dumps(message).encode()])


GAP = [(0, 0, 0, 100), (1, 100, 0, 100), (4, 400, 1, 50), (5, 450, 1, 50)]


class Listening(InAFolder):
    def check_every_sample(self, tap, unit="m/s"):
        run = samples_of_run(PROGRAM, self.folder, SCENE, tap, SAMPLES, RATE_HZ)
        with Stream(PROGRAM, SCENE, "--pace", "flat-out", "--duration", str(SAMPLES / RATE_HZ),
                    "--wait-for-subscriber") as stream:
            with hertzline.listen(stream.endpoint, tap) as live:
                blocks = list(live)
        heard = np.concatenate([block.samples for block in blocks])
        self.assertTrue(np.array_equal(heard.reshape(len(heard), -1), run))
        self.assertEqual([block.sample for block in blocks], [1024 * k for k in range(len(blocks))])
        self.assertEqual((blocks[1].fs, blocks[1].unit, blocks[1].t[0]), (RATE_HZ, unit, 1024 / RATE_HZ))
        self.assertTrue(live.totals["gapless"])
        self.assertEqual(live.totals["ended_by"], "end of run")
        self.assertEqual(live.provenance["scene"]["chain"]["spheres"], 6)

    def test_every_sample_arrives(self):
        self.check_every_sample("v_out")

    def test_every_sample_of_all_spheres_and_contacts_arrives(self):
        self.check_every_sample("v_chain")
        self.check_every_sample("f_chain", unit="N")

    def test_a_block_owns_its_samples(self):
        publisher = Publisher([(0, 0, 0, 100), (1, 100, 0, 100)], 200)
        with hertzline.listen(publisher.endpoint) as live:
            first, second = live
        self.assertEqual((first.samples[0], second.samples[0], len(second.t)), (0, 100, 100))
        self.assertEqual((first.epoch, second.epoch), (0, 0))
        self.assertFalse(np.shares_memory(first.samples, second.samples))

    def test_a_block_of_an_array_has_all_elements(self):
        publisher = Publisher([(0, 0, 0, 100)], 100, channels=3)
        with hertzline.listen(publisher.endpoint) as live:
            samples = next(live).samples
        self.assertEqual((samples.shape, samples[7].tolist()), ((100, 3), [7, 1007, 2007]))

    def test_gaps_raise(self):
        publisher = Publisher(GAP, 500)
        heard = []
        with hertzline.listen(publisher.endpoint) as live:
            with self.assertRaisesRegex(hertzline.GapError, "200 samples are missing before sample 400") as caught:
                for block in live:
                    heard.append(block.sample)
            heard += [block.sample for block in live]  # continues after the gap
        self.assertEqual((caught.exception.missing, heard), (200, [0, 100, 400, 450]))
        again = pickle.loads(pickle.dumps(caught.exception))  # from another process
        self.assertEqual((str(again), again.missing), (str(caught.exception), 200))

    def test_gaps_are_marked(self):
        publisher = Publisher(GAP, 500)
        with hertzline.listen(publisher.endpoint, gaps="mark") as live:
            blocks = list(live)
        found = [(block.sample, block.missing, block.epoch) for block in blocks]
        self.assertEqual(found, [(0, 0, 0), (100, 0, 0), (400, 200, 2), (450, 0, 2)])
        self.assertEqual([(block.burst, block.burst_sample) for block in blocks], [(0, 0), (0, 100), (0, 400), (0, 450)])
        totals = live.totals
        self.assertEqual((totals["missing_samples"], totals["frames_dropped_by_sender"]), (200, 1))
        self.assertEqual((totals["frames_lost_on_the_way"], totals["gapless"]), (1, False))
        self.assertIn("200 samples are missing before sample 400", live.notices[0])

    def test_a_gap_at_the_end_raises(self):
        publisher = Publisher(GAP[:2], 260)
        with hertzline.listen(publisher.endpoint) as live:
            with self.assertRaisesRegex(hertzline.GapError, "60 samples are missing before the end"):
                list(live)

    def test_silence_is_a_timeout(self):
        with hertzline.listen("tcp://127.0.0.1:9", timeout_s=0.3) as live:
            with self.assertRaisesRegex(TimeoutError, "nothing arrived from tcp://127.0.0.1:9"):
                next(live)
            with self.assertRaises(TimeoutError):  # not as if the run were over
                next(live)
            with self.assertRaisesRegex(TypeError, "neither be copied nor pickled"):
                copy.copy(live)

    def test_a_tap_that_the_run_does_not_have_is_a_value_error(self):
        publisher = Publisher([], 0)
        with hertzline.listen(publisher.endpoint, "v_plate") as live:
            with self.assertRaisesRegex(ValueError, "stream: found v_plate, allowed: v_out"):
                next(live)

    def test_another_thread_may_close(self):
        live = hertzline.listen("tcp://127.0.0.1:9")
        threading.Timer(0.3, live.close).start()
        self.assertEqual(list(live), [])

    def test_every_wrong_argument_is_told_at_once(self):
        with self.assertRaises(ValueError) as caught:
            hertzline.listen("tcp://127.0.0.1:99999", "v_ou", timeout_s=0, curve_key="mine")
        self.assertEqual(len(str(caught.exception).splitlines()), 4, caught.exception)
        with self.assertRaisesRegex(ValueError, 'gaps: found .*, allowed: "raise", "mark"'):
            hertzline.listen(gaps="ignore")


if __name__ == "__main__":
    unittest.main()
