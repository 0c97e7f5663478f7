"""Runs the program for the tests of clients: a stream on a free port, and a run of the same scene."""
import subprocess
import numpy as np

LONG_ENOUGH_S = 100  # for a loaded machine with sanitizers


class Stream:
    """hertzline stream (or replay), which ends with the block at the latest. `endpoint` is the bound one, `said` the messages up to it."""

    def __init__(self, program, scene, *words, command="stream"):
        self.process = subprocess.Popen([program, command, scene, "--bind", "tcp://127.0.0.1:*", "--json", *words],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.said = ""
        for line in self.process.stderr:
            self.said += line
            if "endpoint " in line:
                self.endpoint = line.split()[-1]
                return
        raise RuntimeError("no endpoint, but: " + self.said)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def summary(self):
        """Waits for the end. Returns the text of --json."""
        out, errors = self.process.communicate(timeout=LONG_ENOUGH_S)
        assert self.process.returncode == 0, errors
        return out


def samples_of_run(program, folder, scene, stream, samples, rate_hz):
    """Returns the stream's samples from `hertzline run` as float32, [sample][channel]."""
    file = f"{folder}/run.csv"
    subprocess.run([program, "run", scene, "--all", "--tap", "f_chain", "--set", f"output.duration_s={samples / rate_hz}", "-o", file],
                   check=True, timeout=LONG_ENOUGH_S, stdout=subprocess.DEVNULL)
    with open(file) as csv:
        names = csv.readline().strip().split(",")
    of_chain = {"v_chain": "v{}_m_per_s", "f_chain": "f{}_n"}.get(stream)
    wanted = [of_chain.format(k) for k in range(1, len(names))] if of_chain else [f"{stream}_m_per_s"]
    columns = [names.index(name) for name in wanted if name in names]
    return np.loadtxt(file, delimiter=",", skiprows=1, usecols=columns, ndmin=2)[:samples].astype("<f4")
