# SPDX-License-Identifier: BSD-3-Clause
"""A cloth under integration: Sim, made by load()."""
from __future__ import annotations

import math
import os
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from weft._weft import ffi, lib
from weft.callbacks import Hooks, PerformanceWarning, Seen, as_particles, c_function
from weft.exclusion import Exclusion
from weft.library import (POWERS, ArgumentError, ArgumentIndexError, ArgumentTypeError, Array, Error, Failure, Fixed,
                          SceneWarning, Spring, StepError, check, deprecated, failure, index_of, interruption, later,
                          numbers_of, pair, read_scene, real, renamed, scene_twins, spring, status_text, text)
from weft.scenes import Form, Scene, formed

Index = Union[int, tuple[int, int]]


class Energy(NamedTuple):
    """Energies of the free particles and of the springs.

    Attributes
    ----------
    kinetic, gravitational : float
        [J], of the free particles.
    stretch, shear : float
        [J], of the springs, or of the membrane of triangles.
    bend : float
        [J], of bend springs, or of bending rigidity.
    contact : float
        [J], of contact with shapes and of the cloth with itself.
    """

    kinetic: float
    gravitational: float
    stretch: float
    shear: float
    bend: float
    contact: float

    @property
    def total(self) -> float:
        """[J], the sum of all."""
        return math.fsum(self)


class Ledger(NamedTuple):
    """All energy gained and lost since t = 0; a residual of 0 closes it but for the errors of the integration.

    Attributes
    ----------
    dissipated_springs, dissipated_drag : float
        [J], turned into heat by springs and by viscous drag.
    work_wind, work_pins, work_limit : float
        [J], done on the cloth by wind and pins, and added by the strain limit.
    work_outside : float
        [J], added by corrections, set_state, and changes of pins and shapes.
    residual : float
        [J], the energy less that at t = 0, plus what was dissipated, less all work.
    work_force : float
        [J], done by an own force.
    dissipated_contact, dissipated_friction : float
        [J], turned into heat by contact.
    shape_work : float
        [J], done by moving shapes.
    """

    dissipated_springs: float
    dissipated_drag: float
    work_wind: float
    work_pins: float
    work_limit: float
    work_outside: float
    residual: float
    work_force: float
    dissipated_contact: float
    dissipated_friction: float
    shape_work: float

    wind_work = renamed("wind_work", "work_wind")
    pin_work = renamed("pin_work", "work_pins")
    limit_work = renamed("limit_work", "work_limit")
    outside_work = renamed("outside_work", "work_outside")
    force_work = renamed("force_work", "work_force")


class Stats(NamedTuple):
    """Counts of the integrator since t = 0.

    Attributes
    ----------
    steps, rejected : int
        Accepted steps, and rejected attempts.
    rhs_calls : int
        Evaluations of the right-hand side.
    last_step : float
        [s]; 0 before the first.
    next_step : float
        [s], that the solver would try next; 0: unknown.
    linear_iterations, factorisations, newton_failures : int
        Of implicit methods.
    bytes : int
        Memory of the run without the cloth; 0: not known.
    vetoed : int
        Steps that were rolled back because a particle may have passed through a collider.
    """

    steps: int
    rejected: int
    rhs_calls: int
    last_step: float
    next_step: float
    linear_iterations: int
    factorisations: int
    newton_failures: int
    bytes: int
    vetoed: int


class Measures(NamedTuple):
    """The measures of a state.

    Attributes
    ----------
    energy : Energy
        [J]
    momentum : ndarray, shape (3,)
        [kg m/s], of the free particles.
    angular_momentum : ndarray, shape (3,)
        [kg m^2/s], about the origin.
    power : dict of str to float
        [W], by what changes the energy; 0 without `record.ledger`.
    worst : Spring
        The largest strain.
    hash : str
        Of the bits of the state, as in series.csv.
    gap : float
        [m], the smallest of a free particle to a shape; inf: no shapes.
    gap_particle, gap_shape : int
        Whose gap it is.
    touching : int
        Free particles with a gap below the contact's thickness.
    self_gap : float
        [m], of the cloth to itself; inf without contact with itself.
    self_pair : tuple of two tuples of int
        The particles of the two parts of the cloth there.
    self_touching : int
        Pairs of such parts nearer than the thickness.
    """

    energy: Energy
    momentum: Array
    angular_momentum: Array
    power: dict[str, float]
    worst: Spring
    hash: str
    gap: float
    gap_particle: int
    gap_shape: int
    touching: int
    self_gap: float
    self_pair: tuple[tuple[int, ...], tuple[int, ...]]
    self_touching: int


class Stiffness(NamedTuple):
    """Bounds of the modes x'' + c x' + w2 x = 0 of a cloth.

    Attributes
    ----------
    omega2 : float
        [1/s^2], no mode is stiffer.
    damping : float
        [1/s], no mode is damped more.
    corners : ndarray, shape (n, 2)
        Of a convex polygon that holds (w2, c) of every mode.
    """

    omega2: float
    damping: float
    corners: Array


class _Memory:
    """Numbers of libweft, for NumPy, that keep their owner alive."""

    def __init__(self, owner: Any, pointer: Any, count: int) -> None:
        self.owner = owner
        self.__array_interface__ = {"version": 3, "typestr": np.dtype(np.float64).str,
                                    "shape": (count,), "data": (int(ffi.cast("uintptr_t", pointer)), True)}


def load(scene: Scene, overrides: Optional[Mapping[str, Any]] = None, *, force: Any = None, correct: Any = None,
         event: Any = None, event_hold: float = 0.0, interpolate: bool = False,
         dense: Optional[bool] = None) -> Sim:
    """Makes a simulation of a scene, at t = 0.

    Parameters
    ----------
    scene : path, str or dict
        The path of a file; or the text of a scene, a string of more than one line; or a dict of the same keys
        (docs/reference/scene.md), whose values may be NumPy's. In a dict `cloth.mesh`, or that of one of `cloths`, may be a
        weft.Mesh, a trimesh.Trimesh or a meshio.Mesh instead of {"file": ...}, and the `file` of a mesh in
        contact.shapes a trimesh.Trimesh or (vertices, triangles), with vertices (keys, n, 3) for key frames.
    overrides : dict, optional
        {"key.path": value}, for keys of the scene, such as {"run.fps": 60, "cloth.density": 0.3}.
    force : callable, optional
        force(t, x, v, f) adds its own force [N] to f (N, 3) in place, at t [s], positions x (N, 3) [m], velocities v
        (N, 3) [m/s]. It must be a function of (t, x, v) alone, and is called in every evaluation of the right-hand
        side.
    correct : callable, optional
        correct(t, h, x, v) may edit x and v in place, except for pinned particles, after each step of h [s] that ended
        at t; it returns False if it did not.
    event : callable, optional
        event(t, x, v) is a number that falls from > 0 to <= 0 at an event, which ends step(), advance() and frames():
        `event` of the simulation is True then. It is called at the end of every step and at 8 or more points within
        it. By default that of run.stop in the scene.
    event_hold : float
        [s] > 0: the event is when the number has been 0 or below for so long.
    interpolate : bool
        Keeps what between() needs. Neither this nor an event goes with a strain limit or `correct`.
    dense : bool, optional
        Deprecated: `interpolate`.

    Returns
    -------
    Sim
        The simulation.

    Raises
    ------
    SceneError
        The scene has errors: the message lists all of them with their places.
    NotFoundError
        The scene is not there.
    Error
        The cloth or the method refuses the scene.

    Warns
    -----
    SceneWarning
        The scene has a possible error.
    PerformanceWarning
        A Python function costs some microseconds per call.

    Notes
    -----
    x, v and f have the order of Sim.positions: row k is vertex k of a mesh. They are the same arrays in every call: copy what
    must stay. An exception in one of the functions ends the step, and step() or advance() raises it.

    Each may be a C function instead, weft_force_fn and so on: numba.cfunc(weft.FORCE), numba.cfunc(weft.CORRECT),
    numba.cfunc(weft.EVENT), of ctypes or of cffi, alone or as (function, array), whose memory is the function's ctx. A C
    function gets the state, where vertex k stands at Sim.index[k] of each plane.

    Examples
    --------
    >>> sim = weft.load(scene, {"stepper.fixed_step": 5e-4})
    >>> sim.advance(0.5)
    >>> sim.time, sim.positions.shape
    (0.5, (80, 3))
    """
    if dense is not None:
        deprecated("load(dense=)", "interpolate=")
        interpolate = dense
    own = {"force": force, "correct": correct, "event": event, "event_hold": event_hold, "interpolate": interpolate}
    with formed(scene, overrides) as form:
        sim = Sim(form, overrides, own)
    return sim


def _revive(scene: Scene, overrides: Any, saved: bytes, own: dict[str, Any]) -> Sim:
    sim = load(scene, overrides, **own)
    sim.restore(saved)
    return sim


def _revive_text(name: str, content: str, saved: bytes, own: dict[str, Any]) -> Sim:
    sim = Sim(Form(name, content, [], "", content), None, own)
    sim.restore(saved)
    return sim


class Sim(Fixed):
    """A simulation; make it with load().

    While one thread changes, steps or measures it, another one gets an Error. Many may run simulations of their own:
    the interpreter lock is free while weft computes. Ctrl-C ends advance() after a step.

    State arrays are views of weft's memory, read-only and not copied: later steps change them (`.copy()` keeps one).
    They keep the simulation alive; any thread may read them, and the time, at any moment. Particle (r, c) has index r *
    cols + c.

    Examples
    --------
    >>> sim = weft.load(scene)
    >>> sim.advance(0.5)
    >>> sim.energy.kinetic > 0
    True
    """

    __slots__ = ("_cloth", "_definition", "_exclusion", "_form", "_free", "_given", "_hooks", "_index_of", "_kept", "_name",
                 "_overrides", "_present", "_process", "_scene", "_sim", "_twins", "__weakref__")

    def __init__(self, form: Form, overrides: Optional[Mapping[str, Any]], own: dict[str, Any]) -> None:
        self._name = form.file or "scene"
        self._form, self._overrides = form, overrides
        self._scene, found = read_scene(form.file, form.content, form.sets, form.folder)
        for warning in found:
            warnings.warn(warning, SceneWarning, stacklevel=3)
        err, cloth = ffi.new("weft_error *"), ffi.new("weft_cloth **")
        check(lib.weft_cloth_create(lib.weft_scene_cloth(self._scene), cloth, err), err)
        self._cloth, self._twins = ffi.gc(cloth[0], lib.weft_cloth_destroy), ffi.NULL
        if lib.weft_scene_sensitivities(self._scene).count > 0:
            self._twins = scene_twins(self._scene)
        self._begin(own)

    def _begin(self, own: dict[str, Any]) -> None:
        """Makes the simulation of its scene and cloth, at t = 0."""
        self._exclusion, self._process, self._given = Exclusion(), os.getpid(), own
        err, sim = ffi.new("weft_error *"), ffi.new("weft_sim **")
        definition = ffi.new("weft_sim_def *", lib.weft_sim_def_default())
        definition.cloth, definition.method = self._cloth, lib.weft_scene_method_type(self._scene)
        definition.config = lib.weft_scene_config(self._scene)[0]
        definition.config.threads = own.get("threads", definition.config.threads)
        definition.limit = lib.weft_scene_limit(self._scene)[0]
        definition.ledger = lib.weft_scene_record(self._scene).ledger
        definition.sensitivity = lib.weft_scene_perturbed_def(self._twins) if self._twins else ffi.NULL
        definition.log = lib.weftpy_log_of()
        definition.stop = ffi.addressof(lib, "weftpy_must_stop")
        self._definition = definition
        definition.interpolate = own["interpolate"]
        lib.weftpy_stop(definition, lib.weft_scene_run(self._scene), own["event"] is not None)
        if own["event"] is not None:
            definition.event_hold = own["event_hold"]
        hooks, self._kept = ("force", "correct", "event"), []
        self._index_of = index_of(self._cloth)
        own_code = any(callable(own[name]) for name in hooks)
        self._hooks = Hooks(self.particles, self._index_of) if own_code else Hooks(0)
        for name in hooks:  # no comprehension: it would be a level of the stack
            self._kept.append(self._hook(name, "weft_%s_fn *" % name, own[name]))
        check(lib.weft_sim_create(definition, sim, err), err)
        self._sim = ffi.gc(sim[0], self._destroyer(definition, self._scene, self._cloth, self._twins))
        self._present = lib.weft_sim_cloth(self._sim)
        self._free: Optional[Array] = None  # 1 / mass [1/kg], 0 of pinned particles

    def _hook(self, name: str, kind: str, given: Any) -> Any:
        if given is None:
            return None
        compiled = c_function(given, kind)
        if compiled is not None:
            pointer, ctx, keep = compiled
        elif callable(given):
            setattr(self._hooks, name, given)
            ctx = keep = ffi.new_handle(self._hooks)
            pointer = getattr(lib, "weftpy_" + name)
            warnings.warn("%s is a Python function: every %s calls it under the interpreter lock, which takes some "
                          "10 us and a copy of the state; a C function (numba.cfunc(weft.%s)) needs neither"
                          % (name, "evaluation of the right-hand side" if name == "force" else "step", name.upper()),
                          PerformanceWarning, stacklevel=5)
        else:
            raise ArgumentTypeError("%s is neither a function nor a C function: %r" % (name, given))
        setattr(self._definition, name, pointer)
        setattr(self._definition, name + "_ctx", ctx)
        return keep

    @staticmethod
    def _destroyer(definition: Any, *of: Any) -> Any:
        """Destroys a simulation, before what it was made of."""
        destroy: Any = partial(lib.weftpy_destroy, os.getpid(), definition.config.threads)
        destroy.of = definition, of
        return destroy

    def __repr__(self) -> str:
        return "<weft.Sim %r: %s, %s %s, t = %.9g s>" % (
            self.name, text(lib.weft_cloth_text(self._cloth, ffi.new("char[]", 64), 64)),
            text(lib.weft_scene_plugin(self._scene)), text(lib.weft_scene_method(self._scene)), self.time)

    def __reduce__(self) -> Any:
        if self._form.folder:
            return _revive, (self._form.again, self._overrides, self.save(), self._given)
        return _revive_text, (self._name, self.scene, self.save(), self._given)

    @contextmanager
    def _alone(self) -> Iterator[Any]:
        """Of functions that change the simulation, or measure it on its threads; gives a weft_error."""
        with self._exclusion.change():
            if os.getpid() != self._process and self._definition.config.threads > 1:
                raise Error("this simulation has threads, which a fork does not have: load it in the child process")
            yield ffi.new("weft_error *")

    # ---- what it is ----

    @property
    def name(self) -> str:
        """The name of the scene: its key `name`, or the name of its file.

        >>> weft.load({**scene, "name": "curtain"}).name
        'curtain'
        """
        return text(lib.weft_scene_name(self._scene))

    @property
    def scene(self) -> str:
        """The scene as it runs, in YAML: with overrides applied. One of a weft.Mesh names the file scene.obj, for
        Mesh.write(); bodies of arrays are called scene-shape0.obj, ..."""
        found = text(lib.weft_scene_text(self._scene))
        return found.replace(self._form.folder + os.sep, "") if self._form.folder else found

    @property
    def rows(self) -> int:
        """How many rows of particles a grid has; 0 if the cloth is a mesh.

        >>> sim = weft.load(scene)
        >>> sim.rows, sim.cols
        (8, 10)
        """
        return int(lib.weft_cloth_rows(self._cloth))

    @property
    def cols(self) -> int:
        """How many columns of particles a grid has; 0 if the cloth is a mesh. Particle (r, c) has index r * cols + c."""
        return int(lib.weft_cloth_cols(self._cloth))

    @property
    def particles(self) -> int:
        """How many particles there are: N = rows * cols, or the vertices of triangles."""
        return int(lib.weft_cloth_particles(self._cloth))

    @property
    def index(self) -> Optional[np.ndarray[Any, np.dtype[np.intp]]]:
        """(N,), where each vertex of triangles stands in `state`; None of a grid: 0, 1, ..."""
        return None if self._index_of is None else self._index_of.copy()

    @property
    def cloths(self) -> dict[str, slice]:
        """The vertices of each of several cloths, by its name: sim.positions[sim.cloths["shirt"]]."""
        parts = [lib.weft_cloth_part_at(self._cloth, k) for k in range(lib.weft_cloth_parts(self._cloth))]
        return {text(part.name): slice(part.first, part.first + part.count) for part in parts}

    @property
    def triangles(self) -> np.ndarray[Any, np.dtype[np.uint32]]:
        """(T, 3), the particles of each triangle; two triangles for each cell of a grid."""
        return self._corners()[0]

    @property
    def rest_shape(self) -> tuple[np.ndarray[Any, np.dtype[np.uint32]], Array]:
        """The flat rest shape: (T, 3), the UV index of each corner of `triangles`, and (P, 2) [m], u v of each index."""
        return self._corners()[1:]

    def _corners(self) -> Any:
        corners = np.empty((lib.weft_cloth_triangles(self._cloth, ffi.NULL), 3), dtype=np.uint32)
        places, uv = corners.copy(), np.empty((lib.weft_cloth_uv(self._cloth, ffi.NULL, ffi.NULL), 2))
        lib.weft_cloth_triangles(self._cloth, ffi.from_buffer("uint32_t[]", corners))
        lib.weft_cloth_uv(self._cloth, ffi.from_buffer("uint32_t[]", places), ffi.from_buffer("double[]", uv))
        return corners, places, uv

    @property
    def duration(self) -> float:
        """[s], the duration of the scene's run, where frames() ends."""
        return float(lib.weft_scene_run(self._scene).duration)

    @property
    def fps(self) -> float:
        """[1/s], how many frames the scene has per second."""
        return float(lib.weft_scene_run(self._scene).fps)

    @property
    def masses(self) -> Array:
        """(N,) [kg], the mass of each particle, also of pinned ones."""
        mass = np.empty(self.particles)
        lib.weftpy_masses(self._cloth, ffi.from_buffer("double[]", mass))
        return mass

    @property
    def pinned(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """(N,) bool, whether each particle is pinned at present."""
        flags = np.empty(self.particles, dtype=np.bool_)
        with self._exclusion.read():
            lib.weftpy_pinned(self._present, ffi.from_buffer("bool[]", flags))
        return flags

    @property
    def rest(self) -> Array:
        """(N, 3) [m], positions at rest; on a mesh, whose rest shape is flat, those at t = 0."""
        xyz = np.empty((self.particles, 3))
        lib.weft_cloth_rest(self._cloth, ffi.from_buffer("double[]", xyz))
        return xyz

    @property
    def options(self) -> dict[str, str]:
        """Every choice of the integrator beyond the scene's settings, as text, by name."""
        found: dict[str, str] = {}
        handle = ffi.new_handle(found)
        with self._exclusion.read():
            lib.weft_sim_options(self._sim, lib.weftpy_option, handle)
        return found

    # ---- time ----

    @property
    def time(self) -> float:
        """[s], the present time."""
        return float(lib.weft_sim_time(self._sim))

    def _finish(self, status: int, err: Any) -> None:
        error = self._hooks.take() or (interruption() if status == lib.WEFT_STOPPED else None)
        if error is not None:
            raise error
        if status in (lib.WEFT_OK, lib.WEFT_NO_MEMORY):
            return check(status, err)
        raise StepError(text(err.message), status_text(status), self.failure)

    def step(self, until: Optional[float] = None) -> float:
        """Takes one accepted step.

        Parameters
        ----------
        until : float, optional
            [s], which the step never passes; by default the next frame. No step if it is now.

        Returns
        -------
        float
            [s], the size of the step.

        Raises
        ------
        StepError
            The step failed; the state is that of the last good step, or one that a correction left not finite.
        ArgumentError
            The time is over, or not finite.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> h = sim.step()
        >>> sim.time == h
        True
        """
        with self._alone() as err:
            before = self.time
            end = later(self._frame_after(before) if until is None else until, before)
            if end > before:
                self._finish(lib.weft_sim_step(self._sim, end, err), err)
            return self.time - before

    def advance(self, t: float) -> None:
        """Steps until a time is reached exactly, as a double, or an event; frame i of a scene is at i / fps.

        Parameters
        ----------
        t : float
            [s], not before the present time. Compute it as i / fps: sums of 1 / fps accumulate roundoff.

        Raises
        ------
        StepError
            As of step().
        ArgumentError
            The time is over, or not finite.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> for i in range(1, 4):
        ...     sim.advance(i / 60)
        >>> sim.time == 3 / 60
        True
        """
        with self._alone() as err:
            end = later(t, self.time)
            while True:  # returns every 50 ms, so that Python can raise KeyboardInterrupt
                status = lib.weftpy_advance(self._sim, end, 0.05, self._hooks.raised, err)
                self._finish(status, err)
                if self.time == end or self._at_event():
                    return

    def _at_event(self) -> bool:
        return bool(lib.weft_sim_event(self._sim))

    @property
    def event(self) -> bool:
        """Whether an event ended the last step; it is at `time`, to 1e-10 s.

        >>> sim = weft.load(scene, event=lambda t, x, v: x[:, 1].min() + 0.75)
        >>> sim.advance(1.0)
        >>> sim.event, bool(abs(sim.positions[:, 1].min() + 0.75) < 1e-8)
        (True, True)
        """
        with self._exclusion.read():
            return self._at_event()

    def between(self, t: float) -> Array:
        """Computes the state within the last step or at its end, of an order of at least that of the method less one; needs
        load(interpolate=True) or an event.

        Parameters
        ----------
        t : float
            [s]

        Returns
        -------
        ndarray, shape (6 N,)
            In the order of `state`.

        Raises
        ------
        Error
            The time is elsewhere, or the state was changed since.

        Examples
        --------
        >>> sim = weft.load(scene, interpolate=True)
        >>> h = sim.step()
        >>> sim.between(h / 2)[:80].shape
        (80,)
        """
        out = np.empty(6 * self.particles)
        with self._alone() as err:
            check(lib.weft_sim_between(self._sim, float(real(t, "a time", ())), ffi.from_buffer("double[]", out), err), err)
        return out

    def _frame_after(self, t: float) -> float:
        run = lib.weft_scene_run(self._scene)
        i = max(int(t * run.fps), 0)
        while lib.weft_run_frame_time(run, i) <= t:
            if i > lib.weft_run_last_frame(run):
                return t + 1.0 / float(run.fps)
            i += 1
        return float(lib.weft_run_frame_time(run, i))

    def frames(self) -> Iterator[int]:
        """Advances from frame to frame of the scene, up to its duration, as `weft run` does and with the same bits: it
        restarts the integrator at the checkpoints of the scene. An event is the last frame.

        Yields
        ------
        int
            The number of each frame.

        Raises
        ------
        StepError
            As of step().

        Examples
        --------
        >>> sim = weft.load(scene, {"run.duration": 0.1})
        >>> [round(sim.time, 3) for i in sim.frames()]
        [0.0, 0.033, 0.067, 0.1]
        """
        run = lib.weft_scene_run(self._scene)
        last = int(lib.weft_run_last_frame(run))
        for i in range(last + 1):
            t = float(lib.weft_run_frame_time(run, i))
            if t < self.time:
                continue
            self.advance(t)
            yield i
            if self.event:
                return
            if run.checkpoint > 0 and i > 0 and i % run.checkpoint == 0 and i < last:
                self.restart()

    def restart(self) -> None:
        """Starts the integrator again from the present state, with the step size that it would try next. Call it after a
        change of the data that an own force uses.
        """
        with self._alone() as err:
            check(lib.weft_sim_restart(self._sim, err), err)

    @property
    def stats(self) -> Stats:
        """Counts of the integrator since t = 0: steps, rejected steps, force evaluations, bytes.

        >>> sim = weft.load(scene)
        >>> sim.advance(0.1)
        >>> sim.stats.steps >= 100, sim.stats.rejected
        (True, 0)
        """
        with self._exclusion.read():
            stats, vetoed = lib.weft_sim_stats(self._sim), lib.weft_sim_vetoed(self._sim)
        return Stats(**{name: getattr(stats, name) for name in Stats._fields[:-1]}, vetoed=vetoed)

    @property
    def failure(self) -> Optional[Failure]:
        """Why the last step failed; None: it did not."""
        out = ffi.new("weft_failure *")
        with self._exclusion.read():
            return failure(out) if lib.weft_sim_failure(self._sim, out) else None

    # ---- state ----

    @property
    def state(self) -> Array:
        """(6 N,), a view: planes x[N] y[N] z[N] [m], then vx[N] vy[N] vz[N] [m/s]. May be assigned, as set_state()."""
        return np.asarray(_Memory(self, lib.weft_sim_state(self._sim), 6 * self.particles))

    @state.setter
    def state(self, y: Any) -> None:
        planes = real(y, "a state", (6 * self.particles,)).reshape(2, 3, self.particles)
        x, v = planes if self._index_of is None else planes[:, :, self._index_of]
        self.set_state(x.T, v.T)

    @property
    def positions(self) -> Array:
        """(N, 3) [m], a view; on a mesh a copy, by vertices. Assigning (N, 3) or (rows, cols, 3) moves the free
        particles, as set_state().

        >>> sim = weft.load(scene)
        >>> sim.positions = sim.positions + [0, 0.5, 0]
        >>> bool(sim.positions[-1, 1] == sim.rest[-1, 1] + 0.5)
        True
        """
        return self._triples_of(self.state[:3 * self.particles])

    def _triples_of(self, planes: Array) -> Array:
        view = as_particles(planes, self.particles)
        return view if self._index_of is None else view[self._index_of]

    @positions.setter
    def positions(self, xyz: Any) -> None:
        self.set_state(positions=self._given_state(xyz, "positions"))

    def _given_state(self, xyz: Any, name: str) -> Any:
        """None would keep what is there, without a word."""
        if xyz is None:
            raise ArgumentTypeError("%s consists of real numbers, not of None" % name)
        return xyz

    @property
    def velocities(self) -> Array:
        """(N, 3) [m/s], a view; on a mesh a copy, by vertices; may be assigned."""
        return self._triples_of(self.state[3 * self.particles:])

    @velocities.setter
    def velocities(self, xyz: Any) -> None:
        self.set_state(velocities=self._given_state(xyz, "velocities"))

    @property
    def sensitivity(self) -> dict[str, Array]:
        """The derivatives of positions and velocities with respect to the parameters of the scene's `sensitivity`
        (docs/guides/gradients.md): by key, as its `scale` says, an array (2, N, 3), a copy.

        >>> sim = weft.load(scene, {"sensitivity": {"of": ["forces.gravity.1"], "scale": "none"}})
        >>> sim.advance(0.1)
        >>> sim.sensitivity["forces.gravity.1"].shape
        (2, 80, 3)
        """
        of, found = lib.weft_scene_sensitivities(self._scene), {}
        n = self.particles
        with self._exclusion.read():
            for j in range(of.count):
                unit = 1.0 if of.relative else of.values[j] or 1.0
                s = np.frombuffer(ffi.buffer(lib.weft_sim_sensitivity(self._sim, j), 48 * n)) / unit
                found[text(of.keys[j])] = np.stack([self._triples_of(s[:3 * n]), self._triples_of(s[3 * n:])])
        return found

    @property
    def grid(self) -> Array:
        """(rows, cols, 3) [m], the positions of a grid; a view."""
        return self.state[:3 * self.particles].reshape(3, self.rows, self.cols).transpose(1, 2, 0)

    @property
    def grid_velocities(self) -> Array:
        """(rows, cols, 3) [m/s]; a view."""
        return self.state[3 * self.particles:].reshape(3, self.rows, self.cols).transpose(1, 2, 0)

    @property
    def normals(self) -> np.ndarray[Any, np.dtype[np.float32]]:
        """(N, 3), unit normals of the vertices: of their triangles, weighted by area; 0 where these have none.

        >>> weft.load(scene).normals[0] + 0
        array([0., 0., 1.], dtype=float32)
        """
        out = np.empty((self.particles, 3), dtype=np.float32)
        with self._exclusion.read():
            lib.weft_sim_vertices(self._sim, ffi.NULL, ffi.from_buffer("float[]", out), 0)
        return out

    def _triples(self, values: Any, name: str) -> tuple[Any, Any]:
        if values is None:
            return ffi.NULL, None
        grids = [(self.rows, self.cols, 3)] if self.rows > 0 else []
        array = real(values, name, (self.particles, 3), *grids)
        return ffi.from_buffer("double[]", array), array

    def set_state(self, positions: Any = None, velocities: Any = None) -> None:
        """Replaces the state of the free particles. None keeps what is there.

        Parameters
        ----------
        positions : array, shape (N, 3) or (rows, cols, 3), optional
            [m]
        velocities : array, shape (N, 3) or (rows, cols, 3), optional
            [m/s]

        Raises
        ------
        Error
            A number is not finite, or a particle would be in a shape; then nothing changes.
        """
        x, keep_x = self._triples(positions, "positions")
        v, keep_v = self._triples(velocities, "velocities")
        with self._alone() as err:
            check(lib.weft_sim_set_state(self._sim, x, v, err), err)

    def save(self) -> bytes:
        """Saves all that the future of the simulation depends on. It restarts the integrator, so that both continue with the same
        bits. A simulation can also be pickled, and copied with copy.deepcopy.

        Returns
        -------
        bytes
            For restore() of a simulation of the same scene.

        Raises
        ------
        Error
            The state is not finite.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> saved = sim.save()
        >>> sim.advance(0.1)
        >>> sim.restore(saved)
        >>> sim.time
        0.0
        """
        with self._alone() as err:
            size = lib.weft_sim_save_size(self._sim)
            data = ffi.new("char[]", size)
            check(lib.weft_sim_save(self._sim, data, size, err), err)
            return bytes(ffi.buffer(data, size))

    def restore(self, saved: bytes) -> None:
        """Puts the simulation where another one of the same scene was at its save().

        Parameters
        ----------
        saved : bytes
            What save() returned.

        Raises
        ------
        Error
            It is of another scene or method, or damaged; then nothing changes.
        """
        with self._alone() as err:
            self._free = None
            check(lib.weft_sim_restore(self._sim, ffi.from_buffer(saved), len(saved), err), err)

    # ---- measures ----

    def measure(self) -> Measures:
        """Measures the present state.

        Returns
        -------
        Measures
            With the energies.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> sim.measure().energy.kinetic
        0.0
        """
        with self._alone():
            of = lib.weft_sim_measure(self._sim)
        return Measures(self._energy(of.energy), numbers_of(of.momentum), numbers_of(of.angular_momentum),
                        dict(zip(POWERS, of.power)), spring(of.worst), "%016x" % of.hash, of.gap, of.gap_particle,
                        of.gap_shape, of.touching, of.self_gap, pair(of.self_pair), of.self_touching)

    @staticmethod
    def _energy(of: Any) -> Energy:
        stretch, shear, bend = of.elastic
        return Energy(of.kinetic, of.gravitational, stretch, shear, bend, of.contact)

    @property
    def energy(self) -> Energy:
        """[J], the energies of the present state."""
        return self.measure().energy

    @property
    def ledger(self) -> Optional[Ledger]:
        """[J], the energy balance: what was gained and lost; None unless the scene sets `record.ledger`."""
        with self._alone():
            of = lib.weft_sim_ledger(self._sim)
        return Ledger(*(getattr(of, name) for name in Ledger._fields)) if of.kept else None

    @property
    def strains(self) -> Array:
        """(N,), the largest (L - s) / s of the springs, or edges of triangles, of each particle."""
        out = np.empty(self.particles)
        with self._exclusion.read():
            lib.weft_cloth_strains(self._present, lib.weft_sim_state(self._sim), ffi.from_buffer("double[]", out))
        return out

    def _states(self, *values: Any) -> list[Any]:
        return [ffi.from_buffer("double[]", real(y, "a state", (6 * self.particles,))) for y in values]

    def rhs(self, t: float, y: Any) -> Array:
        """Computes the right-hand side, with the simulation's present pins and shapes and its own force; for solvers such as
        scipy.integrate.solve_ivp.

        Parameters
        ----------
        t : float
            [s]
        y : array, shape (6 N,)
            A state, as `state`.

        Returns
        -------
        ndarray, shape (6 N,)
            dy/dt; NaN if y is unusable: not finite, or a particle in a shape.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> sim.rhs(0, sim.state)[4 * 80:5 * 80].round(2)[[0, 40]]  # y'' of a pinned and of a free particle
        array([-0.  , -9.81])
        """
        out = np.empty(6 * self.particles)
        state, = self._states(y)
        with self._exclusion.read():
            if lib.weft_cloth_rhs(self._present, t, state, ffi.from_buffer("double[]", out)) != 0:
                out[:] = np.nan
            elif self._definition.force != ffi.NULL:
                self._add_force(t, state, out)
        return out

    def _add_force(self, t: float, state: Any, out: Array) -> None:
        n = self.particles
        f, usable = np.zeros(3 * n), True
        if self._hooks.force is not None:  # not through weftpy_force, whose arrays a callback may be looking at
            seen, planes = Seen(n, self._index_of), np.zeros(3 * n)
            seen.take(state)
            self._hooks.force(t, *seen.read, as_particles(planes, n))
            seen.give(planes, ffi.from_buffer("double[]", f))
        else:
            usable = self._definition.force(self._definition.force_ctx, t, state, ffi.from_buffer("double[]", f)) == 0
        if self._free is None:
            free = np.where(self.pinned, 0.0, 1.0 / self.masses)
            self._free = free if self._index_of is None else np.empty(n)
            if self._index_of is not None:
                self._free[self._index_of] = free
        out[3 * n:] += (f.reshape(3, n) * self._free).ravel() if usable else np.nan

    def jacobian_product(self, t: float, y: Any, dy: Any) -> Array:
        """Computes the derivative of the cloth's right-hand side along a direction. Exact, without an own force.

        Parameters
        ----------
        t : float
            [s]
        y, dy : array, shape (6 N,)
            A state and a direction, as `state`.

        Returns
        -------
        ndarray, shape (6 N,)
            J dy; NaN if y is unusable.
        """
        out = np.empty(6 * self.particles)
        state, direction = self._states(y, dy)
        with self._exclusion.read():
            if lib.weft_cloth_jacobian_product(self._present, t, state, direction,
                                               ffi.from_buffer("double[]", out)) != 0:
                out[:] = np.nan
        return out

    def jacobian(self, t: Optional[float] = None, y: Any = None) -> Any:
        """Computes the derivative of the cloth's right-hand side as a matrix, that of jacobian_product(), so without an own force.
        Needs SciPy.

        Parameters
        ----------
        t : float, optional
            [s]; by default the present time.
        y : array, shape (6 N,), optional
            A state; by default the present one.

        Returns
        -------
        scipy.sparse.csc_matrix, shape (6 N, 6 N)
            J

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> J, dy = sim.jacobian(), np.ones(480)
        >>> bool(abs(J @ dy - sim.jacobian_product(0, sim.state, dy)).max() < 1e-9)
        True
        """
        from weft.jacobian import assemble
        return assemble(self, self.time if t is None else t, self.state if y is None else y)

    def _joined(self) -> np.ndarray[Any, np.dtype[np.uint32]]:
        """(P, 2), places in a state of particles whose forces depend on each other."""
        count, err, none = ffi.new("size_t *"), ffi.new("weft_error *"), ffi.NULL
        check(lib.weftpy_joined(self._cloth, none, count, err), err)
        pairs = np.empty((count[0], 2), dtype=np.uint32)
        check(lib.weftpy_joined(self._cloth, ffi.from_buffer("uint32_t[]", pairs), count, err), err)
        return np.concatenate([pairs, self._ends()])

    def _ends(self) -> np.ndarray[Any, np.dtype[np.uint32]]:
        """(E, 2), those of the edges that wind and contact have."""
        ends = np.empty((lib.weft_cloth_edges(self._cloth, ffi.NULL), 2), dtype=np.uint32)
        lib.weft_cloth_edges(self._cloth, ffi.from_buffer("uint32_t[]", ends))
        return ends if self._index_of is None else self._index_of[ends]

    def _folded(self, y: Any) -> np.ndarray[Any, np.dtype[np.uint32]]:
        """(P, 2) as _joined(), those that contact of the cloth with itself may join: nearer than its thickness and two
        edges."""
        contact = lib.weft_scene_cloth(self._scene).contact
        if not contact.self:
            return np.empty((0, 2), dtype=np.uint32)
        from scipy.spatial import cKDTree
        x, (p, q) = np.reshape(y, (6, -1))[:3].T, self._ends().T
        reach = contact.thickness + 2 * np.linalg.norm(x[p] - x[q], axis=1).max()
        return np.asarray(cKDTree(x).query_pairs(reach, output_type="ndarray"), dtype=np.uint32)

    def stiffness(self, refine: int = 0, anywhere: bool = False) -> Stiffness:
        """Computes guaranteed bounds of all modes.

        Parameters
        ----------
        refine : int
            Steps of the power method that sharpen the bounds, which are no longer guaranteed then.
        anywhere : bool
            In any state instead of the present one.

        Returns
        -------
        Stiffness
            The bounds.
        """
        state = ffi.NULL if anywhere else lib.weft_sim_state(self._sim)
        out, err = ffi.new("weft_stiffness *"), ffi.new("weft_error *")
        with self._exclusion.read():
            if refine > 0:
                check(lib.weft_cloth_stiffness_refined(self._present, self.time, state, refine, out, err), err)
            else:
                out[0] = lib.weft_cloth_stiffness(self._present, self.time, state)
        corners = np.array([list(out.corners[i]) for i in range(out.count)]).reshape(-1, 2)
        return Stiffness(out.omega2, out.damping, corners)

    def stable_step(self, growth: float = 0.0) -> float:
        """Computes the stability limit: the largest fixed step of the scene's method up to which no mode of the present state grows.

        Parameters
        ----------
        growth : float
            [1/s]; lightly damped oscillations may grow by exp(growth t).

        Returns
        -------
        float
            [s]; inf: every step is stable.

        Raises
        ------
        Error
            The method is not of Runge-Kutta type.
        """
        kind, config = self._definition.method, self._definition.config
        stability, modes = ffi.new("weft_stability *"), ffi.new("weft_stiffness *")
        h, err = ffi.new("double *"), ffi.new("weft_error *")
        with self._exclusion.read():
            modes[0] = lib.weft_cloth_stiffness(self._present, self.time, lib.weft_sim_state(self._sim))
        check(lib.weft_stability_create(kind, config.butcher, stability, err), err)
        check(lib.weft_stability_step(stability, modes, growth, h, err), err)
        return float(h[0])

    # ---- pins and shapes ----

    def _index(self, particle: Index) -> int:
        try:
            if isinstance(particle, tuple):
                row, col = particle
                return range(self.rows)[row] * self.cols + range(self.cols)[col]
            return range(self.particles)[particle]
        except IndexError:
            raise ArgumentIndexError("there is no particle %s in %s" % (
                particle, "%d x %d" % (self.rows, self.cols) if self.cols > 0 else self.particles)) from None

    def pin(self, particle: Index, velocity: Any = None) -> None:
        """Pins a particle where it is, and moves it at a constant velocity from now on. To reach x at the time t of the
        next frame, use velocity = (x - sim.positions[particle]) / (t - sim.time).

        Parameters
        ----------
        particle : int or (row, column)
            Its index, from the end if negative.
        velocity : array, shape (3,), optional
            [m/s]; None: it stays.

        Raises
        ------
        ArgumentIndexError
            There is no such particle.
        Error
            The velocity is not finite.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> sim.pin((-1, -1), velocity=[0, 0, 0.1])
        >>> int(sim.pinned.sum())
        3
        """
        with self._alone() as err:
            self._free = None
            check(lib.weft_sim_pin(self._sim, self._index(particle), _vector(velocity), err), err)

    def pin_many(self, particles: Any, velocities: Any = None) -> None:
        """Pins many particles at once, as pin() does, which costs little more than one.

        Parameters
        ----------
        particles : array, shape (n,)
            Their indices.
        velocities : array, shape (n, 3), optional
            [m/s]; None: they stay.

        Raises
        ------
        ArgumentIndexError
            There is no such particle.
        ArgumentError
            The velocities have another shape.
        Error
            A velocity is not finite.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> sim.pin_many([70, 75, 79], np.zeros((3, 3)))
        >>> int(sim.pinned.sum())
        5
        """
        places = np.array([self._index(int(i)) for i in particles], dtype=np.uintp)
        v = None if velocities is None else real(velocities, "velocities", (len(places), 3))
        with self._alone() as err:
            self._free = None
            check(lib.weft_sim_pin_many(self._sim, ffi.from_buffer("size_t[]", places),
                                        ffi.NULL if v is None else ffi.from_buffer("double[]", v), len(places), err), err)

    def move_pin(self, particle: Index, position: Any) -> None:
        """Moves a pinned particle at once; its velocity stays.

        Parameters
        ----------
        particle : int or (row, column)
            Its index, from the end if negative.
        position : array, shape (3,)
            [m]

        Raises
        ------
        Error
            The particle is not pinned, or the cloth would pass through itself.
        """
        with self._alone() as err:
            check(lib.weft_sim_move_pin(self._sim, self._index(particle), _vector(position), err), err)

    def unpin(self, particle: Index) -> None:
        """Releases a particle with its present velocity.

        Parameters
        ----------
        particle : int or (row, column)
            Its index, from the end if negative.

        Raises
        ------
        Error
            The particle is in a shape, or in another part of the cloth.
        """
        with self._alone() as err:
            self._free = None
            check(lib.weft_sim_unpin(self._sim, self._index(particle), err), err)

    def set_wind(self, velocity: Any, drag: float = 0.0) -> None:
        """Changes the wind from now on.

        Parameters
        ----------
        velocity : array, shape (3,), or None
            [m/s]; None: that of the scene again.
        drag : float
            [kg/(m^2 s)] >= 0; not used without a velocity.

        Raises
        ------
        Error
            A value is not finite, or drag < 0.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> sim.set_wind([0, 0, 3], 1.0)
        >>> sim.advance(0.1)
        >>> bool(sim.positions[40, 2] > 0)
        True
        """
        with self._alone() as err:
            check(lib.weft_sim_set_wind(self._sim, _vector(velocity), drag, err), err)

    @property
    def shapes(self) -> list[dict[str, Any]]:
        """The present colliders, each a dict of the arguments of add_shape(), and vertices and triangles of meshes."""
        with self._exclusion.read():
            return [_shape_dict(lib.weft_cloth_shape(self._present, k)) for k in range(self._shape_count())]

    @property
    def passages(self) -> int:
        """How many edges of the cloth pass through a sphere, capsule or box between their particles, and triangles
        without such an edge, of which weft warns once, and `contact.strict` makes an error of advance().

        >>> sim = weft.load(scene)
        >>> sim.passages
        0
        """
        with self._exclusion.read():
            return int(lib.weft_cloth_passages(self._present, self.time, lib.weft_sim_state(self._sim), ffi.NULL))

    def _shape_count(self) -> int:
        return int(lib.weft_cloth_shapes(self._present))

    def _shape(self, k: int) -> int:
        try:
            return range(self._shape_count())[k]
        except IndexError:
            raise ArgumentIndexError("there is no shape %d of %d" % (k, self._shape_count())) from None

    def add_shape(self, kind: str, **fields: Any) -> int:
        """Adds a rigid collider, as the last one.

        Parameters
        ----------
        kind : str
            "plane", "sphere", "capsule" or "box". Mesh colliders belong to the scene.
        **fields
            at : array, shape (3,) [m], a point of a plane, a centre, the first end of a capsule; to : array, shape (3,) [m], the
            other end of a capsule; normal : array, shape (3,), outwards from a plane; radius : float [m], of a sphere or capsule;
            half : array, shape (3,) [m], half the edges of a box, and rounding : float [m], of its edges; orientation : array,
            shape (4,), of a box, x y z w of a quaternion; velocity : array, shape (3,) [m/s]; amplitude : array, shape (3,) [m],
            and frequency : float [Hz], of an oscillation; spin : array, shape (3,) [rad/s], of the surface of a roller or
            turntable; turn : dict of axis (3,), about (3,) [m], rate [rad/s], amplitude [rad] and frequency [Hz], a rotation;
            friction : float. By default it is at rest, with the friction of the scene's contact.

        Returns
        -------
        int
            Its index.

        Raises
        ------
        ArgumentError, ArgumentTypeError
            There is no such kind, or a field has another shape or name.
        Error
            A value is out of range, or a free particle would be in the collider.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> sim.add_shape("sphere", at=[0, -2, 0], radius=0.3)
        0
        """
        if kind not in _SHAPES:
            raise ArgumentError("there is no shape '%s'; there are %s" % (kind, ", ".join(_SHAPES)))
        shape = ffi.new("weft_shape *", lib.weft_shape_default(_SHAPES.index(kind)))
        _fill(shape[0], fields)
        k = ffi.new("size_t *")
        with self._alone() as err:
            check(lib.weft_sim_add_shape(self._sim, shape, k, err), err)
        return int(k[0])

    def move_shape(self, k: int, at: Any = None, velocity: Any = None, **motion: Any) -> None:
        """Puts a collider somewhere at once, or moves it at a constant velocity from now on. A jump passes through whatever
        is in between; a velocity does not.

        Parameters
        ----------
        k : int
            The index of the collider, as in `shapes`.
        at : array, shape (3,), optional
            [m], where it is put at once; None: it stays.
        velocity : array, shape (3,), optional
            [m/s], from now on; None: its motion continues.
        **motion
            Deprecated: drive_shape().

        Raises
        ------
        ArgumentIndexError
            There is no such collider.
        Error
            A value is not finite, or a free particle would be in the collider.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> k = sim.add_shape("sphere", at=[0, -2, 0], radius=0.3)
        >>> sim.move_shape(k, velocity=[0, 0.5, 0])
        >>> sim.advance(0.2)
        >>> sim.shape_pose(k)[0]
        array([ 0. , -1.9,  0. ])
        """
        if motion:
            if at is not None:
                raise ArgumentTypeError("move_shape() has no '%s'; drive_shape() moves a shape from where it is" % min(motion))
            deprecated("Sim.move_shape(%s=)" % min(motion), "Sim.drive_shape()")
            self.drive_shape(k, **motion, **({} if velocity is None else {"velocity": velocity}))
            return
        with self._alone() as err:
            check(lib.weft_sim_move_shape(self._sim, self._shape(k), _vector(at), _vector(velocity), err), err)

    def drive_shape(self, k: int, **motion: Any) -> None:
        """Gives a collider a new motion from now on, from where it is and as it stands.

        Parameters
        ----------
        k : int
            The index of the collider, as in `shapes`.
        **motion
            velocity, amplitude, frequency and turn as of add_shape(); those that are left out are 0, so that
            drive_shape(k) stops it. turn["about"] is where its axis is now.

        Raises
        ------
        Error
            A value is not finite or out of range.
        ArgumentTypeError
            A motion has no such key.

        Examples
        --------
        >>> sim = weft.load(scene)
        >>> k = sim.add_shape("sphere", at=[0, -2, 0], radius=0.3)
        >>> sim.drive_shape(k, amplitude=[0.1, 0, 0], frequency=2)
        >>> sim.advance(0.125)
        >>> sim.shape_pose(k)[0].round(9)
        array([ 0.1, -2. ,  0. ])
        """
        unknown = set(motion) - {"velocity", "amplitude", "frequency", "turn"}
        if unknown:
            raise ArgumentTypeError("a motion has no '%s'" % min(unknown))
        shape = ffi.new("weft_shape *", lib.weft_shape_default(0))
        _fill(shape[0], motion)
        with self._alone() as err:
            check(lib.weft_sim_drive_shape(self._sim, self._shape(k), shape, err), err)

    def remove_shape(self, k: int) -> None:
        """Removes a collider; those behind it get the next lower indices.

        Parameters
        ----------
        k : int
            The index of the collider, as in `shapes`.
        """
        with self._alone() as err:
            check(lib.weft_sim_remove_shape(self._sim, self._shape(k), err), err)

    def shape_pose(self, k: int) -> tuple[Array, Array]:
        """Computes where a collider is at present.

        Parameters
        ----------
        k : int
            The index of the collider, as in `shapes`.

        Returns
        -------
        at, velocity : ndarray, shape (3,)
            [m], the place of its `at`, and [m/s].
        """
        at, velocity = ffi.new("double[3]"), ffi.new("double[3]")
        with self._exclusion.read():
            lib.weft_cloth_shape_pose(self._present, self._shape(k), self.time, at, velocity)
        return numbers_of(at), numbers_of(velocity)

    def shape_rotation(self, k: int) -> tuple[Array, Array]:
        """Computes how a collider stands at present.

        Parameters
        ----------
        k : int
            The index of the collider, as in `shapes`.

        Returns
        -------
        rotation : ndarray, shape (3, 3)
            Of its directions as defined, of a box from x, y and z.
        omega : ndarray, shape (3,)
            [rad/s], the angular velocity of its turn.
        """
        rotation, omega = ffi.new("double[9]"), ffi.new("double[3]")
        with self._exclusion.read():
            lib.weft_cloth_shape_rotation(self._present, self._shape(k), self.time, rotation, omega)
        return numbers_of(rotation).reshape(3, 3), numbers_of(omega)

    def shape_load(self, k: int) -> tuple[Array, Array]:
        """Computes the force and the torque of the cloth on a collider.

        Parameters
        ----------
        k : int
            The index of the collider, as in `shapes`.

        Returns
        -------
        force, torque : ndarray, shape (3,)
            [N], and [N m] about its `at`.
        """
        force, torque = ffi.new("double[3]"), ffi.new("double[3]")
        with self._alone():
            lib.weft_sim_shape_load(self._sim, self._shape(k), force, torque)
        return numbers_of(force), numbers_of(torque)


def _vector(value: Any) -> Any:
    if value is None:
        return ffi.NULL
    return ffi.new("double[3]", real(value, "a vector", (3,)).tolist())


_SHAPES = [text(lib.weft_shape_name(k)) for k in range(lib.WEFT_SHAPES)]


def _fill(struct: Any, fields: Mapping[str, Any]) -> None:
    """Sets the members of a weft_shape, or of the weft_turn in it."""
    names = [name for name, _ in ffi.typeof(struct).fields if name not in ("kind", "body")]
    of = "shape" if "turn" in names else "turn"
    for name, value in fields.items():
        if name not in names:
            raise ArgumentTypeError("a %s has no '%s'; it has %s" % (of, name, ", ".join(names)))
        if name == "turn":
            _fill(struct.turn, value)
        else:
            now = getattr(struct, name)
            setattr(struct, name, real(value, name, () if isinstance(now, float) else (len(now),)).tolist())


def _members(struct: Any) -> dict[str, Any]:
    plain = {name: getattr(struct, name) for name, _ in ffi.typeof(struct).fields if name not in ("kind", "turn", "body")}
    return {name: value if isinstance(value, float) else numbers_of(value) for name, value in plain.items()}


def _body(body: Any) -> dict[str, Any]:
    count, triangles = int(body.keys * body.vertices), int(body.triangles)
    places = np.frombuffer(ffi.buffer(body.positions, 24 * count)).reshape(-1, int(body.vertices), 3).copy()
    corners = np.frombuffer(ffi.buffer(body.corners, 12 * triangles), np.uint32).reshape(-1, 3).copy()
    return {"vertices": places[0], "triangles": corners, **({"keys": places, "fps": body.fps} if len(places) > 1 else {})}


def _shape_dict(shape: Any) -> dict[str, Any]:
    turn = _members(shape.turn)
    if np.isnan(turn["about"][0]):
        del turn["about"]
    return {"kind": _SHAPES[shape.kind], **(_body(shape.body) if shape.body else {}), **_members(shape), **({"turn": turn} if turn["axis"].any() else {})}
