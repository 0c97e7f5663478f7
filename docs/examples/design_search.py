# %% [markdown]
# # Searching a design
#
# Which thickness and which preload give a wide band and a strong output? Each point of the grid is a simulation.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hertzline

scene = hertzline.scene("paper-vitreous-carbon")
table = hertzline.sweep(
    scene,
    {"end.thickness_m": np.geomspace(0.2e-3, 2e-3, 16), "chain.preload_n": np.geomspace(0.01, 2, 16)},
    quantities=["occupied_20db_hz", "peak_v_out_m_per_s", "ringing_ratio", "below_db", "step_s"],
)
print(len(table), "points:", dict(zip(*np.unique(table["status"], return_counts=True))))
table.plot()
plt.show()

# %% [markdown]
# The widest band among the points with at least 0.3 m/s. A row's numbers are as good as its `status` says. They mean what
# they seem to where the burst has rung down, and where nothing below the band is louder than all in it.

# %%
sound = (table["status"] == "ok") & (table["ringing_ratio"] <= 0.05) & (table["below_db"] <= 0)
strong = table[sound & (table["peak_v_out_m_per_s"] >= 0.3)]
best = strong[np.argmax(strong["occupied_20db_hz"])]
print(f"{best['occupied_20db_hz'] / 1e3:.0f} kHz with {best['end.thickness_m'] * 1e3:.2f} mm and {best['chain.preload_n']:.2f} N")

# %% [markdown]
# A search looks between the points of a grid, and finds a better device with fewer simulations.

# %%
found = hertzline.optimise(
    scene,
    {"end.thickness_m": "0.2e-3..2e-3:log", "chain.preload_n": "0.01..2:log"},
    maximise="occupied_20db_hz",
    subject_to=["peak_v_out_m_per_s >= 0.3", "ringing_ratio <= 0.05", "below_db <= 0"],
    evaluations=200,
)
print(f"{found.best['occupied_20db_hz'] / 1e3:.0f} kHz after {len(found.table)} evaluations")
print(f"within 1 % of each key at least {found.summary['around']['worst_within_1_percent'] / 1e3:.0f} kHz")
assert found.best["occupied_20db_hz"] > best["occupied_20db_hz"]

# %% [markdown]
# The device of the grid, with the step of its row, has the numbers of its row, bit for bit.

# %%
device = hertzline.scene(
    scene,
    end={"thickness_m": best["end.thickness_m"]},
    chain={"preload_n": best["chain.preload_n"]},
    numerics={"step_s": best["step_s"]},
).run()
assert device.summary["peak_v_out_m_per_s"] == best["peak_v_out_m_per_s"]
device.plot(["v_out"], title="the widest band above 0.3 m/s")
plt.show()
