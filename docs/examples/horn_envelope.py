# %% [markdown]
# # The horn's envelope
#
# A horn is a resonator. Driven by a burst it swells and dies away as slowly as its quality factor Q says, whatever the envelope of the
# voltage. The chain pushes back on its tip and takes a little of the peak, the less the heavier the tip. So Q explains
# an envelope that differs from that of the voltage; the load of the chain changes it far less.

# %%
import pathlib
import tempfile

import matplotlib.pyplot as plt
import numpy as np

import hertzline

BURST = {"envelope": "tukey", "taper": 0.2, "horn": "resonator"}
LONG = {"duration_s": 700e-6}


def tip(quality: float, mass_kg: float) -> hertzline.Result:
    drive = BURST | {"horn_quality": quality, "horn_mass_kg": mass_kg}
    return hertzline.scene("paper-vitreous-carbon", drive=drive, output=LONG).run(taps=["x_horn", "v_last"])


figure, (horn, chain) = plt.subplots(2, 1, figsize=(8, 5.5), sharex=True, layout="constrained")
for quality in (25, 100, 400):
    result = tip(quality, 2.7e-3)  # a half-wave rod of steel, 5 mm thick
    horn.plot(result.t * 1e6, result["x_horn"] * 1e6, lw=0.6, label=f"Q = {quality}")
    chain.plot(result.t * 1e6, result["v_last"], lw=0.6)
    print(f"Q {quality}: {np.abs(result['x_horn']).max() / 3e-6:.0%} of the steady amplitude within the burst")
horn.set(ylabel="tip [µm]")
horn.legend(loc="upper right")
chain.set(xlabel="time [µs]", ylabel="last sphere [m/s]")
plt.show()

# %% [markdown]
# The load of the chain lowers the peak by a few per cent.

# %%
for quality in (25, 100):
    free = np.abs(tip(quality, 0)["x_horn"]).max()
    for mass_kg in (10e-3, 3e-3, 1e-3, 0.3e-3):
        loaded = np.abs(tip(quality, mass_kg)["x_horn"]).max()
        print(f"Q {quality}, {mass_kg * 1e3:g} g: the chain takes {1 - loaded / free:.1%} of the peak")

# %% [markdown]
# A vibrometer's record of the tip drives the chain as the horn did. Here the record is that of the resonator, loaded by the chain, so the
# tip then moves as prescribed. `hertzline check` tells noise, offset and drift of a record.

# %%
with tempfile.TemporaryDirectory() as folder:
    record = pathlib.Path(folder) / "tip.csv"
    measured = tip(25, 2.7e-3)
    np.savetxt(record, np.column_stack([measured.t, measured["x_horn"]]), delimiter=",", header="t_s,x_horn_m", comments="")
    again = hertzline.scene("paper-vitreous-carbon", drive={"kind": "file", "file": str(record)}, output=LONG)
    difference = again.run(taps=["v_last"])["v_last"] - measured["v_last"]
    print(f"the last sphere moves the same to {np.linalg.norm(difference) / np.linalg.norm(measured['v_last']):.0e}")
    print(f"strongest line {again.check()['record_frequency_hz'] / 1e3:.1f} kHz")
