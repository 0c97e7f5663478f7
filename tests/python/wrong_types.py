"""An argument of a wrong type is refused by its name, with the type that was found and what is allowed."""
import threading
import time
import unittest

import numpy as np
from support import InAFolder, short_scene

import hertzline


class WrongTypes(InAFolder):
    @classmethod
    def setUpClass(cls):
        cls.scene = short_scene()
        cls.result = cls.scene.run(taps=["v_out", "v_chain"])

    def check(self, error, message, call):
        with self.assertRaises(error) as caught:
            call()
        self.assertRegex(str(caught.exception), message)
        self.assertNotIn("incompatible function arguments", str(caught.exception))

    def test_name_the_argument(self):
        s, r, vary = self.scene, self.result, {"chain.spheres": [5, 6]}
        simulation = hertzline.Simulation(s)
        number, integer, text = "allowed: a number$", "allowed: an integer$", "allowed: a text$"
        for message, call in (
            (f"^band_from_hz: found str '10 kHz', {number}", lambda: s.run(band_from_hz="10 kHz")),
            (f"^band_from_hz: found bool True, {number}", lambda: s.run(band_from_hz=True)),
            (f"^band_from_hz: found list .*{number}", lambda: r.spectrum("v_out", band_from_hz=[])),
            (f"^wav_scale: found str '2', {number}", lambda: r.save("x.wav", wav_scale="2")),
            (f"^sample_rate_hz: .*{number}", lambda: hertzline.load("x.npy", sample_rate_hz="3")),
            (f"^jobs: found float 2.0, {integer}", lambda: hertzline.sweep(s, vary, jobs=2.0)),
            (f"^sobol: .*{integer}", lambda: hertzline.sweep(s, vary, sobol=2.0)),
            (f"^waveforms: found list .*{text}", lambda: hertzline.sweep(s, vary, waveforms=["v_out"])),
            ("^vary: found int 3, allowed: texts as keys", lambda: hertzline.sweep(s, {3: [1]})),
            ("^points: found list .*allowed: a dict", lambda: hertzline.sweep(s, points=[{"chain.spheres": 5}])),
            (f"^maximise: .*{text}", lambda: hertzline.optimise(s, vary, maximise=3)),
            (f"^evaluations: .*{integer}", lambda: hertzline.optimise(s, vary, maximise="thd_r", evaluations=1e3)),
            (f"^seed: .*{integer}", lambda: hertzline.optimise(s, vary, maximise="thd_r", seed=1.0)),
            (f"^samples: .*{integer}", lambda: simulation.advance(2.0)),
            (f"^endpoint: .*{text}", lambda: hertzline.listen(self.folder)),
            (f"^timeout_s: .*{number}", lambda: hertzline.listen(timeout_s="3")),
            (f"^timeout_s: .*{number}", lambda: hertzline.control(timeout_s="1")),
            ("^values: found list", lambda: hertzline.control().set([])),
            ("^taps: found int 3, allowed: a list of names", lambda: s.run(taps=3)),
            ("^chain: found int 3, allowed: texts as keys", lambda: hertzline.scene(chain={3: 6})),
            (f"^name: .*{text}", lambda: r[3]),
            (f"^key: .*{text}", lambda: s[3]),
            ("not iterable", lambda: list(r)),
            ("not iterable", lambda: list(s)),
        ):
            with self.subTest(message=message):
                self.check(TypeError, message, call)

    def test_numbers_of_numpy_are_numbers(self):
        self.assertEqual(self.scene.run(band_from_hz=np.float32(1000)).summary["bandwidth_20db_hz"],
                         self.scene.run(band_from_hz=np.array(1000)).summary["bandwidth_20db_hz"])
        self.assertEqual(len(hertzline.sweep(self.scene, {"chain.spheres": "5..6"}, sobol=np.int8(2), jobs=np.uint16(1))), 2)

    def test_numbers_beyond_those_of_the_native_part_are_told(self):
        self.check(ValueError, "^jobs: found 1000000000000, allowed: at most", lambda: hertzline.sweep(self.scene, {"chain.spheres": [5]}, jobs=10**12))
        self.check(ValueError, "^samples: found 9223372036854775808, ", lambda: hertzline.Simulation(self.scene).advance(2**63))
        self.check(ValueError, "^sobol: found -1, allowed: at least 1", lambda: hertzline.sweep(self.scene, {"chain.spheres": "5..6"}, sobol=-1))
        self.check(ValueError, "^band_from_hz: found -1, ", lambda: self.result.spectrum("v_out", band_from_hz=-1))

    def test_names_of_files_without_null_characters(self):
        for call in (lambda: self.result.save(self.folder / "a\0.npy"), lambda: hertzline.load("a\0.npy"), lambda: hertzline.scene("a\0")):
            self.check(ValueError, r"found the file name '.*a\\x00.*', allowed: ", call)
        self.assertEqual(list(self.folder.iterdir()), [])
        self.check(ValueError, "found the file name '', allowed: ", lambda: hertzline.scene(""))

    def test_names_that_are_not_there(self):
        self.check(KeyError, "end.thickness.*allowed: a key of the scene, as end.thickness_m", lambda: self.scene["end.thickness"])
        self.check(KeyError, "nope.*allowed: v_out, v_chain|allowed: .*v_out", lambda: self.result["nope"])
        self.assertIn("end.thickness_m", self.scene)
        self.assertNotIn("end.thickness", self.scene)
        self.result.save(self.folder / "a.h5")
        recording = hertzline.load(self.folder / "a.h5")
        self.check(KeyError, "nope.*allowed: v_out, v_chain", lambda: recording["nope"])
        self.check(KeyError, "nope.*allowed: v_out", lambda: recording.unit("nope"))
        for samples in (self.result, recording):
            self.assertIn("v3_m_per_s", samples)
            self.assertNotIn("v7_m_per_s", samples)
            self.assertNotIn(3, samples)
        table = hertzline.sweep(self.scene, {"chain.spheres": [5]})
        self.check(KeyError, "found .*nope.*, allowed: point, chain.spheres, ", lambda: table["nope"])
        self.check(ValueError, "^quantities: found nope, allowed: ", lambda: table.plot(["nope"]))


class OneThreadAtATime(unittest.TestCase):
    def test_another_one_is_refused(self):
        scene = hertzline.scene("paper-stream", output={"sample_rate_hz": 1e5})
        simulation = hertzline.Simulation(scene, taps=["v_out"])
        found = []
        thread = threading.Thread(target=lambda: found.append(simulation.advance(300_000)["v_out"]))
        thread.start()
        message = "another thread uses this simulation, allowed: one at a time"
        with self.assertRaisesRegex(RuntimeError, message):
            while thread.is_alive():
                _ = simulation.sample  # until the other thread has begun
                time.sleep(0.001)
        for disturb in (simulation.reset, lambda: simulation.advance(10), lambda: simulation.steps):
            with self.assertRaisesRegex(RuntimeError, message):
                disturb()
        thread.join()
        self.assertEqual(simulation.sample, 300_000)
        alone = hertzline.Simulation(scene, taps=["v_out"])
        self.assertEqual(found[0].tobytes(), alone.advance(300_000)["v_out"].tobytes())


if __name__ == "__main__":
    unittest.main()
