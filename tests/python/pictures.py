"""Pictures are drawn, of all that has samples, and leave matplotlib's settings as they were."""
import argparse
import math
import sys
import unittest

try:
    import matplotlib.pyplot
except ImportError:
    print("skipped: matplotlib is not there")
    sys.exit(77)
import numpy as np
from support import InAFolder, program, short_scene

import hertzline


class Pictures(InAFolder):
    def check(self, figure, panels):
        self.assertEqual(len(figure.axes), panels)
        figure.savefig(self.folder / "x.png")
        self.assertGreater((self.folder / "x.png").stat().st_size, 5000)
        matplotlib.pyplot.close(figure)

    def test_of_a_run(self):
        before = dict(matplotlib.rcParams)
        r = short_scene().run(taps=["v_out", "v_last", "v_chain"])
        self.check(r.plot(["v_out"], title="one"), 2)
        self.check(r.plot(["v_chain"]), 12)
        self.check(r.plot(), 4)
        with self.assertRaisesRegex(TypeError, 'taps: found the text "v_out"'):
            r.plot("v_out")
        self.assertEqual(dict(matplotlib.rcParams), before)

    def test_of_a_recording(self):
        short_scene().run().save(self.folder / "x.sigmf-meta")
        self.check(hertzline.load(self.folder / "x.sigmf-meta").plot(["v_out"]), 2)

    def test_of_sweeps(self):
        table = hertzline.sweep(short_scene(), {"chain.preload_n": np.geomspace(0.1, 1, 4)})
        self.check(table.plot(["peak_v_out_m_per_s"]), 1)
        table = hertzline.sweep(short_scene(), {"chain.preload_n": [0.1, 0.3], "end.thickness_m": [2e-4, 5e-4]})
        self.check(table.plot(["peak_v_out_m_per_s"]), 2)  # with its scale

    def test_of_words_join_no_points(self):
        table = hertzline.sweep(short_scene(), {"end.material": ["pyrex", "acrylic", "steel"]})
        figure = table.plot(["peak_v_out_m_per_s"])
        line, = figure.axes[0].lines
        self.assertEqual((line.get_linestyle(), line.get_marker(), len(line.get_xdata())), ("None", "o", 3))
        self.check(figure, 1)
        table = hertzline.sweep(short_scene(), {"end.material": ["pyrex", "acrylic"], "chain.material": ["steel", "aluminium"]})
        figure = table.plot(["peak_v_out_m_per_s"])
        self.assertEqual([text.get_text() for text in figure.axes[0].get_legend().get_texts()], ["steel", "aluminium"])
        self.check(figure, 1)

    def test_of_a_long_run_keep_every_peak(self):
        samples = np.zeros(3_000_000, dtype=[("t_s", float), ("v", float)])
        samples["t_s"] = np.arange(len(samples)) / 1e6
        samples["v"][2_999_000] = 7
        about = {"columns": [("v", "v", "m/s")], "sample_rate_hz": 1e6}
        from hertzline import _draw
        recording = _draw.recording_of(samples, about)
        self.assertEqual((np.nanmax(recording.high[0]), recording.ends, recording.each), (7, (0, 2.999999), False))
        gap = np.delete(samples[:5000], np.s_[1000:4000])
        recording = _draw.recording_of(gap, about)
        self.assertEqual((len(recording.low[0]), int(np.isnan(recording.low[0]).sum()), len(recording.parts[0])), (5000, 3000, 1000))

    def test_the_map_of_a_chain_shows_every_peak(self):
        from hertzline import _draw
        t = np.arange(40_000) / 1e6  # more samples than stretches of the map
        samples = {"t_s": t, **{f"v{k}_m_per_s": 0.3 * k * np.sin(2 * np.pi * 73e3 * t) for k in range(1, 5)}}
        about = {"columns": [(f"v{k}_m_per_s", "v_chain", "m/s") for k in range(1, 5)], "sample_rate_hz": 1e6}
        figure = _draw.draw([_draw.recording_of(samples, about)], "")
        image, = [image for axes in figure.axes for image in axes.images]
        peaks = np.abs(image.get_array()).max(axis=1)
        self.assertTrue(np.allclose(peaks / peaks[-1], [0.25, 0.5, 0.75, 1]))
        self.assertTrue(np.allclose(np.abs(image.get_array()[3, :-1]).min() / peaks[3], 1, atol=0.3), "no stretch is averaged away")
        matplotlib.pyplot.close(figure)

    def test_panels_of_several_recordings_share_their_time(self):
        from hertzline import _draw

        def recording(count, names):
            samples = {"t_s": np.arange(count) / 1e6, **{name: np.ones(count) for name in names}}
            return _draw.recording_of(samples, {"columns": [(name, name, "m/s") for name in names], "sample_rate_hz": 1e6})

        figure = _draw.draw([recording(1000, ["v_out", "v_last"]), recording(2000, ["v_out"])], "")
        for wave in figure.axes[::2]:
            self.assertEqual(wave.get_xlim(), figure.axes[0].get_xlim())
            for line in wave.get_lines():
                self.assertLessEqual(max(line.get_xdata()), wave.get_xlim()[1])
        matplotlib.pyplot.close(figure)

    def test_of_a_search(self):
        found = hertzline.optimise(short_scene(), {"chain.preload_n": "0.1..1:log"}, maximise="peak_v_out_m_per_s",
                                   evaluations=30)
        self.check(found.plot(title="a search"), 2)  # over the key and over the evaluations
        self.check(found.plot(["thd_r"]), 1)

    def test_into_axes_of_the_callers(self):
        figure, axes = matplotlib.pyplot.subplots(2, 2)
        self.assertIs(short_scene().run(taps=["v_out", "v_last"]).plot(["v_out", "v_last"], axes=axes), figure)
        self.assertTrue(all(panel.has_data() for panel in axes.ravel()))
        with self.assertRaisesRegex(ValueError, "axes: found 4, allowed: 2"):
            short_scene().run().plot(["v_out"], axes=axes)
        matplotlib.pyplot.close(figure)
        table = hertzline.sweep(short_scene(), {"chain.preload_n": np.geomspace(0.1, 1, 4)})
        figure, panel = matplotlib.pyplot.subplots()
        self.assertIs(table.plot(["peak_v_out_m_per_s"], axes=panel), figure)
        self.assertTrue(panel.has_data())
        matplotlib.pyplot.close(figure)

    def test_of_nothing_is_refused(self):
        with self.assertRaisesRegex(ValueError, "plot: found no taps"):
            short_scene().run().plot([])


class PicturesOfFields(InAFolder):
    def draw(self, plane, kind, begin=0, end=math.inf, frames=None):
        """Draws the field of three cycles over 60 us. Returns its table, its samples and the picture."""
        import h5py
        from hertzline._draw import fields, tables
        path = str(self.folder / "field.h5")
        program("field", "wet-vitreous-carbon", "--set", "drive.cycles=3", "--set", "output.duration_s=60us", "--plane", plane,
                "--waveforms", "-o", path)
        field = tables.read_sweep(path)
        options = argparse.Namespace(kind=kind, begin=begin, end=end, at=[], frames=frames, title="")
        with h5py.File(path) as file:
            return field, file["p_points"][:], fields.draw_waveforms(field, path, options)

    def test_a_waterfall_has_time_from_left_to_right_and_every_peak(self):
        field, samples, figure = self.draw("z=5mm..30mm:6", "waterfall", begin=10e-6)
        mesh, = figure.axes[0].collections
        pressure = mesh.get_array().reshape(6, -1)
        self.assertTrue(np.allclose(pressure * 1e3, samples[:, 100:]))
        self.assertTrue(np.allclose(np.abs(pressure).max(axis=1) * 1e3, field.columns["peak_pa"]))
        self.assertAlmostEqual(mesh.get_clim()[1], np.abs(pressure).max(), 3)
        self.assertAlmostEqual(-mesh.get_clim()[0], np.abs(pressure).max(), 3)
        corners = mesh.get_coordinates()  # in us and mm, half a cell beyond the samples
        self.assertTrue(np.allclose(corners[0, 0], (9.95, 2.5)) and np.allclose(corners[-1, -1], (60.05, 32.5)))
        heard = np.argmax(np.abs(pressure) > 0.2 * np.abs(pressure).max(axis=1, keepdims=True), axis=1)
        self.assertTrue((np.diff(heard) > 0).all())  # further away it is heard later
        matplotlib.pyplot.close(figure)

    def test_stretches_keep_the_sample_furthest_from_0(self):
        from hertzline._draw import fields
        self.assertEqual(fields.extremes(np.array([[0, -3, 1, 2, 0], [1, 0, -1, 0, 4]]), 2).tolist(), [[-3, 2, 0], [1, -1, 4]])

    def test_a_movie_has_one_scale_and_one_layout(self):
        _, samples, frames = self.draw("x=-4mm..4mm:9,z=5mm..15mm:11", "movie", frames=7)
        frames = [np.asarray(frame.convert("RGB")).astype(int) for frame in frames]
        height, width, _ = frames[0].shape
        scale = [frame[height // 5: -height // 5, int(0.86 * width):] for frame in frames]  # the bar of colours and its numbers
        self.assertGreater(np.ptp(scale[0]), 200)
        self.assertTrue(all(np.abs(bar - scale[0]).max() < 40 for bar in scale))  # 256 colours a frame
        plane = [np.ptp(frame[height // 3: height // 2, width // 4: width // 2], axis=2).max() for frame in frames]
        self.assertLess(plane[0], 12)  # silence is white
        self.assertGreater(max(plane), 60)
        strongest = np.abs(samples[:, np.rint(np.linspace(0, 600, 7)).astype(int)]).max(axis=0).argmax()
        self.assertEqual(np.argmax(plane), strongest)


if __name__ == "__main__":
    unittest.main()
