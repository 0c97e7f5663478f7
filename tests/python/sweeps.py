"""Sweeps have the rows of `hertzline sweep`."""
import copy
import json
import math
import pickle
import unittest

import numpy as np
from support import SHORT, InAFolder, optional, program, short_scene

import hertzline

VARY = ["--vary", "end.thickness_m=1e-4..2e-3:log:5", "--vary", "end.material=pyrex,aluminium"]


def rows_of_program(*words):
    return [json.loads(line) for line in program("sweep", *SHORT, *words, "--json").splitlines()]


class Sweeps(InAFolder):
    def check_rows(self, table, rows):
        self.assertEqual(list(table.dtype.names), list(rows[0]))
        self.assertEqual(len(table), len(rows))
        for found, wanted in zip(table, rows):
            for name, value in wanted.items():
                if value is None:
                    self.assertTrue(math.isnan(found[name]), name)
                else:
                    self.assertEqual(found[name], value, name)

    def test_have_the_rows_of_the_program(self):
        rows = rows_of_program(*VARY)
        thickness = [row["end.thickness_m"] for row in rows[::2]]
        vary = {"end.thickness_m": np.array(thickness), "end.material": ["pyrex", "aluminium"]}
        for jobs in (1, 2):
            self.check_rows(hertzline.sweep(short_scene(), vary, jobs=jobs), rows)
        ranges = {"end.thickness_m": "1e-4..2e-3:log:5", "end.material": "pyrex,aluminium"}
        self.check_rows(hertzline.sweep(short_scene(), ranges, jobs=2), rows)

    def test_points_and_sobol_sequences(self):
        points = {"chain.preload_n": [0.1, 0.2, 0.3], "chain.spheres": np.array([5, 6, 7])}
        (self.folder / "points.csv").write_text("chain.preload_n,chain.spheres\n0.1,5\n0.2,6\n0.3,7\n", encoding="utf-8")
        rows = rows_of_program("--points", self.folder / "points.csv")
        self.check_rows(hertzline.sweep(short_scene(), points=points), rows)
        rows = rows_of_program("--vary", "chain.preload_n=0.01..2:log", "--sobol", "5")
        self.check_rows(hertzline.sweep(short_scene(), {"chain.preload_n": "0.01..2:log"}, sobol=5), rows)

    def test_measures_and_quantities(self):
        words = ["--vary", "chain.spheres=5,6", "--measure", "v_plate", "--quantity", "harmonics_db,v_plate.thd_r"]
        table = hertzline.sweep(short_scene(), {"chain.spheres": [5, 6]}, measure=["v_plate"],
                                quantities=["harmonics_db", "v_plate.thd_r"])
        self.check_rows(table, rows_of_program(*words))
        self.assertEqual(table.units["harmonics_db_3"], "dB")

    def test_waveforms_are_those_of_runs(self):
        table = hertzline.sweep(short_scene(), {"output.duration_s": [5e-5, 1e-4]}, waveforms="v_out")
        v = short_scene(numerics={"step_s": table["step_s"][1]}).run()["v_out"].astype(np.float32)
        self.assertEqual((table.waveforms.shape, table.waveforms.dtype), ((2, 1001), np.float32))
        self.assertTrue(np.array_equal(table.waveforms[1], v))
        self.assertTrue(np.array_equal(table.waveforms[0][:501], v[:501]))
        self.assertTrue(np.isnan(table.waveforms[0][501:]).all())

    def test_sorted_rows_keep_their_waveforms_and_are_no_grid(self):
        table = hertzline.sweep(short_scene(), {"chain.preload_n": [0.1, 0.3], "chain.spheres": [5, 4, 6]}, waveforms="v_out")
        peaks = np.abs(table.waveforms).max(axis=1)
        np.testing.assert_allclose(peaks, table["peak_v_out_m_per_s"], rtol=1e-6)
        arranged = table.copy()
        arranged.partition(3, order="peak_v_out_m_per_s")
        for found in (np.sort(table, order="peak_v_out_m_per_s"), arranged):
            self.assertFalse(found.grid)
            self.assertEqual(sorted(found["point"]), list(range(6)))
            self.assertFalse(np.array_equal(found["point"], table["point"]))
            np.testing.assert_array_equal(np.abs(found.waveforms).max(axis=1), peaks[found["point"]])
        self.assertTrue(table.grid)
        self.assertTrue((np.diff(np.sort(table, order="peak_v_out_m_per_s")["peak_v_out_m_per_s"]) >= 0).all())

    def test_parts_keep_their_waveforms(self):
        table = hertzline.sweep(short_scene(), {"chain.spheres": [3, 4, 5, 6]}, waveforms="v_out")
        for rows in (slice(1, 3), [3, 0], np.array([False, True, False, True]), table["chain.spheres"] > 4, ...):
            part = table[rows]
            self.assertEqual(len(part.waveforms), len(part))
            np.testing.assert_array_equal(part.waveforms, table.waveforms[part["point"]])
        np.testing.assert_array_equal(np.flip(table).waveforms, table.waveforms[::-1])
        np.testing.assert_array_equal(table.take([2, 1]).waveforms, table.waveforms[[2, 1]])
        np.testing.assert_array_equal(table[["point", "status"]].waveforms, table.waveforms)
        self.assertEqual(table[1]["point"], 1)

    def test_points_of_a_data_frame(self):
        pandas = optional("pandas")
        frame = pandas.DataFrame({"chain.preload_n": [0.1, 0.2], "end.material": ["pyrex", "aluminium"]})
        table = hertzline.sweep(short_scene(), points=frame)
        self.assertEqual(list(table["end.material"]), ["pyrex", "aluminium"])
        self.assertEqual(table.keys, ["chain.preload_n", "end.material"])

    def test_waveforms_of_outputs_with_several_channels(self):
        scene = hertzline.scene("seven-chains", array={"coupling": "none", "x_m": [-12e-3, 12e-3], "y_m": [0, 0]}, drive={"cycles": 1},
                                output={"duration_s": 3e-5, "points_m": [[0, 0, 0.01], [0, 0, 0.02], [0, 0.01, 0.02]]})
        for name, channels in (("v_last", 2), ("p_points", 3)):
            table = hertzline.sweep(scene, {"chain.preload_n": [0.1, 0.2]}, waveforms=name)
            self.assertEqual(table.waveforms.shape, (2, 301, channels))
            one = hertzline.scene(scene, chain={"preload_n": 0.2}, numerics={"step_s": table["step_s"][1], "poles": int(table["poles"][1])})
            np.testing.assert_array_equal(table.waveforms[1], one.run(taps=[name])[name].astype(np.float32))
        import h5py
        program("sweep", "seven-chains", "--set", "array.coupling=none", "--set", "drive.cycles=1", "--set", "output.duration_s=3e-5",
                "--vary", "chain.preload_n=0.1,0.2", "--waveforms", "v_last", "-o", self.folder / "s.h5")
        with h5py.File(self.folder / "s.h5") as file:
            self.assertEqual(file["v_last"].shape, (2, 301, 7))
            self.assertFalse(np.isnan(file["v_last"][:]).any())
        with self.assertRaisesRegex(AssertionError, "found v_last with 7 channels, allowed: an output with one"):
            program("plot", self.folder / "s.h5", "--columns", "v_last", "-o", self.folder / "s.png")

    def test_a_point_that_is_refused_is_a_row(self):
        scene = short_scene(numerics={"integrator": "leapfrog"})
        table = hertzline.sweep(scene, {"numerics.step_s": [1e-9, 1e-5]})
        self.assertEqual(list(table["status"]), ["ok", "refused"])
        self.assertIn("numerics.step_s", table["message"][1])
        self.assertTrue(np.isnan(table["peak_v_out_m_per_s"][1]))

    def test_every_fault_is_told_before_anything_runs(self):
        with self.assertRaises(ValueError) as caught:
            hertzline.sweep(short_scene(), {"chain.preload_n": "2..1:5", "chain.sphere": [1], "drive.cycles": [-1, 3]})
        self.assertEqual(len(str(caught.exception).splitlines()), 3, caught.exception)
        with self.assertRaises(ValueError) as caught:
            hertzline.sweep(short_scene(), {"drive.cycles": [3]}, jobs=0 + 2000, measure=["v_ou"], quantities=["peak"])
        self.assertEqual(len(str(caught.exception).splitlines()), 3, caught.exception)
        with self.assertRaisesRegex(ValueError, "different lengths"):
            hertzline.sweep(short_scene(), points={"drive.cycles": [1, 2], "chain.spheres": [5]})
        with self.assertRaises(ValueError):
            hertzline.sweep(short_scene())

    def test_is_an_array_with_units(self):
        table = hertzline.sweep("paper-wall", {"chain.spheres": [5, 6]}, jobs=2)
        self.assertEqual(table.units["peak_v_out_m_per_s"], "m/s")
        self.assertIs(type(table["peak_v_out_m_per_s"]), np.ndarray)
        best = table[np.argmax(table["peak_v_out_m_per_s"])]
        self.assertIn(best["chain.spheres"], (5, 6))
        part = table[table["chain.spheres"] > 5]
        self.assertEqual((len(part), part.units, part.grid), (1, table.units, False))
        self.assertEqual(table.provenance["plan"]["vary"], ["chain.spheres=5,6"])

    def test_survives_pickling_and_copying(self):
        table = hertzline.sweep(short_scene(), {"chain.preload_n": [0.1, 0.2]}, waveforms="v_last")
        for again in (pickle.loads(pickle.dumps(table)), table.copy(), copy.copy(table), copy.deepcopy(table)):
            self.assertEqual(again.tobytes(), table.tobytes())
            self.assertEqual((again.units, again.keys, again.grid), (table.units, table.keys, True))
            self.assertEqual(again.provenance, table.provenance)
            np.testing.assert_array_equal(again.waveforms, table.waveforms)
        self.assertIsNot(copy.deepcopy(table).waveforms, table.waveforms)

    def test_a_word_in_a_list_is_one_value(self):
        for values in (["wall,free"], ["wall\nfree"], ["0.1..1:3"], []):
            with self.assertRaisesRegex(ValueError, "end.kind: found"):
                hertzline.sweep(short_scene(), {"end.kind": values})
            with self.assertRaisesRegex(ValueError, "end.kind: found"):
                hertzline.sweep(short_scene(), points={"end.kind": values})

    def test_values_reach_the_plan_as_they_are(self):
        values = [0.1, 1 / 3, np.nextafter(0.2, 1)]
        for given in (values, tuple(values), np.array(values), np.array(values)[::-1][::-1]):
            table = hertzline.sweep(short_scene(), {"chain.preload_n": given}, quantities=["thd_r"])
            self.assertEqual(list(table["chain.preload_n"]), values)
        single = np.array([0.1, 0.2], dtype=np.float32)
        table = hertzline.sweep(short_scene(), {"chain.preload_n": single}, quantities=["thd_r"])
        self.assertEqual(list(table["chain.preload_n"]), single.astype(float).tolist())
        table = hertzline.sweep(short_scene(), points={"chain.preload_n": [1, 0.5], "chain.spheres": np.uint8([3, 4])})
        self.assertEqual((list(table["chain.preload_n"]), list(table["chain.spheres"])), ([1, 0.5], [3, 4]))
        self.assertEqual(table.provenance["plan"]["points"], "chain.preload_n,chain.spheres\n1,3\n0.5,4\n")

    def test_values_that_a_key_does_not_take_are_refused(self):
        for key, values, found in [("chain.spheres", [5.0, 6.0], "found 5.0, allowed: an integer"),
                                   ("chain.spheres", [2**63], "allowed: an integer"),
                                   ("chain.spheres", [5, 5], "each value once"),
                                   ("chain.preload_n", [-1.0, math.nan], "found nan"),
                                   ("chain.preload_n", ["x"], 'found "x"'),
                                   ("end.material", [1.5], "allowed: the name of a solid"),
                                   ("chain.prelod_n", [1.5], "did you mean 'chain.preload_n'")]:
            with self.assertRaisesRegex(ValueError, found):
                hertzline.sweep(short_scene(), {key: values})
        with self.assertRaises(ValueError) as caught:
            hertzline.sweep(short_scene(), {"chain.preload_n": -np.arange(1, 1000)})
        self.assertEqual(len(str(caught.exception).splitlines()), 12)
        for values in ([True], [None], [1, [2]], [b"x"], np.zeros((2, 2)), [1j]):
            with self.assertRaises((TypeError, ValueError)):
                hertzline.sweep(short_scene(), {"chain.preload_n": values})

    def test_goes_to_pandas(self):
        optional("pandas")
        table = hertzline.sweep(short_scene(), {"chain.spheres": [5, 6]})
        frame = table.to_pandas()
        self.assertEqual(list(frame["chain.spheres"]), [5, 6])
        self.assertTrue(np.array_equal(frame["peak_v_out_m_per_s"], table["peak_v_out_m_per_s"]))
        self.assertEqual(frame.attrs["units"]["step_s"], "s")

    def test_columns_of_all_names_keep_every_waveform(self):
        table = hertzline.sweep(short_scene(), {"chain.spheres": [5, 6]}, waveforms="v_out")
        self.assertTrue(np.array_equal(table[list(table.dtype.names)].waveforms, table.waveforms))

    def test_the_short_name_of_a_density_stands_for_its_column(self):
        scene = short_scene(chain={"material": "own"}, materials={"own": {"density": 7800.0, "youngs_modulus_pa": 2e11, "poissons_ratio": 0.3}})
        table = hertzline.sweep(scene, {"materials.own.density": [7000.0, 8000.0]})
        self.assertEqual(table.keys, ["materials.own.density_kg_per_m3"])
        self.assertEqual(list(table[table.keys[0]]), [7000, 8000])

    def test_lists_of_files_may_be_in_the_folder_above(self):
        with self.assertRaises(ValueError) as caught:
            hertzline.sweep(short_scene(), points={"drive.file": "../a.csv,../b.csv", "drive.cycles": [1, 2]})
        self.assertNotIn("a range", str(caught.exception))

    def test_goes_to_xarray(self):
        optional("xarray")
        vary = {"chain.preload_n": [0.3, 0.1], "end.material": ["pyrex", "aluminium"]}
        table = hertzline.sweep(short_scene(), vary, waveforms="v_out")
        data = table.to_xarray()
        self.assertEqual(dict(data.sizes), {"chain.preload_n": 2, "end.material": 2, "sample": 1001})
        found = data["peak_v_out_m_per_s"].sel({"chain.preload_n": 0.1, "end.material": "pyrex"})
        self.assertEqual(float(found), table["peak_v_out_m_per_s"][2])
        self.assertEqual(data["peak_v_out_m_per_s"].attrs["units"], "m/s")
        self.assertEqual(table[1:].to_xarray().sizes["point"], 3)
        self.assertEqual(table[1:].to_xarray()["waveforms"].shape, (3, 1001))
        few = table[["chain.preload_n", "peak_v_out_m_per_s"]].to_xarray()
        self.assertTrue(np.array_equal(few["peak_v_out_m_per_s"], table["peak_v_out_m_per_s"]))


if __name__ == "__main__":
    unittest.main()
