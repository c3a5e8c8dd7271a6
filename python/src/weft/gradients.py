# SPDX-License-Identifier: BSD-3-Clause
"""Gradients of an objective with respect to many parameters of a scene."""
from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Optional

import numpy as np

from weft._weft import ffi, lib
from weft.callbacks import Seen, called_by_c
from weft.library import (ArgumentTypeError, Array, SceneError, SceneWarning, check, index_of, keys_of, of_over,
                          read_scene, real, renamed, scene_twins)
from weft.scenes import Form, Scene, formed

# (t [s], x (N, 3) [m], v (N, 3) [m/s]) -> its value, and its derivative by x, or by x and by v.
Objective = Callable[[float, Array, Array], tuple[Any, ...]]


class Gradient(NamedTuple):
    """The derivative of an objective.

    Attributes
    ----------
    value : float
        The sum of the objective over all frames.
    parameters : dict of str to float
        The derivative with respect to each key of `over`, per unit of the parameter.
    x, v : ndarray, shape (N, 3)
        The derivatives with respect to the positions [per m] and velocities [per m/s] at t = 0, in the order of Sim.positions.
    """

    value: float
    parameters: dict[str, float]
    x: Array
    v: Array

    numbers = renamed("numbers", "parameters")


class _Call:
    """An objective with the arrays that it sees, and what it raised."""

    def __init__(self, objective: Objective, cloth: Any) -> None:
        self.objective, self.error = objective, None  # type: Objective, Optional[BaseException]
        n = int(lib.weft_cloth_particles(cloth))
        self.seen, self.slope = Seen(n, index_of(cloth)), np.zeros((2, 3, n))

    def keep(self, error: BaseException) -> None:
        self.error = self.error or error


@called_by_c(1)
def weftpy_objective(ctx: Any, frame: int, t: float, y: Any, value: Any, slope: Any) -> int:
    call = ffi.from_handle(ctx)
    try:
        call.seen.take(y)
        found, *slopes = call.objective(t, *call.seen.read)
        if not 1 <= len(slopes) <= 2:
            raise ArgumentTypeError("the objective returns its value and its derivatives with respect to x, or to x and v")
        call.slope[:] = 0.0
        for k, by in enumerate(slopes):
            call.slope[k] = real(by, "the derivative with respect to " + "xv"[k], call.seen.x.shape).T
        call.seen.give(call.slope, slope)
        value[0] += float(found)
    except BaseException as error:  # also KeyboardInterrupt: the caller gets it
        call.keep(error)
        return 1
    return 0


def _read(form: Form, keys: Sequence[str]) -> tuple[Any, Any, list[str]]:
    """A scene, the cloths with less and more of up to 16 parameters, and warnings."""
    of = "sensitivity={of: [%s], scale: none}" % ", ".join(keys) if keys else "sensitivity=null"
    try:
        scene, found = read_scene(form.file, form.content, [*form.sets, of], form.folder)
    except SceneError as error:
        raise SceneError(of_over(str(error)), [
            one._replace(line=0, column=0, place="over", source="") if one.place == "override sensitivity" else one
            for one in error.diagnostics]) from None
    return scene, scene_twins(scene), [of_over(one) for one in found]


def gradient(scene: Scene, objective: Objective, over: Sequence[str] = (),
             overrides: Optional[Mapping[str, Any]] = None, *, times: Optional[Sequence[float]] = None) -> Gradient:
    """Computes the gradient of an objective with respect to parameters of a scene and to its first state
    (docs/guides/gradients.md).

    It costs some four runs in all, and for each parameter other than those of springs, gravity and drag up to two more.
    The method is an explicit one-step method; the scene has neither a strain limit nor a stop.

    Parameters
    ----------
    scene : path, str or dict
        As of load().
    objective : callable
        objective(t, x, v) returns its value in a frame at t [s] and its derivatives with respect to the positions
        x (N, 3) [m], or to these and to the velocities v (N, 3) [m/s], all in the order of Sim.positions. It gets the same arrays in
        each call and must not change them. The last frame comes first.
    over : list of str
        Keys of parameters, as overrides write them; as many as you like.
    overrides : dict, optional
        {"key.path": value}.
    times : list of float, optional
        [s], of the frames; by default those of the scene.

    Returns
    -------
    Gradient
        Value and derivatives.

    Raises
    ------
    SceneError
        Errors of the scene or of `over`.
    NotFoundError
        The scene is not there.
    Error
        The method or the scene has no gradient; the gradient is not finite.

    Examples
    --------
    >>> def height(t, x, v):
    ...     by = np.zeros(x.shape)
    ...     by[-1, 1] = 1
    ...     return x[-1, 1], by
    >>> found = weft.gradient(scene, height, ["forces.gravity.1", "cloth.density"], times=[0.5])
    >>> found.parameters["forces.gravity.1"] > 0, found.x.shape
    (True, (80, 3))
    """
    over = keys_of(over, "over")
    with formed(scene, overrides) as form:
        parts = [_read(form, over[i:i + lib.WEFT_SENSITIVITIES])
                 for i in range(0, max(len(over), 1), lib.WEFT_SENSITIVITIES)]
    for warning in dict.fromkeys(one for *_, said in parts for one in said):
        warnings.warn(warning, SceneWarning, stacklevel=2)
    first = parts[0][0]
    err, cloth = ffi.new("weft_error *"), ffi.new("weft_cloth **")
    check(lib.weft_cloth_create(lib.weft_scene_cloth(first), cloth, err), err)
    cloth = ffi.gc(cloth[0], lib.weft_cloth_destroy)
    run = lib.weft_scene_run(first)
    if times is None:
        frames = [lib.weft_run_frame_time(run, i) for i in range(lib.weft_run_last_frame(run) + 1)]
    else:
        frames = np.asarray(times, dtype=float).ravel().tolist()
    sim = ffi.new("weft_sim_def *", lib.weft_sim_def_default())
    sim.cloth, sim.method = cloth, lib.weft_scene_method_type(first)
    sim.config, sim.limit = lib.weft_scene_config(first)[0], lib.weft_scene_limit(first)[0]
    lib.weftpy_stop(sim, run, False)
    sim.stop = ffi.addressof(lib, "weftpy_must_stop")
    parameters = ffi.new("weft_parameter[]", max(len(over), 1))
    units: list[float] = []
    for read, twins, _ in parts:
        of = lib.weft_scene_perturbed_def(twins)
        for j in range(0 if of == ffi.NULL else of.count):
            parameters[len(units)] = of.parameters[j]
            units.append(lib.weft_scene_sensitivities(read).values[j] or 1.0)
    call = _Call(objective, cloth)
    handle, at = ffi.new_handle(call), ffi.new("double[]", frames)
    definition = ffi.new("weft_gradient_def *", lib.weft_gradient_def_default())
    definition.sim, definition.count, definition.parameters = sim, len(units), parameters
    definition.frames, definition.times = len(frames), at
    definition.objective, definition.ctx = lib.weftpy_objective, handle
    value, by, start = ffi.new("double *"), np.zeros(max(len(units), 1)), np.zeros_like(call.seen.y)
    status = lib.weft_gradient(definition, value, ffi.from_buffer("double[]", by),
                               ffi.from_buffer("double[]", start), err)
    if call.error is not None:
        raise call.error
    check(status, err)
    call.seen.take(ffi.from_buffer("double[]", start))
    return Gradient(value[0], {key: float(by[j] / units[j]) for j, key in enumerate(over)},
                    np.array(call.seen.x), np.array(call.seen.v))
