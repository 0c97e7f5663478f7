# %% [markdown]
# # Waves in the chain
#
# `v_chain` has the velocities of all spheres, [sample, sphere]. In a chain of twenty spheres before a rigid wall each cycle of the
# horn becomes a pulse that travels, loses strength to the damping, and comes back from the wall.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hertzline

scene = hertzline.scene("paper-wall", chain={"spheres": 20}, output={"duration_s": 200e-6})
result = scene.run(taps=["v_chain", "v_horn"])
v = result["v_chain"]
print(v.shape, "samples and spheres")

figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
spheres = np.arange(1, v.shape[1] + 1)
colours = axes.pcolormesh(result.t * 1e6, spheres, v.T, shading="nearest", cmap="RdBu_r", vmin=-1, vmax=1, rasterized=True)
axes.set(xlabel="time [µs]", ylabel="sphere, from the horn", yticks=spheres[::3])
figure.colorbar(colours, ax=axes, label="velocity [m/s]")
plt.show()

# %% [markdown]
# `check` computes numbers from the scene alone. Small waves above the cut-off frequency do not travel.

# %%
about = scene.check()
print(f"small waves travel at {about['wave_speed_m_per_s']:.0f} m/s, up to {about['cutoff_hz'] / 1e3:.0f} kHz")
