#!/usr/bin/python3
"""Compares a long granular chain in LAMMPS and in hertzline, one core each: the wave, and the time of a sphere-step.

    bench/lammps/compare.py [--build build/release] [--spheres 10000] [--steps 300] [--rounds 5]

Needs LAMMPS (Debian: apt-get install lammps) and a built bench_long_chain. Times are processor times, the lowest of several
rounds in turn.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve().parent
root = here.parent.parent
touching_m = 1e-3
pressed_m = 1e-3 - 2.4668e-7  # by the default preload, 0.1 N


def lammps(folder, spheres, gap, damping, steps, kick):
    """Returns the processor time of the steps [s], and the spheres' velocities after them."""
    variables = {"N": spheres, "gap": gap, "damping": damping, "steps": steps, "kick": kick, "out": folder + "/dump"}
    command = ["lmp", "-in", str(here / "chain.in"), "-log", "none"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    run = subprocess.run(command, env=dict(os.environ, OMP_NUM_THREADS="1"), capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(run.stdout[-2000:] + run.stderr)
    wall = float(re.search(r"Loop time of (\S+)", run.stdout)[1])
    share = float(re.search(r"(\S+)% CPU use", run.stdout)[1]) / 100
    rows = open(folder + "/dump").read().split("id vx")[1].strip().splitlines()
    return wall * min(share, 1), [float(row.split()[1]) for row in rows]


def hertzline(build, *arguments):
    run = subprocess.run([build / "bench_long_chain", *map(str, arguments)], capture_output=True, text=True, check=True)
    return [float(line.split()[1]) for line in run.stdout.splitlines()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=root / "build/release")
    parser.add_argument("--spheres", type=int, default=10_000)
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    if shutil.which("lmp") is None:
        sys.exit("LAMMPS is not installed; on Debian: apt-get install lammps")

    with tempfile.TemporaryDirectory() as folder:
        steps = 4000
        theirs = lammps(folder, 200, touching_m, 0.01, steps, "first")[1]
        ours = hertzline(arguments.build, "pulse", 200, steps, 0.01)
        peak_at = lambda velocities: max(range(len(velocities)), key=velocities.__getitem__) + 1
        ahead = slice(40, None)  # behind follow the waves that hertzline's horn has reflected
        difference = max(abs(a - b) for a, b in zip(ours[ahead], theirs[ahead])) / max(theirs)
        print(f"first of 200 touching spheres kicked, {steps * 25e-3:.0f} us later: pulse at sphere {peak_at(ours)}, "
              f"{max(ours):.4f} m/s; LAMMPS {peak_at(theirs)}, {max(theirs):.4f} m/s; largest difference of a velocity "
              f"{100 * difference:.2f} % of the pulse")
        if difference > 0.01:
            sys.exit("not the same wave")

        slow, fast = [], []
        for _ in range(arguments.rounds):
            seconds = lammps(folder, arguments.spheres, pressed_m, 0.32, arguments.steps, "all")[0]
            slow.append(seconds / arguments.steps / arguments.spheres * 1e9)
            fast += hertzline(arguments.build, arguments.spheres)
    print(f"{arguments.spheres} spheres, all moving [ns per sphere-step]: LAMMPS {min(slow):.1f}, hertzline {min(fast):.3f}; "
          f"ratio {min(slow) / min(fast):.0f}, in the {arguments.rounds} rounds "
          + " ".join(f"{a / b:.0f}" for a, b in zip(slow, fast)))


if __name__ == "__main__":
    main()
