"""Samples are not copied, and live as long as a view of them."""
import gc
import sys
import unittest
import weakref

import numpy as np
from support import InAFolder, short_scene

import hertzline


class Arrays(InAFolder):
    def test_are_views_of_one_memory_that_cannot_be_written(self):
        r = short_scene().run(taps=["v_out", "v_chain"])
        for tap in ("v_out", "v_chain"):
            self.assertTrue(np.shares_memory(r[tap], r[tap]))
            with self.assertRaises(ValueError):
                r[tap][0] = 1.0
        self.assertTrue(r["v_chain"].flags.c_contiguous)

    def test_outlive_their_result(self):
        r = short_scene().run()
        native = weakref.ref(r._native)
        v, wanted = r["v_out"], r["v_out"].copy()
        part = v[10:20]
        del r, v
        gc.collect()
        self.assertIsNotNone(native())
        self.assertTrue(np.array_equal(part, wanted[10:20]))
        del part
        gc.collect()
        self.assertIsNone(native())

    def test_outlive_their_recording(self):
        path = self.folder / "x.npy"
        short_scene().run(taps=["v_out", "v_chain"]).save(path)
        loaded = hertzline.load(path)
        native = weakref.ref(loaded._native)
        v, chain = loaded["v_out"], loaded["v_chain"]
        self.assertTrue(np.shares_memory(v, loaded["v_out"]))
        wanted = chain.copy()
        del loaded
        gc.collect()
        self.assertTrue(np.array_equal(chain, wanted))
        del v, chain
        gc.collect()
        self.assertIsNone(native())

    def test_leave_the_counts_of_references_alone(self):
        r = short_scene().run(taps=["v_out", "v_chain"])
        gc.collect()  # garbage of earlier tests refers to None, too
        before = sys.getrefcount(r._native), sys.getrefcount(None)
        for _ in range(1000):
            r["v_out"], r["v_chain"], r.summary, r.spectrum("v_out") if _ % 100 == 0 else None
        gc.collect()
        after = sys.getrefcount(r._native), sys.getrefcount(None)
        self.assertEqual(before[0], after[0])
        self.assertLess(abs(before[1] - after[1]), 100)

    def test_many_runs_take_the_memory_of_one(self):
        scene = short_scene(output={"duration_s": 1e-3})

        def resident():
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * 4096

        for _ in range(3):
            scene.run(taps=["v_chain", "x_chain"])
        before = resident()
        for _ in range(30):  # each keeps 2 MB
            scene.run(taps=["v_chain", "x_chain"])
        gc.collect()
        self.assertLess(resident() - before, 15e6)


if __name__ == "__main__":
    unittest.main()
