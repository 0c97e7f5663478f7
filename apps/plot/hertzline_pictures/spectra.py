"""Spectra as docs/measures.md defines them: no window, in dB under the maximum from half the drive's frequency upward."""
import numpy as np

from .recordings import MAX_STRETCHES

SPAN_DB = (-60, 6)
HARMONICS = 10


def spectrum(v, rate, lowest):
    """Frequency [Hz] and amplitude [of the largest from `lowest` upward]; None of silence."""
    padded = 4 * len(v)
    magnitude = np.abs(np.fft.rfft(v / (np.abs(v).max() or 1), padded))  # 1e308 has no square
    frequency = np.fft.rfftfreq(padded, 1 / rate)
    largest = magnitude[frequency >= lowest].max(initial=0)
    return (frequency, magnitude / largest) if largest > 0 else None


def band_of(frequency, amplitude, lowest, threshold_db):
    """Where the level first and last reaches the threshold from `lowest` upward, with straight lines between the amplitudes."""
    threshold = 10 ** (threshold_db / 20)
    above = np.flatnonzero((amplitude >= threshold) & (frequency >= lowest))

    def crossing(inside, outside):
        if not 0 <= outside < len(frequency) or frequency[outside] < lowest:
            return frequency[inside]
        share = (amplitude[inside] - threshold) / (amplitude[inside] - amplitude[outside])
        return frequency[inside] + share * (frequency[outside] - frequency[inside])

    return crossing(above[0], above[0] - 1), crossing(above[-1], above[-1] + 1)


def prepare_spectrum(axes, highest, drive):
    axes.set_xlim(0, highest / 1e3)
    axes.set_ylim(*SPAN_DB)
    axes.set_yticks([-60, -40, -20, 0])
    axes.grid(axis="y")
    axes.axhline(-20, color="#555555", lw=0.8, ls=(0, (4, 3)))
    for k in range(1, int(highest // drive) + 1 if drive else 1):
        axes.axvline(k * drive / 1e3, color="#bbbbbb", lw=0.6, zorder=0)


def levels_up_to(highest, frequency, amplitude):
    """Frequencies, and levels [dB]; of many the largest of each pixel."""
    shown = np.searchsorted(frequency, highest, side="right")
    begins = np.arange(0, shown, -(-shown // MAX_STRETCHES))
    return frequency[begins], 20 * np.log10(np.maximum(np.maximum.reduceat(amplitude[:shown], begins), 1e-15))


def draw_spectrum(axes, v, rate, lowest, highest, style, shaded):
    """Draws the levels, under the maximum from `lowest` upward. Returns the band at -20 dB as text."""
    lines = spectrum(v, rate, lowest)
    if lines is None:
        return "silence" if lowest <= rate / 2 else f"no level: half the sample rate is below {lowest / 1e3:.4g} kHz"
    low, high = (edge / 1e3 for edge in band_of(*lines, lowest, -20))
    frequency, level = levels_up_to(highest, *lines)
    axes.plot(frequency / 1e3, level, lw=0.8, **style)
    if shaded:
        axes.axvspan(low, high, color=style["color"], alpha=0.08, lw=0)
        axes.fill_between(frequency / 1e3, level, SPAN_DB[0], color=style["color"], alpha=0.15, lw=0)
    return f"\u221220 dB: {low:.4g} to {high:.4g} kHz"
