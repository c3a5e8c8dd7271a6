# SPDX-License-Identifier: BSD-3-Clause
"""libweft, shared by the other modules: errors, records, methods, the text of a scene."""
from __future__ import annotations

import difflib
import json
import logging
import math
import numbers
import os
import re
import threading
import warnings
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from weft._weft import ffi, lib

Array = np.ndarray[Any, np.dtype[np.float64]]
Places = np.ndarray[Any, np.dtype[np.intp]]
PathLike = Union[str, "os.PathLike[str]"]

FAMILIES = ("stretch", "shear", "bend")
POWERS = ("springs", "drag", "wind", "pins", "contact", "friction", "shapes")
FLAGS = ("fixed_only", "fsal", "multistep", "implicit", "legacy", "butcher", "dense", "controller",
         "quadratures", "libm", "structure", "adaptive_only", "linear", "distributed", "couplings", "pass")


class Error(RuntimeError):
    """A failure of weft.

    Attributes
    ----------
    status : str
        libweft's status in words, such as "invalid argument".
    """

    def __init__(self, message: str, status: str = "") -> None:
        super().__init__(message)
        self.status = status


class ArgumentError(Error, ValueError):
    """An argument has a wrong value: a shape of an array, a number out of range, a name that does not exist.

    It is an Error and a ValueError.
    """


class ArgumentTypeError(Error, TypeError):
    """An argument is of a wrong type. It is an Error and a TypeError."""


class ArgumentIndexError(Error, IndexError):
    """There is no such particle, collider or simulation. It is an Error and an IndexError."""


class MissingKeyError(Error, KeyError):
    """A run did not record a field, or a mesh has no such data. It is an Error and a KeyError."""

    def __str__(self) -> str:
        return str(self.args[0])


class UnknownAttributeError(Error, AttributeError):
    """An object has no attribute of that name to set. It is an Error and an AttributeError."""


class MissingPackageError(Error, ImportError):
    """A Python package that a function needs is not installed. It is an Error and an ImportError."""


class OutOfMemoryError(Error, MemoryError):
    """There is not enough memory. It is an Error and a MemoryError."""


class NotFoundError(FileNotFoundError, Error):
    """A scene, a run, or a file of a run, is not there. It is an Error and a FileNotFoundError.

    Examples
    --------
    >>> try:
    ...     weft.load("nowhere.yaml")
    ... except FileNotFoundError as error:
    ...     print(isinstance(error, weft.Error))
    True
    """

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.status = "not found"


class Diagnostic(NamedTuple):
    """One error, or one warning, with its place in a scene.

    Attributes
    ----------
    warning : bool
        Whether it is a warning.
    line : int
        From 1; 0: unknown.
    column : int
        From 1; 0: unknown.
    place : str
        The file, or the override.
    message : str
        What is wrong, and what would be right.
    source : str
        The line that contains it.
    """

    warning: bool
    line: int
    column: int
    place: str
    message: str
    source: str


class SceneError(Error, ValueError):
    """Errors in a scene: the message shows all of them with their places.

    Attributes
    ----------
    diagnostics : list of Diagnostic
        The errors and warnings. Empty if the program found them: then the message has them all.
    """

    def __init__(self, message: str, diagnostics: Sequence[Diagnostic] = ()) -> None:
        super().__init__(message, "error in the scene")
        self.diagnostics = list(diagnostics)


class SceneWarning(UserWarning):
    """A possible error in a scene."""


class Spring(NamedTuple):
    """A spring between two particles, or an edge of triangles.

    Attributes
    ----------
    family : str
        "stretch", "shear" or "bend".
    p, q : int
        The particles.
    strain : float
        (L - s) / s.
    """

    family: str
    p: int
    q: int
    strain: float


class Failure(NamedTuple):
    """Why a step failed, and the last good state.

    Attributes
    ----------
    status : str
        The status in words.
    time : float
        [s]
    last_step : float
        [s], the one before; 0: none.
    spring : Spring
        The most strained.
    particle : int
        The fastest.
    position : ndarray, shape (3,)
        [m], of that particle.
    speed : float
        [m/s], of that particle.
    energy : float
        [J], the sum of all energies.
    reason : str
        The method's own message.
    contact : bool
        Whether a shape is the reason, which gap_particle to gap_step describe.
    gap_particle, gap_shape : int
        Which particle and which shape are in each other's way.
    gap : float
        [m] between the two.
    gap_step : float
        [s], the length of the step that was tried.
    self_pair : tuple of two tuples of int
        The particles of two parts of the cloth that are the reason, each 1, 2 or 3; empty: they are not.
    held_by_contact : bool
        Whether no step was short enough because contact is stiffer than all else; looser tolerances do not help then.
    other_shape : int
        Another shape that is nearer than the thickness; gap_shape: there is none.
    other_gap : float
        [m] of the nearest particle to it.
    held : str
        What keeps the step short, in words; empty: not looked for.
    force : bool
        Whether an own force is the reason, which is not finite on the free particle force_particle.
    force_particle : int
        The particle, in the order of Sim.positions.
    added : ndarray, shape (3,)
        [N], the own force on that particle.
    """

    status: str
    time: float
    last_step: float
    spring: Spring
    particle: int
    position: Array
    speed: float
    energy: float
    reason: str
    contact: bool
    gap_particle: int
    gap_shape: int
    gap: float
    gap_step: float
    self_pair: tuple[tuple[int, ...], tuple[int, ...]]
    held_by_contact: bool
    other_shape: int
    other_gap: float
    held: str
    force: bool
    force_particle: int
    added: Array


class StepError(Error):
    """A step failed. The state is that of the last good step, or one that a correction left not finite.

    Attributes
    ----------
    failure : Failure or None
        The reason and the state.
    """

    def __init__(self, message: str, status: str = "", failure: Optional[Failure] = None) -> None:
        super().__init__(message, status)
        self.failure = failure


class Method(NamedTuple):
    """A method of a plugin; weft's docs/reference/integrators.md describes the orders and flags.

    Attributes
    ----------
    plugin, name : str
        A scene's stepper.plugin and stepper.method.
    full_name : str
        What the literature calls it.
    order : int
        Of the solution that is continued; 0: variable.
    error_order : int
        Of the solution it is compared with; 0: none.
    stages : int
        Evaluations in a step; 0: variable.
    flags : frozenset of str
        What it can do and needs.
    license : str
        SPDX, of the plugin.
    reference : str
        Where it was published.
    """

    plugin: str
    name: str
    full_name: str
    order: int
    error_order: int
    stages: int
    flags: frozenset[str]
    license: str
    reference: str


class Fixed:
    """An object whose public attributes are those of its class: a misspelt one cannot be set."""

    __slots__ = ()

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            known = [one for one in dir(type(self)) if not one.startswith("_")]
            near = difflib.get_close_matches(name, known, 1, 0.6)
            raise UnknownAttributeError("a weft.%s has no '%s'%s" % (
                type(self).__name__, name, " (did you mean '%s'?)" % near[0] if near else ""))
        object.__setattr__(self, name, value)


def deprecated(old: str, new: str) -> None:
    """Warns the caller of the public function or attribute that calls this: `old` still works."""
    warnings.warn("weft: %s is deprecated: use %s" % (old, new), DeprecationWarning, stacklevel=3)


def renamed(old: str, new: str) -> Any:
    """A property with the name of an earlier version, which reads attribute `new`."""
    def read(self: Any) -> Any:
        deprecated("%s.%s" % (type(self).__name__, old), new)
        return getattr(self, new)

    return property(read, doc="Deprecated: `%s`." % new)


def text(pointer: Any) -> str:
    return "" if pointer == ffi.NULL else ffi.string(pointer).decode("utf-8", "replace")


def status_text(status: int) -> str:
    return text(lib.weft_status_text(status))


_interrupted = threading.local()  # .error: what a handler of a signal raised while weft computed in this thread


def _keep(_type: Any, error: BaseException, _traceback: Any) -> None:
    _interrupted.error = error


@ffi.def_extern(error=True, onerror=_keep)
def weftpy_signalled() -> bool:
    """Gives Python the time to call handlers of signals, which may raise: KeyboardInterrupt, for example."""
    for _ in range(2):
        pass
    return getattr(_interrupted, "error", None) is not None


def interruption() -> Optional[BaseException]:
    """What a handler of a signal raised in the call before, once."""
    error: Optional[BaseException] = getattr(_interrupted, "error", None)
    _interrupted.error = None
    return error


# What the options and the commands of the program are in Python.
_ARGUMENTS = {"out": "out", "force": "force=True", "set": "overrides", "jobs": "jobs", "timeout": "timeout",
              "methods": "methods", "until": "until", "sizes": "sizes", "at": "at", "clamp-midway": "clamp_midway",
              "tol": "tolerance", "frame": "frame", "format": "format", "over": "over", "sigma": "sigma",
              "retry-failed": "retry_failed=True"}
_FUNCTIONS = {"batch": "weft.batch()", "check": "weft.check()", "compare": "weft.compare()", "fabrics": "weft.fabrics()",
              "steppers": "weft.methods()", "scene-help": "weft.scene_help()"}


def in_python(said: str) -> str:
    """What the program or the library reports, in the words of these functions. Commands in quotes that Python has not stay."""
    said = re.sub(r"\n?'weft [a-z-]+ --help' shows how it is used", "", said)
    said = re.sub(r"^weft(?: [a-z-]+)?: (?:error: )?", "", said)
    said = re.sub(r"'weft resume ([^']*)'", r'weft.resume("\1")', said)
    said = re.sub(r"'weft ([a-z-]+)'|\bweft (check|compare|fabrics|steppers|scene-help)(?= |$)",
                  lambda of: _FUNCTIONS.get(of[1] or of[2], of[0]), said, flags=re.MULTILINE)
    return re.sub(r"'weft [^']*'|(?<!\w)--([a-z-]+)", lambda of: _ARGUMENTS.get(of[1], of[0]), said)


def check(status: int, err: Any) -> None:
    """Raises the error of a call that did not return WEFT_OK."""
    if status == lib.WEFT_OK:
        return
    interrupted = interruption() if status == lib.WEFT_STOPPED else None
    if interrupted is not None:
        raise interrupted
    if status == lib.WEFT_NO_MEMORY:
        raise OutOfMemoryError(text(err.message))
    place = text(err.file)
    raise Error((place + ": " if place else "") + in_python(text(err.message)), status_text(status))


def spring(of: Any) -> Spring:
    return Spring(FAMILIES[of.family], of.p, of.q, of.strain)


def pair(of: Any) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The particles of two primitives."""
    return tuple(tuple(one.particle[k] for k in range(one.count)) for one in of)  # type: ignore[return-value]


def chars(value: PathLike) -> Any:
    """A string for C, which ends at a null character."""
    data = os.fsencode(value)
    if b"\0" in data:
        raise ArgumentError("null character in %r" % (value,))
    return ffi.new("char[]", data)


def real(value: Any, name: str, *shapes: tuple[int, ...]) -> Array:
    """An array of real numbers that has one of the shapes."""
    if np.ma.is_masked(value):
        raise ArgumentError("%s has masked elements" % name)
    try:
        array = np.asarray(value)
    except ValueError:
        raise ArgumentError("%s has rows of different lengths" % name) from None
    other = None
    if array.dtype.kind == "O":  # NumPy would take None for NaN
        other = next((type(one).__name__ for one in array.flat if not isinstance(one, (numbers.Real, Decimal, np.bool_))), None)
    elif array.dtype.kind not in "biuf":
        other = "text" if array.dtype.kind in "US" else array.dtype.name
    if other is not None:
        raise ArgumentTypeError("%s consists of real numbers, not of %s" % (name, other.replace("NoneType", "None")))
    if array.shape not in shapes:
        raise ArgumentError("%s has the shape %s, not %s" % (name, array.shape, " or ".join(map(str, shapes))))
    return np.asarray(array, dtype=np.float64, order="C")


def later(t: Any, now: float, of: str = "the time") -> float:
    """A time [s] that is not before the present one."""
    end = float(real(t, "a time", ()))
    if not math.isfinite(end):
        raise ArgumentError("%r is not a finite time" % end)
    if end < now:
        raise ArgumentError("%r s is over: %s is %r s" % (end, of, now))
    return end


def keys_of(over: Any, of: str) -> list[str]:
    """Keys of a scene in a list."""
    if isinstance(over, str) or not isinstance(over, Iterable):
        raise ArgumentTypeError("%s is a list of keys, such as [\"cloth.density\"], not %r" % (of, over))
    return [_key_path(key, of) for key in over]


def _key_path(key: Any, of: str) -> str:
    if not isinstance(key, str) or not re.fullmatch(r"[\w.\[\]-]+", key):
        raise ArgumentTypeError("%s is a list of keys, such as [\"cloth.density\"]: %r is none" % (of, key))
    return key


def numbers_of(values: Any) -> Array:
    return np.array(list(values), dtype=np.float64)


def failure(of: Any) -> Failure:
    plain = {name: getattr(of, name) for name in Failure._fields}
    return Failure(**{**plain, "status": status_text(of.status), "spring": spring(of.spring),
                      "position": numbers_of(of.position), "added": numbers_of(of.added), "reason": text(of.reason),
                      "self_pair": pair(of.self_pair), "held": text(of.held)})


# ---- messages -------------------------------------------------------------------------

log = logging.getLogger("weft")


@ffi.def_extern(onerror=_keep)
def weftpy_log(_ctx: Any, level: int, message: Any) -> None:
    log.log(logging.WARNING if level == lib.WEFT_LOG_WARNING else logging.INFO, "%s", text(message))


@ffi.def_extern(onerror=_keep)
def weftpy_refused(_ctx: Any, why: Any) -> None:
    log.warning("%s", text(why.message))


@ffi.def_extern(onerror=_keep)
def weftpy_line(ctx: Any, line: Any) -> None:
    ffi.from_handle(ctx).append(text(line))


@ffi.def_extern(onerror=_keep)
def weftpy_option(ctx: Any, name: Any, value: Any) -> None:
    ffi.from_handle(ctx)[text(name)] = text(value)


def scene_help(key: Optional[str] = None) -> str:
    """Describes the keys of a scene with type, unit, default and meaning.

    Parameters
    ----------
    key : str, optional
        Only this key, such as "run.fps".

    Returns
    -------
    str
        Lines of text.

    Raises
    ------
    Error
        A scene has no such key.

    Examples
    --------
    >>> print(weft.scene_help("run.fps"))  # doctest: +ELLIPSIS
    run.fps...
    """
    lines: list[str] = []
    handle, err = ffi.new_handle(lines), ffi.new("weft_error *")
    if key is None:
        lib.weft_scene_help(lib.WEFT_HELP_TEXT, lib.weftpy_line, handle)
    else:
        check(lib.weft_scene_help_key(chars(key), lib.weftpy_line, handle, err), err)
    return "\n".join(lines)


# ---- plugins --------------------------------------------------------------------------

# libweft wants one thread at a time; the registry is never destroyed, as simulations run in the
# code of its plugins.
registry_lock = threading.Lock()
_registry: Any = None
_loaded: list[Any] = []  # files of load_plugin()


def _after_fork() -> None:
    global registry_lock, _registry
    if registry_lock.locked():  # another thread was changing the registry: the child needs one of its own
        registry_lock, _registry = threading.Lock(), None


os.register_at_fork(after_in_child=_after_fork)


def registry() -> Any:
    """The plugins of this process, for a caller that holds registry_lock."""
    global _registry
    if _registry is None:
        definition = ffi.new("weft_registry_def *", lib.weft_registry_def_default())
        definition.log = lib.weftpy_log_of()
        out, err = ffi.new("weft_registry **"), ffi.new("weft_error *")
        check(lib.weft_registry_create(definition, out, err), err)
        for file in _loaded:  # of the process that forked this one
            check(lib.weft_registry_load(out[0], file, err), err)
        _registry = out[0]
    return _registry


def load_plugin(file: PathLike) -> None:
    """Loads a plugin with integrators, which runs its code in this process. Plugins in the directories of WEFT_PLUGIN_PATH need no
    call.

    Parameters
    ----------
    file : path
        A file weft-ID.so.

    Raises
    ------
    Error
        It is no plugin, or one of this ID is there already.

    Examples
    --------
    >>> try:
    ...     weft.load_plugin("weft-nothing.so")
    ... except weft.Error as error:
    ...     print(str(error)[:32])
    plugin refused: weft-nothing.so:
    """
    err = ffi.new("weft_error *")
    with registry_lock:
        name = chars(file)
        check(lib.weft_registry_load(registry(), name, err), err)
        _loaded.append(name)


def _method(plugin: Any, kind: Any) -> Method:
    flags = frozenset(name for name in FLAGS if kind.flags & getattr(lib, "WEFT_STEPPER_" + name.upper()))
    return Method(text(plugin.id), text(kind.name), text(lib.weft_stepper_full_name(kind)), kind.order, kind.error_order,
                  kind.stages, flags, text(kind.license), text(kind.reference))


def methods() -> list[Method]:
    """Lists every method of every plugin that is found.

    Returns
    -------
    list of Method
        In the order of the plugins.

    Raises
    ------
    Error
        There are no plugins.

    Examples
    --------
    >>> [m.order for m in weft.methods() if (m.plugin, m.name) == ("verlet", "velocity_verlet")]
    [2]
    """
    err, found = ffi.new("weft_error *"), []
    with registry_lock:
        check(lib.weft_registry_load_all(registry(), lib.weftpy_refused, ffi.NULL, err), err)
        for i in range(lib.weft_registry_count(registry())):
            plugin = lib.weft_registry_at(registry(), i)
            k = 0
            while plugin.types[k] != ffi.NULL:
                found.append(_method(plugin, plugin.types[k]))
                k += 1
    return found


def amplification(plugin: str, method: str) -> Array:
    """Computes the stability polynomial of an explicit Runge-Kutta method, found by running it.

    Parameters
    ----------
    plugin, method : str
        As a scene's stepper.plugin and stepper.method.

    Returns
    -------
    ndarray
        The coefficients r[k] of R(z) = sum r[k] z^k, by which a fixed step h multiplies the solution of y' = m y, z = h
        m.

    Raises
    ------
    Error
        The method is of another kind, or not there.

    Examples
    --------
    >>> weft.amplification("verlet", "midpoint")
    array([1. , 1. , 0.5])
    """
    err, kind = ffi.new("weft_error *"), ffi.new("const weft_stepper_type **")
    out = ffi.new("weft_stability *")
    with registry_lock:
        check(lib.weft_registry_method(registry(), chars(plugin), chars(method), kind, err), err)
    check(lib.weft_stability_create(kind[0], ffi.NULL, out, err), err)
    if out.degree < 0:
        raise Error("method '%s' of plugin '%s' is not of Runge-Kutta type" % (method, plugin))
    return numbers_of(out.r[0:out.degree + 1])


# ---- scenes ---------------------------------------------------------------------------

def _key(key: Any) -> str:
    if not isinstance(key, str):
        raise ArgumentTypeError("a key of a scene is a string, not %r" % (key,))
    return key if re.fullmatch(r"[A-Za-z_][\w.-]*", key, re.ASCII) else json.dumps(key, ensure_ascii=False)


def yaml_text(value: Any, margin: str = "") -> str:
    """A value of a scene as YAML in flow style: one line for each key of a mapping of mappings."""
    if isinstance(value, Mapping):
        inner = margin + "  "
        items = [_key(k) + ": " + yaml_text(v, inner) for k, v in value.items()]
        if any(isinstance(v, Mapping) for v in value.values()):
            return "{\n" + ",\n".join(inner + item for item in items) + "\n" + margin + "}"
        return "{" + ", ".join(items) + "}"
    if isinstance(value, np.ndarray):
        return yaml_text(value.tolist(), margin)
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if value is None or isinstance(value, (bool, np.bool_)):
        return {None: "null", True: "true", False: "false"}[None if value is None else bool(value)]
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        number = float(value)
        if math.isfinite(number):
            return repr(number)
        return ".nan" if math.isnan(number) else ".inf" if number > 0 else "-.inf"
    if isinstance(value, Iterable):
        return "[" + ", ".join(yaml_text(v, margin) for v in value) + "]"
    raise ArgumentTypeError("a scene has no values of type %s" % type(value).__name__)


def fabrics() -> dict[str, dict[str, Any]]:
    """Lists the measured fabrics, in the words of cloth.fabric.

    Returns
    -------
    dict
        By name: density [kg/m^2], stretch [N/m] and bend [N m] along (warp, weft), shear [N/m], twist [N m].

    Examples
    --------
    >>> weft.fabrics()["11oz-black-denim"]["density"]
    0.324
    """
    count = ffi.new("size_t *")
    presets = lib.weft_fabric_presets(count)
    return {text(of.name): {"density": of.density, "stretch": tuple(of.stretch), "shear": of.shear,
                            "bend": tuple(of.bend), "twist": of.twist}
            for of in (presets[i] for i in range(count[0]))}


def settings(overrides: Optional[Mapping[str, Any]]) -> list[str]:
    """Overrides as `--set` of the program takes them."""
    return [key + "=" + yaml_text(value) for key, value in (overrides or {}).items()]


def _diagnostic(of: Any, folder: str) -> tuple[Diagnostic, str]:
    room = ffi.new("char[]", 2048)
    lib.weft_diagnostic_format(ffi.addressof(of), room, 2048)
    place, message, source, whole = (text(one).replace(folder + os.sep, "") if folder else text(one)
                                     for one in (of.place, of.message, of.source, room))
    return Diagnostic(of.warning, of.line, of.column, place, in_python(message), source), in_python(whole)


def read_scene(file: Optional[str], content: Optional[str], sets: list[str], folder: str = "") -> tuple[Any, list[str]]:
    """A weft_scene and its warnings; no message names the folder."""
    err, out, found = ffi.new("weft_error *"), ffi.new("weft_scene **"), ffi.new("weft_diagnostics *")
    definition = ffi.new("weft_scene_def *", lib.weft_scene_def_default())
    alive = [chars(s) for s in sets]
    array, name = ffi.new("const char *[]", alive), chars(file or "scene")
    definition.file, definition.sets, definition.set_count = name, array, len(alive)
    if content is not None:
        data = content.encode()
        held = ffi.from_buffer(data)
        definition.text, definition.length = held, len(data)
    with registry_lock:
        status = lib.weftpy_scene(registry(), definition, out, found, err)
    items = [_diagnostic(found.items[i], folder) for i in range(found.count)]
    if status == lib.WEFT_BAD_SCENE:
        more = found.errors - sum(not d.warning for d, _ in items)
        rest = ["and %d more" % more] if more > 0 else []
        raise SceneError("\n".join([t for _, t in items] + rest), [d for d, _ in items])
    check(status, err)
    return ffi.gc(out[0], lib.weft_scene_destroy), [t for _, t in items]


def of_over(said: str) -> str:
    """What was said of the override that the keys of `over` were put into, which nobody wrote, as of these keys."""
    return re.sub(r"^override sensitivity:\d+: (\w+: .*)\n.*\n *\^$", r"over: \1", said, flags=re.MULTILINE)


def index_of(cloth: Any) -> Optional[Places]:
    """(N,), where each vertex of triangles stands in a state; None of a grid: 0, 1, ..."""
    if lib.weft_cloth_cols(cloth) > 0:
        return None
    places = np.empty(lib.weft_cloth_particles(cloth), dtype=np.intp)
    lib.weftpy_index(cloth, ffi.from_buffer("size_t[]", places))
    return places


def scene_twins(scene: Any) -> Any:
    """The cloths with less and more of each parameter with respect to which a scene is differentiated."""
    out, err = ffi.new("weft_scene_perturbed **"), ffi.new("weft_error *")
    with registry_lock:
        check(lib.weftpy_perturbed(registry(), scene, out, err), err)
    return ffi.gc(out[0], lib.weft_scene_perturbed_destroy)
