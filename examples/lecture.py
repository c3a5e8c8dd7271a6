# SPDX-License-Identifier: BSD-3-Clause
"""lecture.py -- why stiff springs are hard: draws Euler's factor 1 - k h in five exact runs, the regions in which
explicit methods are stable, and the stable steps of a sheet whose springs get stiffer.

    python examples/lecture.py [PICTURE]         default: lecture.png
"""
import sys
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import weft

SCENES = Path(__file__).resolve().parent.parent / "scenes"
warnings.simplefilter("ignore", weft.SceneWarning)  # unstable steps are the subject


def five_runs(axes):
    """v' = -k v under Euler: every step of h = 1 s multiplies v by 1 - k h."""
    for k in (0.5, 1.0, 1.5, 2.0, 3.0):
        sim = weft.load(SCENES / "stiffness.yaml", {"forces.damping": k})
        speed = [sim.velocities[0, 0] for _ in sim.frames()]
        assert speed == [(1 - k) ** i for i in range(len(speed))]  # exact, to the last bit
        axes.plot(speed, "o-", label="k h = %g" % k)
    axes.set(title="Euler: v is multiplied by 1 - k h", xlabel="step", ylabel="v [m/s]", ylim=(-2.5, 2.5))
    axes.legend()


def regions(axes):
    """|R(z)| <= 1, where one step of h on y' = m y multiplies y by R(h m)."""
    x, y = np.meshgrid(np.linspace(-5, 2, 400), np.linspace(-4, 4, 400))
    z = x + 1j * y
    methods = [("verlet", "euler"), ("verlet", "midpoint"), ("arkode", "rk4"), ("arkode", "dormand_prince")]
    present = {(m.plugin, m.name) for m in weft.methods()}
    for i, (plugin, name) in enumerate(m for m in methods if m in present):
        r = np.abs(np.polynomial.polynomial.polyval(z, weft.amplification(plugin, name)))
        axes.contour(x, y, r, levels=[1.0], colors="C%d" % i)
        axes.plot([], [], color="C%d" % i, label=name.replace("_", " "))
    axes.plot([-0.5, -1, -1.5, -2, -3], [0] * 5, "k.", label="the five runs")
    axes.set(title="stable inside: |R(h m)| <= 1", xlabel="real part of h m", ylabel="imaginary part", aspect="equal")
    axes.legend(loc="lower left", fontsize="small")


def stable_steps(axes):
    """The largest stable step of a sheet, guaranteed for the modes of its present state."""
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
        axes.loglog(stiffness, steps, "o-", label="%s, damping %g kg/s" % (name.replace("_", " "), damping))
    axes.set(title="stiffer springs, smaller steps", xlabel="k [N/m]", ylabel="largest stable step [s]")
    axes.legend(fontsize="small")


def main(picture="lecture.png"):
    figure, axes = plt.subplots(1, 3, figsize=(15, 5), layout="constrained")
    five_runs(axes[0])
    regions(axes[1])
    stable_steps(axes[2])
    figure.savefig(picture, dpi=120)
    print(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
