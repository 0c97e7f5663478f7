#!/usr/bin/python3
"""Runs a command with a folder of its own as its last word: in_folder.py COMMAND..."""
import subprocess
import sys
import tempfile

with tempfile.TemporaryDirectory() as folder:
    sys.exit(subprocess.run([*sys.argv[1:], folder], check=False).returncode)
