#!/usr/bin/python3
"""Sweeps on several ranks, each function a test: ranks.py TEST --program hertzline --mpi-program hertzline-mpi

What hertzline gives in one thread is what hertzline-mpi has to give on any number of ranks, to the byte. More ranks than
processors are no matter, so mpirun may start them, and root may: the tests run in containers.
"""
import argparse
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

LONG_ENOUGH_S = 120  # for a loaded machine
SCENE = ["paper-wall", "--set", "output.duration_s=5e-5", "--set", "drive.cycles=2"]
FEW = [*SCENE, "--vary", "chain.preload_n=0.01..1:log:30", "--vary", "chain.spheres=3..6:4"]
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none",
               "OMPI_MCA_plm_rsh_agent": "/bin/false",  # this machine alone
               "OMPI_MCA_btl": "self,vader", "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}


class Programs:
    def __init__(self, program, mpi_program):
        self.program, self.mpi_program = program, mpi_program

    def alone(self, *words):
        return finished(start([self.program, "sweep", *words]))

    def ranks(self, count, *words):
        return finished(self.start_ranks(count, *words))

    def start_ranks(self, count, *words):
        return start(["mpirun", "-n", str(count), self.mpi_program, "sweep", *words])


class Outcome:
    def __init__(self, status, out, err):
        self.status, self.out, self.err = status, out, err


def start(words):
    return subprocess.Popen([str(word) for word in words], env=ENVIRONMENT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def finished(process):
    try:
        out, err = process.communicate(timeout=LONG_ENOUGH_S)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        raise AssertionError(f"it did not end: {out}{err}")
    return Outcome(process.returncode, out, err)


def done(outcome):
    assert outcome.status == 0, outcome.err
    return outcome


def expect(found, wanted, what):
    assert found == wanted, f"{what}: found {found!r}, expected {wanted!r}"


def ranks_of(mpirun):
    """The ranks that mpirun has started: number, process."""
    found = {}
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            parent = int((path / "stat").read_text().rpartition(")")[2].split()[1])
            environment = (path / "environ").read_bytes().split(b"\0")
        except OSError:  # it has ended, or is another user's
            continue
        for entry in environment:
            name, _, value = entry.partition(b"=")
            if parent == mpirun.pid and name == b"OMPI_COMM_WORLD_RANK":
                found[int(value)] = int(path.name)
    return found


def journal_of_lost(programs, folder, count, lost):
    """A long sweep, one rank of which is killed when there are some rows."""
    file = folder / "lost.csv"
    journal = folder / "lost.csv.journal"
    words = [*LONG, "-o", file]
    process = programs.start_ranks(count, *words)
    end = time.monotonic() + LONG_ENOUGH_S
    while not (journal.exists() and journal.stat().st_size > 40_000):
        assert process.poll() is None, finished(process).err
        assert time.monotonic() < end, "no rows came"
        time.sleep(0.002)
    os.kill(ranks_of(process)[lost], signal.SIGKILL)
    outcome = finished(process)
    assert outcome.status != 0, "a rank was lost, and nobody noticed"
    assert journal.exists() and not file.exists(), "the journal is gone"
    return words, file, journal


LONG = [*SCENE, "--vary", "chain.preload_n=0.01..1:log:4000"]


def undisturbed(programs, folder):
    done(programs.alone(*LONG, "-o", folder / "whole.csv", "--jobs", 1))
    return (folder / "whole.csv").read_bytes()


# The tests.


def any_number_of_ranks_gives_the_same_bytes(programs, folder):
    words = [*FEW, "--measure", "f_last", "--waveforms", "v_out"]
    done(programs.alone(*words, "-o", folder / "alone.h5", "--jobs", 1))
    for count in (1, 2, 3):
        outcome = done(programs.ranks(count, *words, "-o", folder / f"{count}.h5"))
        expect((folder / f"{count}.h5").read_bytes() == (folder / "alone.h5").read_bytes(), True, f"{count} ranks: same")
        assert f"on {count} rank{'s' if count > 1 else ''} of 1 thread" in outcome.err, outcome.err
        assert not (folder / f"{count}.h5.journal").exists()


def threads_of_ranks_shards_and_stdout_give_the_same_rows(programs, folder):
    alone = done(programs.alone(*FEW, "--json", "--jobs", 1)).out
    expect(done(programs.ranks(2, *FEW, "--json", "--jobs", 2)).out == alone, True, "2 ranks of 2 threads: same")
    done(programs.alone(*FEW, "-o", folder / "alone.csv"))
    done(programs.ranks(2, *FEW, "-o", folder / "s.csv", "--shard", "1/2"))
    done(programs.alone(*FEW, "-o", folder / "s.csv", "--shard", "2/2"))
    done(programs.ranks(2, "--merge", folder / "s.csv.1-of-2.journal", folder / "s.csv.2-of-2.journal", "-o", folder / "m.csv"))
    expect((folder / "m.csv").read_bytes() == (folder / "alone.csv").read_bytes(), True, "merged: same")


def a_lost_rank_leaves_what_was_done_to_be_resumed_without_mpi(programs, folder):
    words, file, journal = journal_of_lost(programs, folder, 3, lost=2)
    outcome = done(programs.alone(*words, "--resume"))
    assert f"of 4000 points are in {journal}" in outcome.err, outcome.err
    expect(file.read_bytes() == undisturbed(programs, folder), True, "resumed: same")


def a_lost_rank_0_leaves_what_was_done_to_be_resumed_with_mpi(programs, folder):
    words, file, journal = journal_of_lost(programs, folder, 2, lost=0)
    outcome = done(programs.ranks(3, *words, "--resume"))
    assert f"of 4000 points are in {journal}" in outcome.err, outcome.err
    expect(file.read_bytes() == undisturbed(programs, folder), True, "resumed: same")


def ctrl_c_saves_what_is_done(programs, folder):
    # mpirun passes no more messages on once it was interrupted
    process = start(["mpirun", "-n", "2", "sh", "-c", f'exec "$0" "$@" 2>{folder}/messages.$OMPI_COMM_WORLD_RANK',
                     programs.mpi_program, "sweep", *SCENE, "--vary", "chain.preload_n=0.01..1:log:200000", "-o", folder / "s.csv"])
    journal = folder / "s.csv.journal"
    end = time.monotonic() + LONG_ENOUGH_S
    while not (journal.exists() and journal.stat().st_size > 40_000):
        assert time.monotonic() < end, "no rows came"
        time.sleep(0.002)
    os.kill(process.pid, signal.SIGINT)
    outcome = finished(process)
    assert outcome.status != 0
    messages = (folder / "messages.0").read_text()
    assert f"of 200000 points, which are in {journal}: the same command with --resume goes on" in messages, messages
    expect((folder / "messages.1").read_text(), "", "messages of rank 1")
    assert journal.stat().st_size > 40_000


def faults_are_told_once_and_the_exit_status_is_that_of_a_sweep(programs, folder):
    wrong = programs.ranks(3, "paper-wall", "--vary", "chain.sphere=3,4", "-o", folder / "a.csv")
    expect(wrong.status, 2, "exit status of a wrong plan")
    expect(wrong.err.count('found "chain.sphere"'), 1, "messages")
    expect(programs.alone("paper-wall", "--vary", "chain.sphere=3,4", "-o", folder / "a.csv").status, 2, "alone")
    unknown = programs.ranks(2, *FEW, "--nonsense")
    expect(unknown.status, 2, "exit status of an unknown option")
    expect(unknown.err.count("hertzline-mpi sweep --help says what is allowed"), 1, "messages")
    unwritable = programs.ranks(2, *FEW, "-o", folder / "none" / "a.csv")
    expect(unwritable.status, 1, "exit status where nothing can be written")
    expect(unwritable.err.count("error: "), 1, "messages")
    expect(list(folder.iterdir()), [], "files left behind")
    assert "SCENE" in done(programs.ranks(2, "--help")).out


def ranks_take_the_instruction_set_that_is_named(programs, folder):
    wrong = programs.ranks(2, *FEW, "--target", "AVX9", "-o", folder / "a.csv")
    expect(wrong.status, 2, "exit status of an unknown instruction set")
    names = wrong.err.partition("allowed: ")[2].partition(", the instruction sets")[0].split(", ")
    narrow = ["--target", names[-1]]
    done(programs.alone(*FEW, *narrow, "-o", folder / "alone.csv"))
    done(programs.ranks(2, *FEW, *narrow, "-o", folder / "ranks.csv"))
    expect((folder / "ranks.csv").read_bytes() == (folder / "alone.csv").read_bytes(), True, f"{names[-1]}: same")
    if len(names) > 1:
        done(programs.alone(*FEW, "-o", folder / "wide.csv"))
        assert (folder / "wide.csv").read_bytes() != (folder / "alone.csv").read_bytes(), "instruction sets give the same bits"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("test")
    parser.add_argument("--program", required=True)
    parser.add_argument("--mpi-program", required=True)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        getattr(sys.modules[__name__], arguments.test)(Programs(arguments.program, arguments.mpi_program), pathlib.Path(name))


if __name__ == "__main__":
    main()
