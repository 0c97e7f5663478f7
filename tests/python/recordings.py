"""Recordings: each format is written and read, and gaps are reported."""
import os
import pathlib
import shutil
import unittest
import warnings

import numpy as np
from support import SHORT, InAFolder, program, short_scene

import hertzline

EXACT = ["x.h5", "x.csv", "x.npy"]
SINGLE = ["x.sigmf-meta", "x.wav", "x.sigmf-collection"]  # float32


class Recordings(InAFolder):
    def test_give_back_what_was_saved(self):
        r = short_scene().run(taps=["v_out", "v_last", "v_chain", "x_chain"])
        for name in EXACT + SINGLE:
            with self.subTest(name):
                r.save(self.folder / name, wav_scale=2.0 if name.endswith("wav") else 1.0)
                loaded = hertzline.load(self.folder / name)
                self.assertEqual(loaded.sample_rate_hz, 1e7)
                self.assertTrue(np.array_equal(loaded.t, r.t))
                for tap in ("v_out", "v_last", "v_chain", "x_chain"):
                    wanted = r[tap] if name in EXACT else r[tap].astype(np.float32)
                    if not name.endswith("wav"):
                        self.assertTrue(np.array_equal(loaded[tap], wanted), tap)
                    self.assertEqual(loaded[tap].shape, r[tap].shape)
                if not name.endswith("wav"):
                    self.assertEqual((loaded.unit("v_out"), loaded.unit("x_chain")), ("m/s", "m"))
                    self.assertEqual(loaded.provenance["scene_hash"], r.summary["scene_hash"])
                self.assertEqual(loaded.gaps, [])

    def test_those_of_an_array_have_each_element_and_point(self):
        points = [[0, 0, 0.02], [1e-3, 0, 0.02]]
        scene = hertzline.scene("seven-chains", output={"duration_s": 5e-5, "points_m": points})
        r = scene.run(taps=["v_out", "p_points", "p_axis"])
        self.assertEqual((r["v_out"].shape[1], r["p_points"].shape[1], r["p_axis"].ndim), (7, 2, 1))
        for name in EXACT + ["x.sigmf-meta", "x.sigmf-collection"]:
            with self.subTest(name):
                r.save(self.folder / name)
                loaded = hertzline.load(self.folder / name)
                for tap in ("v_out", "p_points", "p_axis"):
                    self.assertTrue(np.array_equal(loaded[tap], r[tap] if name in EXACT else r[tap].astype(np.float32)), tap)
                self.assertEqual(loaded["p_2_pa"].ndim, 1)

    def test_columns_may_lie_in_any_order(self):
        rows = "t_s,v1_m_per_s,x1_m,v2_m_per_s,v3_m_per_s\n0,11,101,12,13\n1e-6,21,201,22,23\n2e-6,31,301,32,33\n"
        (self.folder / "x.csv").write_text(rows)
        loaded = hertzline.load(self.folder / "x.csv")
        self.assertEqual(loaded["v_chain"].tolist(), [[11, 12, 13], [21, 22, 23], [31, 32, 33]])
        self.assertEqual(loaded["v3_m_per_s"].tolist(), [13, 23, 33])
        self.assertEqual(loaded["x_chain"].tolist(), [[101], [201], [301]])
        with self.assertRaises(ValueError):
            loaded["v_chain"][0, 0] = 1

    def test_are_those_of_the_program(self):
        program("run", *SHORT, "-o", self.folder / "a.sigmf-meta", "-o", self.folder / "a.h5")
        r = short_scene().run()
        exact, single = hertzline.load(self.folder / "a.h5"), hertzline.load(self.folder / "a.sigmf-meta")
        self.assertEqual(exact["v_out"].tobytes(), r["v_out"].tobytes())
        self.assertTrue(np.array_equal(single["v_plate"], r["v_plate"].astype(np.float32)))
        self.assertEqual(exact.spectrum("v_out").measures, r.spectrum("v_out").measures)
        self.assertEqual(exact.taps, ["v_last", "v_plate", "v_out"])
        self.assertTrue(np.array_equal(exact["v_out_m_per_s"], exact["v_out"]))

    def test_several_at_once_with_chosen_taps(self):
        r = short_scene().run()
        r.save(self.folder / "a.csv", self.folder / "b.npy", taps=["v_out"])
        self.assertEqual(hertzline.load(self.folder / "b.npy").taps, ["v_out"])
        self.assertTrue((self.folder / "a.csv").read_text().startswith("t_s,v_out_m_per_s\n"))

    def test_names_that_are_not_utf_8_are_names(self):
        r = short_scene().run(taps=["v_out", "v_last"])
        for ending in (".npy", ".csv", ".h5", ".wav", ".sigmf-meta"):
            path = pathlib.Path(os.fsdecode(os.fsencode(self.folder) + b"/caf\xe9" + ending.encode()))
            r.save(path)
            np.testing.assert_allclose(hertzline.load(path)["v_out"], r["v_out"], rtol=1e-6, atol=1e-9)
        self.assertEqual(hertzline.scene(path)["drive.cycles"], 3)
        missing = os.fsdecode(os.fsencode(self.folder) + b"/no\xe9.npy")
        with self.assertRaisesRegex(OSError, r"cannot read .*no\?.npy: No such file"):
            hertzline.load(missing)
        with self.assertRaisesRegex(ValueError, "allowed: .csv"):
            hertzline.load(missing + ".mp3")
        integers = os.fsdecode(os.fsencode(self.folder) + b"/i\xe9.npy")
        np.save(integers, np.arange(5, dtype=np.int16))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            loaded = hertzline.load(integers, sample_rate_hz=1e6)
        self.assertEqual(len(loaded.t), 5)

    def test_columns_of_one_name_are_two(self):
        (self.folder / "scope.csv").write_text("t_s,Volt,Volt\n0,1,2\n1e-6,3,4\n")
        loaded = hertzline.load(self.folder / "scope.csv")
        self.assertEqual(loaded.taps, ["Volt", "Volt_2"])
        np.testing.assert_array_equal(loaded["Volt"], [1, 3])
        np.testing.assert_array_equal(loaded["Volt_2"], [2, 4])

    def test_gaps_are_told(self):
        path = self.folder / "x.csv"
        short_scene().run().save(path)
        lines = path.read_text().splitlines(keepends=True)
        path.write_text("".join(lines[:101] + lines[301:]))
        loaded = hertzline.load(path)
        self.assertEqual(loaded.gaps, [(100, 200)])
        self.assertAlmostEqual(loaded.t[100], 300e-7, delta=1e-12)
        self.assertEqual(len(loaded.t), 801)
        with self.assertRaisesRegex(ValueError, "found 1 gaps"):
            loaded.spectrum("v_out")

    def test_wrong_names_are_value_errors(self):
        r = short_scene().run()
        with self.assertRaises(ValueError) as caught:
            r.save(self.folder / "x.mp3", taps=["v_chain"], wav_scale=0)
        self.assertEqual(len(str(caught.exception).splitlines()), 3)
        with self.assertRaisesRegex(ValueError, "allowed: .csv"):
            hertzline.load("x.mp3")
        with self.assertRaisesRegex(KeyError, "nothing"):
            r.save(self.folder / "x.npy")
            _ = hertzline.load(self.folder / "x.npy")["nothing"]

    def test_files_that_cannot_be_used_are_os_errors(self):
        r = short_scene().run()
        for name in EXACT + SINGLE:
            with self.subTest(name):
                with self.assertRaisesRegex(OSError, "none"):
                    r.save(self.folder / "none" / name)
                with self.assertRaises(OSError):
                    hertzline.load(self.folder / "none" / name)
        (self.folder / "broken.npy").write_bytes(b"\x93NUMPY nonsense")
        with self.assertRaisesRegex(OSError, "broken.npy"):
            hertzline.load(self.folder / "broken.npy")

    def test_a_file_that_crashes_the_hdf5_library_is_an_os_error(self):
        crashes = pathlib.Path(__file__).parents[1] / "fuzz/regressions/recording_hdf5/library_crashes"
        shutil.copy(crashes, self.folder / "broken.h5")
        with self.assertRaisesRegex(OSError, "broken.h5"):
            hertzline.load(self.folder / "broken.h5")

    def test_live_beside_h5py(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("h5py is not there")
        r = short_scene().run()
        with h5py.File(self.folder / "other.h5", "w") as file:
            file["a"] = np.arange(10)
            r.save(self.folder / "x.h5")
            self.assertTrue(np.array_equal(hertzline.load(self.folder / "x.h5")["v_out"], r["v_out"]))
            file["b"] = np.arange(10)
        with h5py.File(self.folder / "x.h5") as file:
            self.assertTrue(np.array_equal(file["v_out"][:], r["v_out"]))


if __name__ == "__main__":
    unittest.main()
