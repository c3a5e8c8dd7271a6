# SPDX-License-Identifier: BSD-3-Clause
"""The program weft, run as a process of its own, and the directories that it writes."""
from __future__ import annotations

import math
import os
import signal
import subprocess
import tempfile
import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from weft._weft import ffi, lib
from weft.library import Array, Error, PathLike, SceneError, SceneWarning, settings, yaml_text
from weft.mesh import Mesh, has_mesh, with_file
from weft.simulation import Scene

if TYPE_CHECKING:
    import pandas as pd


class RunError(Error):
    """The program ended with the exit code `code`. weft.open reads what it left in `directory`."""

    def __init__(self, message: str, code: int = 1, directory: Optional[Path] = None) -> None:
        super().__init__(message, "exit code %d" % code)
        self.code = code
        self.directory = directory


def program() -> Path:
    """The path of the program weft that this package uses."""
    prefix = ffi.string(lib.weftpy_prefix).decode()
    path = (Path(prefix) if prefix else Path(__file__).parent / "prefix") / "bin" / "weft"
    if not path.exists():
        raise Error("there is no %s: weft was built without HDF5 (package libhdf5-dev)" % path)
    return path


def _call(arguments: Sequence[str], folder: str, directory: PathLike, allowed: Sequence[int] = (0,)) -> None:
    """Runs the program on scenes in a temporary folder, which no message names. Ctrl-C passes one SIGINT on, which
    ends the run with its files complete."""
    process = subprocess.Popen([str(program()), *arguments, "--quiet"], stdin=subprocess.DEVNULL, text=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)
    try:
        said = process.communicate()[1].strip().replace(folder + os.sep, "")
    except BaseException:
        process.send_signal(signal.SIGINT)
        process.communicate()
        raise
    if process.returncode == 3:
        raise SceneError(said)
    if process.returncode not in allowed:
        raise RunError(said, process.returncode, Path(directory))
    if said:
        warnings.warn(said, SceneWarning, stacklevel=3)


def _files(scenes: Iterable[Scene], folder: str) -> list[str]:
    """Paths of scenes: of a dict or a text, of a file in folder."""
    paths = []
    for i, scene in enumerate(scenes):
        name = scene.get("name") if isinstance(scene, Mapping) else None
        stem = "".join(c if c.isalnum() or c in "-_" else "-" for c in str(name or "scene-%d" % i))
        if isinstance(scene, Mapping) and has_mesh(scene):
            Mesh.of(scene["cloth"]["mesh"]).write(Path(folder, stem + ".obj"))
            scene = with_file(scene, stem + ".obj")
        content = yaml_text(scene) if isinstance(scene, Mapping) else os.fspath(scene)
        if isinstance(scene, Mapping) or "\n" in content:
            path = Path(folder, stem + ".yaml")
            path.write_text(content, encoding="utf-8")
            content = str(path)
        paths.append(content)
    return paths


def _options(out: PathLike, overrides: Optional[Mapping[str, Any]], force: bool) -> list[str]:
    sets = [argument for setting in settings(overrides) for argument in ("--set", setting)]
    return ["--out", os.fspath(out), *sets, *(["--force"] if force else [])]


def _table(path: PathLike) -> pd.DataFrame:
    import pandas as pd
    exact = {"float_precision": "round_trip"}  # pandas 3.1 always reads numbers so, and warns of it
    newer = tuple(map(int, pd.__version__.split(".")[:2])) >= (3, 1)
    return pd.read_csv(path, dtype={"hash": str}, **({} if newer else exact))


def run(scene: Scene, out: PathLike, overrides: Optional[Mapping[str, Any]] = None, *, force: bool = False) -> Run:
    """Runs a scene as `weft run` does, into the directory `out`, new or empty (force: replaces an earlier run).

    Raises SceneError; RunError, if the simulation failed: weft.open(out) has its frames.

    >>> weft.run(scene, tmp / "fall", {"run.duration": 0.5}).result["status"]
    'done'
    """
    with tempfile.TemporaryDirectory() as folder:
        path, = _files([scene], folder)
        _call(["run", path, *_options(out, overrides, force)], folder, out)
    return Run(out)


def batch(scenes: Union[Scene, Sequence[Scene]], out: PathLike, overrides: Optional[Mapping[str, Any]] = None, *,
          jobs: Optional[int] = None, timeout: Optional[float] = None, force: bool = False) -> pd.DataFrame:
    """Runs scenes, and all runs of a `sweep`, as `weft batch` does: `jobs` processes at a time, `timeout` [s] each.
    Finished runs are skipped. Returns summary.csv: one row per run, with its parameters, `status` and `directory`,
    for weft.open(out / directory). Failed runs raise nothing.

    >>> table = weft.batch({**scene, "sweep": {"cloth.density": [0.1, 0.2]}}, tmp / "sweep")
    >>> list(table["status"])
    ['done', 'done']
    """
    several = scenes if isinstance(scenes, Sequence) and not isinstance(scenes, str) else [scenes]
    with tempfile.TemporaryDirectory() as folder:
        more = [] if jobs is None else ["--jobs", str(jobs)]
        more += [] if timeout is None else ["--timeout", repr(float(timeout))]
        paths = _files(several, folder)
        _call(["batch", *paths, *_options(out, overrides, force), *more], folder, out, (0, 1))
    return _table(Path(out, "summary.csv"))


def compare(scene: Scene, out: PathLike, overrides: Optional[Mapping[str, Any]] = None, *,
            methods: Optional[Sequence[str]] = None, until: Optional[float] = None, jobs: int = 1,
            force: bool = False) -> pd.DataFrame:
    """Runs a scene with every method of every plugin (or `methods`, such as "gsl" or "arkode/heun_euler"), over a
    ladder of tolerances or steps, as `weft compare` does, up to `until` [s]. Returns compare.csv: one row per run, with
    error [m], rhs_calls, time [s] (docs/choosing-a-stepper.md). The page compare.html is in `out`."""
    with tempfile.TemporaryDirectory() as folder:
        more = [] if methods is None else ["--methods", ",".join(methods)]
        more += [] if until is None else ["--until", repr(float(until))]
        path, = _files([scene], folder)
        _call(["compare", path, *_options(out, overrides, force), *more, "--jobs", str(jobs)], folder, out)
    return _table(Path(out, "compare.csv"))


class Run:
    """The files of one run (docs/output.md); make it with weft.open(). Works while the run writes them, too."""

    def __init__(self, directory: PathLike) -> None:
        self.directory = Path(directory)
        if not (self.directory / "scene.yaml").exists():
            raise FileNotFoundError("%s holds no run: it has no scene.yaml" % self.directory)

    def __repr__(self) -> str:
        return "<weft.Run %s>" % self.directory

    def _yaml(self, name: str) -> dict[str, Any]:
        import yaml
        with (self.directory / name).open(encoding="utf-8") as file:
            return dict(yaml.load(file, Loader=yaml.SafeLoader))

    def _csv(self, name: str) -> pd.DataFrame:
        return _table(self.directory / name)

    @property
    def scene(self) -> str:
        """The scene as run, for weft.load."""
        return (self.directory / "scene.yaml").read_text(encoding="utf-8")

    @property
    def result(self) -> dict[str, Any]:
        """How the run ended; FileNotFoundError: it has not."""
        return self._yaml("result.yaml")

    @property
    def manifest(self) -> dict[str, Any]:
        """Versions, method and every option in force."""
        return self._yaml("manifest.yaml")

    @property
    def series(self) -> pd.DataFrame:
        """series.csv: one row per frame.

        >>> float(weft.run(scene, tmp / "series").series["kinetic"].iloc[0])
        0.0
        """
        return self._csv("series.csv")

    @property
    def shapes(self) -> pd.DataFrame:
        """shapes.csv: force [N] and torque [N m] of the cloth on each shape, one row per frame and shape."""
        return self._csv("shapes.csv")

    @property
    def final(self) -> pd.DataFrame:
        """final.csv: row, col (of triangles vertex), x, y, z [m], vx, vy, vz [m/s] at the end."""
        return self._csv("final.csv")

    def _frames(self, path: str) -> Any:
        """Where the frames of a dataset lie in the file; h5py alone, kept open, would not see a run go on."""
        import h5py
        with h5py.File(self.directory / "run.vtkhdf", "r", locking=False) as file:
            data, of = file[path], file["weft"].attrs
            sides = [int(of[name]) for name in (("vertices",) if "vertices" in of else ("rows", "cols"))]
            shape = (int(file["VTKHDF/Steps"].attrs["NSteps"]), *sides, *data.shape[1:])
            offset = data.id.get_offset()
            if offset is None or shape[0] == 0:  # packed by h5repack, or nothing there yet
                return data[:shape[0] * math.prod(sides)].reshape(shape)
            return np.memmap(self.directory / "run.vtkhdf", data.dtype, "r", offset, shape)

    @property
    def positions(self) -> Array:
        """(frames, rows, cols, 3) or, of triangles, (frames, N, 3) [m], of the present frames: run.vtkhdf as memory,
        read as it is used (all at once after h5repack).

        >>> weft.run(scene, tmp / "positions").positions[-1].shape
        (8, 10, 3)
        """
        return self._frames("VTKHDF/Points")  # type: ignore[no-any-return]

    @property
    def velocities(self) -> Array:
        """(frames, rows, cols, 3) or (frames, N, 3) [m/s]; KeyError: they were not recorded."""
        return self._frames("VTKHDF/PointData/velocity")  # type: ignore[no-any-return]

    @property
    def strains(self) -> Array:
        """(frames, rows, cols) or (frames, N), the largest (L - s) / s at each particle; KeyError: they were not
        recorded."""
        return self._frames("VTKHDF/PointData/strain")  # type: ignore[no-any-return]

    @property
    def times(self) -> Array:
        """(frames,) [s], of the frames in run.vtkhdf."""
        import h5py
        with h5py.File(self.directory / "run.vtkhdf", "r", locking=False) as file:
            times: Array = file["VTKHDF/Steps/Values"][:int(file["VTKHDF/Steps"].attrs["NSteps"])]
            return times


def open(directory: PathLike) -> Run:  # noqa: A001 - as numpy's and tarfile's
    """The files of the run in a directory. Raises FileNotFoundError."""
    return Run(directory)
