#!/usr/bin/env python3
"""What `hertzline run` costs beside the simulation: loader, static initialisers, scene and pilots.

    bench/setup_cost.py [--repeat N] BUILD/hertzline [OTHER/hertzline]

Counts the instructions in user mode (`perf stat`), which depend little on what else the machine does, and takes shares from
`perf record` and from what one command does more than another: `check` reads the scene and runs the pilots, `run` simulates as
well. Programs are run in turn, and medians are printed. Needs perf.
"""

import argparse
import os
import re
import statistics
import subprocess
import tempfile

SCENES = ["paper-vitreous-carbon", "paper-acrylic", "paper-aluminium", "paper-pyrex", "paper-silicone-rubber", "paper-wall",
          "paper-stream", "sonic-vacuum"]
NOWHERE = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def counted(command):
    """Instructions in user mode, and the processor's time [ms]."""
    with tempfile.NamedTemporaryFile("r") as report:
        subprocess.run(["perf", "stat", "-x,", "-e", "instructions:u,task-clock", "-o", report.name, *command], check=True, **NOWHERE)
        rows = [line.split(",") for line in report.read().splitlines() if "," in line]
    return float(rows[0][0]), float(rows[1][0])


def medians(commands, repeat):
    """Of each command; the commands are run in turn."""
    found = [[] for _ in commands]
    for _ in range(repeat):
        for command, results in zip(commands, found):
            results.append(counted(command))
    return [tuple(statistics.median(column) for column in zip(*results)) for results in found]


def objects(command):
    """Share of the instructions by the file in which they stand."""
    with tempfile.TemporaryDirectory() as folder:
        data = os.path.join(folder, "perf.data")
        subprocess.run(["perf", "record", "-q", "-c", "5000", "-e", "instructions:u", "-o", data, *command], check=True, **NOWHERE)
        report = subprocess.run(["perf", "report", "-i", data, "--stdio", "--sort", "dso"], check=True, capture_output=True, text=True)
    rows = re.findall(r"^\s*([\d.]+)%\s+(\S+)", report.stdout, re.MULTILINE)
    return {name: float(share) / 100 for share, name in rows}


def loader(program):
    """What the loader says of itself: cycles, and symbols looked up."""
    said = subprocess.run([program, "--version"], env=dict(os.environ, LD_DEBUG="statistics"), capture_output=True, text=True,
                          check=True).stderr
    cycles = int(re.search(r"total startup time in dynamic loader: (\d+)", said)[1])
    return cycles, int(re.search(r"final number of relocations: (\d+)", said)[1])


def libraries(program):
    return len(subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout.splitlines())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--repeat", type=int, default=20)
    arguments = parser.parse_args()
    folder = tempfile.TemporaryDirectory()
    output = os.path.join(folder.name, "run.csv")
    for program in arguments.programs:
        cycles, symbols = loader(program)
        shares = objects([program, "--version"])
        parts = {"loader": "ld-linux", "libstdc++": "libstdc++", "hertzline": "hertzline"}
        split = {part: sum(s for name, s in shares.items() if name.startswith(prefix)) for part, prefix in parts.items()}
        print(f"{program}: {libraries(program)} libraries, {symbols} symbols looked up, {cycles / 1e6:.1f} million cycles in the loader")
        print("  --version: " + ", ".join(f"{part} {share:.0%}" for part, share in split.items()))
    print("million instructions (ms of processor time), median")
    print(f"{'scene':24}{'program':10}{'--version':>18}{'check':>18}{'run':>18}")
    for scene in SCENES:
        commands = [[program, *words] for program in arguments.programs
                    for words in (["--version"], ["check", scene], ["run", scene, "-o", output])]
        found = medians(commands, arguments.repeat)
        for number in range(len(arguments.programs)):
            cells = [f"{count / 1e6:9.1f} ({time:5.1f})" for count, time in found[3 * number:3 * number + 3]]
            print(f"{scene:24}{number + 1:<10}" + "".join(f"{cell:>18}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
