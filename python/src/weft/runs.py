# SPDX-License-Identifier: BSD-3-Clause
"""The program weft, run as a process of its own, and the directories that it writes."""
from __future__ import annotations

import functools
import os
import signal
import subprocess
import tempfile
import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

from weft._weft import ffi, lib
from weft.library import Error, PathLike, SceneError, SceneWarning, settings, yaml_text
from weft.simulation import Scene

if TYPE_CHECKING:
    import h5py
    import pandas as pd


class RunError(Error):
    """The program ended with an exit code other than 0. `code` is that, `directory` what it wrote; weft.open reads it."""

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
    """Runs the program on scenes in a temporary folder, which no message names. Ctrl-C passes one SIGINT on: it ends the run with its files complete."""
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
        content = yaml_text(scene) if isinstance(scene, Mapping) else os.fspath(scene)
        if isinstance(scene, Mapping) or "\n" in content:
            name = scene.get("name") if isinstance(scene, Mapping) else None
            stem = "".join(c if c.isalnum() or c in "-_" else "-" for c in str(name or "scene-%d" % i))
            path = Path(folder, stem + ".yaml")
            path.write_text(content, encoding="utf-8")
            content = str(path)
        paths.append(content)
    return paths


def _options(out: PathLike, overrides: Optional[Mapping[str, Any]], force: bool) -> list[str]:
    sets = [argument for setting in settings(overrides) for argument in ("--set", setting)]
    return ["--out", os.fspath(out), *sets, *(["--force"] if force else [])]


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
    import pandas as pd
    several = scenes if isinstance(scenes, Sequence) and not isinstance(scenes, str) else [scenes]
    with tempfile.TemporaryDirectory() as folder:
        more = [] if jobs is None else ["--jobs", str(jobs)]
        more += [] if timeout is None else ["--timeout", repr(float(timeout))]
        paths = _files(several, folder)
        _call(["batch", *paths, *_options(out, overrides, force), *more], folder, out, (0, 1))
    return pd.read_csv(Path(out, "summary.csv"))


def compare(scene: Scene, out: PathLike, overrides: Optional[Mapping[str, Any]] = None, *,
            methods: Optional[Sequence[str]] = None, until: Optional[float] = None, jobs: int = 1,
            force: bool = False) -> pd.DataFrame:
    """Runs a scene with every method of every plugin (or `methods`, such as "gsl" or "arkode/heun_euler"), over a
    ladder of tolerances or steps, as `weft compare` does, up to `until` [s]. Returns compare.csv: one row per run, with
    error [m], rhs_calls, time [s] (docs/choosing-a-stepper.md). The page compare.html is in `out`."""
    import pandas as pd
    with tempfile.TemporaryDirectory() as folder:
        more = [] if methods is None else ["--methods", ",".join(methods)]
        more += [] if until is None else ["--until", repr(float(until))]
        path, = _files([scene], folder)
        _call(["compare", path, *_options(out, overrides, force), *more, "--jobs", str(jobs)], folder, out)
    return pd.read_csv(Path(out, "compare.csv"))


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
        import pandas as pd
        return pd.read_csv(self.directory / name, dtype={"hash": str})

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
        """final.csv: row, col, x, y, z [m], vx, vy, vz [m/s] at the end."""
        return self._csv("final.csv")

    @functools.cached_property
    def _file(self) -> h5py.File:
        import h5py
        return h5py.File(self.directory / "run.vtkhdf", "r", locking=False)

    def _field(self, path: str) -> Frames:
        return Frames(self._file, path)

    @property
    def positions(self) -> Frames:
        """(frames, rows, cols, 3) [m], read from run.vtkhdf as it is indexed.

        >>> weft.run(scene, tmp / "positions").positions[-1].shape
        (8, 10, 3)
        """
        return self._field("VTKHDF/Points")

    @property
    def velocities(self) -> Frames:
        """(frames, rows, cols, 3) [m/s]; KeyError: they were not recorded."""
        return self._field("VTKHDF/PointData/velocity")

    @property
    def strains(self) -> Frames:
        """(frames, rows, cols), the largest (L - s) / s at each particle; KeyError: they were not recorded."""
        return self._field("VTKHDF/PointData/strain")

    @property
    def times(self) -> Any:
        """(frames,) [s], of the frames in run.vtkhdf."""
        return self._file["VTKHDF/Steps/Values"][:]


class Frames:
    """An array of frames in a file: frames[i] reads frame i, frames[a:b:c] several, numpy.asarray(frames) all. Its
    length grows while the run writes."""

    def __init__(self, file: h5py.File, path: str) -> None:
        self._file, self._data = file, file[path]
        grid = int(file["weft"].attrs["rows"]), int(file["weft"].attrs["cols"])
        self._each = grid[0] * grid[1]
        self._frame = grid + self._data.shape[1:]
        self.dtype = self._data.dtype

    def __len__(self) -> int:
        steps = self._file["VTKHDF/Steps"]
        return int(steps.attrs["NSteps"])

    @property
    def shape(self) -> tuple[int, ...]:
        return (len(self), *self._frame)

    def __repr__(self) -> str:
        return "<weft.Frames %s %s>" % (self.shape, self.dtype)

    def _read(self, i: int) -> Any:
        return self._data[i * self._each:(i + 1) * self._each].reshape(self._frame)

    def __getitem__(self, key: Any) -> Any:
        import numpy as np
        first, rest = (key[0], key[1:]) if isinstance(key, tuple) else (key, ())
        if isinstance(first, slice):
            wanted = range(len(self))[first]
            frames = np.empty((len(wanted), *self._frame), self.dtype)
            for k, i in enumerate(wanted):
                frames[k] = self._read(i)
            return frames[(slice(None), *rest)]
        return self._read(range(len(self))[first])[rest]

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> Any:
        return self[:].astype(dtype or self.dtype, copy=False)


def open(directory: PathLike) -> Run:  # noqa: A001 - as numpy's and tarfile's
    """The files of the run in a directory. Raises FileNotFoundError."""
    return Run(directory)
