"""Reads what other programs have written, and has them read what this project writes: to the last bit where they keep it."""

import pathlib
import subprocess
import sys
import tempfile
import unittest
import warnings

import foreign
import numpy as np

import hertzline

warnings.simplefilter("ignore")


def columns(recording):
    return np.column_stack([recording[name] for name, _, _ in recording.columns])


class ForeignFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def check(self, case, recording, rate):
        self.assertEqual(recording.sample_rate_hz, rate)
        name = "v_out" if case.file.suffix == ".h5" else None
        got = recording[name] if name else columns(recording)
        wanted = np.asarray(case.values, float).reshape(got.shape)
        if case.exact:
            self.assertTrue(np.array_equal(got, wanted), f"off by {np.max(np.abs(got - wanted))}")
        else:
            self.assertLess(np.max(np.abs(got - wanted)), 2**-14)
        if rate > 0 and case.first:
            self.assertEqual(recording.t[0], case.first / rate)
        self.assertEqual(recording.gaps, [])

    def test_are_read(self):
        cases = foreign.write_all(self.folder)
        for case in cases:
            with self.subTest(f"{case.file.parent.name}/{case.file.name}"):
                self.check(case, hertzline.load(case.file), case.rate)
                self.check(case, hertzline.load(case.file, sample_rate_hz=12345), 12345)
        print(f"{len(cases)} files")
        for name, package in foreign.missing.items():
            print(f"left out: {name} is not there (Debian: {package})")

    def test_without_a_rate_have_no_time(self):
        file = self.folder / "a.npy"
        np.save(file, np.ones(10))
        with self.assertRaisesRegex(ValueError, "sample_rate_hz"):
            hertzline.load(file).t
        with self.assertRaisesRegex(ValueError, "more than 0"):
            hertzline.load(file, sample_rate_hz=0)
        self.assertEqual(hertzline.load(file, sample_rate_hz=10).t[1], 0.1)

    def test_warn_of_what_is_left_out(self):
        file = self.folder / "a.csv"
        file.write_text("t_s,v\n0,1\n1,2\n2,3")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.assertEqual(len(hertzline.load(file)["v"]), 2)
        self.assertIn("a.csv:4: left out", str(caught[0].message))

    def test_own_npy_survives_numpy(self):
        run = hertzline.scene("paper-vitreous-carbon", drive={"cycles": 3}, output={"duration_s": 1e-4}).run()
        run.save(self.folder / "a.npy")
        np.save(self.folder / "b.npy", np.load(self.folder / "a.npy"))
        again = hertzline.load(self.folder / "b.npy")
        self.assertEqual(again.sample_rate_hz, 1e7)
        self.assertTrue(np.array_equal(again["v_out"], run["v_out"]))

    def test_own_wav_is_read_by_others(self):
        run = hertzline.scene("paper-vitreous-carbon", drive={"cycles": 3}, output={"duration_s": 1e-4}).run()
        file = self.folder / "a.wav"
        run.save(file)
        wanted = np.column_stack([run[quantity] for _, quantity, _ in hertzline.load(file).columns]).astype("f4")
        for name, package in (("soundfile", "python3-soundfile"), ("scipy.io.wavfile", "python3-scipy")):
            reader = foreign.module(name, package)
            if reader is not None:
                a, b = reader.read(str(file), **({"dtype": "float32"} if name == "soundfile" else {}))
                samples = a if name == "soundfile" else b
                self.assertTrue(np.array_equal(samples.reshape(wanted.shape), wanted), name)
        if foreign.tool("sox"):
            raw = subprocess.run(["sox", file, "-t", "raw", "-e", "floating-point", "-b", "32", "-"], check=True, capture_output=True)
            self.assertLess(np.max(np.abs(np.frombuffer(raw.stdout, "<f4").reshape(wanted.shape) - wanted)), 1e-7)  # by way of 32-bit integers
        if foreign.tool("ffmpeg"):
            raw = subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-f", "f32le", "-"], check=True, capture_output=True)
            self.assertEqual(raw.stdout, wanted.tobytes())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
