# SPDX-License-Identifier: BSD-3-Clause
"""weft.fit of an outline, and how often fits of examples/fit.py find the truth."""
import os
import runpy

import numpy as np
import pandas as pd
import pytest
from conftest import TREE

import weft

BEND = "cloth.springs.bend.stiffness"
DRAPE = {
    "weft": 1,
    "cloth": {"grid": {"rows": 9, "cols": 9, "spacing": 0.03, "origin": [-0.12, 0, -0.12], "right": [1, 0, 0], "down": [0, 0, 1]},
              "density": 0.2, "springs": {"stretch": {"stiffness": 80}, "shear": {"stiffness": 30}, "bend": {"stiffness": 4}},
              "pins": [{"rows": [2, 6], "cols": [2, 6]}]},
    "forces": {"damping": 2e-3},
    "stepper": {"plugin": "verlet", "method": "velocity_verlet", "fixed_step": 5e-4},
    "run": {"duration": 1.0, "fps": 1},
}


def test_bending_is_found_from_the_rim_of_a_drape(tmp_path):
    x = weft.run(DRAPE, tmp_path / "drape").positions[-1]
    rim = np.vstack([x[0], x[-1], x[1:-1, 0], x[1:-1, -1]])
    outline = pd.DataFrame({"x": rim[:, 0], "y": -rim[:, 2]})
    found = weft.fit(DRAPE, outline, [BEND], tmp_path / "fit", {BEND: 9})
    assert found.values[BEND] == pytest.approx(4, rel=1e-3)
    assert found.coordinates == 32


@pytest.mark.skipif("TEST_LONG" not in os.environ, reason="minutes: make check-fit")
@pytest.mark.parametrize("repeats, factor, least", [(100, 1.18, 95), (20, 3.0, 18)])
def test_five_numbers_are_within_three_standard_errors(tmp_path, repeats, factor, least):
    example = runpy.run_path(str(TREE / "examples" / "fit.py"))
    off = example["repeat"](tmp_path, example["tracks"](tmp_path), repeats, factor)
    assert off.shape == (repeats, 5)
    assert (abs(off) < 3).all(axis=1).sum() >= least
