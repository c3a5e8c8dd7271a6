# SPDX-License-Identifier: BSD-3-Clause
"""What the program finds out about scenes and fabrics before a run: stability limits, and tests of a fabric."""
from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Optional

from weft.library import ArgumentError, PathLike, fabrics
from weft.runs import _call, _files, _sets
from weft.scenes import Scene, is_text

if TYPE_CHECKING:
    import pandas as pd


class Check(NamedTuple):
    """What weft.check() finds.

    Attributes
    ----------
    name : str
        Of the scene; if it is a sweep, of its first run, which is described.
    particles, pinned : int
        How many particles it has, and how many of them pins hold.
    omega, damping : float
        [1/s], bounds of the fastest vibration and of its damping rate, at the start.
    omega_anywhere, damping_anywhere : float
        [1/s], bounds that hold in any state.
    methods : pandas.DataFrame
        One row per method of every plugin, the cheapest first: plugin, method, of_the_scene, and of explicit one-step methods the
        stability limit stable_step [s], the force evaluations that a simulated second then takes, rhs_calls_per_second, and
        whether vibrations without damping may double in the run, undamped_modes_double. NaN: not known of the method.
    trial : dict or None
        What some steps of the scene's own method showed: steps, mean_step [s], held_by_stability, the part of steps that the
        stability limit held, and rhs_calls_per_second. None: the scene's steps are fixed.
    advice, stiffness : str
        Which method would be faster, and how stiff the cloth is.
    details : dict
        All that was found, as `weft check --yaml` prints it: also stretch, fabric, contact and cloths.
    """

    name: str
    particles: int
    pinned: int
    omega: float
    damping: float
    omega_anywhere: float
    damping_anywhere: float
    methods: pd.DataFrame
    trial: Optional[dict[str, Any]]
    advice: str
    stiffness: str
    details: dict[str, Any]


_OF_A_METHOD = ["plugin", "method", "of_the_scene", "stable_step", "rhs_calls_per_second", "undamped_modes_double"]


def check(scene: Scene, overrides: Optional[Mapping[str, Any]] = None, *, refine: bool = False) -> Check:
    """Validates a scene and finds which steps are stable on it, without a run.

    Parameters
    ----------
    scene : path, str or dict
        As of load().
    overrides : dict, optional
        {"key.path": value}.
    refine : bool
        Sharpens the bounds by the power method; they are no longer guaranteed then.

    Returns
    -------
    Check
        What the scene holds, the stability limit of each method, and advice.

    Raises
    ------
    SceneError
        Errors of the scene, all at once.
    NotFoundError
        The scene is not there.
    RunError
        The start intersects itself, and contact.untangle does not free it.

    Warns
    -----
    SceneWarning
        Possible errors of the scene.

    Examples
    --------
    >>> found = weft.check(scene)
    >>> found.particles, found.pinned
    (80, 2)
    >>> limits = found.methods.set_index("method")["stable_step"]
    >>> bool(limits["velocity_verlet"] > 1e-3)
    True
    """
    import pandas as pd
    import yaml
    with tempfile.TemporaryDirectory() as folder:
        path, = _files([scene], folder)
        _, printed = _call(["check", path, "--yaml", *(["--refine"] if refine else []), *_sets(overrides)], folder, folder)
    of = yaml.safe_load(printed)["scenes"][0]
    bounds = of.get("power_method", of["at_the_start"])
    table = pd.DataFrame(of["methods"]).reindex(columns=_OF_A_METHOD)
    del of["file"]
    return Check(of["name"], of["particles"], of["pinned"], bounds["omega"], bounds["damping"], of["in_any_state"]["omega"],
                 of["in_any_state"]["damping"], table, of.get("trial"), of["advice"], of["stiffness"], of)


class FabricTest(NamedTuple):
    """What weft.lab() measured.

    Attributes
    ----------
    test, fabric : str
        Which test, of which fabric.
    values : dict of str to float
        drape: coefficient [%] and nodes; cantilever: length [m] and angle [degrees] of the strip's chord, bending_length [m] and
        rigidity [N m] by Peirce's formula; strip: extension [%] at 490 N/m, and the secant modulus [N/m].
    scene : Path
        The scene of the test.
    picture : Path or None
        drape: the shadow, an SVG file.
    """

    test: str
    fabric: str
    values: dict[str, float]
    scene: Path
    picture: Optional[Path]


_FABRIC_TESTS = ("drape", "cantilever", "strip")


def lab(test: str, fabric: Scene, out: PathLike, overrides: Optional[Mapping[str, Any]] = None, *,
        force: bool = False) -> FabricTest:
    """Tests a measured fabric as a textile laboratory does: writes the scene of the test, and runs it to rest.

    Parameters
    ----------
    test : str
        "drape": Cusick's, a disc of 30 cm on a support of 18 cm; "cantilever": Peirce's (ASTM D1388), a strip twice as long as its
        bending length; "strip": the extension at 490 N/m, as of KES.
    fabric : str, path or dict
        The name of one of weft.fabrics(); or a scene, as of load(), whose cloth.fabric is tested.
    out : path
        The directory of the test's scene and picture, which is made.
    overrides : dict, optional
        {"key.path": value} of the test's scene, such as {"cloth.cut.spacing": 5e-3}.
    force : bool
        Replaces a scene of that name with another text.

    Returns
    -------
    FabricTest
        The measured values, and the files.

    Raises
    ------
    ArgumentError
        There is no such test or fabric.
    SceneError
        Errors of the scene, or its cloth has no fabric.
    NotFoundError
        The scene is not there.
    RunError
        The simulation failed, or a file cannot be written.

    Examples
    --------
    >>> found = weft.lab("strip", "11oz-black-denim", tmp / "tested")
    >>> round(found.values["extension"], 1)
    118.9
    """
    import yaml
    if test not in _FABRIC_TESTS:
        raise ArgumentError("there is no test %r; there are %s" % (test, ", ".join(_FABRIC_TESTS)))
    with tempfile.TemporaryDirectory() as folder:
        preset = isinstance(fabric, str) and not is_text(fabric) and not fabric.endswith(".yaml")
        if preset and fabric not in fabrics():
            raise ArgumentError("there is no fabric %r; there are %s" % (fabric, ", ".join(fabrics())))
        name, = [fabric] if preset else _files([fabric], folder)
        _, printed = _call(["lab", test, os.fspath(name), "--yaml", "--out", os.fspath(out), *_sets(overrides),  # type: ignore[arg-type]
                            *(["--force"] if force else [])], folder, out)
    of = yaml.safe_load(printed)
    places = {key: Path(of.pop(key)) for key in ("scene", "picture") if key in of}
    return FabricTest(of.pop("test"), of.pop("fabric"), of, places["scene"], places.get("picture"))
