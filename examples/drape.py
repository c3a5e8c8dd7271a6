# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # A sheet falls onto a ball
#
# Draws drape.png: the sheet after a second, and its energies on the way. A gust is a force of the user's own.
# `python examples/drape.py`, or open this file as a notebook.

# %%
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import weft

SCENES = Path(globals().get("__file__", "examples/drape.py")).resolve().parent.parent / "scenes"
warnings.simplefilter("ignore", weft.PerformanceWarning)  # 625 particles: a Python function is fast enough


def gust(t, x, v, f):
    """A force [N] along x that comes and goes; a function of (t, x, v) alone, so that the bits stay the same."""
    f[:, 0] += 2e-4 * np.sin(np.pi * t) ** 2


# %%
sim = weft.load(SCENES / "ball.yaml", {"run.duration": 1.0}, force=gust)
rows = []
for frame in sim.frames():
    measures = sim.measure()
    rows.append((sim.time, *measures.energy, measures.touching))
time, kinetic, gravitational, stretch, shear, bend, contact, touching = np.array(rows).T

# %%
figure = plt.figure(figsize=(12, 5), layout="constrained")
sheet = figure.add_subplot(1, 2, 1, projection="3d")
x, y, z = sim.grid.transpose(2, 0, 1)  # views: nothing is copied
sheet.plot_surface(x, z, y, rstride=1, cstride=1, cmap="viridis", edgecolor="k", linewidth=0.1)
sheet.set(title="t = %.3g s, %d particles touch the ball" % (sim.time, touching[-1]), xlabel="x [m]", ylabel="z [m]",
          zlabel="y [m]", aspect="equal")
energy = figure.add_subplot(1, 2, 2)
for name, values in (("kinetic", kinetic), ("gravitational", gravitational), ("elastic", stretch + shear + bend),
                     ("contact", contact)):
    energy.plot(time, values, label=name)
energy.set(xlabel="t [s]", ylabel="energy [J]", title="%d steps" % sim.stats.steps)
energy.legend()
figure.savefig("drape.png", dpi=120)
print("drape.png")
