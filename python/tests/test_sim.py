# SPDX-License-Identifier: BSD-3-Clause
"""Simulations: the state, its lifetime, callbacks, save and restore."""
import copy
import ctypes
import gc
import math
import multiprocessing
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import time
import types
import weakref
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from conftest import TREE

import weft
from weft._weft import ffi, lib

quiet = pytest.mark.filterwarnings("ignore::weft.PerformanceWarning")
pytestmark = pytest.mark.filterwarnings("ignore::weft.SceneWarning")


def with_shapes(scene):
    return {**scene, "contact": {"shapes": [{"shape": "sphere", "at": [0.5, -1.2, 0], "radius": 0.3}]}}


# ---- the state ------------------------------------------------------------------------

def test_arrays_share_weft_memory_in_every_layout(scene):
    sim = weft.load(scene)
    sim.advance(0.3)
    n, y = 80, sim.state
    assert y.shape == (6 * n,) and y.dtype == np.float64
    for view in (sim.positions, sim.velocities, sim.grid, sim.grid_velocities):
        assert np.shares_memory(y, view)
    assert sim.positions.shape == (n, 3) and sim.grid.shape == (8, 10, 3)
    for r, c in ((0, 0), (3, 7), (7, 9)):
        i = 10 * r + c
        assert list(sim.positions[i]) == list(sim.grid[r, c]) == [y[i], y[n + i], y[2 * n + i]]
        assert list(sim.velocities[i]) == list(sim.grid_velocities[r, c]) == [y[3 * n + i], y[4 * n + i], y[5 * n + i]]


def test_a_view_follows_the_steps_and_is_read_only(scene):
    sim = weft.load(scene)
    view = sim.positions
    before = view.copy()
    sim.advance(0.1)
    assert (view == sim.positions).all() and (view != before).any()
    with pytest.raises(ValueError, match="read-only"):
        view[5] = 0


def test_a_view_keeps_its_simulation_alive(scene):
    sim = weft.load(scene)
    sim.advance(0.1)
    expected, view, alive = sim.state.copy(), sim.grid[2:, ::3, 1], weakref.ref(sim)
    del sim
    gc.collect()
    junk = [np.full(480, np.nan) for _ in range(200)]
    assert alive() is not None and np.array_equal(view.ravel(), expected[80:160].reshape(8, 10)[2:, ::3].ravel())
    del view, junk
    gc.collect()
    assert alive() is None


def test_positions_and_velocities_can_be_assigned_in_both_shapes(scene):
    sim = weft.load(scene)
    moved = sim.grid + [0.0, 0.0, 0.1]
    sim.positions = moved
    sim.velocities = np.ones((80, 3))
    free = ~sim.pinned
    assert (sim.grid == moved)[free.reshape(8, 10)].all()
    assert (sim.velocities[free] == 1).all() and (sim.velocities[~free] == 0).all()
    with pytest.raises(ValueError, match=r"positions has the shape \(10, 8, 3\), not \(80, 3\) or \(8, 10, 3\)"):
        sim.positions = np.zeros((10, 8, 3))
    with pytest.raises(weft.Error, match="finite"):
        sim.velocities = np.full((80, 3), np.inf)
    assert (sim.grid == moved)[free.reshape(8, 10)].all()


def test_a_state_can_be_handed_to_another_simulation(scene):
    sim, other = weft.load(scene), weft.load(scene)
    sim.advance(0.3)
    other.state = sim.state
    assert (other.state == sim.state).all() and other.time == 0
    with pytest.raises(ValueError, match=r"a state has the shape \(80, 3\), not \(480,\)"):
        other.state = sim.positions


def test_a_complex_state_is_refused(scene):
    sim = weft.load(scene)
    before = sim.state.copy()
    for name, value in (("state", before + 1j), ("positions", sim.positions + 1j), ("velocities", sim.grid * 1j)):
        with pytest.raises(TypeError, match="consists of real numbers, not of complex128"):
            setattr(sim, name, value)
    with pytest.raises(TypeError, match="a state consists of real numbers"):
        sim.rhs(0, before + 0j)
    with pytest.raises(TypeError, match="a vector consists of real numbers"):
        sim.pin(40, velocity=[1j, 0, 0])
    assert (sim.state == before).all() and not sim.pinned[40]


def test_masses_rest_and_strains_have_one_entry_per_particle(scene):
    scene["cloth"]["loads"] = [{"at": "bottom-left", "mass": 0.25}]
    sim = weft.load(scene)
    assert sim.masses.sum() == pytest.approx(0.2 * 0.7 * 0.9 + 0.25)
    assert sim.rest.shape == (80, 3) and (sim.rest == sim.positions).all()
    assert list(np.flatnonzero(sim.pinned)) == [0, 9]
    sim.advance(0.2)
    assert sim.strains.shape == (80,) and sim.strains.max() == sim.measure().worst.strain > 0


def test_a_step_ends_at_or_before_the_next_frame(scene):
    sim = weft.load(scene, {"stepper.fixed_step": 1 / 1024, "run.fps": 400})
    assert sim.step() == 1 / 1200  # three equal steps a frame
    sim.step()
    sim.step()
    assert sim.time == 1 / 400
    assert sim.step(until=sim.time + 2e-4) == pytest.approx(2e-4)
    assert sim.stats.steps == 4
    sim.advance(sim.duration)
    assert sim.step() > 0 and sim.step(until=sim.time) == 0
    for t in (0.0, np.nan, np.inf):
        with pytest.raises(ValueError):
            sim.advance(t)


@pytest.fixture
def deadline():
    """Ends a test that hangs, and the child of its fork."""
    def late(*_):
        raise TimeoutError
    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(60)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("t", [Fraction(1, 30), Decimal("0.1"), np.longdouble("0.2"), np.float32(0.1), 1])
def test_a_time_of_any_real_type_is_that_of_the_nearest_double(scene, deadline, t):
    sim, same = weft.load(scene), weft.load(scene)
    sim.advance(t)
    same.advance(float(t))
    assert sim.time == float(t) and (sim.state == same.state).all()
    while sim.step(until=t + t):
        pass
    assert sim.time == float(t + t)


def test_what_is_no_real_number_is_no_time(scene):
    sim = weft.load(scene)
    for t in ("0.1", 0.1 + 0j, np.complex128(0.1)):
        with pytest.raises(TypeError, match="a time consists of real numbers"):
            sim.advance(t)
    with pytest.raises(ValueError, match=r"a time has the shape \(2,\)"):
        sim.step(until=[0.1, 0.2])


def test_frames_have_the_bits_of_the_program(scene, tmp_path):
    scene["run"]["checkpoint"] = 7
    run = weft.run(scene, tmp_path / "run", {"stepper": {"plugin": "verlet", "method": "velocity_verlet",
                                                         "fixed_step": 1.3e-3}})
    sim = weft.load(run.scene)
    assert [sim.measure().hash for _ in sim.frames()] == list(run.series["hash"])


def test_the_energy_is_constant_without_damping(scene):
    del scene["cloth"]["springs"]["stretch"]["damping"]
    sim = weft.load(scene, {"stepper.fixed_step": 2e-4})
    start = sim.energy.total
    sim.advance(1.0)
    assert sim.energy.total == pytest.approx(start, abs=1e-4)
    assert sim.energy.kinetic > 0.01 and sim.energy.stretch > 0.01 and sim.ledger is None


def test_the_ledger_closes(scene):
    scene["record"] = {"ledger": True}
    sim = weft.load(scene, {"stepper.fixed_step": 2e-4})
    start = sim.energy.total
    sim.advance(0.5)
    ledger = sim.ledger
    assert ledger.dissipated_springs > 0 and abs(ledger.residual) < 1e-5
    assert sim.energy.total - start + ledger.dissipated_springs == pytest.approx(ledger.residual, abs=1e-12)


def test_records_have_the_fields_of_the_headers():
    def fields(name):
        return {field for field, _ in ffi.typeof(name).fields}
    assert set(weft.Failure._fields) == fields("weft_failure")
    assert set(weft.Ledger._fields) == fields("weft_ledger") - {"kept", "energy"}
    assert set(weft.Stats._fields) - {"vetoed"} == fields("weft_stepper_stats") - {"struct_size"}
    assert set(weft.Measures._fields) == fields("weft_measures")
    assert lib.WEFT_FAMILIES == 3 and lib.WEFT_POWERS == len(weft.library.POWERS)
    flags = [name for name in dir(lib) if name.startswith("WEFT_STEPPER_")]
    assert {name.lower()[len("weft_stepper_"):] for name in flags} - {"abi"} == set(weft.library.FLAGS)
    powers = [name for _, name in sorted(ffi.typeof("weft_power").elements.items()) if name != "WEFT_POWERS"]
    assert tuple(name[len("WEFT_POWER_"):].lower() for name in powers) == weft.library.POWERS


# ---- errors ---------------------------------------------------------------------------

def test_a_dict_has_the_located_errors_of_a_file(scene, tmp_path):
    scene["cloth"]["densty"] = 1
    with pytest.raises(weft.SceneError) as error:
        weft.load(scene, {"run.fps": -1})
    first = error.value.diagnostics[0]
    assert "unknown key 'densty' in cloth (did you mean 'density'?)" in first.message
    assert first.source.strip().startswith("densty: 1") and first.source[first.column - 1:].startswith("densty")
    last = error.value.diagnostics[-1]
    assert last.place == "override run.fps" and "fps must be a number > 0 [1/s], not '-1'" in last.message
    assert "\noverride run.fps:9: error: fps must be" in str(error.value)
    path = tmp_path / "wrong.yaml"
    path.write_text("weft: 1\ncloth: {grid: [1]}\n")
    with pytest.raises(weft.SceneError, match=r"wrong.yaml:2:15: error: "):
        weft.load(path)
    with pytest.raises(weft.Error, match="no.yaml"):
        weft.load(tmp_path / "no.yaml")


def test_values_of_numpy_and_odd_values_reach_the_scene_whole(scene):
    scene["name"] = "a \"name\": with # ünïcödé, \\ and\ttabs"
    scene["cloth"]["grid"] = {"rows": np.int64(8), "cols": np.uint8(10), "spacing": np.float64(0.1),
                              "origin": np.array([1e-300, -2.5e3, 3])}
    scene["cloth"]["velocity"] = (np.float32(0.5), 0.1 + 0.2, 0)
    sim = weft.load(scene)
    assert sim.name == scene["name"]
    assert list(sim.rest[0]) == [1e-300, -2.5e3, 3]
    assert list(sim.velocities[5]) == [0.5, 0.1 + 0.2, 0]
    for value in (None, float("nan"), float("inf"), True, {}, [], "x", {"a": {"b": 1}}):
        with pytest.raises(weft.SceneError):
            weft.load(scene, {"cloth.density": value})
    for value in (object(), 1j):
        with pytest.raises(TypeError, match="no values of type"):
            weft.load({**scene, "forces": value})
    with pytest.raises(TypeError, match="key"):
        weft.load({**scene, 5: 6})
    with pytest.raises(ValueError, match="null character"):
        weft.load("no\0.yaml")
    with pytest.raises(weft.SceneError):
        weft.load({**scene, "na\0me": "\0"})


def test_overrides_replace_whole_sections(scene, tmp_path):
    springs = {"stretch": {"stiffness": 50}, "shear": {"stiffness": 7, "damping": 0.125}}
    sim = weft.load(scene, {"cloth.springs": springs, "run": {"duration": 0.1}})
    assert "0.125" in sim.scene and sim.duration == 0.1
    run = weft.run(scene, tmp_path / "run", {"cloth.springs": springs, "run": {"duration": 0.1}})
    sim.advance(0.1)
    assert run.positions[-1] == pytest.approx(sim.grid, abs=1e-6)


def test_a_scene_may_be_a_text_and_its_text_loads_again(scene):
    sim = weft.load(scene, {"run.fps": 12})
    again = weft.load(sim.scene)
    assert again.fps == 12 and again.scene == sim.scene and "velocity_verlet" in repr(again)


def test_a_scene_that_may_be_wrong_warns(scene):
    with pytest.warns(weft.SceneWarning, match="scene:.*warning: fixed_step 0.1 s is longer than a frame") as warned:
        weft.load(scene, {"stepper.fixed_step": 0.1})
    assert warned[0].filename == __file__


def test_a_failed_step_names_the_place_and_leaves_the_state(scene):
    scene["stepper"] = {"plugin": "verlet", "method": "euler", "fixed_step": 0.1}
    sim = weft.load(scene)
    with pytest.raises(weft.StepError) as error:
        sim.advance(100.0)
    failed = error.value.failure
    assert failed.time == sim.time > 0 and failed.status == error.value.status == "state is not finite"
    assert np.isfinite(sim.state).all()
    assert list(failed.position) == list(sim.positions[failed.particle])
    assert pickle.loads(pickle.dumps(error.value)).failure.time == sim.time


def test_an_unknown_particle_or_shape_is_an_index_error(scene):
    sim = weft.load(scene)
    for particle in (80, -81, (8, 0), (0, -11)):
        with pytest.raises(IndexError):
            sim.pin(particle)
    for call in (sim.shape_pose, sim.shape_load, sim.remove_shape):
        with pytest.raises(IndexError):
            call(0)
    with pytest.raises(ValueError, match=r"\(3,\)"):
        sim.pin(0, velocity=[1, 2])


def test_messages_of_the_library_are_logged(scene, caplog):
    with caplog.at_level("INFO", logger="weft"):
        weft.load(scene)
    assert any("8 x 10 particles under velocity_verlet" in message for message in caplog.messages)


def test_help_and_plugins_name_what_is_missing():
    assert "stepper" in weft.scene_help() and "[s]" in weft.scene_help("stepper.fixed_step")
    with pytest.raises(weft.Error, match="did you mean"):
        weft.scene_help("stepper.rtoll")
    with pytest.raises(weft.Error, match="weft-none.so"):
        weft.load_plugin("/weft-none.so")


# ---- pins and shapes ------------------------------------------------------------------

def test_pins_hold_move_and_release_particles(scene):
    sim = weft.load(scene)
    sim.pin((-1, -1), velocity=[0, 0, 1])
    corner = sim.grid[-1, -1].copy()
    sim.advance(0.25)
    assert sim.grid[-1, -1] == pytest.approx(corner + [0, 0, 0.25]) and sim.pinned[79]
    sim.move_pin(79, corner)
    assert list(sim.positions[79]) == list(corner)
    sim.unpin(79)
    assert not sim.pinned[79] and list(sim.velocities[79]) == [0, 0, 1]
    with pytest.raises(weft.Error, match="pin"):
        sim.move_pin(79, corner)


def test_shapes_come_move_and_go(scene):
    sim = weft.load(scene)
    k = sim.add_shape("sphere", at=np.array([0.5, -1.2, 0]), radius=0.3, friction=0.1)
    assert k == 0 and sim.shapes[k]["kind"] == "sphere" and sim.shapes[k]["radius"] == 0.3
    assert list(sim.shapes[k]["at"]) == [0.5, -1.2, 0]
    sim.move_shape(k, velocity=[0, 0, 0.5])
    sim.advance(0.2)
    at, velocity = sim.shape_pose(k)
    assert at == pytest.approx([0.5, -1.2, 0.1]) and list(velocity) == [0, 0, 0.5]
    force, torque = sim.shape_load(k)
    assert force.shape == torque.shape == (3,)
    with pytest.raises(weft.Error, match="shape"):
        sim.add_shape("box", at=sim.positions[40], half=[0.1, 0.1, 0.1])
    with pytest.raises(TypeError, match="no 'radios'; it has"):
        sim.add_shape("sphere", radios=1)
    with pytest.raises(ValueError, match="plane, sphere, capsule, box"):
        sim.add_shape("ball")
    for name, value in (("at", [0, -2]), ("to", [1]), ("normal", [0, 1]), ("velocity", [1]), ("half", np.zeros((3, 1))),
                        ("amplitude", 1.0)):
        with pytest.raises(ValueError, match=name + r" has the shape .*, not \(3,\)"):
            sim.add_shape("capsule", radius=0.1, **{name: value})
    with pytest.raises(ValueError, match=r"radius has the shape \(1,\), not \(\)"):
        sim.add_shape("sphere", at=[0, -2, 0], radius=[0.1])
    sim.remove_shape(-1)
    assert sim.shapes == []


def test_shapes_turn(scene):
    sim = weft.load(scene)
    turn = {"axis": [0, 0, 2], "about": [0, -3, 0], "rate": 0.5, "amplitude": 0.1, "frequency": 2}
    k = sim.add_shape("box", at=[1, -3, 0], half=[0.1, 0.1, 0.1], turn=turn)
    assert sim.shapes[k]["turn"].keys() == turn.keys() and list(sim.shapes[k]["turn"]["about"]) == [0, -3, 0]

    def by(angle):
        return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])

    sim.advance(0.1)
    angle = 0.05 + 0.1 * np.sin(0.4 * np.pi)
    rotation, omega = sim.shape_rotation(k)
    assert rotation == pytest.approx(by(angle)) and omega[2] == pytest.approx(0.5 + 0.4 * np.pi * np.cos(0.4 * np.pi))
    place = sim.shape_pose(k)[0]
    assert place == pytest.approx([np.cos(angle), np.sin(angle) - 3, 0])
    sim.drive_shape(k, turn={"axis": [0, 0, 1], "rate": -2}, velocity=[0, 0, 1])  # about its own centre, from how it stands
    assert sim.shape_rotation(k)[0] == pytest.approx(by(angle)) and sim.shape_pose(k)[0] == pytest.approx(place)
    sim.advance(0.3)
    assert sim.shape_rotation(k)[0] == pytest.approx(by(angle - 0.4))
    assert sim.shape_pose(k)[0] == pytest.approx(place + [0, 0, 0.2])
    sim.drive_shape(k)  # stops the turn too
    sim.advance(0.4)
    assert sim.shape_rotation(k)[0] == pytest.approx(by(angle - 0.4)) and sim.shape_rotation(k)[1].tolist() == [0, 0, 0]
    other = weft.load(scene)
    assert other.add_shape(**sim.shapes[k]) == 0 and other.shape_rotation(0)[0] == pytest.approx(by(angle - 0.4))
    with pytest.raises(TypeError, match="a turn has no 'speed'; it has axis"):
        sim.add_shape("sphere", turn={"speed": 1})
    with pytest.raises(TypeError, match=r"move_shape\(\) has no 'turn'; drive_shape"):
        sim.move_shape(k, at=[0, -5, 0], turn={"axis": [0, 0, 1]})
    with pytest.raises(weft.Error, match="turn: frequency"):
        sim.drive_shape(k, turn={"axis": [0, 0, 1], "frequency": -1})
    with pytest.raises(TypeError, match="a motion has no 'spin'"):
        sim.drive_shape(k, spin=[0, 0, 1])


def test_names_of_earlier_versions_warn_and_work(scene):
    scene["record"] = {"ledger": True}
    with pytest.deprecated_call(match="load.dense=. is deprecated: use interpolate="):
        sim = weft.load(scene, dense=True)
    sim.advance(0.1)
    assert sim.between(0.1).shape == sim.state.shape
    for old, new in {"wind_work": "work_wind", "pin_work": "work_pins", "limit_work": "work_limit",
                     "outside_work": "work_outside", "force_work": "work_force"}.items():
        with pytest.deprecated_call(match="Ledger.%s is deprecated: use %s" % (old, new)):
            assert getattr(sim.ledger, old) == getattr(sim.ledger, new)
    k = sim.add_shape("sphere", at=[0, -9, 0])
    with pytest.deprecated_call(match="Sim.move_shape.turn=. is deprecated: use Sim.drive_shape"):
        sim.move_shape(k, turn={"axis": [0, 0, 1], "rate": 2}, velocity=[0, 0, 1])
    assert sim.shape_rotation(k)[1][2] == 2 and sim.shape_pose(k)[1].tolist() == [0, 0, 1]
    square = [[0, 0], [1, 0], [1, 1]], [[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 1, 2]]
    with pytest.deprecated_call(match="Mesh.places=. is deprecated: use corner_uv="):
        mesh = weft.Mesh(*square, places=[[0, 1, 2]])
    with pytest.deprecated_call(match="Mesh.places is deprecated: use corner_uv"):
        assert mesh.places is mesh.corner_uv


# ---- solvers of Python ----------------------------------------------------------------

@quiet
@pytest.mark.parametrize("own", [False, True])
def test_solve_ivp_on_rhs_agrees_with_weft(scene, own):
    solve_ivp = pytest.importorskip("scipy.integrate").solve_ivp

    def spring_to_the_left(t, x, v, f):
        f[:, 0] -= 0.5 * x[:, 0] + 0.01 * v[:, 0]

    scene["cloth"]["springs"]["shear"] = {"stiffness": 20, "damping": 0.01}
    def difference(h):
        sim = weft.load(scene, {"stepper.fixed_step": h}, force=spring_to_the_left if own else None)
        start = sim.state.copy()
        sim.advance(0.2)
        assert np.abs(sim.positions - sim.rest).max() > 0.01
        solved = solve_ivp(sim.rhs, (0, 0.2), start, method="DOP853", rtol=1e-11, atol=1e-11)
        return np.abs(solved.y[:240, -1] - sim.state[:240]).max()

    coarse, fine = difference(4e-4), difference(2e-4)
    assert fine < 2e-5 and coarse / fine == pytest.approx(4, rel=0.1)  # velocity Verlet's order is 2


@quiet
def test_rhs_in_a_correction_does_not_disturb_it(scene):
    def force(t, x, v, f):
        f[:, 0] += x[:, 0]

    def correct(t, h, x, v):
        sim.rhs(t, np.full(480, 7.0))

    sim, plain = weft.load(scene, force=force, correct=correct), weft.load(scene, force=force)
    sim.advance(0.05)
    plain.advance(0.05)
    assert sim.positions == pytest.approx(plain.positions, abs=1e-12)


def test_the_jacobian_product_is_the_derivative_of_rhs(scene):
    sim = weft.load(scene)
    sim.advance(0.3)
    y, dy = sim.state.copy(), np.sin(np.arange(480.0))
    dy[np.tile(sim.pinned, 6)] = 0
    h = 1e-6
    slope = (sim.rhs(0.3, y + h * dy) - sim.rhs(0.3, y - h * dy)) / (2 * h)
    assert sim.jacobian_product(0.3, y, dy) == pytest.approx(slope, rel=1e-6, abs=1e-4)


def test_an_unusable_state_has_no_slope(scene):
    sim = weft.load(with_shapes(scene))
    y = sim.state.copy()
    y[40], y[120], y[200] = sim.shapes[0]["at"]
    assert np.isnan(sim.rhs(0, y)).all()
    with pytest.raises(ValueError, match=r"\(480,\)"):
        sim.rhs(0, y[:-1])


def test_amplification_is_the_polynomial_of_the_method():
    assert list(weft.amplification("verlet", "euler")) == [1, 1]
    with pytest.raises(weft.Error):
        weft.amplification("verlet", "velocity_verlet")
    with pytest.raises(weft.Error, match="did you mean"):
        weft.amplification("verlt", "euler")


def test_the_stable_step_separates_growth_from_decay():
    path = TREE / "scenes" / "stiffness.yaml"
    if not path.exists():
        pytest.skip("no scenes/stiffness.yaml")
    sim = weft.load(path)
    bound = sim.stable_step()
    assert bound == pytest.approx(2 / 0.5)
    for factor, grows in ((0.99, False), (1.01, True)):
        sim = weft.load(path, {"stepper.fixed_step": factor * bound, "run.duration": 200,
                               "run.fps": 1 / (factor * bound)})
        sim.advance(40 * factor * bound)
        assert (abs(sim.velocities[0, 0]) > 1) == grows


def test_bounds_of_the_stiffness_hold(scene):
    sim = weft.load(scene)
    sim.advance(0.2)
    sharp, sure, ever = sim.stiffness(refine=50), sim.stiffness(), sim.stiffness(anywhere=True)
    assert 0 < sharp.omega2 <= sure.omega2 <= ever.omega2 and sure.corners.shape[1] == 2


# ---- own forces and corrections -------------------------------------------------------

def test_a_python_function_warns_of_its_cost(scene):
    with pytest.warns(weft.PerformanceWarning, match="numba") as warned:
        weft.load(scene, force=lambda t, x, v, f: None)
    assert warned[0].filename == __file__


@quiet
def test_a_force_equal_to_gravity_replaces_it(scene):
    plain = weft.load(scene)
    weight = plain.masses[:, None] * [0, -9.81, 0]

    def gravity(t, x, v, f):
        f += weight

    own = weft.load({**scene, "forces": {"gravity": [0, 0, 0]}}, force=gravity)
    plain.advance(0.5)
    own.advance(0.5)
    assert own.positions == pytest.approx(plain.positions, abs=1e-10)


C_FORCE = r"""
int pull(void *ctx, double t, const double *y, double *f)
{
    const double *k = ctx;
    for (int i = 0; i < 80; ++i) f[i] -= k[0] * y[i];
    return 0;
}
"""


@pytest.fixture(scope="module")
def pull(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pull")
    (folder / "pull.c").write_text(C_FORCE)
    subprocess.run(["cc", "-O1", "-ffp-contract=off", "-shared", "-fPIC", "-o", folder / "pull.so", folder / "pull.c"],
                   check=True)
    return ctypes.CDLL(str(folder / "pull.so")).pull


@quiet
def test_c_functions_of_ctypes_cffi_and_numba_equal_python(scene, pull):
    def slow(t, x, v, f):
        f[:, 0] -= 0.5 * x[:, 0]

    k = np.array([0.5])
    address = ctypes.cast(pull, ctypes.c_void_p).value
    functions = [(pull, k), (ffi.cast("weft_force_fn *", address), ffi.from_buffer(k)),
                 (types.SimpleNamespace(address=address), k)]  # as numba's
    try:
        import numba
    except ImportError:
        numba = None
    if numba is not None:
        @numba.cfunc(weft.FORCE)
        def compiled(ctx, t, y, f):
            for i in range(80):
                f[i] -= 0.5 * y[i]
            return 0
        functions.append(compiled)
    expected = weft.load(scene, force=slow)
    expected.advance(0.2)
    for function in functions:
        sim = weft.load(scene, force=function)
        sim.advance(0.2)
        assert (sim.state == expected.state).all()


def test_the_memory_of_a_c_function_stays(scene, pull):
    sim = weft.load(scene, force=(pull, np.array([0.5])))
    gc.collect()
    junk = [np.full(1, np.nan) for _ in range(1000)]
    sim.advance(0.1)
    assert np.isfinite(sim.state).all() and junk


@quiet
def test_a_correction_edits_the_state_and_false_leaves_it(scene):
    seen = []

    def floor(t, h, x, v):
        seen.append((t, h))
        below = x[:, 1] < -0.75
        x[below, 1], v[below] = -0.75, 0
        return bool(below.any())

    sim = weft.load(scene, correct=floor)
    sim.advance(0.4)
    assert len(seen) == sim.stats.steps and seen[-1][0] == sim.time
    assert sim.positions[:, 1].min() == -0.75

    def pretend(t, h, x, v):
        x += 1
        return False

    plain, same = weft.load(scene), weft.load(scene, correct=pretend)
    plain.advance(0.1)
    same.advance(0.1)
    assert (plain.state == same.state).all()


@quiet
@pytest.mark.parametrize("kind", ["force", "correct"])
def test_an_exception_in_a_callback_reaches_the_caller(scene, kind):
    calls = []

    def fails(*arguments):
        calls.append(1)
        if len(calls) == 10:
            arguments[-1][:] = 7
            raise KeyError("the tenth")

    sim = weft.load(scene, **{kind: fails})
    with pytest.raises(KeyError, match="the tenth"):
        sim.advance(0.5)
    assert len(calls) == 10 and 0 < sim.time < 0.05
    assert np.abs(sim.velocities).max() < 1
    sim.advance(0.1)
    assert sim.time == 0.1


@quiet
@pytest.mark.parametrize("value", [0, 1.5, np.zeros(3), "yes"])
def test_a_callback_that_returns_something_else_is_a_type_error(scene, value):
    for kind in ("force", "correct"):
        with pytest.raises(TypeError, match="returned"):
            weft.load(scene, **{kind: lambda *arguments: value}).advance(0.1)


def test_what_is_no_function_is_refused(scene):
    with pytest.raises(TypeError, match="neither a function"):
        weft.load(scene, force=5)
    with pytest.raises(TypeError, match="only a C function takes a context"):
        weft.load(scene, force=(print, None))


@pytest.mark.parametrize("name", ["force", "correct"])
def test_what_is_no_c_function_of_the_signature_is_refused(scene, name):
    wrong = [ffi.NULL, ffi.cast("int", 3), ffi.new("double[3]"), ffi.cast("void *", 4096),
             ffi.cast("double (*)(double)", 4096)]
    for function in wrong + [(one, np.zeros(1)) for one in wrong]:
        with pytest.raises(TypeError, match="is not a C function of the type .*void \\*, double, "):
            weft.load(scene, **{name: function})
    kind = "weft_%s_fn *" % name
    for function in (ffi.cast(kind, 0), types.SimpleNamespace(address=0), ctypes.CFUNCTYPE(ctypes.c_int)()):
        with pytest.raises(ValueError, match="null"):
            weft.load(scene, **{name: function})


@quiet
def test_after_a_correction_that_left_nan_the_state_is_that_of_the_correction(scene):
    def spoil(t, h, x, v):
        if t > 0.05:
            x[5] = np.nan

    sim = weft.load(scene, correct=spoil)
    with pytest.raises(weft.StepError):
        sim.advance(0.1)
    assert sim.time > 0.05 and np.isnan(sim.positions[5]).all() and np.isfinite(sim.positions[6:]).all()


@quiet
def test_a_force_sees_read_only_arrays(scene):
    def edits(t, x, v, f):
        x[0] = 0

    with pytest.raises(ValueError, match="read-only"):
        weft.load(scene, force=edits).advance(0.1)


@quiet
def test_a_callback_may_read_but_not_step(scene):
    found = []

    def curious(t, h, x, v):
        assert (sim.positions == x).all() and sim.time == t
        with pytest.raises(weft.Error, match="in use"):
            sim.advance(1.0)
        found.append(sim.stats.steps)

    sim = weft.load(scene, {"run.fps": 100}, correct=curious)
    sim.advance(0.01)
    assert found == list(range(1, 11))


def test_nothing_frees_a_simulation_that_is_held(scene):
    sim = weft.load(scene)
    with pytest.raises(AttributeError):
        sim.__del__()
    assert sim.step() > 0


@quiet
def test_a_cycle_through_a_callback_is_collected(scene):
    class Game:
        def __init__(self):
            self.sim = weft.load(scene, correct=self.correct)

        def correct(self, t, h, x, v):
            return False

    game = Game()
    game.sim.advance(0.01)
    gone = weakref.ref(game.sim)
    del game
    gc.collect()
    assert gone() is None


# ---- save, pickle, processes ----------------------------------------------------------

def test_a_restored_simulation_continues_with_the_same_bits(scene):
    scene = with_shapes(scene)
    sim = weft.load(scene)
    sim.advance(0.1)
    sim.pin((4, 4))
    saved = sim.save()
    assert isinstance(saved, bytes)
    sim.advance(0.3)
    other = weft.load(scene)
    other.restore(saved)
    assert other.pinned[44]
    other.advance(0.3)
    assert other.measure().hash == sim.measure().hash
    for wrong in (b"", saved[:-1], bytes(len(saved)), saved[:100] + b"?" + saved[101:]):
        with pytest.raises(weft.Error):
            other.restore(wrong)
    assert other.measure().hash == sim.measure().hash


def test_copies_and_pickles_continue_with_the_same_bits(scene):
    sim = weft.load(scene, {"stepper.fixed_step": 7e-4})
    sim.advance(0.1)
    others = [pickle.loads(pickle.dumps(sim)), copy.deepcopy(sim), copy.copy(sim)]
    sim.advance(0.2)
    for other in others:
        assert other.time == 0.1
        other.advance(0.2)
        assert (other.state == sim.state).all()


def height(sim):
    sim.advance(sim.time + 0.1)
    return sim.measure().hash


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_other_processes_compute_the_same(scene, method):
    sim = weft.load(scene)
    with multiprocessing.get_context(method).Pool(2) as pool:
        found = pool.map(height, [sim, sim])
    assert found == [height(sim)] * 2


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_fork_neither_uses_nor_waits_for_threads_of_its_parent(scene):
    scene["cloth"]["grid"] = {"rows": 70, "cols": 70, "spacing": 0.01}
    sim = weft.load(scene, {"run.threads": 2, "stepper.fixed_step": 1e-4})
    sim.advance(0.001)
    child = os.fork()
    if child == 0:
        try:
            sim.advance(0.002)
        except weft.Error:
            del sim
            gc.collect()
            os._exit(0)
        os._exit(1)
    assert os.waitpid(child, 0)[1] == 0
    sim.advance(0.002)


def exits_well(child, work):
    """Of os.fork(): does the work in the child, and in the parent whether that succeeded."""
    if child == 0:
        signal.alarm(60)
        try:
            os._exit(0 if work() else 1)
        finally:
            os._exit(2)
    return os.waitpid(child, 0)[1] == 0


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_fork_during_a_load_can_load(scene, tmp_path):
    file = tmp_path / "weft-verlet.so"
    shutil.copy(next(Path(weft.__file__).parent.rglob("weft-verlet.so")), file)
    code = """
import logging, os, sys, weft, weft.library
weft.load_plugin(sys.argv[1])
messages = []
logging.basicConfig(level="INFO", handlers=[type("Keep", (logging.Handler,), {
    "emit": lambda self, record: messages.append(record.getMessage())})()])
with weft.library.registry_lock:
    child = os.fork()
if child == 0:
    import signal
    signal.alarm(60)
    weft.load(%r)
    os._exit(0 if any(sys.argv[1] in message for message in messages) else 1)
sys.exit(os.waitpid(child, 0)[1] != 0)
""" % scene
    subprocess.run([sys.executable, "-W", "ignore", "-c", code, file], check=True, timeout=600)


def blocked_read(scene):
    """A simulation that another thread reads until an event is set: (sim, thread, event)."""
    entered, release = threading.Event(), threading.Event()

    def force(t, x, v, f):
        entered.set()
        release.wait()

    sim = weft.load(scene, force=force)
    thread = threading.Thread(target=sim.rhs, args=(0, sim.state.copy()))
    thread.start()
    entered.wait()
    return sim, thread, release


@quiet
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_fork_does_not_wait_for_reads_of_absent_threads(scene, deadline):
    sim, thread, release = blocked_read(scene)

    def work():
        sim.pin(40)
        return sim.pinned[40]

    try:
        assert exits_well(os.fork(), work)
    finally:
        release.set()
        thread.join()
    assert not sim.pinned[40]


# ---- threads, signals, exit -----------------------------------------------------------

def test_simulations_in_threads_have_the_same_bits(scene):
    def work(sim):
        sim.advance(0.5)

    sims = [weft.load(scene) for _ in range(4)]
    threads = [threading.Thread(target=work, args=(sim,)) for sim in sims]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({sim.measure().hash for sim in sims}) == 1 and sims[0].time == 0.5


def long_run(scene):
    """A simulation that takes minutes."""
    scene["cloth"]["grid"] = {"rows": 50, "cols": 50, "spacing": 0.02}
    return weft.load(scene, {"stepper.fixed_step": 1e-6})


@quiet
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_the_interpreter_is_free_meanwhile_and_one_thread_at_a_time_steps(scene):
    stop = threading.Event()

    def until_stopped(t, h, x, v):
        if stop.is_set():
            raise InterruptedError
        return False

    scene["cloth"]["grid"] = {"rows": 50, "cols": 50, "spacing": 0.02}
    sim = weft.load(scene, {"stepper.fixed_step": 1e-6}, correct=until_stopped)
    found, y = [], sim.state.copy()

    def refused():
        with pytest.raises(weft.Error, match="in use"):
            sim.pin(40)
        return True

    def work():
        try:
            sim.advance(100.0)
        except InterruptedError as error:
            found.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    while sim.time == 0:
        time.sleep(0.001)
    for use in ("measure()", "shapes", "shape_pose(0)", "rhs(0, y)", "jacobian_product(0, y, y)", "strains", "pinned",
                "stiffness()", "stable_step()", "stats", "failure", "options", "pin(0)", "energy"):
        with pytest.raises(weft.Error, match="in use"):
            eval("sim." + use, {"sim": sim, "y": y})
    assert exits_well(os.fork(), refused) and sim.time > 0 and sim.positions.shape == (2500, 3)
    stop.set()
    thread.join()
    assert len(found) == 1


@quiet
def test_a_change_waits_for_a_read(scene, deadline):
    sim, thread, release = blocked_read(scene)
    done = threading.Event()
    change = threading.Thread(target=lambda: (sim.pin(40), done.set()))
    change.start()
    assert not done.wait(0.2)
    release.set()
    thread.join()
    change.join()
    assert done.is_set() and sim.pinned[40]


def test_shapes_can_be_read_while_another_thread_adds_and_removes_them(scene, deadline):
    sim, over, seen = weft.load(scene), threading.Event(), []

    def read():
        while not over.is_set():
            try:
                seen.extend(shape["radius"] for shape in sim.shapes)
                sim.shape_pose(-1)
            except (IndexError, weft.Error):
                pass

    threads = [threading.Thread(target=read) for _ in range(2)]
    for thread in threads:
        thread.start()
    try:
        while len(seen) < 1000:
            for _ in range(5):
                sim.add_shape("sphere", at=[0, -9, 0], radius=0.25)
            for _ in range(5):
                sim.remove_shape(0)
    finally:
        over.set()
        for thread in threads:
            thread.join()
    assert set(seen) == {0.25}


def test_ctrl_c_ends_an_advance(scene):
    sim = long_run(scene)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it

    def interrupt():
        while sim.time == 0:
            time.sleep(0.001)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        sim.advance(100.0)
    thread.join()
    at = sim.time
    assert 0 < at < 100
    sim.step()
    assert sim.time > at


IN_A_THREAD = """
import threading, time
begin = sim.time
threading.Thread(target=sim.advance, args=(1e3,), daemon=True).start()
while sim.time == begin:
    time.sleep(0.001)
"""


@pytest.mark.parametrize("end", ["pass", "view = sim.state; del sim", "sim._kept.append(sim)", "import sys; sys.exit(0)",
                                 IN_A_THREAD])
def test_the_interpreter_ends_well_in_the_midst_of_a_simulation(scene, end):
    code = ("import warnings; warnings.simplefilter('ignore'); import weft\n"
            "sim = weft.load(%r, force=lambda t, x, v, f: None)\nsim.advance(0.01)\n%s\n" % (scene, end))
    done = subprocess.run([sys.executable, "-c", code], stderr=subprocess.PIPE, text=True, timeout=600)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_large_state_is_not_copied(scene):
    scene["cloth"]["grid"] = {"rows": 1000, "cols": 1000, "spacing": 0.001}
    sim = weft.load(scene)
    import tracemalloc
    tracemalloc.start()
    total = float(sim.positions[:, 1].sum() + sim.grid_velocities[-1, -1, 0])
    assert tracemalloc.get_traced_memory()[1] < 1e6
    tracemalloc.stop()
    assert np.isfinite(total) and sim.state.nbytes == 48_000_000


def test_a_misspelt_attribute_cannot_be_set(scene, tmp_path):
    run = weft.run(scene, tmp_path / "run", {"run.duration": 0.05})
    mesh = weft.Mesh([[0, 0], [1, 0], [0, 1]], None, [[0, 1, 2]])
    for of, name, near in ((weft.load(scene), "positons", "positions"), (weft.Batch(scene, 1, forces=True), "force", "forces"),
                           (run, "serie", "series"), (mesh, "tringles", "triangles"), (weft.view(run), "hight", "height")):
        with pytest.raises(AttributeError, match=r"has no '%s' \(did you mean '%s'\?\)" % (name, near)):
            setattr(of, name, 1)
    with pytest.raises(AttributeError, match="a weft.Sim has no 'xyzzy'$"):
        weft.load(scene).xyzzy = 1


@pytest.mark.parametrize("value, error, words", [
    (None, TypeError, "consists of real numbers, not of None"), ("abc", TypeError, "not of text"),
    (np.array(["1"]), TypeError, "not of text"), ([[None, 0, 0]] * 80, TypeError, "not of None"),
    ([["1", None, 0]] * 80, TypeError, "not of str"), (np.ma.masked_less(np.ones((80, 3)), 2), ValueError, "masked elements"),
    ([[0, 0, 0], [1, 2]], ValueError, "rows of different lengths"), ({}, TypeError, "not of dict")])
def test_what_is_no_number_is_no_state(scene, value, error, words):
    sim = weft.load(scene)
    for name in ("positions", "velocities", "state"):
        with pytest.raises(error, match=words):
            setattr(sim, name, value)
    assert (sim.positions == sim.rest).all()


def test_fractions_and_decimals_are_numbers(scene):
    sim = weft.load(scene)
    sim.velocities = [[Fraction(1, 4), Decimal("0.5"), np.bool_(True)]] * 80
    assert sim.velocities[-1].tolist() == [0.25, 0.5, 1.0]


def test_a_time_that_is_over_or_not_finite_is_told_as_it_was_given(scene):
    sim = weft.load(scene)
    sim.advance(0.3)
    batch = weft.Batch(scene, 2)
    batch.advance([0.0, 0.3])
    for call, words in ((lambda: sim.advance(0.1), "^0.1 s is over: the time is 0.3 s$"),
                        (lambda: sim.step(0.1), "^0.1 s is over: the time is 0.3 s$"),
                        (lambda: sim.advance(math.inf), "^inf is not a finite time$"),
                        (lambda: batch.advance(0.1), "^0.1 s is over: the time of simulation 1 is 0.3 s$"),
                        (lambda: batch.advance([math.nan, 1.0]), "^nan is not a finite time$")):
        with pytest.raises(ValueError, match=words):
            call()
