"""Recordings reduced to what a picture shows of them."""
import dataclasses
import json
import os

import numpy as np

MAX_STRETCHES = 8192  # of a waveform, and levels of a spectrum: some for each pixel
MAX_SPECTRUM = 1 << 20  # samples


def furthest_from_0(low, high):
    """Of each stretch, by its smallest and largest sample, the one that is furthest from 0: no peak is lost."""
    return np.where(high >= -low, high, low)


@dataclasses.dataclass(eq=False)
class Recording:
    """A recording as it is drawn: smallest and largest samples of stretches, and the samples of its spectrum."""

    name: str
    columns: list  # (name, quantity, unit)
    rate: float  # [Hz]
    drives: list  # frequencies of the drive, in turn [Hz]; empty: the recording does not say
    epochs: list  # (number, beginning [s]) of that of the first sample, and of those that begin in the picture
    t: object  # middle of each stretch [s]
    ends: tuple  # [s]
    each: bool  # a stretch is a sample
    low: list  # [column][stretch], NaN where there is no sample
    high: list
    parts: list  # [column], samples without a gap
    part_from: float  # [s]
    record: tuple = None  # that drove the horn: quantity, times [s], values
    band_from: float = None  # where the search for the maximum and for bands begins [Hz]; None: at half the drive's frequency

    @property
    def span(self):
        """The time that a picture of it alone shows [s]: that of one sample at least."""
        begin, end = self.ends
        return begin, max(end, begin + 1 / self.rate)

    def lowest(self, drive=None):
        """Where bands begin [Hz]. drive: of the recordings beside it, for one that does not say its own"""
        return self.band_from if self.band_from is not None else min(self.drives, default=drive or 0) / 2


def reduced_recordings(path):
    """The recordings of `hertzline plot`, which it has reduced."""
    with open(path, encoding="utf-8") as file:
        return [reduced_recording(about, os.path.dirname(path)) for about in json.load(file)]


def reduced_recording(about, folder):
    columns, rate, width = len(about["columns"]), about["sample_rate_hz"], about["width"]
    numbers = np.fromfile(os.path.join(folder, about["numbers"]), dtype="<f8")
    outline, parts = np.split(numbers, [2 * columns * about["stretches"]])
    outline, parts = outline.reshape(columns, 2, -1), parts.reshape(columns, -1)
    return Recording(about["name"], about["columns"], rate,
                     drives_of(about, about["part_first"], about["part_first"] + parts.shape[1]), about["epochs"],
                     middles(about["first"], about["end"], width, rate), (about["first"] / rate, (about["end"] - 1) / rate),
                     width == 1, list(outline[:, 0]), list(outline[:, 1]), list(parts),
                     about["part_first"] / rate, record_of(about["drive"]), about["band_from_hz"])


def middles(first, end, width, rate):
    """The middle of each stretch [s]; the last one may be shorter."""
    begins = np.arange(first, end, width)
    return (begins + np.minimum(begins + width, end) - 1) / 2 / rate


def recording_of(samples, about, name=""):
    """The recording of samples by column, and their description."""
    t, rate = samples["t_s"], about["sample_rate_hz"]
    if len(t) == 0:
        raise ValueError("the recording has no samples")
    index = np.rint(np.asarray(t) * rate).astype(np.int64)
    width = 1
    while (index[-1] - index[0]) // width >= MAX_STRETCHES:
        width *= 2
    stretch = (index - index[0]) // width
    begins = np.flatnonzero(np.diff(stretch, prepend=-1))
    part = longest_part(index)
    low, high, parts = [], [], []
    for column, *_ in about["columns"]:
        v = np.asarray(samples[column], dtype=float)
        for values, choose in ((low, np.minimum), (high, np.maximum)):
            values.append(np.full(stretch[-1] + 1, np.nan))
            values[-1][stretch[begins]] = choose.reduceat(v, begins)
        parts.append(v[part])
    return Recording(name, about["columns"], rate, drives_of(about, index[part.start], index[part.stop - 1] + 1), epochs_in(about, index / rate),
                     middles(index[0], index[-1] + 1, width, rate), (index[0] / rate, index[-1] / rate), width == 1, low, high, parts,
                     index[part.start] / rate, record_of(drive_of(about)))


def read(path):
    """Samples by column, and their description."""
    with open(path, "rb") as file:
        samples = np.load(file, max_header_size=10**7)
        return samples, json.loads(np.load(file).item())


def drive_of(about):
    """The section of the scene; None: the recording does not say."""
    try:
        drive = about["provenance"]["scene"]["drive"]
    except (KeyError, TypeError):
        return None
    return drive if isinstance(drive, dict) else None


def is_change(change):
    """Whether it is a live change of the scene. Recordings come from outside."""
    def is_count(value):
        return isinstance(value, int) and 0 <= value < 2**63

    return isinstance(change, dict) and is_count(change.get("epoch")) and is_count(change.get("sample")) and isinstance(change.get("set"), dict)


def changes_of(about):
    """The live changes of the scene, in turn."""
    try:
        changes = about["provenance"]["changes"]
    except (KeyError, TypeError):
        return []
    return [change for change in changes if is_change(change)] if isinstance(changes, list) else []


def drives_of(about, begin=0, end=1):
    """Frequencies of the drive in the samples from `begin` up to `end`, in turn [Hz]; empty: the recording does not say."""
    def is_frequency(value):
        return isinstance(value, (int, float)) and 0 < value < 1e300

    of_scene = (drive_of(about) or {}).get("frequency_hz")
    drives = [of_scene] if is_frequency(of_scene) else []
    for change in changes_of(about):
        frequency = change["set"].get("drive.frequency_hz")
        if change["sample"] < end and is_frequency(frequency) and [frequency] != drives[-1:]:
            drives = drives if change["sample"] > begin else []
            drives.append(frequency)
    return [float(frequency) for frequency in drives]


def record_of(drive):
    """The record that drove the horn, from its first sample on: quantity, times [s], values; None: it moved otherwise."""
    try:
        values = np.asarray(drive["samples"], dtype=float) * (drive["scale"] or 1)
        t = drive["start_s"] + np.arange(len(values)) / drive["sample_rate_hz"]
        velocity = drive["quantity"] == "velocity"
        return ("v_horn", t, values) if velocity else ("x_horn", t, values - values[0])
    except (KeyError, TypeError, ValueError, IndexError):
        return None


def epochs_in(about, t):
    """Number and beginning [s] of the epochs that live changes began; one that began before t at its first time."""
    epochs = [(change["epoch"], change["sample"] / about["sample_rate_hz"]) for change in changes_of(about)]
    before = [(number, t[0]) for number, begin in epochs if begin <= t[0]][-1:]
    return before + [(number, begin) for number, begin in epochs if t[0] < begin <= t[-1]]


def longest_part(index):
    """The longest part without a gap, as a slice of at most MAX_SPECTRUM samples."""
    edges = np.concatenate(([0], np.flatnonzero(np.diff(index) > 1) + 1, [len(index)]))
    longest = np.argmax(np.minimum(np.diff(edges), MAX_SPECTRUM))
    return slice(edges[longest], min(edges[longest + 1], edges[longest] + MAX_SPECTRUM))
