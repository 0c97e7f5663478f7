# %% [markdown]
# # A glue line
#
# A hard face bears the contact, a soft backing matches the water: vitreous carbon on acrylic, glued. How thick may the glue be, and does
# it have to be hard? Each layer of the disc is an entry of `end.materials` and `end.thicknesses_m`, and an entry varies as any key.

# %%
import matplotlib.pyplot as plt
import numpy as np

import hertzline

disc = hertzline.scene(
    "wet-vitreous-carbon",
    end={
        "theory": "thick",
        "materials": ["vitreous_carbon", "epoxy", "acrylic"],
        "thicknesses_m": ["0.3 mm", "20 um", "0.2 mm"],
    },
)
glue = np.geomspace(2e-6, 100e-6, 8)
varied = {"end.theory": ["thin", "thick"], "end.materials[2]": ["epoxy", "silicone_rubber"], "end.thicknesses_m[2]": glue}
table = hertzline.sweep(disc, varied, measure=["p_axis"], quantities=["p_axis.peak_p_axis_pa"])
print(len(table), "points:", dict(zip(*np.unique(table["status"], return_counts=True))))

# %% [markdown]
# Thin-plate theory takes the layers for stiff against shear and hardly sees the glue. With shear (`end.theory = "thick"`) rubber
# decouples the layers: the disc becomes softer. A point is refused where so little shear stiffness is left that the layers no longer
# bend as one plate; `message` has the figure.

# %%
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for theory, line in (("thin", "--"), ("thick", "-")):
    for material, colour in (("epoxy", "tab:blue"), ("silicone_rubber", "tab:orange")):
        rows = table[(table["end.theory"] == theory) & (table["end.materials[2]"] == material)]
        label = f"{material.replace('_', ' ')}, {theory}"
        axes.plot(rows["end.thicknesses_m[2]"] * 1e6, rows["p_axis.peak_p_axis_pa"] / 1e3, line, marker="o", color=colour, label=label)
axes.set(xscale="log", xlabel="thickness of the glue [µm]", ylabel="peak pressure at 10 mm [kPa]", ylim=(0, None))
axes.set_title("0.3 mm vitreous carbon, glue, 0.2 mm acrylic")
axes.grid(visible=True, which="both", alpha=0.3)
axes.legend()
plt.show()

# %%
thick = table[table["end.theory"] == "thick"]
refused = thick[thick["status"] == "refused"]
print(*refused["message"], sep="\n")
hard = thick[thick["end.materials[2]"] == "epoxy"]["p_axis.peak_p_axis_pa"]
print(f"epoxy of 2 to 100 µm changes the peak by {(hard.max() / hard.min() - 1) * 100:.0f} %")
