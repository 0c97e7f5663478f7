"""A simulation that is stepped has the samples of a run; materials, pickles, control of a live stream."""
import copy
import pickle
import subprocess
import unittest

import numpy as np
from support import PROGRAM, InAFolder, program, short_scene

import hertzline


class Steps(unittest.TestCase):
    def test_give_the_samples_of_a_run_whatever_their_length(self):
        s = short_scene()
        run = s.run(taps=["v_out", "v_chain"])
        simulation = hertzline.Simulation(s, taps=["v_out", "v_chain"])
        parts = [simulation.advance(count) for count in (1, 7, 500, 493)]
        self.assertEqual(np.concatenate([part["v_out"] for part in parts]).tobytes(), run["v_out"][:1001].tobytes())
        self.assertTrue(np.array_equal(np.concatenate([part["v_chain"] for part in parts]), run["v_chain"][:1001]))
        self.assertEqual(simulation.sample, 1001)
        self.assertAlmostEqual(simulation.t, 1001 / run.sample_rate_hz)
        self.assertGreater(simulation.steps, 0)
        self.assertEqual(simulation.step_s, run.summary["step_s"])
        self.assertLess(simulation.energy_residual, 1e-2)

    def test_go_beyond_the_runs_end_and_back_to_the_start(self):
        s = short_scene()
        simulation = hertzline.Simulation(s, taps=["v_out"])
        first = simulation.advance(5000)["v_out"]
        simulation.reset()
        self.assertEqual(simulation.sample, 0)
        self.assertEqual(simulation.advance(5000)["v_out"].tobytes(), first.tobytes())

    def test_wrong_arguments_are_refused(self):
        with self.assertRaisesRegex(ValueError, "taps: found .*allowed"):
            hertzline.Simulation("paper-wall", taps=["v_plate"])
        with self.assertRaisesRegex(ValueError, "samples: found 0, allowed: at least 1"):
            hertzline.Simulation("paper-wall").advance(0)

    def test_cannot_be_copied(self):
        simulation = hertzline.Simulation("paper-wall")
        for copied in (copy.copy, copy.deepcopy, pickle.dumps):
            with self.assertRaisesRegex(TypeError, "neither be copied nor pickled"):
                copied(simulation)


class Materials(unittest.TestCase):
    def test_are_the_programs(self):
        import json

        listed = {material.pop("name"): material for material in json.loads(program("materials", "--json"))}
        self.assertEqual(hertzline.materials(), listed)
        self.assertEqual(hertzline.materials()["water"]["sort"], "fluid")


class Pickles(InAFolder):
    def test_a_run_comes_back_whole(self):
        run = short_scene().run(taps=["v_out", "v_chain"])
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            self.assertEqual(pickle.loads(pickle.dumps(run, protocol))["v_chain"].tobytes(), run["v_chain"].tobytes())
        again = pickle.loads(pickle.dumps(run))
        self.assertEqual(again["v_chain"].tobytes(), run["v_chain"].tobytes())
        self.assertEqual((again.taps, again.summary, again.warnings), (run.taps, run.summary, run.warnings))
        self.assertEqual(again.provenance, run.provenance)
        again.save(self.folder / "again.npy")
        run.save(self.folder / "run.npy")
        self.assertEqual((self.folder / "again.npy").read_bytes(), (self.folder / "run.npy").read_bytes())

    def test_a_recording_comes_back_whole(self):
        short_scene().run(taps=["v_out", "v_chain"]).save(self.folder / "run.h5")
        recording = hertzline.load(self.folder / "run.h5")
        self.assertEqual(pickle.loads(pickle.dumps(recording, 0))["v_chain"].tobytes(), recording["v_chain"].tobytes())
        again = pickle.loads(pickle.dumps(recording))
        self.assertEqual(again["v_chain"].tobytes(), recording["v_chain"].tobytes())
        self.assertEqual((again.columns, again.gaps), (recording.columns, recording.gaps))
        self.assertEqual(again.provenance, recording.provenance)
        self.assertEqual(again.t.tobytes(), recording.t.tobytes())


class Control(unittest.TestCase):
    def setUp(self):
        self.stream = subprocess.Popen(
            [PROGRAM, "stream", "paper-stream", "--bind", "tcp://127.0.0.1:*", "--control", "tcp://127.0.0.1:*",
             "--pace", "0.01"], stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end)
        self.endpoint = next(line.split()[-1] for line in self.stream.stderr if line.startswith("info: control"))

    def end(self):
        self.stream.terminate()
        self.stream.communicate()

    def test_reads_changes_and_undoes(self):
        live = hertzline.control(self.endpoint)
        before = live["drive.amplitude_m"]
        reply = live.set({"drive.amplitude_m": 2 * before})
        self.assertEqual(reply["epoch"], 1)
        self.assertEqual(live["drive.amplitude_m"], 2 * before)
        live.undo()
        self.assertEqual(live["drive.amplitude_m"], before)
        self.assertEqual(live.get("drive.amplitude_m")["drive.amplitude_m"]["unit"], "m")

    def test_a_wrong_value_is_a_value_error_and_changes_nothing(self):
        live = hertzline.control(self.endpoint)
        before = live["drive.amplitude_m"]
        with self.assertRaisesRegex(ValueError, "drive.amplitude_m: found .*allowed"):
            live["drive.amplitude_m"] = -1
        self.assertEqual(live["drive.amplitude_m"], before)

    def test_no_reply_is_an_os_error(self):
        with self.assertRaises(OSError):
            hertzline.control("tcp://127.0.0.1:9", timeout_s=0.2).get()


if __name__ == "__main__":
    unittest.main()
