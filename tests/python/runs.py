"""Runs have the bits of `hertzline run`."""
import pickle
import unittest

import numpy as np
from support import SHORT, InAFolder, program, short_scene, summary

import hertzline

CLOCK = ("setup_s", "wall_s", "real_time_factor")


class Runs(InAFolder):
    def test_have_the_bits_of_the_program(self):
        program("run", *SHORT, "--all", "--tap", "f_last", "--tap", "f_chain", "-o", self.folder / "run.npy")
        table = np.load(self.folder / "run.npy")
        r = short_scene().run(taps=["v_out", "v_last", "v_chain", "x_chain", "f_last", "f_chain"])
        self.assertEqual(r["v_out"].tobytes(), table["v_out_m_per_s"].tobytes())
        self.assertEqual(r["f_last"].tobytes(), table["f_last_n"].tobytes())
        self.assertEqual(r.t.tobytes(), table["t_s"].tobytes())
        self.assertEqual(r["v_chain"].shape, (len(table), 6))
        for sphere in range(6):
            self.assertTrue(np.array_equal(r["v_chain"][:, sphere], table[f"v{sphere + 1}_m_per_s"]))
            self.assertTrue(np.array_equal(r["x_chain"][:, sphere], table[f"x{sphere + 1}_m"]))
        self.assertEqual(r["f_chain"].shape, (len(table), 7))
        for contact in range(7):
            self.assertTrue(np.array_equal(r["f_chain"][:, contact], table[f"f{contact + 1}_n"]))
        self.assertTrue(np.array_equal(hertzline.load(self.folder / "run.npy")["f_chain"], r["f_chain"]))
        self.assertTrue(r["v_out"].any())

    def test_a_modal_plate_has_them_too(self):
        words = ["wet-vitreous-carbon", "--set", "output.duration_s=5e-5"]
        program("run", *words, "-o", self.folder / "wet.npy")
        table = np.load(self.folder / "wet.npy")
        r = hertzline.scene("wet-vitreous-carbon", output={"duration_s": 5e-5}).run()
        for tap, column in (("v_face", "v_face_m_per_s"), ("p_axis", "p_axis_pa"), ("v_centre", "v_centre_m_per_s")):
            self.assertEqual(r[tap].tobytes(), table[column].tobytes())
        self.assertEqual((r.unit("p_axis"), r.unit("v_face")), ("Pa", "m/s"))

    def test_those_of_an_array_have_each_element(self):
        words = ["seven-chains", "--set", "output.duration_s=5e-5"]
        program("run", *words, "--columns", "v_out,v_last,p_axis,v_centre", "-o", self.folder / "a.npy")
        table = np.load(self.folder / "a.npy")
        r = hertzline.scene("seven-chains", output={"duration_s": 5e-5}).run(taps=["v_out", "v_last"], measure=["v_last"])
        for result in (r, pickle.loads(pickle.dumps(r))):
            for tap in ("v_out", "v_last", "v_centre"):
                self.assertEqual(result[tap].shape, (len(table), 7))
                for element in range(7):
                    self.assertTrue(np.array_equal(result[tap][:, element], table[f"{tap}_{element + 1}_m_per_s"]))
            self.assertTrue(np.array_equal(result["p_axis"], table["p_axis_pa"]))
        r.save(self.folder / "b.npy", taps=["v_out"])
        self.assertTrue(np.array_equal(np.load(self.folder / "b.npy")["v_out_7_m_per_s"], table["v_out_7_m_per_s"]))

    def test_files_of_a_result_are_its_own(self):
        r = short_scene().run()
        for first, second in (("a.csv", "a.csv"), ("a.sigmf-meta", "a.sigmf-data"),
                              ("a.sigmf-collection", "a-v_last_m_per_s.sigmf-meta")):
            with self.assertRaisesRegex(ValueError, "allowed: each file once"):
                r.save(self.folder / first, self.folder / second)

    def test_the_summary_is_the_programs(self):
        said = summary("run", *SHORT, "--measure", "v_plate")
        run = short_scene().run(measure=["v_plate"])
        found = run.summary
        said.pop("recordings")
        self.assertEqual(said.pop("warnings"), run.warnings)
        self.assertEqual(list(found), list(said))
        for name in CLOCK:
            self.assertGreater(found.pop(name), 0)
            said.pop(name)
        self.assertEqual(found, said)

    def test_warnings_are_the_programs(self):
        r = hertzline.scene("paper-vitreous-carbon", output={"duration_s": 1e-4}).run()
        self.assertTrue(any("output.duration_s" in warning for warning in r.warnings), r.warnings)
        gentle = hertzline.scene("paper-wall", drive={"amplitude_m": 1e-8}, chain={"preload_n": 1e-3})
        self.assertEqual(gentle.run().warnings, [])

    def test_a_spectrum_is_the_programs(self):
        program("run", *SHORT, "--spectrum", self.folder / "lines.csv")
        lines = np.loadtxt(self.folder / "lines.csv", delimiter=",", skiprows=1)
        r = short_scene().run()
        spectrum = r.spectrum("v_out")
        self.assertTrue(np.array_equal(spectrum.frequency_hz, lines[:, 0]))
        self.assertTrue(np.array_equal(spectrum.amplitude, lines[:, 1]))
        self.assertEqual(spectrum.measures["harmonics_db"], r.summary["harmonics_db"])

    def test_one_channel_has_the_name_of_its_column(self):
        r = short_scene().run(taps=["v_chain", "x_chain"])
        self.assertTrue(np.array_equal(r["v3_m_per_s"], r["v_chain"][:, 2]))
        self.assertTrue(np.array_equal(r["x6_m"], r["x_chain"][:, 5]))
        self.assertEqual((r.unit("x6_m"), r.unit("v3_m_per_s")), ("m", "m/s"))
        self.assertTrue(np.shares_memory(r["v3_m_per_s"], r["v_chain"]))
        r.save(self.folder / "a.h5")
        lines = hertzline.load(self.folder / "a.h5").spectrum("v3_m_per_s")
        self.assertTrue(np.array_equal(r.spectrum("v3_m_per_s").amplitude, lines.amplitude))
        for name in ("v0_m_per_s", "v7_m_per_s", "v_last_m_per_s"):
            with self.assertRaises(KeyError):
                _ = r[name]
        with self.assertRaisesRegex(ValueError, "found samples of several channels, allowed: one, as \"v3_m_per_s\" of v_chain"):
            r.spectrum("v_chain")

    def test_a_wav_that_its_full_scale_does_not_fit_is_told(self):
        r = short_scene().run()
        with self.assertWarnsRegex(UserWarning, "recording .*a.wav: .* beyond the full scale of 0.1"):
            r.save(self.folder / "a.wav", wav_scale=0.1)
        with self.assertWarnsRegex(UserWarning, "too little for float32 at a full scale of 1e\\+300"):
            r.save(self.folder / "b.wav", wav_scale=1e300)

    def test_a_file_is_the_programs(self):
        r = short_scene().run()
        program("run", *SHORT, "-o", self.folder / "a.csv")
        r.save(self.folder / "b.csv")
        self.assertEqual((self.folder / "a.csv").read_bytes(), (self.folder / "b.csv").read_bytes())

    def test_every_wrong_argument_is_told_at_once(self):
        with self.assertRaises(ValueError) as caught:
            short_scene().run(taps=["v_ou", "v_face"], measure=["v_chain"], band_from_hz=-1)
        self.assertEqual(len(str(caught.exception).splitlines()), 4)
        self.assertIn("""taps: found "v_ou", allowed: v_out, """, str(caught.exception))
        with self.assertRaisesRegex(TypeError, "^taps: found 1, allowed: text in each place of the list$"):
            short_scene().run(taps=["v_out", 1])
        with self.assertRaisesRegex(ValueError, r"\\ud800"):  # half a surrogate pair
            short_scene().run(taps=["\ud800"])
        with self.assertRaisesRegex(TypeError, r'allowed: a list of names, as \["v_out"\]'):
            short_scene().run(taps="v_out")

    def test_what_was_not_kept_is_a_key_error(self):
        with self.assertRaisesRegex(KeyError, "v_chain"):
            _ = short_scene().run()["v_chain"]

    def test_a_motion_that_becomes_unstable_is_a_runtime_error(self):
        # later bursts are stronger than those of the pilots; the moment of the failure depends on the instruction set
        scene = hertzline.scene(
            "paper-stream",
            drive={"amplitude_m": 1.05e-3},
            numerics={"integrator": "leapfrog", "step_s": 2.3e-7},
            output={"duration_s": 0.5, "sample_rate_hz": 2e6},
        )
        with self.assertRaisesRegex(RuntimeError, "stability limit"):
            scene.run()

    def test_too_long_a_record_is_refused(self):
        with self.assertRaisesRegex(ValueError, "output.duration_s: found .* samples, allowed: at most"):
            short_scene(output={"duration_s": 1e5}).run()


if __name__ == "__main__":
    unittest.main()
