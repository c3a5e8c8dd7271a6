# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # Which method for this cloth?
#
# Draws work-precision.png: the error of each method against its cost, measured by `weft compare` against a reference.
# Down and to the left is better; a slope is an order.
# `python examples/work_precision.py`, or open this file as a notebook.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import weft

HERE = Path(globals().get("__file__", "examples/work_precision.py")).resolve().parent
SCENE = HERE.parent / "scenes" / "two-corners.yaml"
UNTIL = 0.2  # [s]
METHODS = ["gsl/rkf45", "gsl/rk8pd", "arkode/bogacki_shampine", "arkode/dormand_prince", "arkode/verner65", "verlet"]

# %% [markdown]
# One row per run: every method over a ladder of tolerances, or of steps.

# %%
with tempfile.TemporaryDirectory() as folder:
    table = weft.compare(SCENE, Path(folder, "compare"), methods=METHODS, until=UNTIL, jobs=2)
table = table[(table["outcome"] == "done") & (table["near_reference"] == 0)]  # 1: too near to it to be judged

# %%
figure, axes = plt.subplots(figsize=(8, 6), layout="constrained")
for (plugin, method), rows in table.groupby(["plugin", "method"]):
    rows = rows.sort_values("rhs_calls")
    axes.loglog(rows["rhs_calls"], rows["error"], "o-", label="%s %s" % (plugin, method))
axes.set(title="%s, up to %g s" % (SCENE.stem, UNTIL), xlabel="evaluations of the forces",
         ylabel="largest error of a particle [m]")
axes.legend(fontsize="small")
figure.savefig("work-precision.png", dpi=120)
print("work-precision.png")
