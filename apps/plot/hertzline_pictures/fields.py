"""Waveforms of a field: the spectrum at a point, pressure over time along a line, and over a plane as a movie."""
import contextlib
import json

import matplotlib.pyplot as plt
import numpy as np

from .recordings import drives_of, furthest_from_0, recording_of
from .style import COLOURS, WrongUse, titled, unit_of_time, use_style
from .tables import open_hdf5
from .waveforms import draw

MAX_ROWS = 2000  # of a waterfall, and stretches of time in it: more than a picture has pixels
BATCH = 256  # waveforms that are in memory at once
FRAMES_A_PERIOD = 8  # of the drive: with fewer, waves seem to run backwards
USUAL_FRAMES = 100  # without a drive
MAX_FRAMES = 1000
FRAME_MS = 50
SAME_POINT_M = 1e-9
KINDS = ("beam", "spectrum", "waterfall", "movie")
ALLOWED = {1: "a line, where one of x, y, z varies", 2: "a plane, where two of x, y, z vary"}


class Waveforms:
    """The samples of a field that lie in a window of time."""

    def __init__(self, field, samples, about, window):
        self.field, self.samples = field, samples
        self.drives = drives_of({"provenance": about})
        self.rate = about["scene"]["output"]["sample_rate_hz"]
        nearly = 1e-6  # of a sample, as times are rounded
        begin, end = window
        self.first = int(np.ceil(begin * self.rate - nearly))
        self.end = int(min(np.floor(end * self.rate + nearly) + 1, samples.shape[1]))
        if self.first >= self.end:
            raise WrongUse(f"--from, --to: found no samples in this window, allowed: 0 to {(samples.shape[1] - 1) / self.rate:g} s")

    def times(self):
        return np.arange(self.first, self.end) / self.rate

    def chosen(self, reduce):
        """What `reduce` makes of the samples of some points, [point][sample], for all points."""
        parts = (self.samples[begin:begin + BATCH, self.first:self.end] for begin in range(0, len(self.samples), BATCH))
        return np.concatenate([reduce(part) for part in parts])


def require_field(sweep, kind):
    if not sweep.is_field:
        raise WrongUse(f"--kind {kind}: found a sweep, allowed: a table of hertzline field")


@contextlib.contextmanager
def waveforms_of(field, path, kind, window):
    """The pressures in the file of a field."""
    if not path.endswith(".h5"):
        raise WrongUse(f"--kind {kind}: found a CSV, allowed: an .h5 file that was made with --waveforms")
    with open_hdf5(path) as file:
        if "p_points" not in file:
            raise WrongUse(f"--kind {kind}: found a field without waveforms, allowed: one that was made with --waveforms")
        yield Waveforms(field, file["p_points"], json.loads(file.attrs["provenance"]), window)


def axes_of(field, kind, count):
    """The coordinates that vary. @throws WrongUse unless they are `count`."""
    keys = [key for key in field.keys if len(np.unique(field.columns[key])) > 1]
    if len(keys) != count:
        found = f"points over {', '.join(key[0] for key in keys)}" if keys else "one point"
        raise WrongUse(f"--kind {kind}: found {found}, allowed: {ALLOWED[count]}")
    return keys


def place(field, point, keys=("x_m", "y_m", "z_m")):
    return ", ".join(f"{key[0]} = {1e3 * field.columns[key][point]:.6g} mm" for key in keys)


def fixed(field, keys, point=0):
    """The coordinates that do not vary."""
    return place(field, point, [key for key in ("x_m", "y_m", "z_m") if key not in keys])


def unit_of_pressure(largest):
    return (1e6, "MPa") if largest >= 1e6 else (1e3, "kPa") if largest >= 1e3 else (1, "Pa")


def point_at(field, place_m):
    """The number of the point there. @throws WrongUse with the nearest one"""
    points = np.column_stack([field.columns[key] for key in ("x_m", "y_m", "z_m")])
    distance = np.linalg.norm(points - place_m, axis=1)
    nearest = int(np.argmin(distance))
    if distance[nearest] > SAME_POINT_M:
        found = ", ".join(f"{name} = {1e3 * value:.6g} mm" for name, value in zip("xyz", place_m))
        raise WrongUse(f"--at: found {found}, allowed: points of the field; the nearest is {place(field, nearest)}")
    return nearest


def loudest(waves):
    """The number of the point with the largest peak."""
    peaks = np.nan_to_num(waves.chosen(lambda samples: np.abs(samples).max(axis=1)), nan=-1)
    if peaks.max() < 0:
        raise ValueError("no point has samples")
    return int(np.argmax(peaks))


def draw_spectrum_at(waves, places, title):
    """Waveform and spectrum at the points, or at the one with the largest peak."""
    field = waves.field
    points = [point_at(field, place_m) for place_m in places] or [loudest(waves)]
    if len(points) > len(COLOURS):
        raise WrongUse(f"--at: found {len(points)} points, allowed: {len(COLOURS)} at most")
    keys = [key for key in field.keys if len(np.unique(field.columns[key][points])) > 1]
    recordings = []
    for point in points:
        about = {"columns": [("p_points", "p_points", "Pa")], "sample_rate_hz": waves.rate}
        samples = {"t_s": waves.times(), "p_points": waves.samples[point, waves.first:waves.end]}
        recordings.append(recording_of(samples, about, place(field, point, keys)))
        recordings[-1].drives = waves.drives
    largest = "" if places else f", the largest peak of {len(waves.samples)} points"
    return draw(recordings, f"{title}: {fixed(field, keys, points[0])}{largest}")


def extremes(samples, width):
    """Of each stretch of this many samples the one furthest from 0, so that no peak is lost."""
    begins = np.arange(0, samples.shape[1], width)
    high, low = np.maximum.reduceat(samples, begins, axis=1), np.minimum.reduceat(samples, begins, axis=1)
    return furthest_from_0(low, high)


def draw_waterfall(waves, title):
    """Pressure over time and the position along a line."""
    field = waves.field
    key, = axes_of(field, "waterfall", 1)
    if len(waves.samples) > MAX_ROWS:
        raise WrongUse(f"--kind waterfall: found {len(waves.samples)} points, allowed: {MAX_ROWS} at most")
    width = -(-(waves.end - waves.first) // MAX_ROWS)
    pressure = waves.chosen(lambda samples: extremes(samples, width))
    largest = np.abs(pressure).max()
    scale, unit = unit_of_pressure(largest)
    t = (waves.first + width * np.arange(pressure.shape[1]) + (width - 1) / 2) / waves.rate
    unit_s, unit_t = unit_of_time(t[-1] - t[0])
    position, label = field.axis(key)
    order = np.argsort(position)
    figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
    image = axes.pcolormesh(t / unit_s, position[order], pressure[order] / scale, shading="nearest", rasterized=True, cmap="RdBu_r",
                            vmin=-largest / scale or -1, vmax=largest / scale or 1)
    axes.set_xlabel(f"time [{unit_t}]")
    axes.set_ylabel(label)
    figure.colorbar(image, ax=axes, label=f"pressure [{unit}]", pad=0.01)
    return titled(figure, f"{title}: {fixed(field, [key])}")


def frames_of(waves, frames):
    """The number of frames: that which is asked for, or some of each period of the drive."""
    count = waves.end - waves.first
    usual = int(np.ceil(FRAMES_A_PERIOD * waves.drives[0] * count / waves.rate)) if waves.drives else USUAL_FRAMES
    if count < 2:
        raise WrongUse("--from, --to: found one sample in this window, allowed: two or more, as frames of a movie")
    asked = min(usual, count) if frames is None else frames
    if not 2 <= asked <= min(count, MAX_FRAMES):
        raise WrongUse(f"--frames: found {asked}{'' if frames is not None else f', {FRAMES_A_PERIOD} of each period of the drive'}, allowed: 2 to "
                       f"{min(count, MAX_FRAMES)}{'' if count > MAX_FRAMES else ', the samples in the window'}")
    return asked


def draw_movie(waves, frames, title):
    """Pressure over a plane, frame by frame with one scale of colours. @returns frames of pillow"""
    from PIL import Image
    field = waves.field
    slow, fast = axes_of(field, "movie", 2)
    (x, label_x), (y, label_y) = field.axis(fast), field.axis(slow)
    shape = len(np.unique(y)), len(np.unique(x))
    sample = np.rint(np.linspace(0, waves.end - waves.first - 1, frames_of(waves, frames))).astype(int)
    order = np.lexsort((x, y))
    pressure = waves.chosen(lambda samples: samples[:, sample])[order]
    x, y = (a[order].reshape(shape) for a in (x, y))
    largest = np.abs(pressure).max()
    scale, unit = unit_of_pressure(largest)
    t = waves.times()[sample]
    unit_s, unit_t = unit_of_time(t[-1])
    figure, axes = plt.subplots(figsize=(6.4, 5.2), layout="constrained")
    image = axes.pcolormesh(x, y, np.zeros(shape), shading="nearest", cmap="RdBu_r", vmin=-largest / scale or -1, vmax=largest / scale or 1)
    axes.set_aspect("equal")
    axes.set_xlabel(label_x)
    axes.set_ylabel(label_y)
    figure.colorbar(image, ax=axes, label=f"pressure [{unit}]")
    titled(figure, f"{title}: {fixed(field, [fast, slow])}")
    digits = max(1, int(np.ceil(-np.log10(np.diff(t).min() / unit_s))) + 1)  # frames that follow each other differ
    for number, time in enumerate(t):
        image.set_array(pressure[:, number].reshape(shape) / scale)
        axes.set_title(f"t = {time / unit_s:.{digits}f} {unit_t}", fontsize=10)
        figure.canvas.draw()
        figure.set_layout_engine("none")  # all frames have the layout of the first one
        yield Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3]).quantize(256)


def save_movie(frames, file):
    """An animated GIF that repeats."""
    first, *others = frames
    first.save(file, format="gif", save_all=True, append_images=others, duration=FRAME_MS, loop=0)


def draw_waveforms(field, path, arguments):
    """A figure of the kind that is asked for, or the frames of a movie."""
    use_style()
    with waveforms_of(field, path, arguments.kind, (arguments.begin, arguments.end)) as waves:
        if arguments.kind == "spectrum":
            return draw_spectrum_at(waves, arguments.at, arguments.title)
        if arguments.kind == "waterfall":
            return draw_waterfall(waves, arguments.title)
        return list(draw_movie(waves, arguments.frames, arguments.title))
