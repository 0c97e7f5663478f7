# %% [markdown]
# # A running stream
#
# `hertzline stream` publishes samples in real time. Here it runs beside this script for some milliseconds of simulated time, as fast
# as the script reads.

# %%
import os
import subprocess

import matplotlib.pyplot as plt
import numpy as np

import hertzline

program = os.environ.get("HERTZLINE_PROGRAM", "hertzline")
endpoint = f"ipc:///tmp/hertzline-example-{os.getpid()}"
stream = subprocess.Popen(
    [program, "stream", "paper-stream", "--bind", endpoint, "--duration", "5e-3", "--pace", "flat-out", "--wait-for-subscriber"],
    stdout=subprocess.DEVNULL,
    stderr=subprocess.DEVNULL,
)

# %% [markdown]
# A block has the indices of its samples. Missing samples raise a `GapError`. With `gaps="mark"` the loop continues, and
# `block.missing` counts them.

# %%
peaks, samples = [], []
with stream, hertzline.listen(endpoint, "v_out", timeout_s=60) as live:
    for block in live:
        peaks.append((block.t[0], np.abs(block.samples).max()))
        samples.append(block.samples)
print(live.totals["samples"], "samples, missing:", live.totals["missing_samples"])

# %% [markdown]
# The stream has the samples of a run, as float32.

# %%
heard = np.concatenate(samples)
run = hertzline.scene("paper-stream", output={"duration_s": (len(heard) - 1) / 10e6}).run()
assert np.array_equal(heard, run["v_out"].astype(np.float32))

figure, axes = plt.subplots(figsize=(8, 3), layout="constrained")
axes.plot(run.t[: len(heard)] * 1e3, heard, lw=0.5, color="#9db8c4")
axes.step(*np.array(peaks).T * np.array([[1e3], [1]]), where="post", color="#c46a1b", lw=1, label="peak of each block")
axes.set(xlabel="time [ms]", ylabel="v_out [m/s]")
axes.legend(frameon=False)
plt.show()
