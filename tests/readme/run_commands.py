#!/usr/bin/python3
"""Runs every command that a document shows in a block of code: run_commands.py ROOT BUILD DOCUMENT

A shell runs each command as it stands, in a folder that looks like the project's. A stream, or a replay that waits for a subscriber,
continues during the commands after it until another one takes its port or the document ends; Ctrl-C then ends it. NOT_RUN lists the
commands that are not run, with reasons. A line that is neither a command nor listed fails the test. A block of TOML whose first line is
"# FILE.toml: ..." is saved under that name. A block of "output" has lines that the commands since the last such block print, in their order; "..." stands for others.
"""
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time

LONG_ENOUGH_S = 300  # on a busy machine
ENDPOINT = ("127.0.0.1", 5573)  # the program's own
PROGRAMS = re.compile(r"(\./)?(build/\w+|scripts|bench/\w+|apps/clients|tests)/[\w.]+$|/usr/bin/\w+$|"
                      r"(hertzline|mpirun|sbatch|cmake|ctest|ninja|npm|node|octave-cli|python3?|sh|git|sudo|export|c\+\+|pkg-config)$")

BUILDS = "builds the project"
BUILDS_WHEEL = "builds the module for minutes; the tests python/wheel and python/source_package check the rest"
MINUTES = "takes minutes, or needs an idle machine"
INSTALL = "the tests install/ do it"
CLANG = "needs clang, and minutes"
PACKAGES = "builds packages; scripts/package.sh --try and --reproducible check them"
SLURM = "needs a Slurm; scripts/cluster.sh starts one"

NOT_RUN = {
    "README.md": {
        "./scripts/demo.sh": BUILDS,
        "./scripts/test.sh": "runs this",
        "sudo apt build-dep . && sudo apt install lintian patchelf": PACKAGES,
        "./scripts/package.sh && sudo apt install ./build/packages/*.deb": PACKAGES,
        "./scripts/package.sh --archive": PACKAGES,
        "python3 -m venv env && env/bin/pip install .": BUILDS_WHEEL,
    },
    "CONTRIBUTING.md": {
        "./scripts/test.sh": "runs this",
        "./scripts/docs.sh": "the test readme/manual does it",
        "cmake --workflow --preset release": BUILDS,
        "ninja -C build/release test_core && ctest --preset release -R '^core/'": BUILDS,
    },
    "apps/README.md": {
        "mpirun -n 4 hertzline sweep paper-wall --vary chain.preload_n=0.01..2:log:400 -o m.h5 --shard mpi --resume":
            "the tests apps/SharedSweep do it",
        'sbatch --array=1-8 --wrap "hertzline sweep my-scene.toml --points p.csv -o s.h5 --shard slurm --resume"': SLURM,
        'sbatch --array=3,7 --wrap "hertzline sweep my-scene.toml --points p.csv -o s.h5 --shard slurm/8 --resume"': SLURM,
        'sbatch --ntasks=64 --wrap "srun hertzline sweep my-scene.toml --points p.csv -o s.h5 --shard mpi --resume"': SLURM,
        "hertzline sweep --merge s.h5.*-of-8.journal -o s.h5": SLURM,
    },
    "apps/clients/README.md": {
        "node apps/clients/node_client.js tcp://127.0.0.1:5573 v_out 10000 received.f32": "the tests clients/node do it",
        "from zmq.auth import load_certificate": "a part; apps/python_client_of_an_encrypted_stream has them",
    },
    "apps/python/README.md": {
        "python3 -m venv env && env/bin/pip install .": BUILDS_WHEEL,
        "python3 -m venv --system-site-packages env && env/bin/pip install --no-build-isolation .": BUILDS_WHEEL,
        "python3 -m build --wheel --no-isolation": BUILDS_WHEEL,
    },
    "bench/README.md": {
        "./scripts/build.sh release": BUILDS,
        "build/release/bench_scenes": MINUTES,
        "build/release/bench_stability --json build/stability.json": MINUTES,
        "bench/plots/plot_stability.py build/stability.json --out docs/stability.png": "draws the results of bench_stability",
        "build/release/bench_arrays --json build/arrays.json": MINUTES,
        "bench/plots/plot_arrays.py build/arrays.json --out docs/array-cost.png": "draws the results of bench_arrays",
        "build/release/bench_random_scenes": MINUTES,
        "build/release/bench_work_precision --json build/work_precision.json": MINUTES,
        "build/release/bench_work_precision --scene paper_wall --repetitions 3": MINUTES,
        "build/release/bench_work_precision --check": "is a test of its own, in bench/",
        "bench/plots/plot_work_precision.py build/work_precision.json --out docs/work-precision.png":
            "draws the results of bench_work_precision",
        "build/release/bench_long_chain": MINUTES,
        "bench/lammps/compare.py": "needs LAMMPS",
        "build/release/bench_crossover 10000": MINUTES,
        "build/release/bench_accuracy": MINUTES,
        "build/release/bench_accuracy 0": MINUTES,
        "build/release/bench_accuracy --wet": MINUTES,
        "build/release/bench_accuracy --mixed": MINUTES,
        "build/release/bench_accuracy --arrays": MINUTES,
    },
    "docs/examples/README.md": {
        "scripts/examples.py --build build/release --out build/pictures": "the test python/examples does it",
    },
    "docs/packaging.md": {
        "./scripts/package.sh": PACKAGES,
        "./scripts/package.sh --archive": PACKAGES,
        "./scripts/package.sh --try": PACKAGES,
        "./scripts/package.sh --reproducible": PACKAGES,
    },
    "examples/README.md": {
        "scripts/build.sh release hertzline hertzline_python": BUILDS,
        "cmake --install build/release --prefix ~/hertzline": INSTALL,
        "cmake -S examples -B build/examples -D CMAKE_PREFIX_PATH=~/hertzline": INSTALL,
        "cmake --build build/examples": INSTALL,
        "build/examples/run": INSTALL,
        'export PKG_CONFIG_PATH=$(dirname "$(find ~/hertzline -name hertzline.pc)")': INSTALL,
        "c++ examples/core/peak.cpp $(pkg-config --cflags --libs hertzline-core) -o peak": INSTALL,
        "c++ examples/stream/listen.cpp $(pkg-config --cflags --libs hertzline) -o listen": INSTALL,
    },
    "tests/README.md": {
        "./scripts/test.sh": "runs this",
        "./scripts/test.sh asan tsan": BUILDS,
    },
    "tests/fuzz/README.md": {
        "./scripts/fuzz.sh 900": CLANG,
        "./scripts/fuzz.sh 60 scene_text": CLANG,
        "./scripts/fuzz.sh --keep scene_text": CLANG,
    },
}

# Commands that other people have run before.
BEFORE = {"apps/clients/README.md": "hertzline keys laboratory"}

# Other words in the blocks of commands.
NO_COMMANDS = ("GNU Radio ", "PlotJuggler ")

# Replacements of placeholders, and of commands that would not end.
INSTEAD = {
    "hertzline run SCENE [-o FILE]... [--columns OUTPUT,...] [--tap OUTPUT]... [--measure OUTPUT,...] [--spectrum FILE]... [--plot FILE]":
        "hertzline run paper-wall -o a.csv -o a.npy --columns v_last,v_horn --tap f_last --measure f_last --spectrum s.h5 "
        "--plot a.png",
    "hertzline sweep SCENE --vary KEY=VALUES... -o FILE": "hertzline sweep paper-wall --vary chain.spheres=5,6 -o swept.h5",
    "hertzline field SCENE --plane x=..,z=.. -o FILE": "hertzline field wet-vitreous-carbon --plane x=0..4mm:3,z=10mm -o f.h5",
    "hertzline optimise SCENE --vary KEY=VALUES... --maximise MEASURE -o FILE":
        "hertzline optimise paper-wall --vary chain.preload_n=0.1..1 --maximise thd_r --evaluations 60 -o o.h5",
    "hertzline stream SCENE [--record FILE]... [--columns STREAM,...]":
        "hertzline stream paper-stream --record live.h5 --columns v_out,v_horn",
    "hertzline replay FILE": "hertzline replay a.csv --pace 0.01",
    "hertzline listen [-o FILE]...": "hertzline listen -o heard.h5",
    "hertzline set KEY=VALUE... [--undo]": "hertzline set --help",  # the streams there are not controlled
    "hertzline get [KEY...]": "hertzline get --help",
    "hertzline scope": "timeout --preserve-status -s INT 3 hertzline scope --http 127.0.0.1:0",
    "hertzline plot RECORDING... -o FILE.png": "hertzline plot a.npy -o b.png && test -s a.png && test -s b.png",
    "hertzline scenes [NAME]": "hertzline scenes && hertzline scenes paper-wall",
    "hertzline check SCENE": "hertzline check paper-wall",
    "hertzline keys NAME": "hertzline keys name",
    "hertzline man [PAGE]": "hertzline man run | grep hertzline",
    "hertzline completion SHELL": "hertzline completion bash | bash -n",
    "hertzline check FILE": "hertzline check scenes/paper-wall.toml",
}


def blocks(text):
    """Returns language and lines of each block of code. The language of an indented block is ''."""
    fence = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
    found = [(block.start(), block[1], block[2].splitlines()) for block in fence.finditer(text)]
    blank = fence.sub(lambda block: re.sub("[^\n]", " ", block[0]), text)  # as long as it was
    for block in re.finditer(r"(?<=\n\n)(    .*\n(\n(?=    ))?)+", blank):
        found.append((block.start(), "", [line[4:] for line in block[0].splitlines() if line.strip()]))
    return [block[1:] for block in sorted(found)]


def command_of(line):
    """Returns the command of a line, or None. Two blanks separate a command from its description."""
    cells = re.split(r"\s{2,}", line.removeprefix("$ ").strip())
    return next((cell for cell in cells if PROGRAMS.match(cell.split(" ")[0])), None)


def commands(text):
    """Yields the document's commands and Python programs in their order: language, name, text.

    An indented block without a command is a drawing or a formula."""
    for language, lines in blocks(text):
        if language in ("python", "toml", "output"):
            yield language, lines[0], "\n".join(lines)
        elif language in ("sh", "bash", "console") or not language and any(map(command_of, lines)):
            for line in lines:
                if command := command_of(line):
                    yield "sh", command, command
                elif not line.startswith(("  ", "#") + NO_COMMANDS):
                    raise AssertionError(f"neither a program that is known here nor named in NO_COMMANDS: {line}")


def refuse_other_code(text, root):
    """Checks that C++ in a document is part of an example, which the tests build."""
    examples = [file.read_text() for file in (root / "examples").rglob("*.cpp")]
    for language, lines in blocks(text):
        if language == "cpp" and not any("\n".join(lines) in example for example in examples):
            raise AssertionError("a block of C++ is not part of an example: " + lines[0])


class Folder:
    """A folder that looks like the project's, for the files that the commands write."""

    def __init__(self, path, root, build):
        self.path, self.stream, self.printed = path, None, []
        for entry in root.iterdir():
            if entry.name not in ("build", ".git"):
                (path / entry.name).symlink_to(entry)
        (path / "build").mkdir()
        (path / "build/release").symlink_to(build)
        self.environment = {**os.environ, "HOME": str(path), "PATH": f"{build}:{os.environ['PATH']}",
                            "PYTHONPATH": f"{build}/python", "MPLBACKEND": "Agg"}

    def _start(self, command, output=None):
        print("+", command, flush=True)
        return subprocess.Popen(["bash", "-c", f"set -eo pipefail\n{command}"], cwd=self.path, env=self.environment,
                                stdin=subprocess.DEVNULL, stdout=output, start_new_session=True)

    def _run(self, command, name):
        with tempfile.TemporaryFile("w+", encoding="utf-8") as output:
            try:
                self._finish(self._start(command, output), name)
            finally:
                output.seek(0)
                text = output.read()
                print(text, flush=True)
            self.printed += text.splitlines()

    def run(self, command):
        command = INSTEAD.get(command, command).replace("HOST", "127.0.0.1")
        if re.search(r"hertzline (stream|replay) ", command):
            self.end_stream()
        if re.search(r"hertzline (stream (?!.*--duration)|replay .*--wait-for-subscriber)", command):
            self.stream = self._start("exec " + command)
            self._wait_for_the_port()
            return
        if "hertzline listen" in command or "apps/clients/" in command:
            self.need_stream()
        if "hertzline listen" in command and "--duration" not in command:
            command += " --duration 0.01"
        if command.startswith("ctest"):  # they are tests themselves: are there any?
            command += " -N | grep 'Total Tests: [1-9]'"
        if "--gtest_filter" in command:
            command += " --gtest_list_tests | grep '^  '"
        self._run(command, command)

    def run_python(self, text):
        self.need_stream()
        self._run(f"/usr/bin/python3 - <<'END'\n{text}\nEND", "the program")

    def save(self, text):
        if name := re.match(r"# ([\w-]+\.toml): ", text):
            (self.path / name[1]).write_text(text + "\n", encoding="utf-8")

    def compare(self, text):
        """Checks that the commands since the last comparison printed the lines of the text in their order."""
        printed = (" ".join(line.split()) for line in self.printed)
        for line in text.splitlines():
            assert line == "..." or " ".join(line.split()) in printed, f"is not printed, or not in this order: {line}"
        self.printed = []

    def _finish(self, process, command):
        try:
            status = process.wait(LONG_ENOUGH_S)
        except BaseException:
            process.kill()
            raise
        assert status == 0, f"exit status {status} of {command}"

    def need_stream(self):
        if self.stream is None:
            self.run("hertzline stream paper-stream")

    def _wait_for_the_port(self):
        end = time.monotonic() + LONG_ENOUGH_S
        while self.stream.poll() is None and time.monotonic() < end:
            with socket.socket() as peer:
                if peer.connect_ex(ENDPOINT) == 0:
                    return
            time.sleep(0.05)
        raise AssertionError(f"it does not publish on port {ENDPOINT[1]}")

    def end_stream(self):
        if self.stream is not None:
            self.stream.send_signal(signal.SIGINT)
            stream, self.stream = self.stream, None
            self._finish(stream, "a stream that was interrupted")

    def kill(self):
        if self.stream is not None:
            self.stream.kill()
            self.stream.wait()


def main(root, build, document):
    not_run = NOT_RUN.get(document, {})
    text_of_document = (root / document).read_text()
    shown = list(commands(text_of_document))
    refuse_other_code(text_of_document, root)
    gone = not_run.keys() - {name for _, name, _ in shown}
    assert not gone, f"named as not run, but no longer there: {gone}"
    with tempfile.TemporaryDirectory() as path:
        folder = Folder(pathlib.Path(path), root, build)
        try:
            if document in BEFORE:
                folder.run(BEFORE[document])
            for language, name, text in shown:
                if name in not_run:
                    print(f"not run: {name}: {not_run[name]}", flush=True)
                elif "import hertzline" in text and language == "python" and not (build / "python/hertzline").exists():
                    print(f"not run: {name}: the Python package is not built", flush=True)
                elif language == "python":
                    folder.run_python(text)
                elif language == "toml":
                    folder.save(text)
                elif language == "output":
                    folder.compare(text)
                else:
                    folder.run(text)
            folder.end_stream()
        finally:
            folder.kill()


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), sys.argv[3])
