"""Common parts of the project's pictures: their style, and the command line of those drawn from results."""
import argparse
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "apps" / "plot"))
from hertzline_pictures.style import STYLE  # noqa: E402 (its folder has to be known first)


def use_style(font_size=10):
    matplotlib.rcParams.update(STYLE | {"font.size": font_size})


def draw_results(description, bench, default_png, draw):
    """Reads the results of a benchmark and draws the picture by draw(results, png)."""
    parser = argparse.ArgumentParser(description=description.split("\n", maxsplit=1)[0])
    parser.add_argument("results", type=pathlib.Path, help=f"file of {bench} --json")
    parser.add_argument("--out", type=pathlib.Path, default=default_png, help="picture (%(default)s)")
    arguments = parser.parse_args()
    try:
        draw(json.loads(arguments.results.read_text(encoding="utf-8")), arguments.out)
        print(arguments.out)
    except (OSError, ValueError) as error:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {error}")
