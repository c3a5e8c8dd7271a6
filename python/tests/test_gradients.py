# SPDX-License-Identifier: BSD-3-Clause
"""weft.gradient, against differences of runs with fixed steps."""
import numpy as np
import pytest
from conftest import sheet

import weft

KEYS = ["cloth.springs.stretch.stiffness", "cloth.density", "forces.gravity.1"]


def distance(t, x, v):
    """From a target, half squared, and the kinetic energy of unit masses."""
    off = x[-1] - [0.1, -0.5, 0.2]
    by = np.zeros(x.shape)
    by[-1] = off
    return 0.5 * (off @ off) + 0.5 * (v**2).sum(), by, v


def value(overrides, start=lambda sim: None):
    sim, total = weft.load(sheet(), overrides), 0.0
    start(sim)
    for t in (0.1, 0.2):
        sim.advance(t)
        total += distance(t, sim.positions, sim.velocities)[0]
    return total


def test_it_is_the_derivative_of_runs():
    found = weft.gradient(sheet(), distance, KEYS, times=[0.1, 0.2])
    assert found.value == pytest.approx(value({}), rel=1e-12)
    assert list(found.numbers) == KEYS
    for key, p in zip(KEYS, (100, 0.2, -9.81)):
        before = {"forces.gravity": [0, -9.81, 0]} if "gravity" in key else {}
        h = 1e-4 * p
        at = [value({**before, key: p + s * h}) for s in (-2, -1, 1, 2)]
        assert found.numbers[key] == pytest.approx((at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h), rel=1e-7)


def test_it_is_the_derivative_by_the_first_state():
    found = weft.gradient(sheet(), distance, times=[0.1, 0.2])
    assert found.numbers == {}
    rng = np.random.default_rng(1)
    free = ~weft.load(sheet()).pinned[:, None]
    dx, dv = free * rng.standard_normal(found.x.shape), free * rng.standard_normal(found.v.shape)
    less, more = [value({}, lambda sim, s=s: sim.set_state(sim.positions + s * dx, sim.velocities + s * dv))
                  for s in (-1e-6, 1e-6)]
    assert (found.x * dx + found.v * dv).sum() == pytest.approx((more - less) / 2e-6, rel=1e-6)


def test_frames_are_those_of_the_scene_from_the_last_one():
    seen = []

    def nothing(t, x, v):
        seen.append(t)
        return 0.0, np.zeros(x.shape)
    found = weft.gradient(sheet(), nothing, overrides={"run.duration": 0.1, "run.fps": 20})
    assert seen == [0.1, 0.05, 0.0]
    assert found.value == 0.0 and not found.x.any()


def test_mistakes_are_errors():
    with pytest.raises(ZeroDivisionError):
        weft.gradient(sheet(), lambda t, x, v: 1 / 0, times=[0.01])
    with pytest.raises(TypeError, match="its value and its derivatives"):
        weft.gradient(sheet(), lambda t, x, v: (1.0,), times=[0.01])
    with pytest.raises(ValueError, match="the derivative by x has the shape"):
        weft.gradient(sheet(), lambda t, x, v: (1.0, np.zeros(3)), times=[0.01])
    with pytest.raises(weft.SceneError, match="cloth.grid.rows"):
        weft.gradient(sheet(), distance, ["cloth.grid.rows"], times=[0.01])
    with pytest.raises(weft.Error, match="times"):
        weft.gradient(sheet(), distance, times=[0.02, 0.01])
    with pytest.raises(weft.Error, match="history"):
        weft.gradient(sheet(), distance, times=[0.01], overrides={
            "stepper": {"plugin": "gsl", "method": "msadams", "rtol": 1e-4, "atol": 1e-4}})
