# SPDX-License-Identifier: BSD-3-Clause
"""Many simulations of one cloth on a pool of threads, for learning and control."""
from __future__ import annotations

import operator
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Any, Optional

import numpy as np

from weft._weft import ffi, lib
from weft.exclusion import Exclusion
from weft.library import (ArgumentError, ArgumentIndexError, ArgumentTypeError, Array, Error, Fixed, OutOfMemoryError,
                          StepError, check, later, real, status_text, text)
from weft.scenes import Scene
from weft.simulation import Index, Sim, load


class BatchError(Error):
    """Simulations of a Batch failed. The others have advanced.

    Attributes
    ----------
    errors : dict of int to Exception
        The StepError of each that failed, by its index.
    count : int
        Of all simulations.
    """

    def __init__(self, errors: dict[int, Exception], count: int) -> None:
        first = min(errors)
        more = " (and %d more)" % (len(errors) - 1) if len(errors) > 1 else ""
        super().__init__("simulation %d of %d: %s%s" % (first, count, errors[first], more), getattr(errors[first], "status", ""))
        self.errors, self.count = errors, count

    def __reduce__(self) -> Any:
        return BatchError, (self.errors, self.count)


class _Member:
    """The force of a simulation of a batch, which is not pickled without it."""

    def __reduce__(self) -> Any:
        raise ArgumentTypeError("a simulation of a weft.Batch with forces is pickled and copied with its batch alone")


def _revive(model: Sim, n: int, threads: int, forces: Optional[Array], saved: Sequence[bytes]) -> Batch:
    batch = Batch.__new__(Batch)
    batch._make(model, n, threads, forces is not None)
    if forces is not None and batch._added is not None:
        batch._added[:] = forces
    for sim, data in zip(batch._sims, saved):
        sim.restore(data)
    return batch


class Batch(Fixed):
    """n simulations of one cloth, for learning and control.

    They advance without the interpreter lock, each on one thread whatever run.threads says: with the bits of
    weft.load(scene) on any number of threads. They share scene and cloth; memory grows with n, not with the threads.
    batch[i] is the weft.Sim of one of them, with all its functions. The batch and its members are one for threads:
    while one thread changes or advances any of them, another one gets an Error.

    Parameters
    ----------
    scene : path, str or dict
        As of load(), also with meshes and bodies of arrays.
    n : int
        The number of simulations.
    overrides : dict, optional
        {"key.path": value}.
    threads : int, optional
        Which advance the simulations; by default one per processor.
    forces : bool
        Whether each simulation has a constant force per particle, which `forces` sets.

    Examples
    --------
    >>> batch = weft.Batch(scene, 3)
    >>> batch.pin((-1, 0), [[0, 0, 0.1], [0, 0, 0.2], [0, 0, 0.3]])
    >>> batch.advance(0.1)
    >>> batch.reset([1])
    >>> batch.states.shape, batch.times
    ((3, 2, 80, 3), array([0.1, 0. , 0.1]))
    """

    __slots__ = ("_added", "_all", "_exclusion", "_index", "_model", "_pool", "_sims", "_start", "_threads", "__weakref__")

    def __init__(self, scene: Scene, n: int, overrides: Optional[Mapping[str, Any]] = None, *,
                 threads: Optional[int] = None, forces: bool = False) -> None:
        if operator.index(n) < 1:
            raise ArgumentError("a batch has at least one simulation, not %d" % n)
        threads = len(os.sched_getaffinity(0)) if threads is None else operator.index(threads)
        if threads < 1:
            raise ArgumentError("a batch needs at least one thread, not %d" % threads)
        self._make(load(scene, overrides), operator.index(n), threads, forces)

    def _make(self, model: Sim, n: int, threads: int, forces: bool) -> None:
        self._model, self._threads, self._exclusion = model, threads, Exclusion()
        self._pool: Optional[tuple[int, ThreadPoolExecutor]] = None  # and its process
        self._index, particles = model.index, model.particles
        self._added = np.zeros((n, 3, particles)) if forces else None
        self._sims = [self._member(i) for i in range(n)]
        self._all = ffi.new("weft_sim *[]", [sim._sim for sim in self._sims])
        self._start = self._sims[0].save()

    def _member(self, i: int) -> Sim:
        sim, own = Sim.__new__(Sim), {**self._model._given, "threads": 1}
        for name in ("_name", "_form", "_overrides", "_scene", "_cloth", "_twins"):
            setattr(sim, name, getattr(self._model, name))
        if self._added is not None:
            added = ffi.new("weftpy_added *", {"count": self._added[i].size, "force": ffi.from_buffer("double[]", self._added[i])})
            own["force"] = (ffi.addressof(lib, "weftpy_add"), added)
        sim._begin(own)
        sim._exclusion, sim._given = self._exclusion, {**own, "force": None if self._added is None else _Member()}
        return sim

    def __reduce__(self) -> Any:
        return _revive, (self._model, len(self), self.threads, self._added, [sim.save() for sim in self._sims])

    def __repr__(self) -> str:
        return "<weft.Batch of %d x %r>" % (len(self), self._model)

    @property
    def threads(self) -> int:
        """How many threads advance the simulations."""
        return self._threads

    def __len__(self) -> int:
        return len(self._sims)

    def __getitem__(self, i: int) -> Sim:
        return self._sims[self._of(i)]

    def _of(self, i: Any) -> int:
        try:
            return range(len(self._sims))[operator.index(i)]
        except IndexError:
            raise ArgumentIndexError("there is no simulation %d of %d" % (i, len(self))) from None

    @property
    def states(self) -> Array:
        """(n, 2, N, 3), a copy: the positions [m] and velocities [m/s] of the particles of each simulation, in the order
        of Sim.positions."""
        out = np.empty((len(self), 2, self._model.particles, 3))
        index = ffi.NULL if self._index is None else ffi.from_buffer("size_t[]", self._index)
        with self._exclusion.read():
            lib.weftpy_states(self._all, len(self), index, ffi.from_buffer("double[]", out))
        return out

    @property
    def times(self) -> Array:
        """(n,) [s], the time of each simulation."""
        return np.array([sim.time for sim in self._sims])

    def advance(self, t: Any) -> None:
        """Steps until a time is reached exactly, as Sim.advance().

        After reset() the times differ: batch.advance(batch.times + 0.02). Ctrl-C ends each simulation after its present
        step, and all can continue.

        Parameters
        ----------
        t : float or array, shape (n,)
            [s], of all, or of each simulation.

        Raises
        ------
        BatchError
            Some failed, when all have ended: those have the state of their last good step.
        ArgumentError
            A time is over, or not finite.
        """
        with self._exclusion.change():
            ends = np.array(np.broadcast_to(real(t, "a time", (), (len(self),)), len(self)), order="C")
            for i in np.flatnonzero(~((self.times <= ends) & (ends < np.inf)))[:1]:
                later(ends[i], self._sims[i].time, "the time of simulation %d" % i)
            status, errors = ffi.new("weft_status[]", len(self)), ffi.new("weft_error[]", len(self))
            self._advance(ends, status, errors)
            failed = [i for i in range(len(self)) if status[i] != lib.WEFT_OK]
            if failed:
                raise BatchError({i: self._error(i, status[i], errors[i]) for i in failed}, len(self))

    def _advance(self, ends: Array, status: Any, errors: Any) -> None:
        if self._pool is None or self._pool[0] != os.getpid():  # a fork has no threads
            self._pool = os.getpid(), ThreadPoolExecutor(self._threads, "weft.Batch")
        following, stop = ffi.new("size_t *"), ffi.new("bool *")
        tasks = [self._pool[1].submit(lib.weftpy_advance_some, self._all, ffi.from_buffer("double[]", ends), len(ends),
                                      following, stop, status, errors) for _ in range(min(self._threads, len(ends)))]
        try:
            wait(tasks)
        except BaseException:
            stop[0] = True
            wait(tasks)
            raise

    def _error(self, i: int, status: int, err: Any) -> Exception:
        if status == lib.WEFT_NO_MEMORY:
            return OutOfMemoryError(text(err.message))
        return StepError(text(err.message), status_text(status), self._sims[i].failure)

    def reset(self, indices: Optional[Sequence[int]] = None) -> None:
        """Puts simulations back to t = 0, as new: state, pins, shapes, wind and counts of the scene, no forces. They
        continue with the bits of a new simulation.

        Parameters
        ----------
        indices : list of int, optional
            Which; None: all.
        """
        wanted = range(len(self)) if indices is None else [self._of(i) for i in indices]
        with self._exclusion.change():
            err = ffi.new("weft_error *")
            for i in wanted:
                self._sims[i]._free = None
                if self._added is not None:
                    self._added[i] = 0.0
                check(lib.weft_sim_restore(self._all[i], ffi.from_buffer(self._start), len(self._start), err), err)

    def pin(self, particle: Index, velocities: Any = None) -> None:
        """Pins a particle in all simulations, as Sim.pin() does.

        Parameters
        ----------
        particle : int or (row, column)
            Which one.
        velocities : array, shape (n, 3) or (3,), optional
            [m/s], of each simulation, or of all; None: it stays.
        """
        count, k = len(self), self._model._index(particle)
        v = None if velocities is None else np.array(
            np.broadcast_to(real(velocities, "velocities", (3,), (count, 3)), (count, 3)), order="C")
        for i, c in np.argwhere(~np.isfinite(v))[:1] if v is not None else ():
            raise ArgumentError("the velocity of simulation %d has %s = %r, not finite" % (i, "xyz"[c], float(v[i, c])))
        with self._exclusion.change():
            err = ffi.new("weft_error *")
            for i, sim in enumerate(self._sims):
                sim._free = None
                check(lib.weft_sim_pin(self._all[i], k, ffi.NULL if v is None else ffi.from_buffer("double[]", v[i]), err), err)

    @property
    def forces(self) -> Array:
        """(n, N, 3) [N], a copy: the force on each particle, besides all others, from now on; 0 at first. Assigning
        (n, N, 3) restarts the integrator of the simulations whose forces change. Needs Batch(forces=True)."""
        if self._added is None:
            raise Error("this batch has no forces: make it with forces=True")
        return np.array(self._added.transpose(0, 2, 1) if self._index is None else self._added[:, :, self._index].transpose(0, 2, 1))

    @forces.setter
    def forces(self, values: Any) -> None:
        before = self.forces
        given = real(values, "forces", before.shape)
        for i, k, c in np.argwhere(~np.isfinite(given))[:1]:
            raise ArgumentError("forces[%d, %d, %d] is %r, not finite" % (i, k, c, float(given[i, k, c])))
        with self._exclusion.change():
            err = ffi.new("weft_error *")
            for i in np.flatnonzero((given != before).any(axis=(1, 2))):
                self._added[i][:, slice(None) if self._index is None else self._index] = given[i].T  # type: ignore[index]
                check(lib.weft_sim_restart(self._all[i], err), err)
