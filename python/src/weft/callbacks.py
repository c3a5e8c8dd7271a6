# SPDX-License-Identifier: BSD-3-Clause
"""Own forces and corrections: functions of Python, with the arrays that they see, and of C."""
from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any, Optional

import numpy as np

from weft._weft import ffi
from weft.library import Array

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


class Hooks:
    """The Python functions of a simulation, with the arrays that they see, and what they raised."""

    def __init__(self, n: int) -> None:
        self.force: Optional[Force] = None
        self.correct: Optional[Correction] = None
        self.event: Optional[Event] = None
        self.y, self.f = np.zeros(6 * n), np.zeros(3 * n)
        self.x, self.v = as_particles(self.y[:3 * n], n), as_particles(self.y[3 * n:], n)
        self.forces = as_particles(self.f, n)
        self.read = self.x.view(), self.v.view()
        for array in self.read:
            array.flags.writeable = False
        self.raised = ffi.new("bool *")
        self.error: Optional[BaseException] = None

    def keep(self, error: BaseException) -> None:
        self.error = self.error or error
        self.raised[0] = True

    def take(self) -> Optional[BaseException]:
        error, self.error, self.raised[0] = self.error, None, False
        return error


def _none(value: Any, name: str, advice: str) -> None:
    if value is not None:
        raise TypeError("%s returned %s; %s" % (name, type(value).__name__, advice))


@ffi.def_extern()
def weftpy_force(ctx: Any, t: float, y: Any, f: Any) -> int:
    hooks = ffi.from_handle(ctx)
    try:
        ffi.memmove(ffi.from_buffer(hooks.y), y, hooks.y.nbytes)
        hooks.f[:] = 0.0
        _none(hooks.force(t, *hooks.read, hooks.forces), "the force", "it adds to its last argument in place")
        ffi.memmove(f, ffi.from_buffer(hooks.f), hooks.f.nbytes)
    except BaseException as error:  # also KeyboardInterrupt: the caller of step() gets it
        hooks.keep(error)
        return -1
    return 0


@ffi.def_extern()
def weftpy_correct(ctx: Any, t: float, h: float, y: Any) -> bool:
    hooks = ffi.from_handle(ctx)
    try:
        ffi.memmove(ffi.from_buffer(hooks.y), y, hooks.y.nbytes)
        changed = hooks.correct(t, h, hooks.x, hooks.v)
        if changed is not None and not isinstance(changed, (bool, np.bool_)):
            raise TypeError("the correction returned %s, not None or whether it changed the state"
                            % type(changed).__name__)
        if changed is False:
            return False
        ffi.memmove(y, ffi.from_buffer(hooks.y), hooks.y.nbytes)
    except BaseException as error:
        hooks.keep(error)
        return False
    return True


@ffi.def_extern()
def weftpy_event(ctx: Any, _cloth: Any, t: float, y: Any) -> float:
    hooks = ffi.from_handle(ctx)
    try:
        ffi.memmove(ffi.from_buffer(hooks.y), y, hooks.y.nbytes)
        return float(hooks.event(t, *hooks.read))
    except BaseException as error:
        hooks.keep(error)
        return math.nan


def c_function(value: Any, kind: str) -> Optional[tuple[Any, Any, Any]]:
    """A C function as (pointer, ctx, what to keep alive); None: value is a function of Python."""
    function, ctx = value if isinstance(value, tuple) else (value, None)
    if isinstance(function, ffi.CData):
        pointer = function
        if ffi.typeof(function) != ffi.typeof(kind):
            raise TypeError("%r is not a C function of the type %s" % (function, ffi.getctype(kind)))
    elif isinstance(getattr(function, "address", None), int):  # numba.cfunc
        pointer = ffi.cast(kind, function.address)
    elif isinstance(function, ctypes._CFuncPtr):  # type: ignore[attr-defined]
        pointer = ffi.cast(kind, ctypes.cast(function, ctypes.c_void_p).value or 0)
    elif isinstance(value, tuple):
        raise TypeError("only a C function takes a context: (function, context)")
    else:
        return None
    if pointer == ffi.NULL:
        raise ValueError("the address of the C function %r is null" % (function,))
    if isinstance(ctx, (np.ndarray, bytearray)):
        ctx = ffi.from_buffer(ctx)
    return pointer, ffi.NULL if ctx is None else ffi.cast("void *", ctx), (function, ctx, value)
