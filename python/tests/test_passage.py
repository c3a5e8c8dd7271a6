# SPDX-License-Identifier: BSD-3-Clause
"""Cloth that passes through a shape between its particles."""
import logging
from typing import Any

import pytest

import weft

SCENE: dict[str, Any] = {
    "weft": 1,
    "cloth": {"grid": {"rows": 4, "cols": 4, "spacing": 0.1, "origin": [-0.15, 0.02, -0.15], "right": [1, 0, 0],
                       "down": [0, 0, 1]},
              "density": 0.2,
              "springs": {"stretch": {"stiffness": 50, "damping": 0.02}, "shear": {"stiffness": 20, "damping": 0.01}}},
    "contact": {"shapes": [{"shape": "capsule", "from": [0, 0, -1], "to": [0, 0, 1], "radius": 0.01}]},
    "stepper": {"method": "verlet/velocity_verlet", "fixed_step": 5.0e-4},
    "run": {"duration": 0.3, "fps": 20},
}
SHAPE = "contact.shapes.0.triangles"


def test_a_passage_is_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    sim = weft.load(SCENE)
    assert sim.passages == 0
    with caplog.at_level(logging.WARNING, "weft"):
        seen = [sim.passages for _ in sim.frames()]
    told = [r.message for r in caplog.records if "passes through shapes[0] at t = " in r.message]
    assert len(told) == 1 and "triangles: true" in told[0]
    assert seen[0] == 0 and seen[-1] == 0  # it has fallen past


def test_strict_raises() -> None:
    sim = weft.load(SCENE, {"contact.strict": True})
    with pytest.raises(weft.StepError, match="contact.strict: edge .* passes through"):
        sim.advance(0.3)
    assert 0.02 < sim.time < 0.1 and sim.passages > 0


def test_triangles_hold_it() -> None:
    sim = weft.load(SCENE, {"contact.strict": True, SHAPE: True, "contact.thickness": 0.01})
    sim.advance(0.3)
    assert sim.shapes[0]["kind"] == "mesh"
    assert sim.positions[:, 1].max() > 0
