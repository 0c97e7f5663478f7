"""Simulates a chain of spheres that an ultrasonic horn pushes. The results are those of the program `hertzline`, bit for bit.

    import hertzline
    s = hertzline.scene("paper-vitreous-carbon", end={"thickness_m": 0.4e-3})
    r = s.run(taps=["v_out", "v_chain"])
    r.t, r["v_out"], r.summary

All numbers are in SI units, and the names say which: `thickness_m`, `preload_n`, `peak_v_out_m_per_s`.

A wrong scene or argument is a `ValueError` that names every fault, a line each: its place, what was found and what is
allowed. A file that cannot be read or written is an `OSError`, too little memory a `MemoryError`, a motion that
becomes unstable a `RuntimeError`. While it computes, other threads of Python run, and Ctrl-C ends it.

FFTW is used for spectra: no other code of the process (pyfftw) may plan with it at the same time.
"""

from ._live import Block, Control, GapError, Live, control, listen
from ._native import version as __version__
from ._recording import Recording, load
from ._samples import Samples, Spectrum
from ._scene import Result, Scene, materials, scene, scenes
from ._simulation import Simulation
from ._studies import SearchResult, Table, optimise, sweep

__all__ = [
    "Block",
    "Control",
    "GapError",
    "Live",
    "Recording",
    "Result",
    "Samples",
    "Scene",
    "SearchResult",
    "Simulation",
    "Spectrum",
    "Table",
    "__version__",
    "control",
    "listen",
    "load",
    "materials",
    "optimise",
    "scene",
    "scenes",
    "sweep",
]
