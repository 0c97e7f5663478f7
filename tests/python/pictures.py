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


def recorded(samples, columns, rate=1e6):
    """columns: quantity and unit by name"""
    from hertzline import _draw
    return _draw.recording_of(samples, {"columns": [(name, *about) for name, about in columns.items()], "sample_rate_hz": rate})


def drawn(recordings):
    from hertzline import _draw
    return _draw.draw(recordings, "")


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

    def test_the_map_of_chosen_spheres_names_them(self):
        t = np.arange(400) / 1e6
        numbers = [1, 5, 9, 20]
        samples = {"t_s": t, **{f"v{k}_m_per_s": np.sin(k * t) for k in numbers}}
        figure = drawn([recorded(samples, {f"v{k}_m_per_s": ("v_chain", "m/s") for k in numbers})])
        axes = next(axes for axes in figure.axes if axes.images)
        rows = dict(zip((text.get_text() for text in axes.get_yticklabels()), axes.get_yticks()))
        self.assertEqual([rows[str(k)] for k in numbers], [1, 2, 3, 4])
        matplotlib.pyplot.close(figure)

    def test_units_have_panels_of_their_own(self):
        t = np.arange(100) / 1e6
        velocity = recorded({"t_s": t, "v": np.ones(100)}, {"v": ("v", "m/s")})
        force = recorded({"t_s": t, "f": np.ones(100)}, {"f": ("f", "N")})
        figure = drawn([velocity, force])
        self.assertEqual([axes.get_ylabel() for axes in figure.axes[::2]], ["v [m/s]", "f [N]"])
        matplotlib.pyplot.close(figure)
        other = recorded({"t_s": t, "w": np.ones(100)}, {"w": ("w", "m/s")})
        figure = drawn([velocity, other])  # one unit: together, named
        self.assertEqual((len(figure.axes), figure.axes[0].get_ylabel()), (2, "[m/s]"))
        self.assertEqual([text.get_text()[:3] for text in figure.axes[0].get_legend().get_texts()], [" v:", " w:"])
        matplotlib.pyplot.close(figure)

    def test_columns_of_elements_keep_their_numbers(self):
        samples = {"t_s": np.arange(100) / 1e6, **{name: np.ones(100) for name in ("v_last_1_m_per_s", "v_last_2_m_per_s", "v_last_m_per_s")}}
        figure = drawn([recorded(samples, {name: ("v_last", "m/s") for name in samples if name != "t_s"})])
        self.assertEqual([axes.get_ylabel() for axes in figure.axes[::2]], ["v_last_1 [m/s]", "v_last_2 [m/s]", "v_last [m/s]"])
        matplotlib.pyplot.close(figure)

    def test_samples_between_gaps_are_dots(self):
        figure = drawn([recorded({"t_s": np.array([0, 1, 2, 5, 9, 10]) / 1e6, "v": np.array([0, 0, 0, 7.0, 0, 0])}, {"v": ("v", "m/s")})])
        dots, = [line for line in figure.axes[0].lines if line.get_marker() == "."]
        self.assertTrue(np.allclose(dots.get_xydata(), [[5, 7]]))
        matplotlib.pyplot.close(figure)

    def test_the_last_stretch_ends_with_the_recording(self):
        for count in (16_385, 100_003):
            v = np.zeros(count)
            v[[0, -1]] = 1
            recording = recorded({"t_s": np.arange(count) / 1e6, "v": v}, {"v": ("v", "m/s")})
            self.assertTrue(recording.ends[0] <= recording.t[0] and recording.t[-1] <= recording.ends[1])
            figure = drawn([recording])
            begin, end = figure.axes[0].get_xlim()
            x, y = figure.axes[0].lines[0].get_data()
            self.assertEqual((y[(x >= begin) & (x < x.mean())].max(), y[(x <= end) & (x > x.mean())].max()), (1, 1))
            matplotlib.pyplot.close(figure)

    def test_a_drive_that_changes_is_that_of_the_samples(self):
        from hertzline import _draw
        about = {"columns": [("v", "v", "m/s")], "sample_rate_hz": 1e6,
                 "provenance": {"scene": {"drive": {"frequency_hz": 73e3}}, "changes": [
                     {"epoch": 1, "sample": 50, "set": {"chain.preload_n": 1}}, {"epoch": 2, "sample": 100, "set": {"drive.frequency_hz": 1e5}}]}}
        for first, end, drives, lowest, epochs in ((0, 300, [73e3, 1e5], 36.5e3, [(1, 50e-6), (2, 100e-6)]), (0, 90, [73e3], 36.5e3, [(1, 50e-6)]),
                                                   (60, 90, [73e3], 36.5e3, [(1, 60e-6)]), (100, 300, [1e5], 5e4, [(2, 100e-6)])):
            t = np.arange(first, end) / 1e6
            recording = _draw.recording_of({"t_s": t, "v": np.sin(t * 1e6)}, about)
            self.assertEqual((recording.drives, recording.lowest(), recording.epochs), (drives, lowest, epochs))
        figure = drawn([recording])  # of the change before it has the number, and no line
        self.assertIn(" 2", [text.get_text() for text in figure.axes[0].texts])
        self.assertEqual(sum(len(lines.get_segments()) for lines in figure.axes[0].collections), 0)
        matplotlib.pyplot.close(figure)

    def test_a_change_that_is_damaged_takes_no_other_one_away(self):
        from hertzline._draw import recordings
        good = {"epoch": 1, "sample": 10, "set": {"drive.frequency_hz": 1e5}}
        for damaged in (3, {"epoch": 1}, {"epoch": "x"}, {"epoch": 2, "sample": 10**400, "set": {}}, {"epoch": 2, "sample": 20, "set": []},
                        *({"epoch": 2, "sample": 20, "set": {"drive.frequency_hz": f}} for f in (None, "1e5", -1, 10**400, float("inf"), 1e5))):
            about = {"sample_rate_hz": 1e6, "provenance": {"scene": {"drive": {"frequency_hz": 73e3}}, "changes": [damaged, good, damaged]}}
            self.assertEqual(recordings.drives_of(about, 0, 100), [73e3, 1e5], damaged)
            self.assertIn((1, 1e-5), recordings.epochs_in(about, np.arange(100) / 1e6))
        for scene in (None, 3, {"drive": []}, {"drive": {"frequency_hz": "x"}}):
            self.assertEqual(recordings.drives_of({"provenance": {"scene": scene, "changes": 3}}), [])

    def test_several_drives_have_no_lines_in_common(self):
        from hertzline._draw import waveforms
        v = {"t_s": np.arange(1000) / 1e7, "v": np.sin(np.arange(1000))}
        one, other, unknown = (recorded(v, {"v": ("v", "m/s")}, rate=1e7) for _ in range(3))
        one.drives, other.drives = [73e3], [1e5]
        self.assertEqual(waveforms.frequencies_of([one, unknown]), (73e3, 10.5 * 73e3))
        self.assertEqual(waveforms.frequencies_of([one, other]), (None, 10.5e5))
        unknown.drives = [73e3, 2e5]
        self.assertEqual(waveforms.frequencies_of([one, unknown]), (None, 21e5))
        unknown.drives = []
        self.assertEqual(waveforms.frequencies_of([unknown]), (None, 5e6))  # half the sample rate
        self.assertEqual((unknown.lowest(73e3), unknown.lowest(), other.lowest(73e3)), (36.5e3, 0, 5e4))
        other.band_from = 5e3
        self.assertEqual(other.lowest(73e3), 5e3)
        figure = drawn([one, other])
        self.assertEqual(figure.axes[1].get_xlabel(), "frequency [kHz]")
        matplotlib.pyplot.close(figure)

    def test_a_rate_below_the_drive_is_no_silence(self):
        recording = recorded({"t_s": np.arange(1000) / 6e4, "v": np.sin(np.arange(1000))}, {"v": ("v", "m/s")}, rate=6e4)
        recording.drives = [73e3]
        figure = drawn([recording])
        self.assertRegex(figure.axes[1].get_title(loc="right"), "half the sample rate is below 36.5 kHz")
        matplotlib.pyplot.close(figure)

    def test_cells_of_a_map_surround_their_points(self):
        from hertzline._draw import sweeps
        x = np.geomspace(1e-3, 10, 5)
        edges = sweeps.edges_of(x, "log", within=False)
        self.assertTrue(np.allclose(edges[1:] / edges[:-1], 10) and np.allclose(np.sqrt(edges[1:] * edges[:-1]), x))
        self.assertFalse(np.isfinite(sweeps.edges_of([1e-300, 1, 1e300], "log", within=False)).all())  # drawn as dots
        self.assertTrue(np.allclose(sweeps.edges_of([0, 1, 3], "linear", within=False), [-0.5, 0.5, 2, 4]))
        self.assertTrue(np.allclose(sweeps.edges_of([0, 1, 3], "linear", within=True), [0, 0.5, 2, 3]))
        table = hertzline.sweep(short_scene(), {"chain.preload_n": np.geomspace(1e-2, 1, 4), "end.thickness_m": np.geomspace(1e-4, 1e-2, 3)})
        figure = table.plot(["peak_v_out_m_per_s"])
        mesh, = figure.axes[0].collections
        self.assertTrue(np.allclose(mesh.get_array().reshape(4, 3), table["peak_v_out_m_per_s"].reshape(4, 3)))
        (left, right), (low, high) = figure.axes[0].get_xlim(), figure.axes[0].get_ylim()
        self.assertTrue(left < 1e-4 and right > 1e-2 and low < 1e-2 and high > 1)
        matplotlib.pyplot.close(figure)

    def test_points_without_cells_are_dots(self):
        from hertzline import _draw
        for preloads, thicknesses in (([0.1, 0.1, 0.3, 0.3], [1, 1, 2, 2]),  # repeated
                                      ([1e-300, 1, 1e300] * 2, [1, 1, 1, 2, 2, 2])):  # the cell of the last one would be infinite
            count = len(preloads)
            columns = {"point": np.arange(count), "chain.preload_n": np.array(preloads), "end.thickness_m": np.array(thicknesses, dtype=float),
                       "status": np.array(["ok"] * count), "thd_r": np.arange(float(count))}
            figure = _draw.draw_sweep(_draw.Sweep(columns, {}, {}), ["thd_r"], "")
            self.assertEqual(len(figure.axes[0].collections[0].get_offsets()), count)
            matplotlib.pyplot.close(figure)

    def test_a_legend_names_curves_that_differ(self):
        from hertzline import _draw
        words = np.array([f"$w{k}$" for k in range(40)])
        columns = {"point": np.arange(80.0), "chain.preload_n": np.tile([1.0, 2], 40), "end.material": np.repeat(words, 2),
                   "status": np.array(["ok"] * 80), "thd_r": np.arange(80.0)}
        figure = _draw.draw_sweep(_draw.Sweep(columns, {}, {}), ["thd_r"], "")
        names = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
        self.assertEqual((names[0], names[-1], len(names)), (r"\$w0\$", "and 17 more", 24))
        styles = {(line.get_color(), str(line.get_linestyle()), tuple(line._dash_pattern[1] or ())) for line in figure.axes[0].lines[:23]}
        self.assertEqual(len(styles), 23)
        matplotlib.pyplot.close(figure)
        words = {key: column[::2] for key, column in columns.items() if key != "chain.preload_n"}
        figure = _draw.draw_sweep(_draw.Sweep(words, {}, {}), ["thd_r"], "")
        self.assertEqual(figure.axes[0].get_xticklabels()[0].get_text(), r"\$w0\$")
        figure.savefig(self.folder / "x.png")
        matplotlib.pyplot.close(figure)

    def test_a_search_tells_why_points_do_not_count(self):
        from hertzline import _draw
        columns = {"point": np.arange(5.0), "chain.preload_n": np.arange(1.0, 6), "status": np.array(["ok", "ok", "chaotic", "refused", "ok"]),
                   "thd_r": np.array([1, 2, 3, np.nan, 4]), "peak_v_out_m_per_s": np.array([1, 2, 1, 1, 9.0])}
        request = {"maximise": "thd_r", "subject_to": ["peak_v_out_m_per_s <= 5"], "vary": ["chain.preload_n=1..5"], "best_point": 1}

        def labels():
            figure = _draw.draw_sweep(_draw.Sweep(columns, {}, {"search": request}), [], "")
            matplotlib.pyplot.close(figure)
            return {line.get_label(): line.get_xdata().tolist() for line in figure.axes[0].lines if line.get_label()[0] != "_"}

        self.assertEqual(labels(), {"beyond a bound": [5], "best": [2], "chaotic": [3], "refused": [4]})
        columns["status"][:] = "chaotic"
        self.assertEqual(list(labels()), ["chaotic", "chaotic, no number"])

    def test_waveforms_of_a_sweep_have_the_drive_of_their_point(self):
        from hertzline._draw import sweeps, tables
        path = str(self.folder / "s.h5")
        program("sweep", "paper-wall", "--vary", "drive.frequency_hz=40kHz,80kHz,160kHz", "--waveforms", "f_last", "-o", path)
        recordings, looked_at = sweeps.waveform_recordings(tables.read_sweep(path), path, "f_last")
        self.assertEqual(([recording.drives for recording, _ in recordings], looked_at), ([[40e3], [80e3], [160e3]], 3))

    def test_waveforms_of_swept_records_have_the_drive_of_their_record(self):
        from hertzline._draw import sweeps, tables
        for name, cycles in (("a", 40e3), ("b", 160e3)):
            program("run", "paper-wall", "--set", f"drive.frequency_hz={cycles}", "--columns", "v_horn", "-o", self.folder / f"{name}.csv")
        path = str(self.folder / "s.h5")
        program("sweep", "paper-wall", "--set", "drive.kind=file", "--vary", f"drive.file={self.folder}/a.csv,{self.folder}/b.csv",
                "--waveforms", "f_last", "-o", path)
        recordings, _ = sweeps.waveform_recordings(tables.read_sweep(path), path, "f_last")
        for (recording, _), frequency in zip(recordings, (40e3, 160e3)):
            self.assertLess(abs(recording.drives[0] / frequency - 1), 0.02)

    def test_waveforms_of_a_sweep_tell_of_points_without_samples(self):
        from hertzline._draw import sweeps, tables
        path = str(self.folder / "s.h5")
        program("sweep", "paper-wall", "--vary", "numerics.step_s=1e-7,1e-4", "--waveforms", "f_last", "-o", path)
        figure = sweeps.draw_waveforms(tables.read_sweep(path), path, ["f_last"], "s.h5")
        self.assertEqual(figure._suptitle.get_text(), "s.h5; 1 of 2 points without samples")
        self.assertRegex(figure.axes[0].get_title(loc="right"), "peak .* N")
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

    def test_the_loudest_point_is_that_of_the_window(self):
        from hertzline._draw import fields
        samples = np.array([[9, 1, 1], [0, 3, 2], [np.nan, np.nan, np.nan]])

        class Waves:
            first, end, field, rate = 1, 3, None, 1e6
            chosen = staticmethod(lambda reduce: reduce(samples[:, 1:]))

        self.assertEqual(fields.loudest(Waves), 1)
        samples[:] = np.nan
        with self.assertRaisesRegex(ValueError, "no point has samples"):
            fields.loudest(Waves)

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
