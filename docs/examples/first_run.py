# %% [markdown]
# # A first run
#
# Six aluminium spheres of 1 mm between an ultrasonic horn and a plate of vitreous carbon in water. The horn sends a burst of
# 25 cycles at 73 kHz. Hertz's law at the contacts of the spheres turns it into a train of wideband impulses.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hertzline

scene = hertzline.scene("paper-vitreous-carbon")
result = scene.run(taps=["v_out", "v_last", "f_last"])
print(result)

# %% [markdown]
# All numbers are in SI units. `summary` has the numbers that `hertzline run` prints, the estimated error among them.

# %%
summary = result.summary
print(f"peak of v_out     {summary['peak_v_out_m_per_s']:.3f} m/s")
print(f"estimated error   {summary['estimated_error']:.1e}")
print("harmonics [dB]   ", np.round(summary["harmonics_db"], 1))

# %% [markdown]
# The samples are read-only NumPy views, not copies.

# %%
assert np.abs(result["v_out"]).max() == summary["peak_v_out_m_per_s"]
result.plot(["v_out", "f_last"], title="vitreous carbon, 0.5 mm")
plt.show()
