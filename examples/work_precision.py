# SPDX-License-Identifier: BSD-3-Clause
"""work_precision.py -- which method for this cloth: a work-precision diagram, the cost of each method against its error,
measured by `weft compare`. Down and to the left is better, and a slope is an order.

    python examples/work_precision.py [PICTURE [SCENE [SECONDS]]]     default: work-precision.png, two-corners, 0.2
"""
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import weft

SCENES = Path(__file__).resolve().parent.parent / "scenes"
METHODS = ["gsl/rkf45", "gsl/rk8pd", "arkode/bogacki_shampine", "arkode/dormand_prince", "arkode/verner65", "verlet"]


def main(picture="work-precision.png", scene=SCENES / "two-corners.yaml", until=0.2):
    with tempfile.TemporaryDirectory() as folder:
        table = weft.compare(scene, Path(folder, "compare"), methods=METHODS, until=float(until), jobs=2)
    table = table[(table["outcome"] == "done") & (table["near_reference"] == 0)]  # 1: too near it to be judged
    figure, axes = plt.subplots(figsize=(8, 6), layout="constrained")
    for (plugin, method), rows in table.groupby(["plugin", "method"]):
        rows = rows.sort_values("rhs_calls")
        axes.loglog(rows["rhs_calls"], rows["error"], "o-", label="%s %s" % (plugin, method))
    axes.set(title="%s, up to %g s" % (Path(scene).stem, float(until)), xlabel="evaluations of the forces",
             ylabel="largest error of a particle [m]")
    axes.legend(fontsize="small")
    figure.savefig(picture, dpi=120)
    print(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
