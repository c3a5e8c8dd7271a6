# SPDX-License-Identifier: BSD-3-Clause
"""weft.gradient, against differences of runs with fixed steps."""
import json
import warnings

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
    assert list(found.parameters) == KEYS
    for key, p in zip(KEYS, (100, 0.2, -9.81)):
        before = {"forces.gravity": [0, -9.81, 0]} if "gravity" in key else {}
        h = 1e-4 * p
        at = [value({**before, key: p + s * h}) for s in (-2, -1, 1, 2)]
        assert found.parameters[key] == pytest.approx((at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h), rel=1e-7)


def test_it_is_the_derivative_by_the_first_state():
    found = weft.gradient(sheet(), distance, times=[0.1, 0.2])
    assert found.parameters == {}
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
    with pytest.raises(ValueError, match="the derivative with respect to x has the shape"):
        weft.gradient(sheet(), lambda t, x, v: (1.0, np.zeros(3)), times=[0.01])
    with pytest.raises(weft.SceneError, match="cloth.grid.rows"):
        weft.gradient(sheet(), distance, ["cloth.grid.rows"], times=[0.01])
    with pytest.raises(weft.Error, match="times"):
        weft.gradient(sheet(), distance, times=[0.02, 0.01])
    with pytest.raises(weft.Error, match="history"):
        weft.gradient(sheet(), distance, times=[0.01], overrides={
            "stepper": {"plugin": "gsl", "method": "msadams", "rtol": 1e-4, "atol": 1e-4}})


def drape(body):
    return {"cloth": {"grid": {"rows": 5, "cols": 5, "spacing": 0.02, "origin": [-0.04, 0.083, -0.04], "right": [1, 0, 0],
                               "down": [0, 0, 1]}, "density": 0.2, "springs": {"stretch": {"stiffness": 50}}},
            "contact": {"thickness": 4e-3, "shapes": [{"shape": "mesh", "file": body}]},
            "stepper": {"method": "arkode/rk4", "fixed_step": 1e-4}, "run": {"duration": 0.01, "fps": 100}}


def low(t, x, v):
    return x[:, 1].sum(), np.tile([0.0, 1.0, 0.0], (len(x), 1))


OCTAHEDRON = (np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]) * 0.08,
              np.array([(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]))


def test_bodies_and_meshes_of_arrays_and_of_files_have_the_same_gradient(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    vertices, triangles = OCTAHEDRON
    (tmp_path / "body.obj").write_text("".join("v %r %r %r\n" % tuple(x) for x in vertices.tolist())
                                       + "".join("f %d %d %d\n" % tuple(c) for c in triangles + 1))
    (tmp_path / "drape.yaml").write_text(json.dumps({**drape("body.obj"), "weft": 1}))
    found = [weft.gradient(scene, low, ["cloth.density", "contact.thickness"])
             for scene in (drape(OCTAHEDRON), drape("body.obj"), drape(tmp_path / "body.obj"), "drape.yaml")]
    assert found[0].parameters["cloth.density"] != 0.0
    assert all(one.value == found[0].value and one.parameters == found[0].parameters for one in found)
    uv = np.array([[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1], [0.05, 0.05]])
    mesh = weft.Mesh(uv, None, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    mesh.write("cloth.obj")
    cloth = {"fabric": {"preset": "royal-target"}, "pins": [{"vertices": [2]}]}
    free = {key: of for key, of in drape(OCTAHEDRON).items() if key != "contact"}
    first, second = (weft.gradient({**free, "cloth": {"mesh": one, **cloth}}, low, ["cloth.fabric.density"])
                     for one in (mesh, {"file": "cloth.obj"}))
    assert first.parameters == second.parameters and first.parameters["cloth.fabric.density"] != 0.0


@pytest.mark.parametrize("densities, touching, kinks", [((0.2, 0.2), True, 1), ((0.2, 0.201), True, 0), ((0.2, 0.2), False, 0)])
def test_a_kink_of_contact_between_equal_densities_is_warned_of(densities, touching, kinks):
    uv = np.array([[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1]])
    scene = {"cloths": [{"name": "abc"[k], "mesh": weft.Mesh(uv, np.c_[uv, np.full(4, 0.1 * k)], [[0, 1, 2], [0, 2, 3]]),
                         "fabric": {"density": density, "stretch": 50}} for k, density in enumerate(densities)],
             "contact": {"self": touching, "thickness": 1e-3, "friction": 0},
             "stepper": {"method": "arkode/rk4", "fixed_step": 1e-4}, "run": {"duration": 0.01}}
    words = "cloths.1.fabric.density is also the density of another fabric: contact takes the smaller"
    over = ["cloths.1.fabric.density", "cloths.1.fabric.stretch"]
    for call, place in ((lambda: weft.load(scene, {"sensitivity": {"of": over}}), "override sensitivity:"),
                        (lambda: weft.gradient(scene, low, over, times=[0.001]), "over: warning: ")):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            call()
        found = [str(one.message) for one in caught if words in str(one.message)]
        assert len(found) == kinks and all(one.startswith(place) for one in found)
