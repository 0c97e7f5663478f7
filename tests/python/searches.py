"""Searches have the rows, the best point and the numbers of `hertzline optimise`."""
import csv
import json
import math
import pickle
import unittest

import numpy as np
from support import SHORT, InAFolder, program, short_scene

import hertzline

VARY = {"chain.preload_n": "0.01..1:log", "chain.spheres": [3, 4, 5, 6]}
GOAL = {"maximise": "peak_v_out_m_per_s", "subject_to": ["peak_contact_force_n <= 4"], "evaluations": 60, "seed": 3}
WORDS = ["--vary", "chain.preload_n=0.01..1:log", "--vary", "chain.spheres=3,4,5,6", "--maximise", "peak_v_out_m_per_s",
         "--subject-to", "peak_contact_force_n <= 4", "--evaluations", 60, "--seed", 3]


def quick_search(**changes):
    return hertzline.optimise(short_scene(), VARY, **{**GOAL, **changes})


class Searches(InAFolder):
    def test_have_the_rows_and_the_summary_of_the_program(self):
        file = self.folder / "s.csv"
        summary = json.loads(program("optimise", *SHORT, *WORDS, "--json", "-o", file))
        del summary["file"]
        with open(file, encoding="utf-8") as rows:
            rows = list(csv.DictReader(rows))
        provenance = json.loads((self.folder / "s.csv-metadata.json").read_text())["urn:hertzline:provenance"]
        for jobs in (1, 2):
            found = quick_search(jobs=jobs)
            self.assertEqual(found.summary, summary)
            self.assertEqual(found.table.provenance, provenance)
            self.assertEqual(list(found.table.dtype.names), list(rows[0]))
            self.assertEqual(len(found.table), len(rows))
            for row, wanted in zip(found.table, rows):
                for name, text in wanted.items():
                    if row.dtype[name].kind != "f":
                        self.assertEqual(str(row[name]), text, name)
                    elif not text:
                        self.assertTrue(math.isnan(row[name]), name)
                    else:
                        self.assertEqual(row[name], float(text), name)

    def test_the_best_point_is_a_row_and_a_scene(self):
        found = quick_search()
        self.assertEqual(found.best["point"], found.summary["best"]["point"])
        kept = found.table[found.table["peak_contact_force_n"] <= 4]
        self.assertEqual(found.best["peak_v_out_m_per_s"], kept["peak_v_out_m_per_s"].max())
        self.assertEqual(found.best_scene["chain.preload_n"], found.best["chain.preload_n"])
        self.assertEqual(found.best_scene["drive.cycles"], 3)
        self.assertEqual(found.table.units["peak_v_out_m_per_s"], "m/s")
        self.assertEqual(found.scene, short_scene())
        best = found.best["chain.preload_n"]
        found.table.sort(order="peak_v_out_m_per_s")
        self.assertEqual(found.best["point"], found.summary["best"]["point"])
        self.assertEqual(found.best_scene["chain.preload_n"], best)

    def test_a_list_of_numbers_is_a_list_of_the_program(self):
        values = np.geomspace(0.01, 1, 30)
        listed = quick_search(subject_to=[]).table.provenance["search"]["vary"]
        self.assertEqual(listed, ["chain.preload_n=0.01..1:log", "chain.spheres=3,4,5,6"])
        found = hertzline.optimise(short_scene(), {"chain.preload_n": values}, minimise="thd_r", evaluations=30)
        self.assertTrue(set(found.table["chain.preload_n"]) <= set(values))
        self.assertEqual(found.best["thd_r"], np.nanmin(found.table["thd_r"]))

    def test_other_outputs_are_measured(self):
        found = quick_search(maximise="v_plate.thd_r", subject_to=[], measure=["v_plate"])
        self.assertEqual(found.best["v_plate.thd_r"], np.nanmax(found.table["v_plate.thd_r"]))

    def test_without_a_feasible_point_the_closest_is_named(self):
        found = quick_search(subject_to=["peak_v_last_m_per_s >= 100"])
        self.assertIsNone(found.best)
        self.assertGreater(len(found.table), 30)
        self.assertIn("the closest is point", found.warnings[-1])
        with self.assertRaisesRegex(ValueError, "the closest is point"):
            found.best_scene  # noqa: B018

    def test_every_fault_is_reported_before_anything_runs(self):
        def faults(vary, **changes):
            with self.assertRaises(ValueError) as caught:
                hertzline.optimise(short_scene(), vary, **changes)
            return str(caught.exception).splitlines()

        wrong = faults(VARY, evaluations=10, jobs=2000, subject_to=["thd_r == 1", "thd >= 1"])
        self.assertEqual([line.split(":")[0] for line in wrong],
                         ["jobs", "maximise or minimise is missing", "subject_to", "evaluations"])
        self.assertEqual(len(faults(VARY, maximise="peak", subject_to=["thd >= 1"], measure=["v_ou"])), 3)
        self.assertIn("found both", faults(VARY, maximise="thd_r", minimise="thd_r")[0])
        self.assertIn("a range that goes up", faults({"chain.preload_n": "2..1"}, maximise="thd_r")[0])
        self.assertIn("without a count", faults({"chain.preload_n": "1..2:5"}, maximise="thd_r")[0])
        self.assertIn("seed: found -1", faults(VARY, maximise="thd_r", seed=-1)[0])
        self.assertTrue(faults({}, maximise="thd_r"))

    def test_survives_pickling(self):
        found = quick_search()
        again = pickle.loads(pickle.dumps(found))
        self.assertEqual(again.table.tobytes(), found.table.tobytes())
        self.assertEqual((again.summary, again.warnings, again.scene), (found.summary, found.warnings, found.scene))
        self.assertEqual(again.best, found.best)


if __name__ == "__main__":
    unittest.main()
