#!/usr/bin/env python3
"""Measures the time of `hertzline run` beside the simulation: scene, pilots, spectra, summary.

    bench/setup_cost.py [--repeat N] BUILD/hertzline [OTHER/hertzline]

`--version` measures the start of the program alone. The set-up is the time of `run` less that start and less its own wall_s.
Programs run in turn; medians are printed [ms].
"""

import argparse
import json
import os
import statistics
import subprocess
import time

SCENES = ["paper-vitreous-carbon", "paper-acrylic", "paper-aluminium", "paper-pyrex", "paper-silicone-rubber", "paper-wall",
          "sonic-vacuum"]


def timed(command):
    """Returns wall time and processor time of a command [ms]."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    to_nowhere = [(os.POSIX_SPAWN_DUP2, nowhere, 1), (os.POSIX_SPAWN_DUP2, nowhere, 2)]
    begin = time.perf_counter()
    child = os.posix_spawn(command[0], command, os.environ, file_actions=to_nowhere)
    _, status, used = os.wait4(child, 0)
    end = time.perf_counter()
    os.close(nowhere)
    if status != 0:
        raise SystemExit(f"{' '.join(command)}: status {status}")
    return 1e3 * (end - begin), 1e3 * (used.ru_utime + used.ru_stime)


def summary_of(command):
    return json.loads(subprocess.run([*command, "--json"], capture_output=True, text=True, check=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--repeat", type=int, default=60)
    arguments = parser.parse_args()
    print(f"{'scene':24}{'program':>8}{'--version':>11}{'run':>8}{'wall_s':>8}{'setup_s':>9}{'set-up':>8}{'of the processor':>18}")
    for scene in SCENES:
        programs = [os.path.abspath(program) for program in arguments.programs]
        found = [[] for _ in programs]
        for _ in range(arguments.repeat):
            for program, times in zip(programs, found):
                times.append((*timed([program, "--version"]), *timed([program, "run", scene])))
        for number, (program, times) in enumerate(zip(programs, found), 1):
            start, start_cpu, run, run_cpu = (statistics.median(column) for column in zip(*times))
            summaries = [summary_of([program, "run", scene]) for _ in range(9)]
            wall, pilots = (1e3 * statistics.median(s[name] for s in summaries) for name in ("wall_s", "setup_s"))
            print(f"{scene:24}{number:8}{start:11.2f}{run:8.2f}{wall:8.2f}{pilots:9.2f}{run - start - wall:8.2f}"
                  f"{run_cpu - start_cpu - wall:18.2f}", flush=True)


if __name__ == "__main__":
    main()
