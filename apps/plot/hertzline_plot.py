#!/usr/bin/python3
"""Draws waveform and spectrum of each column of a NumPy recording of hertzline, a sweep or a field: hertzline_plot.py FILE -o FILE.png

hertzline runs it for `hertzline plot` and `hertzline run --plot`, with recordings that it has reduced to what a picture shows; by
itself it draws recordings that end in .npy, and tables of `hertzline sweep` and `hertzline field`. A waveform of many samples is
drawn as the smallest and largest of each pixel. The spectrum is that of docs/measures.md: no window, in dB under the maximum from
half the drive's frequency upward, of the first million samples without a gap. Of a sweep it draws curves over one key that varies,
a map over two, or waveforms; of a search what it looked for over each key and as the search went on; of a field the beam, and with
--kind the spectrum at a point, the pressure over time along a line, or a movie of a plane.
Debian: python3-numpy python3-matplotlib (with python3-pil), for tables that end in .h5 python3-h5py.
"""
import argparse
import math
import os
import sys

MODULES_MISSING = 3  # exit status
NOT_A_SWEEP = 4
WRONG_USE = 5
UNREADABLE = 6

FOLDER = os.getcwd()
os.chdir("/")  # a user's settings may ask for LaTeX or a window; matplotlib looks for them in the folder first
os.environ.update(MATPLOTLIBRC=os.devnull, MPLBACKEND="agg")
try:
    from hertzline_pictures import fields, recordings, style, sweeps, tables, waveforms
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(MODULES_MISSING)
os.chdir(FOLDER)


def list_of(text):
    return text.split(",")


def places_of(text):
    """"x,y,z;x,y,z" [m]"""
    return [[float(number) for number in place.split(",")] for place in text.split(";")]


def figure_of(arguments):
    """A figure, or the frames of a movie."""
    path = arguments.recording
    if path.endswith(".json"):
        return waveforms.draw(recordings.reduced_recordings(path), arguments.title)
    if path.endswith(".npy"):
        return waveforms.draw([recordings.recording_of(*recordings.read(path))], arguments.title)
    sweep = tables.read_sweep(path)
    if arguments.kind:
        fields.require_field(sweep, arguments.kind)
        if arguments.kind != "beam":
            return fields.draw_waveforms(sweep, path, arguments)
    if arguments.columns:
        if not path.endswith(".h5"):
            raise style.WrongUse("--columns: found a sweep as CSV, allowed: one that ends in .h5 and was made with --waveforms")
        return sweeps.draw_waveforms(sweep, path, arguments.columns, arguments.title)
    return sweeps.draw_sweep(sweep, arguments.quantity, arguments.title)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("recording", help="a recording of hertzline that ends in .npy, or a sweep or field: .h5, .csv")
    parser.add_argument("-o", "--output", required=True, help="the picture")
    parser.add_argument("--format", help="png, svg or pdf (default: the ending of the picture); a movie is a GIF")
    parser.add_argument("--title", default="", help="stands above")
    parser.add_argument("--quantity", type=list_of, default=[], help="of a sweep: draw these numbers")
    parser.add_argument("--columns", type=list_of, default=[], help="of a sweep: draw the waveforms of this output")
    parser.add_argument("--kind", choices=fields.KINDS, help="of a field (default: beam); all but beam need waveforms")
    parser.add_argument("--at", type=places_of, default=[], metavar="X,Y,Z;...", help="points of the spectra [m]")
    parser.add_argument("--from", type=float, default=0, dest="begin", help="of a field's waveforms [s]")
    parser.add_argument("--to", type=float, default=math.inf, dest="end", help="of a field's waveforms [s]")
    parser.add_argument("--frames", type=int, help="of a movie")
    arguments = parser.parse_args()
    figure = figure_of(arguments)
    if arguments.kind == "movie":
        fields.save_movie(figure, arguments.output)
    else:
        figure.savefig(arguments.output, format=arguments.format, dpi=110, facecolor="white")


if __name__ == "__main__":
    try:
        main()
    except ImportError as missing:
        print(missing, file=sys.stderr)
        sys.exit(MODULES_MISSING)
    except tables.NotASweep:
        print("it is no sweep", file=sys.stderr)
        sys.exit(NOT_A_SWEEP)
    except style.WrongUse as error:
        print(error, file=sys.stderr)
        sys.exit(WRONG_USE)
    except tables.Unreadable as error:
        print(error, file=sys.stderr)
        sys.exit(UNREADABLE)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"{error}")
