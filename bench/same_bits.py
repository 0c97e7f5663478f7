#!/usr/bin/env python3
"""Compares two builds of hertzline bit by bit: same_bits.py OLD NEW [--quick]

Runs both programs on each shipped scene with each integrator, and on sweeps, a search, recordings of every format and of a stream,
compares the files, and prints a line for each. Exit status 1 when one differs. --quick: the unchanged scenes only.
The provenance of recordings differs (commit, date), so only their samples are compared, as the Python module beside NEW reads them.
"""
import argparse
import hashlib
import pathlib
import subprocess
import sys
import tempfile

SLOW = {"long-chain", "paper-stream", "paper-stream-symplectic"}
SERIES = ["taylor8", "taylor12"]
INTEGRATORS = ["leapfrog", "chin4a", *SERIES]
FORMATS = ["csv", "h5", "npy", "wav", "sigmf-meta", "sigmf-collection"]


def digest_of(path):
    """Returns the digest of a file's data: of a table the lines that do not begin with '#', of a recording the samples."""
    if path.suffix == ".csv":
        data = b"".join(line for line in path.read_bytes().splitlines(True) if not line.startswith(b"#"))
    else:
        import hertzline  # from the folder of NEW
        recording = hertzline.load(path)
        data = b"".join(recording[name].tobytes() for name, _, _ in recording.columns)
    return hashlib.sha256(data).hexdigest()[:16]


def outcome(program, arguments, output):
    """Returns the digest of the file that a call writes, or the message of a refusal."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([program, *arguments, output], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            return f"{done.stderr.strip().splitlines()[-1][:60]}"
        return digest_of(pathlib.Path(folder) / output)


def calls(quick):
    scenes = sorted(path.stem for path in (pathlib.Path(__file__).parent.parent / "scenes").glob("*.toml"))
    for scene in scenes:
        short = ["--set", "output.duration_s=2e-4"] if scene in SLOW else []
        known = SERIES if scene.startswith("wet-") else INTEGRATORS  # grids refuse modal plates
        for integrator in [""] + ([] if quick else known):
            chosen = ["--set", f"numerics.integrator={integrator}"] if integrator else []
            yield f"run {scene} {integrator}", ["run", scene, "--all", *short, *chosen, "-o"], "a.csv"
    if quick:
        return
    for ending in FORMATS:
        yield f"recording .{ending}", ["run", "paper-wall", "--tap", "f_last", "-o"], f"a.{ending}"
    yield "spectrum", ["run", "paper-vitreous-carbon", "-o", "samples.csv", "--spectrum"], "a.csv"
    device = "paper-vitreous-carbon"
    yield "sweep", ["sweep", device, "--vary", "chain.preload_n=0.01..2:log:100", "--vary", "end.material=pyrex,acrylic", "-o"], "s.csv"
    yield "sweep of Sobol points", ["sweep", device, "--vary", "chain.preload_n=0.01..2:log", "--vary",
                                    "end.thickness_m=1e-4..2e-3:log", "--sobol", "64", "-o"], "s.csv"
    yield "sweep of wet plates", ["sweep", "wet-vitreous-carbon", "--vary", "chain.preload_n=0.05..0.5:log:6", "-o"], "s.csv"
    yield "search", ["optimise", device, "--vary", "chain.preload_n=0.01..2:log", "--vary", "end.thickness_m=1e-4..2e-3:log",
                     "--maximise", "peak_v_out_m_per_s", "--evaluations", "120", "-o"], "s.csv"
    yield "stream", ["stream", "paper-stream", "--duration", "0.01", "--pace", "flat-out", "--bind", "ipc://unheard", "--record"], "a.csv"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true", help="the unchanged shipped scenes only")
    options = parser.parse_args()
    sys.path.insert(0, str(options.new.resolve().parent / "python"))
    differ = 0
    for name, arguments, output in calls(options.quick):
        old, new = (outcome(program.resolve(), arguments, output) for program in (options.old, options.new))
        differ += old != new
        print(f"{'same     ' if old == new else 'DIFFERENT'} {new}  {name}" + ("" if old == new else f"  (was {old})"), flush=True)
    print(f"{differ} differ")
    sys.exit(1 if differ else 0)


if __name__ == "__main__":
    main()
