"""Pictures of recordings, sweeps, searches and fields: apps/plot/hertzline_plot.py draws them for the program, `import hertzline` for Python."""
from .recordings import recording_of
from .sweeps import draw_sweep
from .tables import Sweep
from .waveforms import draw

__all__ = ["Sweep", "draw", "draw_sweep", "recording_of"]
