# SPDX-License-Identifier: BSD-3-Clause
"""Tables of times: pins follow them as SciPy's interpolators do, and methods keep their order."""

import numpy as np
import pytest

import weft

ROWS = [[-0.2, 0.1, 0, 0], [0.1, 0.1, 0.02, 0], [0.25, 0.13, 0, 0.05], [0.8, 0.13, 0, 0], [0.9, -0.1, 0.01, 0.02]]


def scene(path, **stepper):
    """A chain of four particles, the first on a path."""
    return {
        "weft": 1,
        "cloth": {
            "grid": {"rows": 4, "cols": 1, "spacing": 0.1},
            "mass": 0.05,
            "springs": {"stretch": {"stiffness": 20, "damping": 0.1}},
            "pins": [{"at": "top", "path": path}],
        },
        "stepper": {"plugin": "gsl", "method": "rkf45"} | stepper,
        "run": {"duration": 1.0, "fps": 1},
    }


def way(path):
    """Where the pin is at each frame, from its place at 0."""
    sim = weft.load(scene(path))
    start = sim.positions[0].copy()
    places = []
    for frame in range(1, 51):
        sim.advance(frame / 50)
        places.append(sim.positions[0] - start)
    return np.arange(1, 51) / 50, np.array(places)


def at(curve, t):
    """A curve that rests outside of its rows, from its place at 0."""
    held = np.clip(t, ROWS[0][0], ROWS[-1][0])
    return curve(held) - curve(0.0)


def test_a_table_is_scipys_monotone_interpolator_with_rests_at_its_ends():
    interpolate = pytest.importorskip("scipy.interpolate")
    rows = np.array(ROWS)
    slopes = interpolate.PchipInterpolator(rows[:, 0], rows[:, 1:]).derivative()(rows[:, 0])
    slopes[[0, -1]] = 0.0
    t, x = way(ROWS)
    np.testing.assert_allclose(x, at(interpolate.CubicHermiteSpline(rows[:, 0], rows[:, 1:], slopes), t), atol=1e-12)
    low, high = np.min(rows[1:, 1:], axis=0), np.max(rows[:, 1:], axis=0)
    start = interpolate.CubicHermiteSpline(rows[:, 0], rows[:, 1:], slopes)(0.0)
    assert np.all(x + start >= low - 1e-12) and np.all(x + start <= high + 1e-12)


def test_a_natural_table_is_scipys_natural_spline(tmp_path):
    interpolate = pytest.importorskip("scipy.interpolate")
    rows = np.array(ROWS)
    t, x = way({"rows": ROWS, "spline": "natural"})
    curve = interpolate.CubicSpline(rows[:, 0], rows[:, 1:], bc_type="natural")
    np.testing.assert_allclose(x, at(curve, t), atol=1e-12)
    np.savetxt(tmp_path / "path.csv", rows, delimiter=",", header="t,x,y,z", comments="")
    np.testing.assert_array_equal(way({"rows": str(tmp_path / "path.csv"), "spline": "natural"})[1], x)


@pytest.mark.parametrize(
    ("method", "order"), [("esdirk436", 4), ("qesdirk436", 4), ("esdirk547", 5), ("kvaerno745", 5), ("cash524", 4)]
)
def test_methods_with_stages_outside_of_the_step_keep_their_order(method, order):
    path = [[0, 0, 0, 0], [0.3, 0.05, 0, 0], [0.55, -0.05, 0.02, 0], [1.0, 0, 0, 0]]

    def end(**stepper):
        sim = weft.load(scene(path, plugin="arkode", **stepper))
        sim.advance(1.0)
        return sim.positions.copy()

    exact = end(method="verner65", rtol=1e-13, atol=1e-13)
    coarse, fine = (np.abs(end(method=method, fixed_step=1 / n) - exact).max() for n in (40, 80))
    assert np.log2(coarse / fine) > order - 0.4
