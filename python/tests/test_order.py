# SPDX-License-Identifier: BSD-3-Clause
"""Every array that reaches a function of the user has the order of Sim.positions: that of the mesh's vertices."""
import ctypes
import warnings

import numpy as np
import pytest

import weft

pytestmark = pytest.mark.filterwarnings("ignore::weft.PerformanceWarning")
STEPPER = {"method": "verlet/velocity_verlet", "fixed_step": 1e-4}


def scrambled(n=7, seed=3):
    """A flat square of fabric, its vertices in no order."""
    u = np.linspace(0, 0.3, n)
    uv = np.stack(np.meshgrid(u, u, indexing="ij"), axis=-1).reshape(-1, 2)
    order = np.random.default_rng(seed).permutation(n * n)
    number = np.argsort(order)
    i = (np.arange(n * n).reshape(n, n))[:-1, :-1].ravel()
    triangles = number[np.concatenate([np.c_[i, i + n, i + n + 1], np.c_[i, i + n + 1, i + 1]])]
    return weft.Mesh(uv[order], None, triangles)


def hanging(mesh, **more):
    return {"cloth": {"mesh": mesh, "fabric": {"preset": "royal-target"}, **more}, "stepper": STEPPER,
            "run": {"duration": 1, "fps": 100}}


def pillow(n=6, side=0.2, seed=5):
    """Two squares sewn along their rim, vertices in no order, normals outwards: a mesh, and its volume's triangles."""
    h = side / (n - 1)
    r, c = (of.ravel() for of in np.mgrid[0:n, 0:n])
    rim = (r % (n - 1) == 0) | (c % (n - 1) == 0)
    below = np.arange(n * n)
    below[~rim] = n * n + np.arange((~rim).sum())
    start = np.c_[c * h, np.where(rim, 0.0, 0.01), r * h]
    start = np.concatenate([start, start[~rim] * [1, -1, 1]])
    i = np.arange(n * n).reshape(n, n)[:-1, :-1].ravel()
    up = np.concatenate([np.c_[i, i + n, i + 1], np.c_[i + 1, i + n, i + n + 1]])
    down = np.concatenate([np.c_[i, i + 1, i + n + 1], np.c_[i, i + n + 1, i + n]])
    rest = np.concatenate([np.c_[c * h, -r * h], np.c_[-c * h, -r * h]])
    order = np.random.default_rng(seed).permutation(len(start))
    number = np.argsort(order)
    return weft.Mesh(rest, start[order], number[np.concatenate([up, below[down]])],
                     corner_uv=np.concatenate([up, n * n + down]))


def pressure(mesh, p):
    def force(t, x, v, f):
        a, b, c = (x[mesh.triangles[:, k]] for k in range(3))
        third = p / 6 * np.cross(b - a, c - a)
        for k in range(3):
            np.add.at(f, mesh.triangles[:, k], third)
    return force


def lumped(mesh):
    """A third of the area of its triangles [m^2] for each vertex of a flat mesh."""
    a, b, c = (mesh.start[mesh.triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return np.bincount(mesh.triangles.ravel(), np.repeat(area / 3, 3), minlength=len(mesh.start))


def test_the_mesh_of_these_tests_has_another_order_in_the_state():
    sim = weft.load(hanging(scrambled()))
    assert (sim.index != np.arange(49)).sum() > 40


def test_own_functions_see_positions_and_velocities_in_the_order_of_the_mesh():
    mesh, seen = scrambled(), {}

    def correct(t, h, x, v):
        seen["correct"] = x.copy(), v.copy()
        v[11] = [0.0, 3.0, 0.0]

    def force(t, x, v, f):
        seen["force"] = x.copy(), v.copy()
        f[7] += [0.0, 0.0, 1e3]
    velocity = {"velocity": [0.5, 0.0, 0.0]}
    sim = weft.load(hanging(mesh, **velocity), force=force, correct=correct)
    sim.step(1e-4)
    moved = np.flatnonzero(sim.velocities[:, 2] > 1.0), np.flatnonzero(sim.velocities[:, 1] == 3.0)
    assert [list(of) for of in moved] == [[7], [11]]
    assert (seen["correct"][0] == sim.positions).all()
    for name in ("force", "correct"):
        assert np.allclose(seen[name][0][:, :2], mesh.start[:, :2] + [5e-5, 0], atol=1e-3)

    def event(t, x, v):
        seen[t] = x.copy(), v.copy()  # also within steps
        return 1.0
    sim = weft.load(hanging(mesh, **velocity), event=event)
    sim.advance(0.01)
    assert (seen[sim.time][0] == sim.positions).all() and (seen[sim.time][1] == sim.velocities).all()


def test_pins_of_the_simulation_are_those_that_a_function_sees():
    mesh, held = scrambled(), []

    def force(t, x, v, f):
        held.append(np.flatnonzero((x == mesh.start).all(axis=1) & (v == 0).all(axis=1)).tolist())
    sim = weft.load(hanging(mesh, pins=[{"vertices": [4, 40]}]), force=force)
    sim.pin(19)
    sim.advance(0.02)
    assert held[-1] == [4, 19, 40] == np.flatnonzero(sim.pinned).tolist()


@pytest.mark.parametrize("p", [1.0, -300.0])
def test_a_pressure_by_vertices_is_exact(p):
    mesh = scrambled()
    sims = [weft.load(hanging(mesh), force=force) for force in (None, pressure(mesh, p))]
    plain, pressed = (sim.rhs(0, sim.state).reshape(2, 3, -1)[1][:, sim.index].T for sim in sims)
    found = (pressed - plain) * sims[0].masses[:, None]
    assert np.allclose(found, np.c_[np.zeros((49, 2)), p * lumped(mesh)], rtol=1e-9, atol=abs(p) * 1e-15)
    sims[1].step(1e-6)
    assert np.allclose(sims[1].velocities[:, 2] / sims[1].time * sims[1].masses, p * lumped(mesh), rtol=1e-3)


def test_a_pressure_in_a_closed_surface_has_the_sum_zero_and_inflates_it():
    mesh = pillow()
    scene = {**hanging(mesh), "forces": {"gravity": [0, 0, 0]}}
    sim = weft.load(scene, force=pressure(mesh, 30.0))

    def volume():
        a, b, c = (sim.positions[mesh.triangles[:, k]] for k in range(3))
        return (a * np.cross(b, c)).sum() / 6
    f, before = np.zeros((len(mesh.start), 3)), volume()
    pressure(mesh, 30.0)(0.0, sim.positions, None, f)
    assert abs(f.sum(axis=0)).max() < 1e-15 and abs(f).max() > 0.02
    sim.advance(0.02)
    assert volume() > 2 * before > 0
    assert abs((sim.velocities * sim.masses[:, None]).sum(axis=0)).max() < 1e-15


def test_a_c_function_has_the_order_of_the_state_and_gets_the_index():
    mesh = scrambled()
    place = np.zeros(2, dtype=np.uintp)  # of vertex 7, and the number of vertices; filled when the simulation is there
    kind = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(ctypes.c_size_t), ctypes.c_double,
                            ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_double))

    @kind
    def push(ctx, t, y, f):
        f[2 * ctx[1] + ctx[0]] += 1e3
        return 0
    sim = weft.load(hanging(mesh), force=(push, place))
    place[:] = sim.index[7], sim.particles
    sim.step(1e-4)
    assert np.flatnonzero(sim.velocities[:, 2] > 1.0).tolist() == [7]


def test_an_objective_sees_vertices_and_its_gradient_is_by_vertices():
    mesh, vertex, seen = scrambled(), 12, {}

    def objective(t, x, v):
        seen[t] = x.copy()
        by = np.zeros(x.shape)
        by[vertex, 1] = 1.0
        return x[vertex, 1], by
    scene = hanging(mesh, pins=[{"vertices": [3]}])
    found = weft.gradient(scene, objective, ["cloth.fabric.density"], times=[0.004])
    sim = weft.load(scene)
    sim.advance(0.004)
    assert (seen[0.004] == sim.positions).all() and found.value == sim.positions[vertex, 1]
    assert found.x.shape == (49, 3)
    others = np.random.default_rng(1).choice(np.setdiff1d(np.arange(49), [3]), 3)
    for i in (vertex, *others):
        values = []
        for h in (-1e-6, 1e-6):
            one = weft.load(scene)
            one.positions = mesh.start + h * np.eye(49)[i][:, None] * [0, 1, 0]
            one.advance(0.004)
            values.append(one.positions[vertex, 1])
        assert found.x[i, 1] == pytest.approx((values[1] - values[0]) / 2e-6, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("scene, particle, name", [
    (lambda: hanging(scrambled()), 5, "vertex 5"),
    (lambda: {"cloth": {"grid": {"rows": 4, "cols": 6, "spacing": 0.1}, "density": 0.2,
                        "springs": {"stretch": {"stiffness": 100}}}, "stepper": STEPPER,
              "run": {"duration": 1}}, 9, "particle (1, 3)")])
def test_a_force_that_is_no_number_is_reported_with_its_particle(scene, particle, name):
    def force(t, x, v, f):
        f[:, 2] += 1e-3 * np.arange(len(f))
        f[particle, 1] = np.nan if t > 1e-3 else 0.0
    sim = weft.load(scene(), force=force)
    with pytest.raises(weft.StepError) as caught:
        sim.advance(0.5)
    failure = caught.value.failure
    assert "the own force on %s is (0, nan, " % name in str(caught.value) and "fastest" not in str(caught.value)
    assert failure.force and failure.force_particle == particle and np.isnan(failure.added[1])


def test_a_correction_that_is_no_number_is_reported_with_its_particle():
    def correct(t, h, x, v):
        v[5, 2] = np.inf
    with pytest.raises(weft.StepError, match="vz of vertex 5 is inf") as caught:
        weft.load(hanging(scrambled()), correct=correct).step()
    assert not caught.value.failure.force
    sim = weft.load(hanging(scrambled()))
    with pytest.raises(weft.Error, match="the position of vertex 17 has z = nan"):
        sim.positions = np.where(np.arange(49)[:, None] == 17, [0, 0, np.nan], sim.positions)


def test_several_cloths_have_their_vertices_one_after_the_other():
    seen = []

    def force(t, x, v, f):
        seen.append(x.copy())
    lower, upper = scrambled(seed=1), scrambled(seed=2)
    scene = {"cloths": [{"name": "lower", "mesh": lower, "fabric": {"preset": "royal-target"}},
                        {"name": "upper", "mesh": upper, "fabric": {"preset": "royal-target"}}],
             "stepper": STEPPER, "run": {"duration": 1}}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", weft.SceneWarning)
        sim = weft.load(scene, force=force)
    sim.step(1e-4)
    assert np.allclose(seen[0], np.concatenate([lower.start, upper.start]), atol=1e-6)
