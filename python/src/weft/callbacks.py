# SPDX-License-Identifier: BSD-3-Clause
"""Own forces and corrections: functions of Python, with the arrays that they see, and of C."""
from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any, Optional

import numpy as np

from weft._weft import ffi
from weft.library import ArgumentError, ArgumentTypeError, Array, Places

Force = Callable[[float, Array, Array, Array], None]
Correction = Callable[[float, float, Array, Array], Optional[bool]]

Event = Callable[[float, Array, Array], float]

# Signatures for numba.cfunc, of functions in C: weft_force_fn, weft_correct_fn, weft_event_fn.
FORCE = "int32(voidptr, float64, CPointer(float64), CPointer(float64))"
CORRECT = "boolean(voidptr, float64, float64, CPointer(float64))"
EVENT = "float64(voidptr, voidptr, float64, CPointer(float64))"


class PerformanceWarning(UserWarning):
    """A Python function is called in every evaluation of the right-hand side, or in every step."""


def as_particles(plane: Array, n: int) -> Array:
    """The planes x[N] y[N] z[N] as (N, 3); a view."""
    return plane.reshape(3, n).T


class Seen:
    """The arrays in which a function of Python sees states, filled again for each call: x and v (N, 3), in the order of
    Sim.positions. index (N,): where a state has each particle; None: in that order."""

    def __init__(self, n: int, index: Optional[Places]) -> None:
        self.index = index
        self.y = np.zeros(6 * n)
        self.x, self.v = as_particles(self.y[:3 * n], n), as_particles(self.y[3 * n:], n)
        self.read = self.x.view(), self.v.view()
        for array in self.read:
            array.flags.writeable = False

    def take(self, y: Any) -> None:
        """Fills the arrays from a state of C."""
        if self.index is None:
            ffi.memmove(ffi.from_buffer(self.y), y, self.y.nbytes)
        else:
            planes: Array = np.frombuffer(ffi.buffer(y, self.y.nbytes)).reshape(6, -1)
            planes.take(self.index, axis=1, out=self.y.reshape(6, -1), mode="clip")

    def give(self, planes: Array, to: Any) -> None:
        """Writes planes in the order of the arrays to those of C, which have the order of states."""
        if self.index is None:
            ffi.memmove(to, ffi.from_buffer(planes), planes.nbytes)
        else:
            n = len(self.x)
            np.frombuffer(ffi.buffer(to, planes.nbytes)).reshape(-1, n)[:, self.index] = planes.reshape(-1, n)


class Hooks:
    """The Python functions of a simulation, with the arrays that they see, and what they raised."""

    def __init__(self, n: int, index: Optional[Places] = None) -> None:
        self.force: Optional[Force] = None
        self.correct: Optional[Correction] = None
        self.event: Optional[Event] = None
        self.seen, self.f = Seen(n, index), np.zeros(3 * n)
        self.forces = as_particles(self.f, n)
        self.raised = ffi.new("bool *")
        self.error: Optional[BaseException] = None

    def keep(self, error: BaseException) -> None:
        self.error = self.error or error
        self.raised[0] = True

    def take(self) -> Optional[BaseException]:
        error, self.error, self.raised[0] = self.error, None, False
        return error


def _keep_early(_type: Any, error: BaseException, traceback: Any) -> None:
    """Keeps what a handler of a signal raised as Python entered a function that C called, before its `try`."""
    ffi.from_handle(traceback.tb_frame.f_locals["ctx"]).keep(error)


def called_by_c(failed: Any) -> Any:
    """Of a function of C whose first argument, ctx, is a handle of what has keep(error); failed: what it then returns."""
    return ffi.def_extern(error=failed, onerror=_keep_early)


def _none(value: Any, name: str, advice: str) -> None:
    if value is not None:
        raise ArgumentTypeError("%s returned %s; %s" % (name, type(value).__name__, advice))


@called_by_c(-1)
def weftpy_force(ctx: Any, t: float, y: Any, f: Any) -> int:
    hooks = ffi.from_handle(ctx)
    try:
        hooks.seen.take(y)
        hooks.f[:] = 0.0
        _none(hooks.force(t, *hooks.seen.read, hooks.forces), "the force", "it adds to its last argument in place")
        hooks.seen.give(hooks.f, f)
    except BaseException as error:  # also KeyboardInterrupt: the caller of step() gets it
        hooks.keep(error)
        return -1
    return 0


@called_by_c(False)
def weftpy_correct(ctx: Any, t: float, h: float, y: Any) -> bool:
    hooks = ffi.from_handle(ctx)
    try:
        hooks.seen.take(y)
        changed = hooks.correct(t, h, hooks.seen.x, hooks.seen.v)
        if changed is not None and not isinstance(changed, (bool, np.bool_)):
            raise ArgumentTypeError("the correction returned %s, not None or whether it changed the state"
                            % type(changed).__name__)
        if changed is False:
            return False
        hooks.seen.give(hooks.seen.y, y)
    except BaseException as error:
        hooks.keep(error)
        return False
    return True


@called_by_c(math.nan)
def weftpy_event(ctx: Any, _cloth: Any, t: float, y: Any) -> float:
    hooks = ffi.from_handle(ctx)
    try:
        hooks.seen.take(y)
        return float(hooks.event(t, *hooks.seen.read))
    except BaseException as error:
        hooks.keep(error)
        return math.nan


def c_function(value: Any, kind: str) -> Optional[tuple[Any, Any, Any]]:
    """A C function as (pointer, ctx, what to keep alive); None: value is a function of Python."""
    function, ctx = value if isinstance(value, tuple) else (value, None)
    if isinstance(function, ffi.CData):
        pointer = function
        if ffi.typeof(function) != ffi.typeof(kind):
            raise ArgumentTypeError("%r is not a C function of the type %s" % (function, ffi.getctype(kind)))
    elif isinstance(getattr(function, "address", None), int):  # numba.cfunc
        pointer = ffi.cast(kind, function.address)
    elif isinstance(function, ctypes._CFuncPtr):  # type: ignore[attr-defined]
        pointer = ffi.cast(kind, ctypes.cast(function, ctypes.c_void_p).value or 0)
    elif isinstance(value, tuple):
        raise ArgumentTypeError("only a C function takes a context: (function, context)")
    else:
        return None
    if pointer == ffi.NULL:
        raise ArgumentError("the address of the C function %r is null" % (function,))
    if isinstance(ctx, (np.ndarray, bytearray)):
        ctx = ffi.from_buffer(ctx)
    return pointer, ffi.NULL if ctx is None else ffi.cast("void *", ctx), (function, ctx, value)
