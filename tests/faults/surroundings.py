"""Disturbances of a stream by users and the system: signals, closed and broken files, another clock or language."""
import contextlib
import ctypes
import json
import os
import signal
import subprocess
import sys
import time

import stand as stands
from stand import check, wait_until

def stopped_and_continued_again_and_again(stand):
    with stand.stream() as stream:
        for _ in range(200):  # calls that wait return with EINTR (signal(7)); each stop is shorter than a queue
            stream.process.send_signal(signal.SIGSTOP)
            time.sleep(0.002)
            stream.process.send_signal(signal.SIGCONT)
            time.sleep(0.003)


def signals_again_and_again(stand):
    """Sends signals to each thread that does not block them, about ten thousand in all."""
    tgkill = ctypes.CDLL(None).tgkill
    sent = 0
    with stand.stream(env=stand.with_shim()) as stream:
        pid = stream.process.pid
        end = time.monotonic() + 1.5
        while time.monotonic() < end:
            for thread in os.listdir(f"/proc/{pid}/task"):
                sent += tgkill(pid, int(thread), signal.SIGUSR1) == 0
            time.sleep(1e-4)
    check(sent > 0, "no signal was sent")


def interrupted_twice(stand):
    with stand.stream() as stream:
        time.sleep(0.5)
        stream.interrupt()
        stream.interrupt()
        time.sleep(0.005)
        with contextlib.suppress(ProcessLookupError):
            stream.interrupt()


def wall_clock_set_back(stand):
    with stand.stream(env=stand.with_shim()) as stream:
        time.sleep(0.3)
        stream.process.send_signal(signal.SIGUSR2)
        before, begin = stream.first_frame()["sample"], time.monotonic()
        time.sleep(1)
        rate = (stream.first_frame()["sample"] - before) / (time.monotonic() - begin)
        check(rate < 100_000, f"{rate:.0f} samples a second instead of 50 000")
        wait_until(lambda: stream.first_frame()["sample"] > before + 25_000, "had half a second's samples")


def _pipe_without_a_reader():
    reader, writer = os.pipe()
    os.close(reader)
    return writer


def nobody_reads_stdout(stand):
    with stand.stream(stdout=_pipe_without_a_reader(), exit_status=1) as stream:
        time.sleep(0.3)
    check("cannot write to standard output: Broken pipe" in stream.messages.read_text(), "it does not say so")


def a_listing_is_read_in_part(stand):
    for words in (["--help"], ["scenes"], ["scenes", "--keys"], ["materials"], ["man", "scene"], ["completion", "bash"]):
        writer = _pipe_without_a_reader()
        outcome = stand.run(*words, stdout=writer)
        os.close(writer)
        check((outcome.returncode, outcome.stderr) == (0, ""), f"{words}: {outcome.returncode}: {outcome.stderr}")


def nobody_reads_stderr(stand):
    with stand.stream(endpoint=f"ipc://{stand.folder}/socket", stderr=_pipe_without_a_reader()):
        time.sleep(0.3)


def stdout_closed(stand):
    with stand.stream(before_exec=lambda: os.close(1), exit_status=1) as stream:
        time.sleep(0.3)
    check("cannot write to standard output: Bad file descriptor" in stream.messages.read_text(), "it does not say so")


def stdin_stdout_and_stderr_closed(stand):
    with stand.stream(before_exec=lambda: os.closerange(0, 3), exit_status=1,
                      endpoint=f"ipc://{stand.folder}/socket") as stream:
        instead = [os.readlink(f"/proc/{stream.process.pid}/fd/{i}") for i in range(3)]
        check(instead == 3 * ["/dev/null"], f"messages go to {instead}")


def run_with_stdout_closed(stand):
    file = stand.folder / "run.csv"
    done = stand.run("run", "paper-wall", "-o", file, preexec_fn=lambda: os.close(1))
    check(done.returncode == 1 and "Bad file descriptor" in done.stderr, f"{done}")
    check(file.read_text().startswith("t_s,"), "the file holds something else")


def decimal_comma(stand):
    locales = stand.folder / "locales"
    locales.mkdir()
    subprocess.run(["localedef", "-i", "de_DE", "-f", "ISO-8859-1", locales / "de_DE"], check=True)
    # glibc keeps the parsed path of locales: not a leak of the program.
    german = {"LOCPATH": str(locales), "LC_ALL": "de_DE", "ASAN_OPTIONS": "detect_leaks=0"}
    number = subprocess.run(["/usr/bin/printf", "%.1f", "1"], env=german, capture_output=True, text=True, check=True)
    check(number.stdout == "1,0", f"the locale is not in force: {number.stdout}")
    scene = stand.folder / "scene.toml"
    scene.write_text("[drive]\namplitude_m = 2.5e-6\n[output]\nduration_s = 0.00005\n")
    words = ["run", scene, "--set", "chain.damping_kg_per_s=0.25", "--json", "-o"]
    file, german_file = stand.folder / "a.csv", stand.folder / "b.csv"
    here = stand.run(*words, file)
    there = stand.run(*words, german_file, env={**os.environ, **german})
    check(here.returncode == there.returncode == 0, here.stderr + there.stderr)
    check(file.read_text() == german_file.read_text(), "another CSV")
    differing = {"setup_s", "wall_s", "real_time_factor", "recordings"}
    summaries = [{key: value for key, value in json.loads(text).items() if key not in differing}
                 for text in (here.stdout, there.stdout)]
    check(summaries[0] == summaries[1], "another summary")
    with stand.stream("--duration", "0.1251", env=german) as stream:  # with --pace 0.05: two and a half seconds
        stream.process.wait(stands.LONG_ENOUGH_S)
        stream.interrupted = time.monotonic()
    check(json.loads(stream.summary.read_text())["samples"] == 125_100, "another --duration")


if __name__ == "__main__":
    stands.main(sys.modules[__name__])
