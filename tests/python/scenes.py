"""Scenes: their sources, their contents, and every fault at once."""
import array
import copy
import json
import pickle
import unittest

import numpy as np
from support import SHORT, InAFolder, optional, program, short_scene, summary

import hertzline


class Scenes(InAFolder):
    def test_are_those_of_the_program(self):
        self.assertIn("paper-vitreous-carbon", hertzline.scenes())
        for name in hertzline.scenes():
            self.assertEqual(hertzline.scene(name).name, name)

    def test_a_key_is_changed_to_the_last_bit(self):
        for value in (0.4e-3, 1 / 3000, np.float64(0.1) / 137, np.float32(1e-3)):
            scene = hertzline.scene("paper-vitreous-carbon", end={"thickness_m": value})
            self.assertEqual(scene["end.thickness_m"], float(value))
        self.assertEqual(hertzline.scene("paper-wall", chain={"spheres": np.int32(9)})["chain.spheres"], 9)
        self.assertEqual(hertzline.scene("paper-wall", drive={"envelope": "tukey"})["drive.envelope"], "tukey")

    def test_lists_are_python_lists_tuples_or_arrays(self):
        materials = ["aluminium", "acrylic"]
        thicknesses = [1 / 7000, 0.5e-3]
        for given in (thicknesses, tuple(thicknesses), np.array(thicknesses)):
            scene = hertzline.scene("paper-wall", end={"kind": "plate", "materials": np.array(materials), "thicknesses_m": given})
            self.assertEqual((scene["end.materials"], scene["end.thicknesses_m"]), (materials, thicknesses))
            self.assertEqual((scene["end.thicknesses_m[1]"], scene.values["end"]["loss_factors"]), (1 / 7000, None))
        for none in ([], (), np.array([]), "[]"):
            self.assertIsNone(hertzline.scene("seven-chains", array={"focus_m": none})["array.focus_m"])
        thicker = hertzline.scene(scene, end={"thicknesses_m[2]": "0.6 mm", "loss_factors": (0.01, 0.02)})
        self.assertEqual(list(thicker["end.thicknesses_m"]), [1 / 7000, 0.6e-3])
        for key in ("end.thicknesses_m[0]", "end.thicknesses_m[3]", "end.radius_m[1]", "end.thicknesses_m[2", "end.thicknesses_m[1][1]"):
            with self.assertRaises(KeyError):
                scene[key]
        for wrong, message in ((np.zeros(17), r"end.thicknesses_m: found 17 entries"), ([1e-3, -1], r"end.thicknesses_m\[2\]: found -1"),
                               ([1e-3, [1]], r"end.thicknesses_m\[2\]: found an array"),
                               (np.zeros((2, 2)), r"found an array"), ([1e-3, float("nan")], r"\[2\]: found nan"),
                               ([1e-3, True], r"\[2\]: found true"), (np.zeros(2_000_000), "allowed: at most 1000000")):
            with self.assertRaisesRegex(ValueError, message):
                hertzline.scene(scene, end={"thicknesses_m": wrong})
        with self.assertRaisesRegex(TypeError, r"end.thicknesses_m\[2\]: found NoneType"):
            hertzline.scene(scene, end={"thicknesses_m": [1e-3, None]})

    def test_a_record_drives_the_horn_from_a_file_or_an_array(self):
        t = np.arange(2001) / 10e6
        x = 3e-6 * np.exp(-((t - 100e-6) / 20e-6) ** 2 / 2) * np.sin(2 * np.pi * 70e3 * t)
        np.savetxt(self.folder / "horn.csv", np.column_stack([t, x]), delimiter=",", header="t_s,x_um", comments="")
        (self.folder / "device.toml").write_text("[drive]\nkind = 'file'\nfile = 'horn.csv'\n[output]\nduration_s = 1e-4\n")
        with self.assertRaisesRegex(ValueError, "drive.file: found \"none.csv\", which is no file"):
            hertzline.scene("paper-wall", drive={"kind": "file", "file": "none.csv"})
        np.savetxt(self.folder / "horn.csv", np.column_stack([t, 1e6 * x]), delimiter=",", header="t_s,x_um", comments="")
        (self.folder / "horn 😀 é.csv").write_bytes((self.folder / "horn.csv").read_bytes())
        smiling = hertzline.scene("paper-wall", drive={"kind": "file", "file": str(self.folder / "horn 😀 é.csv")})
        self.assertEqual(smiling["drive.scale"], 1e-6)
        scene = hertzline.scene(self.folder / "device.toml")
        self.assertEqual((scene["drive.scale"], scene["drive.quantity"], scene["drive.file"]), (1e-6, "displacement", None))
        self.assertLess(abs(scene["drive.frequency_hz"] / 70e3 - 1), 0.02)
        (self.folder / "horn.csv").unlink()
        self.assertEqual(pickle.loads(pickle.dumps(scene)), scene)
        v = scene.run(taps=["v_last", "x_horn"])
        array = hertzline.scene("paper-vitreous-carbon", drive={"kind": "file", "samples": x, "sample_rate_hz": 10e6},
                                output={"duration_s": 1e-4})
        again = array.run(taps=["v_last", "x_horn"])
        self.assertLess(np.abs(again["x_horn"] - x[:1001]).max(), 1e-13)
        self.assertLess(np.linalg.norm(again["v_last"] - v["v_last"]), 1e-6 * np.linalg.norm(v["v_last"]))

    def test_another_record_takes_the_place_of_the_first_one(self):
        t = np.arange(2001) / 10e6
        x = 3e-6 * np.exp(-((t - 100e-6) / 20e-6) ** 2 / 2) * np.sin(2 * np.pi * 70e3 * t)
        np.savetxt(self.folder / "um.csv", np.column_stack([t, 1e6 * x]), delimiter=",", header="t_s,x_um", comments="")
        np.savetxt(self.folder / "m.csv", np.column_stack([2 * t, x]), delimiter=",", header="t_s,x_m", comments="")
        one, other = ({"kind": "file", "file": self.folder / name} for name in ("um.csv", "m.csv"))
        first = hertzline.scene("paper-wall", drive=one)
        for drive in (other, {"file": self.folder / "m.csv"}):
            second = hertzline.scene(first, drive=drive)
            self.assertEqual(second, hertzline.scene("paper-wall", drive=other))
            self.assertEqual(second["drive.sample_rate_hz"], 5e6)
        self.assertEqual(hertzline.scene(first, drive={"file": None}), first)

    def test_a_record_is_read_as_the_scene_says_that_waits_for_it(self):
        x = 3 * np.sin(2 * np.pi * 50e3 * np.arange(2001) / 10e6) ** 3
        np.savetxt(self.folder / "horn.csv", x, header="x", comments="")
        waits = hertzline.scene("paper-wall", drive={"kind": "file", "scale": 1e-6, "sample_rate_hz": 10e6, "frequency_hz": 80e3})
        read = hertzline.scene(waits, drive={"file": self.folder / "horn.csv"})
        self.assertEqual((read["drive.scale"], read["drive.sample_rate_hz"], read["drive.frequency_hz"]), (1e-6, 10e6, 80e3))

    def test_lists_may_be_columns_of_other_packages(self):
        t = np.arange(200) / 10e6
        x = 1e-6 * np.sin(2 * np.pi * 70e3 * t)
        wanted = hertzline.scene("paper-wall", drive={"kind": "file", "samples": x, "sample_rate_hz": 10e6})
        for given in (list(x), memoryview(x), array.array("d", x), optional("pandas").Series(x), optional("xarray").DataArray(x)):
            self.assertEqual(hertzline.scene("paper-wall", drive={"kind": "file", "samples": given, "sample_rate_hz": 10e6}), wanted)

    def test_a_recording_has_the_scene_that_was_asked_for(self):
        scene = hertzline.scene(short_scene(), numerics={"accuracy": 1e-3})
        file = self.folder / "r.h5"
        scene.run().save(file)
        self.assertEqual(hertzline.scene(file), scene)
        self.assertEqual(hertzline.scene(file, drive={"cycles": 4}), hertzline.scene(scene, drive={"cycles": 4}))
        with self.assertRaisesRegex(ValueError, "drive.cycles: found -1, allowed: "):
            hertzline.scene(file, drive={"cycles": -1})
        np.save(self.folder / "other.npy", np.zeros(20))
        with self.assertRaisesRegex(ValueError, "other.npy: found no scene in this recording, allowed: scenes, and recordings of hertzline"):
            hertzline.scene(self.folder / "other.npy")

    def test_an_entry_of_a_list_varies(self):
        scene = hertzline.scene(short_scene(), end={"kind": "plate", "materials": ["aluminium", "acrylic"], "thicknesses_m": [2e-4, 5e-4]})
        table = hertzline.sweep(scene, {"end.thicknesses_m[2]": [4e-4, 5e-4], "end.materials[1]": ["steel", "aluminium"]})
        self.assertEqual(list(table["end.thicknesses_m[2]"]), [4e-4, 4e-4, 5e-4, 5e-4])
        run = hertzline.scene(scene, numerics={"step_s": table["step_s"][3]}).run()
        self.assertEqual(run.summary["peak_v_out_m_per_s"], table["peak_v_out_m_per_s"][3])
        with self.assertRaisesRegex(ValueError, "end.materials: found a list, allowed: an entry of it, as end.materials"):
            hertzline.sweep(scene, {"end.materials": ["steel"]})

    def test_a_text_is_a_number_with_its_unit(self):
        scene = hertzline.scene("paper-wall", end={"thickness_m": "0.4 mm"}, drive={"amplitude_m": "2 \u00b5m", "frequency_hz": "60kHz"},
                                materials={"clay": {"youngs_modulus_pa": "5 GPa", "poissons_ratio": 0.3, "density_kg_per_m3": "1.9 g/cm^3"}})
        self.assertEqual((scene["end.thickness_m"], scene["drive.amplitude_m"], scene["drive.frequency_hz"]), (0.4e-3, 2e-6, 60e3))
        self.assertEqual(scene["materials.clay.density_kg_per_m3"], 1900)
        with self.assertRaisesRegex(ValueError, r"found \"1 N\", allowed: a number from 1e-09 to 10 m \(m, with any prefix, as um or mm\)"):
            hertzline.scene("paper-wall", end={"thickness_m": "1 N"})
        table = hertzline.sweep(short_scene(), {"chain.preload_n": ["100 mN", "1 N"]})
        self.assertEqual(list(table["chain.preload_n"]), [0.1, 1])

    def test_materials_of_the_scenes_own(self):
        clay = {"youngs_modulus_pa": 5e9, "poissons_ratio": 0.3, "density_kg_per_m3": 1900}
        scene = hertzline.scene("paper-pyrex", materials={"clay": clay}, end={"material": "clay"})
        self.assertEqual(scene["materials.clay.density_kg_per_m3"], 1900)

    def test_a_file_and_a_scene_can_be_the_source(self):
        path = self.folder / "mine.toml"
        path.write_text("chain.spheres = 4\n", encoding="utf-8")
        scene = hertzline.scene(path, drive={"cycles": 5})
        self.assertEqual((scene["chain.spheres"], scene["drive.cycles"]), (4, 5))
        self.assertEqual(hertzline.scene(scene, drive={"cycles": 6})["chain.spheres"], 4)

    def test_every_fault_is_told_at_once(self):
        with self.assertRaises(ValueError) as caught:
            hertzline.scene("paper-wall", chain={"spheres": 0, "sphere": 3}, drive={"frequency_hz": -1})
        lines = str(caught.exception).splitlines()
        self.assertEqual(len(lines), 3)
        self.assertIn("chain.spheres: found 0, allowed: an integer from 1 to", str(caught.exception))
        self.assertIn("did you mean 'chain.spheres'?", str(caught.exception))
        self.assertNotIn("--set", str(caught.exception))

    def test_faults_of_a_file_name_their_lines(self):
        path = self.folder / "mine.toml"
        path.write_text("[chain]\nspheres = 0\n", encoding="utf-8")
        with self.assertRaisesRegex(ValueError, "mine.toml:2: chain.spheres: found 0"):
            hertzline.scene(path)

    def test_an_unknown_name_is_told_what_there_is(self):
        with self.assertRaisesRegex(ValueError, "paper-wal: found no such file or shipped scene.*did you mean 'paper-wall'"):
            hertzline.scene("paper-wal")

    def test_wrong_types_are_type_errors(self):
        for wrong in ({"chain": 5}, {"chain": {"spheres": [object()]}}):
            with self.assertRaisesRegex(TypeError, "allowed: "):
                hertzline.scene("paper-wall", **wrong)
        for masked in (np.ma.masked, np.ma.array([1e-3, 2e-3], mask=[0, 1])):
            with self.assertRaisesRegex(TypeError, "found a masked array"):
                hertzline.scene("paper-wall", chain={"diameters_m": masked})
            with self.assertRaisesRegex(TypeError, "found a masked array"):
                hertzline.sweep(hertzline.scene("paper-wall"), {"chain.preload_n": masked})
        with self.assertRaisesRegex(ValueError, "chain.spheres: found an array, allowed: an integer"):
            hertzline.scene("paper-wall", chain={"spheres": [1, 2]})
        with self.assertRaisesRegex(ValueError, "chain.diameters_m: found .*, allowed: "):
            hertzline.scene("paper-wall", chain={"diameters_m": {}})

    def test_check_says_what_the_program_says(self):
        said = json.loads(program("check", *SHORT, "--json"))
        found = short_scene().check()
        self.assertRegex(found.pop("warnings")[0], "contacts press harder than their materials bear: .*aluminium yields")
        self.assertEqual(found, {key: said[key] for key in found})
        self.assertGreater(len(found), 30)
        warnings = hertzline.scene("paper-vitreous-carbon", output={"duration_s": 2e-6}).check()["warnings"]
        self.assertTrue(any("the wave needs about" in warning for warning in warnings), warnings)

    def test_a_live_scene_is_checked_and_not_run(self):
        said = json.loads(program("check", "paper-wall", "--set", "drive.kind=live", "--json"))
        scene = hertzline.scene("paper-wall", drive={"kind": "live"})
        found = scene.check()
        found.pop("warnings")
        self.assertEqual(found, {key: said[key] for key in found})
        self.assertGreater(found["latency_s"], 0)
        for work in (scene.run, lambda: hertzline.Simulation(scene)):
            with self.assertRaisesRegex(ValueError, 'drive.kind: found "live" without samples, allowed: a stream'):
                work()

    def test_check_refuses_a_step_beyond_stability(self):
        scene = short_scene(numerics={"integrator": "leapfrog", "step_s": 1e-5})
        with self.assertRaisesRegex(ValueError, "numerics.step_s: found 1e-05, allowed: "):
            scene.check()

    def test_a_resolved_scene_leaves_nothing_open(self):
        scene = short_scene()
        self.assertIsNone(scene["numerics.step_s"])
        resolved = scene.resolved()
        self.assertIsNone(hertzline.scene(resolved, numerics={"step_s": None})["numerics.step_s"])
        self.assertGreater(resolved["numerics.step_s"], 0)
        self.assertEqual(resolved.hash, summary("run", *SHORT)["scene_hash"])

    def test_equal_scenes_are_equal_and_travel(self):
        scene = short_scene()
        self.assertEqual(scene, short_scene())
        self.assertEqual(hash(scene), hash(short_scene()))
        self.assertNotEqual(scene, hertzline.scene("paper-wall"))
        self.assertEqual(pickle.loads(pickle.dumps(scene)), scene)
        self.assertEqual(copy.deepcopy(scene), scene)


if __name__ == "__main__":
    unittest.main()
