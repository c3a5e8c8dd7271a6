# SPDX-License-Identifier: BSD-3-Clause
"""What is derived of a simulation: the Jacobian, normals, states within steps, events."""
import pickle

import numpy as np
import pytest

import weft

G = 9.81  # [m/s^2], the default of a scene
pytestmark = pytest.mark.filterwarnings("ignore::weft.PerformanceWarning")


def disc(membrane):
    """A flat disc of 49 vertices that is held on one side."""
    angle = np.linspace(0, 2 * np.pi, 25)[:-1]
    rim = 0.1 * np.c_[np.cos(angle), np.sin(angle)]
    i, j = np.arange(1, 25), np.roll(np.arange(1, 25), -1)
    corners = np.concatenate([np.c_[0 * i, i, j], np.c_[i, i + 24, j], np.c_[j, i + 24, j + 24]])
    return {"mesh": weft.Mesh(np.concatenate([[[0, 0]], rim / 2, rim]), None, corners), "membrane": membrane,
            "fabric": {"preset": "11oz-black-denim", "damping": [1e-5, 1e-5]}, "pins": [{"vertices": [25, 26, 27]}]}


@pytest.mark.filterwarnings("ignore::weft.SceneWarning")
@pytest.mark.parametrize("kind", ["springs", "fabric", "triangles", "arcs"])
def test_every_column_of_the_jacobian_is_a_product(scene, kind):
    pytest.importorskip("scipy")
    if kind == "fabric":
        scene["cloth"].update(fabric={"preset": "11oz-black-denim", "damping": [1e-4, 1e-4]},
                              grid={"rows": 8, "cols": 10, "spacing": [0.1, 0.11]})
        del scene["cloth"]["density"], scene["cloth"]["springs"]
        scene["stepper"]["fixed_step"] = 1e-5
    elif kind != "springs":
        scene["cloth"] = disc("arc" if kind == "arcs" else "chord")
        scene["stepper"]["fixed_step"] = 1e-6
    scene["forces"] = {"wind": {"velocity": [1, 0, 2], "drag": 1.0}}
    sim = weft.load(scene)
    for _ in range(5):
        sim.step()
    dim, rng = 6 * sim.particles, np.random.default_rng(1)
    J = sim.jacobian()
    assert J.shape == (dim, dim) and J.nnz < dim * dim / 2
    for column in rng.choice(dim, 40):
        unit = np.zeros(dim)
        unit[column] = 1.0
        wanted = sim.jacobian_product(sim.time, sim.state, unit)
        assert abs(J[:, [column]].toarray().ravel() - wanted).max() <= 1e-14 * abs(wanted).max()
    dy = rng.standard_normal(dim)
    assert np.allclose(J @ dy, sim.jacobian_product(sim.time, sim.state, dy), rtol=1e-9, atol=1e-9 * abs(J @ dy).max())


def test_the_jacobian_has_contact_of_the_cloth_with_itself(scene):
    scene["cloth"]["grid"] = {"rows": 9, "cols": 3, "spacing": 0.05, "down": [0, 0, -1]}
    scene["cloth"]["pins"] = [{"at": {"rows": 0, "cols": "all"}},
                              {"at": {"rows": 8, "cols": "all"}, "velocity": [0.03, 0, 0.6]}]
    scene["contact"] = {"self": True, "thickness": 0.02, "slip": 0.1}
    scene["stepper"]["fixed_step"] = 1e-4
    sim = weft.load(scene)
    while sim.measure().self_touching == 0:
        sim.step()
    J = sim.jacobian()
    for dy in np.random.default_rng(2).standard_normal((3, 6 * sim.particles)):
        wanted = sim.jacobian_product(sim.time, sim.state, dy)
        assert abs(J @ dy - wanted).max() <= 1e-12 * abs(wanted).max()
        rates = [sim.rhs(sim.time, sim.state + h * dy) for h in (-1e-8, 1e-8)]
        free = np.tile(~sim.pinned.ravel(), 6)
        assert abs((rates[1] - rates[0]) / 2e-8 - wanted)[free].max() <= 1e-5 * abs(wanted).max()


def test_implicit_euler_with_the_jacobian_is_stable_beyond_explicit_steps(scene):
    from scipy.sparse import identity
    from scipy.sparse.linalg import spsolve
    scene["cloth"]["springs"]["stretch"] = {"stiffness": 1e5, "damping": 1.0}
    sim = weft.load(scene, {"stepper.fixed_step": 1e-5})
    y, h = sim.state.copy(), 100 * sim.stable_step()
    for i in range(20):
        y = y + spsolve((identity(len(y), format="csc") - h * sim.jacobian(0, y)), h * sim.rhs(0, y))
    assert np.isfinite(y).all() and abs(y).max() < 10


def test_normals_are_of_unit_length_and_those_of_a_plane(scene):
    sim = weft.load(scene)
    assert np.allclose(sim.normals, [0, 0, 1])
    sim.advance(0.5)
    assert np.allclose(np.linalg.norm(sim.normals, axis=1), 1) and sim.normals.shape == (80, 3)


def test_a_ball_has_the_normals_of_its_radii():
    ring = np.linspace(0, 2 * np.pi, 13)[:-1]
    angle = np.repeat(np.linspace(0.3, 2.8, 12), 12), np.tile(ring, 12)
    start = np.c_[np.sin(angle[0]) * np.cos(angle[1]), np.cos(angle[0]), np.sin(angle[0]) * np.sin(angle[1])]
    i = (np.arange(11)[:, None] * 12 + np.arange(11)).ravel()
    corners = np.r_[np.c_[i, i + 12, i + 1], np.c_[i + 1, i + 12, i + 13]]
    scene = {"weft": 1, "cloth": {"mesh": weft.Mesh(np.c_[angle[1], -angle[0]], start, corners),
                                  "fabric": {"preset": "royal-target"}},
             "stepper": {"plugin": "verlet", "method": "euler", "fixed_step": 1e-6}, "run": {"duration": 1.0}}
    sim = weft.load(scene)
    inside = np.setdiff1d(np.arange(12, 132), np.r_[12:132:12, 23:132:12])
    assert (abs((sim.normals * start).sum(1))[inside] > 0.99).all()


@pytest.mark.parametrize("method", ["velocity_verlet", "midpoint"])
def test_a_state_within_a_step_of_a_free_fall_lies_on_its_parabola(scene, method):
    del scene["cloth"]["springs"], scene["cloth"]["pins"]
    scene["stepper"].update(method=method, fixed_step=1e-2)
    sim = weft.load(scene, interpolate=True)
    for _ in range(10):
        sim.step()
    t = sim.time - 0.4 * sim.stats.last_step
    x, v = sim.between(t).reshape(2, 3, 80)
    assert np.allclose(x[1], sim.rest[:, 1] - G * t**2 / 2, rtol=0, atol=1e-12)
    assert np.allclose(v[1], -G * t, rtol=0, atol=1e-12)
    assert (sim.between(sim.time) == sim.state).all()
    with pytest.raises(weft.Error, match="between|within"):
        sim.between(0.0)
    plain = weft.load(scene)
    plain.step()
    with pytest.raises(weft.Error, match="interpolate"):
        plain.between(plain.time / 2)


def test_an_event_is_when_a_free_fall_has_fallen(scene):
    del scene["cloth"]["springs"], scene["cloth"]["pins"]
    sim = weft.load(scene, event=lambda t, x, v: x[0, 1] + 0.5)
    sim.advance(1.0)
    assert sim.event and abs(sim.time - (2 * 0.5 / G) ** 0.5) < 1e-9 and abs(sim.positions[0, 1] + 0.5) < 1e-9
    sim.advance(1.0)
    assert not sim.event and sim.time == 1.0
    assert [i for i in weft.load(scene, event=lambda t, x, v: x[0, 1] + 0.5).frames()][-1] < 11


def test_an_event_may_have_to_last(scene):
    sim = weft.load(scene, event=lambda t, x, v: 0.1 - t, event_hold=0.2)
    sim.advance(2.0)
    assert sim.event and abs(sim.time - 0.3) < 2e-3


def test_what_an_event_raises_is_raised(scene):
    sim = weft.load(scene, event=lambda t, x, v: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        sim.advance(1.0)
    with pytest.raises(weft.Error, match="correct"):
        weft.load(scene, event=lambda t, x, v: 1.0, correct=lambda t, h, x, v: False)


def test_the_end_that_a_scene_gives_is_that_of_the_program(scene, tmp_path):
    scene["stop"] = {"when": "max_strain > 0.05"}
    sim = weft.load(scene)
    numbers = list(sim.frames())
    run = weft.run(scene, tmp_path / "run")
    assert sim.event and sim.time == run.series["time"].iloc[-1] and len(numbers) == len(run.series)
    assert sim.measure().hash == run.series["hash"].iloc[-1]


def test_a_pickled_simulation_keeps_its_event(scene):
    sim = pickle.loads(pickle.dumps(weft.load(scene, event=falls)))
    sim.advance(1.0)
    assert sim.event


def falls(t, x, v):
    return x[:, 1].min() + 0.75


def test_many_pins_are_each_a_pin(scene):
    many, one = weft.load(scene), weft.load(scene)
    rng = np.random.default_rng(2)
    places, velocities = rng.choice(80, 12, replace=False), rng.standard_normal((12, 3))
    many.pin_many(places, velocities)
    for i, v in zip(places, velocities):
        one.pin(int(i), v)
    for sim in (many, one):
        sim.advance(0.1)
    assert many.measure().hash == one.measure().hash
    with pytest.raises(IndexError):
        many.pin_many([80])
    with pytest.raises(ValueError, match="velocities"):
        many.pin_many([1, 2], [0, 0, 0])


def test_a_wind_that_is_set_is_that_of_a_scene(scene):
    changed = weft.load(scene)
    changed.set_wind([1, 0, 2], 0.5)
    blown = weft.load({**scene, "forces": {"wind": {"velocity": [1, 0, 2], "drag": 0.5}}})
    y = changed.state.copy()
    assert (changed.rhs(0, y) == blown.rhs(0, y)).all()
    changed.advance(0.1)
    blown.advance(0.1)
    assert changed.measure().hash == blown.measure().hash
    changed.set_wind(None)
    assert (changed.rhs(0, y) == weft.load(scene).rhs(0, y)).all()


@pytest.mark.parametrize("scale", ["log", "none"])
def test_sensitivity_of_free_fall_by_gravity_is_exact(scene, scale):
    del scene["cloth"]["pins"]
    scene["forces"] = {"gravity": [0, -G, 0]}
    sim = weft.load(scene, {"sensitivity": {"of": ["forces.gravity.1"], "scale": scale}})
    sim.advance(0.25)
    x, v = sim.sensitivity["forces.gravity.1"] / (-G if scale == "log" else 1.0)
    assert abs(x - [0, 0.25 ** 2 / 2, 0]).max() < 1e-12 and abs(v - [0, 0.25, 0]).max() < 1e-12
    assert (pickle.loads(pickle.dumps(sim)).sensitivity["forces.gravity.1"][0] == sim.sensitivity["forces.gravity.1"][0]).all()
    sim.restart()
    assert abs(sim.sensitivity["forces.gravity.1"]).max() > 0


def test_sensitivity_is_that_of_the_runs_file(scene, tmp_path):
    key = "cloth.springs.stretch.stiffness"
    sets = {"sensitivity": {"of": [key]}, "run.duration": 0.2, "run.fps": 5}
    sim, run = weft.load(scene, sets), weft.run(scene, tmp_path / "run", sets)
    sim.advance(0.2)
    rows = np.genfromtxt(tmp_path / "run" / "sensitivity.csv", delimiter=",", skip_header=1, usecols=range(3, 9))
    assert run.result["status"] == "done"
    assert (np.hstack(sim.sensitivity[key]) == rows).all()


def test_without_a_key_there_is_no_sensitivity(scene):
    assert weft.load(scene).sensitivity == {}


def test_sensitivity_of_arrays_of_triangles_is_that_of_their_file(scene, tmp_path):
    sets = {"sensitivity": {"of": ["cloth.fabric.density", "forces.gravity.1"]}, "stepper.fixed_step": 2e-5}
    arrays = {**scene, "cloth": {**disc("chord"), "pins": [{"vertices": [0, 1]}]}}
    arrays["cloth"]["mesh"].write(tmp_path / "disc.obj")
    file = {**arrays, "cloth": {**arrays["cloth"], "mesh": {"file": tmp_path / "disc.obj"}}}
    sims = [weft.load(one, sets) for one in (arrays, file)]
    for sim in sims:
        sim.advance(0.01)
    first, second = (sim.sensitivity for sim in sims)
    assert all((first[key] == second[key]).all() and abs(first[key]).max() > 1e-6 for key in sets["sensitivity"]["of"])
