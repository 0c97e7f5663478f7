"""Other threads continue while hertzline computes, and Ctrl-C ends the computation."""
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
from support import LONG_ENOUGH_S

import hertzline


def counted_during(work):
    """Returns how far another thread counts during calls beyond twice in each: without the GIL released it counts once, if at all.

    On a busy machine it may wait for its turn, so that there are up to 200 calls."""
    count, over = 0, threading.Event()

    def run():
        nonlocal count
        while not over.wait(0.001):
            count += 1

    thread = threading.Thread(target=run)
    thread.start()
    time.sleep(0.05)
    before = count
    for calls in range(1, 201):
        work()
        gained = count - before - 2 * calls
        if gained > 20:
            break
    over.set()
    thread.join()
    return gained


LONG = """
import hertzline, numpy as np
s = hertzline.scene("paper-stream", output={"duration_s": 2000.0, "sample_rate_hz": 1e4})
short = hertzline.scene("paper-vitreous-carbon")
"""


class Threads(unittest.TestCase):
    def test_others_go_on_during_a_run(self):
        scene = hertzline.scene("paper-stream", output={"duration_s": 2.0, "sample_rate_hz": 1e5})
        scene.run()
        self.assertGreater(counted_during(scene.run), 20)  # none at all when the GIL is kept

    def test_others_go_on_during_a_sweep(self):
        scene = hertzline.scene("paper-stream", output={"duration_s": 0.05, "sample_rate_hz": 1e5})
        self.assertGreater(counted_during(lambda: hertzline.sweep(scene, {"drive.cycles": range(5, 25)}, jobs=1)), 20)

    def test_others_go_on_during_a_search(self):
        scene = hertzline.scene("paper-stream", output={"duration_s": 0.05, "sample_rate_hz": 1e5})
        search = dict(vary={"drive.cycles": [5, 15, 25]}, maximise="thd_r", evaluations=18, jobs=1)
        self.assertGreater(counted_during(lambda: hertzline.optimise(scene, **search)), 20)

    def test_others_go_on_while_values_are_read(self):
        # the last value is refused, so that only reading takes time
        preloads = np.append(np.linspace(0.1, 1, 1_000_000), -1)

        def refuse():
            with self.assertRaisesRegex(ValueError, "found -1"):
                hertzline.sweep("paper-wall", {"chain.preload_n": preloads})

        self.assertGreater(counted_during(refuse), 20)

    def test_runs_beside_each_other_have_the_same_bits(self):
        scene = hertzline.scene("paper-wall")
        wanted, found = scene.run()["v_out"], []
        threads = [threading.Thread(target=lambda: found.append(scene.run()["v_out"])) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([v.tobytes() for v in found], [wanted.tobytes()] * 4)

    def interrupted(self, work):
        """Returns the seconds from Ctrl-C to KeyboardInterrupt, and checks that the interpreter continues."""
        text = f"{LONG}\nprint('go', flush=True)\ntry:\n    {work}\nexcept KeyboardInterrupt:\n" \
               "    print('interrupted', len(short.run()['v_out']), flush=True)\n"
        with subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "go\n")
            time.sleep(0.7)
            start = time.monotonic()
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.stdout.readline(), "interrupted 5001\n")
            took = time.monotonic() - start
            self.assertEqual(process.wait(LONG_ENOUGH_S), 0)
        return took

    def test_ctrl_c_ends_a_run(self):
        self.assertLess(self.interrupted("s.run()"), LONG_ENOUGH_S)

    def test_ctrl_c_ends_a_sweep(self):
        self.assertLess(self.interrupted("hertzline.sweep(s, {'drive.cycles': np.linspace(5, 25, 8)}, jobs=2)"), LONG_ENOUGH_S)

    def test_ctrl_c_ends_a_search(self):
        search = "hertzline.optimise(s, {'drive.cycles': '5..25'}, maximise='thd_r', evaluations=50, jobs=2)"
        self.assertLess(self.interrupted(search), LONG_ENOUGH_S)

    def test_ctrl_c_ends_reading_a_pipe_without_a_writer(self):
        with tempfile.TemporaryDirectory() as folder:
            os.mkfifo(f"{folder}/pipe.csv")
            self.assertLess(self.interrupted(f"hertzline.load('{folder}/pipe.csv', sample_rate_hz=1e6)"), LONG_ENOUGH_S)

    def test_ctrl_c_ends_a_sweep_of_more_points_than_can_be_looked_at(self):
        vary = "{'chain.preload_n': np.linspace(0.1, 1, 10_000), 'drive.cycles': np.linspace(5, 25, 10_000)}"
        self.assertLess(self.interrupted(f"hertzline.sweep(s, {vary})"), LONG_ENOUGH_S)

    def test_a_daemon_thread_ends_with_the_interpreter(self):
        for work in ("next(hertzline.listen('tcp://127.0.0.1:9'))", "hertzline.Simulation(s).advance(50_000_000)", "s.run()"):
            text = f"{LONG}import threading, time\nthreading.Thread(target=lambda: {work}, daemon=True).start()\ntime.sleep(0.5)\n"
            for _ in range(3):
                done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=LONG_ENOUGH_S, check=False)
                self.assertEqual((done.returncode, done.stderr), (0, ""), work)

    def test_daemon_threads_amid_short_calls_end_with_the_interpreter(self):
        for work in ("hertzline.Simulation(s)", "s.run()", "s.check()"):
            text = f"import hertzline, threading, time\nscenes = [hertzline.scene('paper-stream', drive={{'amplitude_m': n * 1e-7}}) for n in range(1, 99)]\n" \
                   f"def work():\n    for s in scenes:\n        {work}\n" \
                   "for _ in range(3):\n    threading.Thread(target=work, daemon=True).start()\ntime.sleep("
            for i in range(8):
                done = subprocess.run([sys.executable, "-c", f"{text}{0.1 + 0.02 * i})"], capture_output=True, text=True,
                                      timeout=LONG_ENOUGH_S, check=False)
                self.assertEqual((done.returncode, done.stderr), (0, ""), work)

    def test_a_forked_process_ends_though_it_has_a_connection(self):
        text = f"import hertzline, os, sys\nlive = hertzline.listen('tcp://127.0.0.1:9')\n" \
               "child = os.fork()\nif child:\n    sys.exit(os.waitpid(child, 0)[1])\nlive.close()\ndel live\n"
        done = subprocess.run([sys.executable, "-c", text], timeout=LONG_ENOUGH_S, check=False)
        self.assertEqual(done.returncode, 0)

    def test_ctrl_c_ends_listening(self):
        self.assertLess(self.interrupted("next(hertzline.listen('tcp://127.0.0.1:9'))"), LONG_ENOUGH_S)


if __name__ == "__main__":
    unittest.main()
