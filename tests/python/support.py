"""Shared by the tests of the Python package: the program, and short scenes."""
import importlib
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import hertzline

PROGRAM = os.environ["HERTZLINE_PROGRAM"]
LONG_ENOUGH_S = 100  # for a loaded machine


def program(*words):
    """Returns the program's output."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=LONG_ENOUGH_S, check=False)
    if done.returncode != 0:
        raise AssertionError(f"exit status {done.returncode}: {done.stderr}")
    return done.stdout


def summary(*words):
    return json.loads(program(*words, "--json"))


def optional(name):
    """The module. Skips the test where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise unittest.SkipTest(f"{name} is not there") from None


def short_scene(**sections):
    """Three cycles, 100 µs."""
    sections = {"drive": {"cycles": 3}, "output": {"duration_s": 1e-4}, **sections}
    return hertzline.scene("paper-vitreous-carbon", **sections)


SHORT = ["paper-vitreous-carbon", "--set", "drive.cycles=3", "--set", "output.duration_s=1e-4"]


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
