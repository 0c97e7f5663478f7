#!/usr/bin/python3
"""Checks that live_plot.py draws a picture of a running stream: live_plot_draws.py HERTZLINE LIVE_PLOT..."""
import subprocess, sys, tempfile
from streaming import LONG_ENOUGH_S, Stream

program, *client = sys.argv[1:]
for name in "v_out", "v_chain":
    with tempfile.TemporaryDirectory() as folder, Stream(program, "paper-stream") as stream:
        subprocess.run([*client, stream.endpoint, name, f"{folder}/live.png"], check=True, timeout=LONG_ENOUGH_S)
        with open(f"{folder}/live.png", "rb") as picture:
            assert picture.read(8) == b"\x89PNG\r\n\x1a\n"
