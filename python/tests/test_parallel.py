# SPDX-License-Identifier: BSD-3-Clause
"""weft.Batch: many simulations of one cloth, with the bits of a loop over weft.load."""
import copy
import pickle
import signal
import threading
import time

import numpy as np
import pytest

import weft
from test_mesh import hung
from test_mesh import sheet as mesh_sheet

METHODS = {"verlet": {}, "adaptive": {"stepper": {"plugin": "arkode", "method": "dormand_prince", "rtol": 1e-6}},
           "gsl": {"stepper": {"plugin": "gsl", "method": "rkf45", "rtol": 1e-6}},
           "multistep": {"stepper": {"plugin": "cvode", "method": "adams", "rtol": 1e-6}},
           "threads": {"run.threads": 2}}


def states(sims):
    return np.array([(sim.positions, sim.velocities) for sim in sims])


def loop(scene, n, overrides, ends, prepare=lambda i, sim: None, **own):
    """What `states` of a batch must be."""
    sims = [weft.load(scene, overrides, **own) for _ in range(n)]
    for i, sim in enumerate(sims):
        prepare(i, sim)
        for t in ends:
            sim.advance(t)
    return states(sims)


@pytest.mark.parametrize("threads", [1, 2, 4])
@pytest.mark.parametrize("method", METHODS)
def test_the_bits_are_those_of_a_loop_on_any_number_of_threads(method, threads, scene):
    pull = [[0, 0, 0.1 * i] for i in range(5)]
    batch = weft.Batch(scene, 5, METHODS[method], threads=threads)
    batch.pin((-1, 0), pull)
    batch[3].set_wind([0, 0, 2], 0.5)
    batch.advance(0.1)
    batch.advance(0.25)

    def prepare(i, sim):
        sim.pin((-1, 0), pull[i])
        if i == 3:
            sim.set_wind([0, 0, 2], 0.5)

    expected = loop(scene, 5, METHODS[method], [0.1, 0.25], prepare)
    assert batch.states.shape == (5, 2, 80, 3) and (batch.states == expected).all()
    assert len({s.tobytes() for s in batch.states}) == 5
    assert (batch.times == 0.25).all() and (states(batch) == expected).all()


@pytest.mark.parametrize("method", METHODS)
def test_reset_ones_are_new_and_the_others_go_on(method, scene):
    batch = weft.Batch(scene, 4, METHODS[method], forces=True, threads=2)
    batch.forces = np.full((4, 80, 3), 1e-3)
    batch.pin((-1, 0), [0, 0, 1])
    batch.advance(0.2)
    before = batch.states
    batch.reset([1, -1])
    assert batch.times.tolist() == [0.2, 0, 0.2, 0]
    assert (batch.states[[0, 2]] == before[[0, 2]]).all() and not batch.forces[[1, 3]].any() and batch.forces[[0, 2]].all()
    batch.advance(batch.times + [0, 0.1, 0, 0.3])
    assert (batch.states[1] == loop(scene, 1, METHODS[method], [0.1])[0]).all()
    assert (batch.states[3] == loop(scene, 1, METHODS[method], [0.3])[0]).all()
    batch.reset()
    assert not batch.times.any() and not batch.forces.any() and (batch.states == loop(scene, 4, None, [])).all()


@pytest.mark.filterwarnings("ignore::weft.PerformanceWarning")
@pytest.mark.parametrize("method", METHODS)
def test_forces_are_those_of_a_loop_with_a_force_of_python(method, scene):
    rng = np.random.default_rng(5)
    first, second = rng.normal(scale=0.01, size=(2, 3, 80, 3))
    second[1] = first[1]
    batch = weft.Batch(scene, 3, METHODS[method], forces=True)
    batch.forces = first
    batch.advance(0.1)
    batch.forces = second
    assert (batch.forces == second).all()
    batch.advance(0.2)
    for i in range(3):
        present = [first[i]]

        def push(t, x, v, f, present=present):
            f += present[0]

        sim = weft.load(scene, METHODS[method], force=push)
        sim.restart()
        sim.advance(0.1)
        present[0] = second[i]
        if i != 1:
            sim.restart()
        sim.advance(0.2)
        assert (batch.states[i] == states([sim])[0]).all()


def test_meshes_are_by_vertices():
    batch = weft.Batch(hung(mesh_sheet()), 3, forces=True)
    push = np.zeros(batch.forces.shape)
    push[1, 7] = [0, 0.01, 0]
    batch.forces = push
    assert (batch.forces == push).all()
    batch.advance(2e-5)
    assert (batch.states == states(batch)).all()
    moved = np.linalg.norm(batch.states[1, 1] - batch.states[0, 1], axis=1)
    assert moved.argmax() == 7 and (batch.states[2] == batch.states[0]).all()


def test_an_error_names_its_simulation_and_leaves_the_others(scene):
    batch = weft.Batch(scene, 4, METHODS["adaptive"], threads=2, forces=True)
    push = batch.forces
    push[2, 40] = 1e300
    batch.forces = push
    with pytest.raises(weft.BatchError, match="^simulation 2 of 4: ") as raised:
        batch.advance(0.1)
    error = pickle.loads(pickle.dumps(raised.value))
    assert list(error.errors) == [2] and isinstance(error.errors[2], weft.StepError) and error.errors[2].failure.time < 0.1
    assert batch.times[[0, 1, 3]].tolist() == [0.1] * 3 and batch.times[2] < 0.1 and np.isfinite(batch.states).all()
    batch.reset(list(error.errors))
    batch.advance([0.2, 0.2, 0.1, 0.2])
    assert (batch.states[[0, 1, 3]] == loop(scene, 1, METHODS["adaptive"], [0.1, 0.2])).all()
    assert (batch.states[2] == loop(scene, 1, METHODS["adaptive"], [0.1])).all()


def test_an_event_ends_one_simulation(scene):
    batch = weft.Batch(scene, 2, {"stop": {"when": "max_strain > 0.05"}})
    batch.pin((-1, 0), [[0, -4, 0], [0, 0, 0]])
    batch.advance(0.05)
    assert batch[0].event and not batch[1].event and batch.times[0] < batch.times[1] == 0.05


@pytest.mark.parametrize("again", [copy.deepcopy, lambda batch: pickle.loads(pickle.dumps(batch))])
def test_a_copy_goes_on_with_the_same_bits(again, scene):
    batch = weft.Batch(scene, 3, METHODS["adaptive"], forces=True)
    batch.forces = np.arange(720).reshape(3, 80, 3) * 1e-6
    batch.pin((-1, 0), [[0, 0, 1], [0, 1, 0], [1, 0, 0]])
    batch.advance(0.1)
    batch.reset([2])
    other = again(batch)
    assert (other.states == batch.states).all() and (other.forces == batch.forces).all() and other.threads == batch.threads
    for one in (batch, other):
        one.advance([0.3, 0.2, 0.1])
    assert (other.states == batch.states).all()
    with pytest.raises(TypeError, match="with its batch"):
        pickle.dumps(batch[0])


def test_a_second_thread_is_refused(scene):
    batch = weft.Batch(scene, 2, {"stepper.fixed_step": 2e-6})
    thread = threading.Thread(target=batch.advance, args=(0.1,))
    thread.start()
    while batch.times[0] == 0.0:
        time.sleep(0.001)
    for call in (lambda: batch.advance(1.0), lambda: batch.reset(), lambda: batch[0].advance(1.0), lambda: batch[1].energy,
                 lambda: batch.states, lambda: batch.pin(0), lambda: pickle.dumps(batch)):
        assert thread.is_alive()
        with pytest.raises(weft.Error, match="in use"):
            call()
    thread.join()
    assert (batch.times == 0.1).all() and (batch.states[0] == batch.states[1]).all()


def test_ctrl_c_ends_all_after_a_step_and_they_continue(scene):
    batch = weft.Batch(scene, 3, {"stepper.fixed_step": 1e-5}, threads=2)
    timer = threading.Timer(0.3, signal.pthread_kill, [threading.main_thread().ident, signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        batch.advance(1e4)
    assert (batch.times < 1e4).all()
    batch.reset()
    batch.advance(0.01)
    assert (batch.states == loop(scene, 1, {"stepper.fixed_step": 1e-5}, [0.01])).all()


def test_a_fork_has_a_pool_of_its_own(scene):
    import os
    batch = weft.Batch(scene, 3, threads=2)
    batch.advance(0.1)
    child = os.fork()
    if child == 0:
        try:
            batch.advance(0.2)
            os._exit(0 if (batch.states == loop(scene, 1, None, [0.1, 0.2])).all() else 1)
        finally:
            os._exit(2)
    assert os.waitpid(child, 0)[1] == 0


def test_wrong_arguments_are_refused(scene):
    for n, error in ((0, ValueError), (-1, ValueError), (1.5, TypeError)):
        with pytest.raises(error):
            weft.Batch(scene, n)
    with pytest.raises(ValueError, match="at least one thread"):
        weft.Batch(scene, 1, threads=0)
    batch = weft.Batch(scene, 2)
    batch.advance(0.1)
    for t in (0.05, np.nan, np.inf, [0.2], [0.2, 0.05], [[0.2, 0.2]]):
        with pytest.raises(ValueError):
            batch.advance(t)
    assert (batch.times == 0.1).all()
    with pytest.raises(IndexError, match="no simulation 2 of 2"):
        batch.reset([0, 2])
    assert (batch.times == 0.1).all()
    with pytest.raises(IndexError):
        batch.pin(80)
    for velocities in ([0, 0], [[0, 0, 0]] * 3, [0, 0, np.nan]):
        with pytest.raises(ValueError):
            batch.pin(0, velocities)
    with pytest.raises(weft.Error, match="forces=True"):
        batch.forces = np.zeros((2, 80, 3))
    forced = weft.Batch(scene, 2, forces=True)
    for forces in (np.zeros((2, 80)), np.full((2, 80, 3), np.nan)):
        with pytest.raises(ValueError):
            forced.forces = forces
    assert len(batch) == 2 and [sim.time for sim in batch] == [0.1, 0.1] and repr(batch).startswith("<weft.Batch of 2 x <weft.Sim")


def test_memory_grows_with_the_simulations_and_not_with_the_threads(scene):
    one, many = weft.Batch(scene, 8, threads=1), weft.Batch(scene, 8, threads=4)
    for batch in (one, many):
        batch.advance(0.1)
        assert len({id(sim._cloth) for sim in batch}) == 1 and all(sim._definition.config.threads == 1 for sim in batch)
    assert (one.states == many.states).all()
