# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # Why stiff springs are hard
#
# Draws lecture.png: `python examples/lecture.py`. notebooks/lecture.ipynb goes further.

# %%
import warnings

import matplotlib.pyplot as plt
import numpy as np

import weft

warnings.simplefilter("ignore", weft.SceneWarning)  # of unstable steps, which are the subject
figure, (runs, regions, sheet) = plt.subplots(1, 3, figsize=(15, 5), layout="constrained")

# %% [markdown]
# ## Five exact runs
#
# v' = -k v: an Euler step multiplies v by 1 - k h. Up to k h = 1 v decays, up to 2 it oscillates and decays, beyond it
# explodes. The scene has h = 1 s.

# %%
for k in (0.5, 1.0, 1.5, 2.0, 3.0):
    sim = weft.load(weft.scene("stiffness"), {"forces.damping": k})
    speed = [sim.velocities[0, 0] for frame in sim.frames()]
    assert speed == [(1 - k) ** i for i in range(len(speed))]  # to the last bit
    runs.plot(speed, "o-", label="k h = %g" % k)
runs.set(title="Euler: v is multiplied by 1 - k h", xlabel="step", ylabel="v [m/s]", ylim=(-2.5, 2.5))
runs.legend()

# %% [markdown]
# ## Regions of stability
#
# On y' = m y a step of a Runge-Kutta method multiplies y by the polynomial R(h m). weft finds R by running the method.

# %%
x, y = np.meshgrid(np.linspace(-5, 2, 400), np.linspace(-4, 4, 400))
found = {(method.plugin, method.name) for method in weft.methods()}  # arkode only where SUNDIALS is
methods = [("verlet", "euler"), ("verlet", "midpoint"), ("arkode", "rk4"), ("arkode", "dormand_prince")]
for i, (plugin, name) in enumerate(method for method in methods if method in found):
    r = np.polynomial.polynomial.polyval(x + 1j * y, weft.amplification(plugin, name))
    regions.contour(x, y, np.abs(r), levels=[1.0], colors="C%d" % i)
    regions.plot([], [], color="C%d" % i, label=name.replace("_", " "))
regions.plot([-0.5, -1, -1.5, -2, -3], [0] * 5, "k.", label="the five runs")
regions.set(title="stable inside: |R(h m)| <= 1", xlabel="real part of h m", ylabel="imaginary part", aspect="equal")
regions.legend(loc="lower left", fontsize="small")

# %% [markdown]
# ## A sheet whose springs get stiffer
#
# Its modes oscillate at up to sqrt(k / m): without damping the stable step falls as 1 / sqrt(k). Euler needs damping to
# be stable at all, and then its step falls as 1 / k.

# %%
stiffness = np.geomspace(10, 1e5, 9)
for name, damping in (("velocity_verlet", 0.0), ("midpoint", 0.05), ("euler", 0.05)):
    steps = [weft.load({
        "weft": 1,
        "cloth": {"grid": {"rows": 12, "cols": 12, "spacing": 0.05}, "density": 0.2,
                  "springs": {"stretch": {"stiffness": k, "damping": damping}},
                  "pins": ["top-left", "top-right"]},
        "stepper": {"plugin": "verlet", "method": name, "fixed_step": 1e-3},
        "run": {"duration": 1.0},
    }).stable_step() for k in stiffness]
    sheet.loglog(stiffness, steps, "o-", label="%s, damping %g kg/s" % (name.replace("_", " "), damping))
sheet.set(title="stiffer springs, smaller steps", xlabel="k [N/m]", ylabel="largest stable step [s]")
sheet.legend(fontsize="small")

# %%
figure.savefig("lecture.png", dpi=120)
print("lecture.png")
