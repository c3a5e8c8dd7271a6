# SPDX-License-Identifier: BSD-3-Clause
"""The program weft, run as a process of its own, and the directories that it writes."""
from __future__ import annotations

import html
import io
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import warnings
import webbrowser
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Union
from urllib.parse import unquote, urlsplit

import numpy as np

from weft._weft import ffi, lib
from weft.library import (Array, Error, Fixed, MissingKeyError, NotFoundError, PathLike, SceneError, SceneWarning,
                          in_python, keys_of, of_over, settings, yaml_text)
from weft.own import Method, served
from weft.scenes import Scene, is_text, path_of, written

if TYPE_CHECKING:
    import pandas as pd


RunLike = Union[PathLike, "Run"]


class RunError(Error):
    """The program ended with an exit code that is not 0. weft.open reads what it left.

    Attributes
    ----------
    code : int
        The exit code.
    directory : Path or None
        Where the run writes.
    """

    def __init__(self, message: str, code: int = 1, directory: Optional[Path] = None) -> None:
        super().__init__(message, "exit code %d" % code)
        self.code = code
        self.directory = directory


def _prefix() -> Path:
    prefix = ffi.string(lib.weftpy_prefix).decode()
    return Path(prefix) if prefix else Path(__file__).parent / "prefix"


def program() -> Path:
    """Finds the program weft that this package uses; `weft` in a shell and `python -m weft` start it.

    Returns
    -------
    Path
        Where it is.

    Raises
    ------
    Error
        weft was built without it.

    Examples
    --------
    >>> weft.program().name
    'weft'
    """
    path = _prefix() / "bin" / "weft"
    if not path.exists():
        raise Error("there is no %s: weft was built without HDF5 (package libhdf5-dev)" % path)
    return path


def scene(name: str) -> Path:
    """Finds the file of a scene that comes with weft.

    Parameters
    ----------
    name : str
        Such as "flag".

    Returns
    -------
    Path
        For load(), run() and all others.

    Raises
    ------
    NotFoundError
        There is none of that name; lists all.

    Examples
    --------
    >>> weft.load(weft.scene("two-corners")).particles
    289
    """
    folder = _prefix() / "share" / "doc" / "weft" / "scenes"
    path = folder / (name + ".yaml")
    if not path.exists():
        raise NotFoundError("there is no scene %r; there are %s" % (name, ", ".join(sorted(p.stem for p in folder.glob("*.yaml")))))
    return path


def _process(arguments: Sequence[str], folder: str = "", own: Optional[Mapping[str, Method]] = None,
             stop: Optional[Path] = None) -> tuple[int, str, str]:
    """Runs the program on scenes in a temporary folder, which no message names; its exit code, and what it wrote to
    stdout and stderr. Ctrl-C passes one SIGINT on, which ends the run with its files complete; so does a file `stop`."""
    with served(own) as (environment, server):
        environment["WEFT_PARENT"] = str(os.getpid())  # the program ends with this process, however that ends
        process = subprocess.Popen([str(program()), *arguments], stdin=subprocess.DEVNULL, text=True, env=environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
        if server is not None:
            server.stop = process.terminate
        try:
            while True:
                try:
                    printed, said = process.communicate(timeout=None if stop is None else 0.5)
                    break
                except subprocess.TimeoutExpired:
                    if stop is not None and stop.exists():
                        process.send_signal(signal.SIGINT)
                        stop = None
        except BaseException:
            process.send_signal(signal.SIGINT)
            process.communicate()
            raise
        if server is not None and server.error is not None:
            raise server.error
    said = said.strip().replace(folder + os.sep, "") if folder else said.strip()
    return process.returncode, printed, in_python(said)


def _call(arguments: Sequence[str], folder: str = "", directory: PathLike = "", allowed: Sequence[int] = (0,),
          own: Optional[Mapping[str, Method]] = None) -> tuple[int, str]:
    """_process(), whose exit code is one of `allowed`, else an error; stderr becomes a warning."""
    code, printed, said = _process(arguments, folder, own)
    if code == 3:
        raise SceneError(said)
    if code not in allowed:
        raise RunError(said, code, Path(directory))
    if said:
        warnings.warn(said, SceneWarning, stacklevel=3)
    return code, printed


def _files(scenes: Iterable[Scene], folder: str) -> list[str]:
    """Paths of scenes: of a dict or a text, of a file in folder."""
    paths = []
    for i, scene in enumerate(scenes):
        name = scene.get("name") if isinstance(scene, Mapping) else None
        stem = "".join(c if c.isalnum() or c in "-_" else "-" for c in str(name or "scene-%d" % i))
        if isinstance(scene, Mapping) or is_text(scene):
            path = Path(folder, stem + ".yaml")
            path.write_text(scene if isinstance(scene, str) else yaml_text(written(scene, folder, stem)),  # type: ignore[arg-type]
                            encoding="utf-8")
            paths.append(str(path))
        else:
            paths.append(path_of(scene))
    return paths


def _sets(overrides: Optional[Mapping[str, Any]]) -> list[str]:
    return [argument for setting in settings(overrides) for argument in ("--set", setting)]


def _options(out: PathLike, overrides: Optional[Mapping[str, Any]], force: bool) -> list[str]:
    return ["--out", os.fspath(out), "--quiet", *_sets(overrides), *(["--force"] if force else [])]


def _table(path: Any) -> pd.DataFrame:
    import pandas as pd
    exact = {"float_precision": "round_trip"}  # pandas 3.1 always reads numbers so, and warns of it
    newer = tuple(map(int, pd.__version__.split(".")[:2])) >= (3, 1)
    return pd.read_csv(path, dtype={"hash": str}, **({} if newer else exact))


def run(scene: Scene, out: PathLike, overrides: Optional[Mapping[str, Any]] = None, *, force: bool = False,
        own: Optional[Mapping[str, Method]] = None) -> Run:
    """Runs a scene as `weft run` does.

    Parameters
    ----------
    scene : path, str or dict
        As of load().
    out : path
        The directory that is written, new or empty.
    overrides : dict, optional
        {"key.path": value}.
    force : bool
        Replaces an earlier run.
    own : dict, optional
        Your own methods, {"mine": step}, for scenes with stepper.plugin "own" and stepper.method "mine", and a
        fixed_step. step(rhs, t, y, h) returns the state at t + h [s] that follows from y, at t; rhs(t, y) is dy/dt.
        States are arrays of any even length: positions, then velocities. The program, which looks for the largest
        stable step of the method, too, calls it from several threads, and takes nothing to be kept from call to call.

    Returns
    -------
    Run
        The files.

    Raises
    ------
    SceneError
        Errors of the scene.
    NotFoundError
        The scene is not there.
    RunError
        The simulation failed: weft.open(out) has its frames.

    Examples
    --------
    >>> weft.run(scene, tmp / "fall", {"run.duration": 0.5}).result["status"]
    'done'
    """
    with tempfile.TemporaryDirectory() as folder:
        path, = _files([scene], folder)
        _call(["run", path, *_options(out, overrides, force)], folder, out, own=own)
    return Run(out)


def batch(scenes: Union[Scene, Sequence[Scene]], out: PathLike, overrides: Optional[Mapping[str, Any]] = None, *,
          jobs: Optional[int] = None, timeout: Optional[float] = None, force: bool = False) -> pd.DataFrame:
    """Runs scenes, and all runs of a `sweep`, as `weft batch` does. Finished runs are skipped. Failed runs raise nothing.

    Parameters
    ----------
    scenes : path, str, dict, or a list of them
        As of load().
    out : path
        The directory of all runs.
    overrides : dict, optional
        {"key.path": value}.
    jobs : int, optional
        Processes at a time; by default one per processor.
    timeout : float, optional
        [s], of each run.
    force : bool
        Replaces runs of other scenes.

    Returns
    -------
    pandas.DataFrame
        summary.csv: one row per run, with its parameters, `status` and `directory`, for weft.open(out / directory).

    Raises
    ------
    SceneError
        Errors of the scene.
    NotFoundError
        The scene is not there.
    RunError
        The directory cannot be used.

    Examples
    --------
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
            force: bool = False, own: Optional[Mapping[str, Method]] = None) -> pd.DataFrame:
    """Runs a scene with every method of every plugin, over a ladder of tolerances or steps, as `weft compare` does. The
    page compare.html is in `out`; weft.Page shows it.

    Parameters
    ----------
    scene : path, str or dict
        As of load().
    out : path
        The directory that is written, new or empty.
    overrides : dict, optional
        {"key.path": value}.
    methods : list of str, optional
        Only these, such as "gsl" or "arkode/heun_euler".
    until : float, optional
        [s], the end of the comparison; by default that of the scene.
    jobs : int
        Processes at a time; one measures the time best.
    force : bool
        Replaces an earlier comparison.
    own : dict, optional
        Your own methods, as for run(), which take part; their time is without that of Python.

    Returns
    -------
    pandas.DataFrame
        compare.csv: one row per run, with error [m], rhs_calls, time [s] (docs/guides/pick-an-integrator.md).

    Raises
    ------
    SceneError
        Errors of the scene.
    NotFoundError
        The scene is not there.
    RunError
        The program cannot compare, or there is no such method.

    Examples
    --------
    >>> def heun(rhs, t, y, h):
    ...     k = rhs(t, y)
    ...     return y + h / 2 * (k + rhs(t + h, y + h * k))
    ...
    >>> table = weft.compare(scene, tmp / "compared", methods=["verlet"], until=0.04, own={"heun": heun})
    >>> bool(table[table["method"] == "heun"]["error"].min() < 1e-6)
    True
    """
    with tempfile.TemporaryDirectory() as folder:
        more = [] if methods is None else ["--methods", ",".join([*methods, *(["own"] if own else [])])]
        more += [] if until is None else ["--until", repr(float(until))]
        path, = _files([scene], folder)
        _call(["compare", path, *_options(out, overrides, force), *more, "--jobs", str(jobs)], folder, out, own=own)
    return _table(Path(out, "compare.csv"))


def converge(scene: Scene, sizes: Sequence[int], overrides: Optional[Mapping[str, Any]] = None, *,
             at: Union[str, Sequence[str]] = (), clamp_midway: bool = False, jobs: int = 1) -> pd.DataFrame:
    """Refines a cloth, as `weft converge` does.

    Parameters
    ----------
    scene : path, str or dict
        As of load().
    sizes : list of int
        Particles along its larger extent.
    overrides : dict, optional
        {"key.path": value}.
    at : str or list of str
        Columns of series.csv, or particles such as "tip" or "3,4.x".
    clamp_midway : bool
        Two pinned rows or columns at the beginning stay two.
    jobs : int
        Processes at a time.

    Returns
    -------
    pandas.DataFrame
        One row per quantity and size, with value, difference, order and the extrapolated limit.

    Raises
    ------
    SceneError
        Errors of the scene.
    NotFoundError
        The scene is not there.
    RunError
        A run failed, or an argument is wrong.

    Examples
    --------
    >>> table = weft.converge(scene, [10, 19], {"run.duration": 0.1, "stepper.fixed_step": 2e-4}, at="gravitational")
    >>> list(table["size"])
    [10, 19]
    """
    with tempfile.TemporaryDirectory() as folder:
        path, = _files([scene], folder)
        wanted = [argument for what in ([at] if isinstance(at, str) else at) for argument in ("--at", what)]
        more = ["--clamp-midway"] if clamp_midway else []
        _, printed = _call(["converge", path, "--sizes", ",".join(map(str, sizes)), *wanted, *more, "--csv", "--quiet",
                            "--jobs", str(jobs), *_sets(overrides)], folder)
    return _table(io.StringIO(printed))


class Fit(NamedTuple):
    """What weft.fit() found.

    Attributes
    ----------
    values, errors : dict of str to float
        By key the value, and its standard error.
    correlation : ndarray
        Of the logarithms.
    chi2 : float
        The sum of the squared residuals over sigma squared.
    coordinates, runs : int
        Of the data, and of the simulation.
    unresolved : list of dict
        Directions of which the data tell nothing.
    scene : Path
        The scene with the values.
    """

    values: dict[str, float]
    errors: dict[str, float]
    correlation: Array
    chi2: float
    coordinates: int
    runs: int
    unresolved: list[dict[str, Any]]
    scene: Path


def fit(scene: Scene, data: Union[PathLike, pd.DataFrame], over: Sequence[str], out: PathLike,
        overrides: Optional[Mapping[str, Any]] = None, *, sigma: float = 1e-3, force: bool = False) -> Fit:
    """Fits parameters of a scene to measured trajectories or to a shadow, as `weft fit` does.

    Parameters
    ----------
    scene : path, str or dict
        As of load().
    data : path or pandas.DataFrame
        A CSV file or a table with the columns time, row and col (vertex for a mesh, cloth and vertex for several cloths),
        x, y and z, where NaN is missing; or the outline of its shadow at the end, with the columns angle and radius
        [degrees, m] or x and y [m].
    over : list of str
        Keys of the parameters.
    out : path
        The directory that is written.
    overrides : dict, optional
        {"key.path": value}.
    sigma : float
        [m], the standard deviation of a coordinate, or of a radius.
    force : bool
        Replaces an earlier fit.

    Returns
    -------
    Fit
        Values, errors and the fitted scene.

    Raises
    ------
    SceneError
        Errors of the scene or of `over`.
    NotFoundError
        The scene or the data are not there.
    RunError
        The data do not fit the scene, or a run failed.

    Examples
    --------
    >>> _ = (tmp / "track.csv").write_text("time,row,col,x,y,z\\n0.05,7,5,,-0.709810,\\n")
    >>> found = weft.fit(scene, tmp / "track.csv", ["forces.gravity.1"], tmp / "fit", force=True)
    >>> round(found.values["forces.gravity.1"], 1)
    -7.8
    """
    import yaml
    over = keys_of(over, "over")
    with tempfile.TemporaryDirectory() as folder:
        path, = _files([scene], folder)
        table = data if isinstance(data, (str, os.PathLike)) else Path(folder, "data.csv")
        if isinstance(data, (str, os.PathLike)) and not os.path.exists(data):
            raise NotFoundError("%s: there is no such table" % os.fspath(data))
        if not isinstance(data, (str, os.PathLike)):
            data.to_csv(table, index=False)
        try:
            _call(["fit", path, os.fspath(table), "--over", ",".join(over), "--sigma", repr(float(sigma)),
                   *_options(out, overrides, force)], folder, out)
        except SceneError as error:
            raise SceneError(of_over(str(error))) from None
    found = yaml.safe_load(Path(out, "fit.yaml").read_text())
    return Fit({key: found[key]["value"] for key in over}, {key: found[key]["standard_error"] for key in over},
               np.array(found["correlation"]), found["chi2"], found["coordinates"], found["runs"], found["unresolved"],
               Path(out, "fitted.yaml"))


def resume(run: RunLike, until: Optional[float] = None, *, force: bool = False,
           own: Optional[Mapping[str, Method]] = None) -> Run:
    """Continues a run that was killed or interrupted from its last checkpoint, to the same files, byte for byte, as an
    uninterrupted run.

    A run without a checkpoint starts again, and a finished run is left alone unless `until` is given.

    Parameters
    ----------
    run : path or Run
        The run.
    until : float, optional
        [s], beyond the scene's run.duration: the files become those of a run with that duration.
    force : bool
        Repeats a run that failed.
    own : dict, optional
        Your own methods that the run uses, as for run().

    Returns
    -------
    Run
        The files.

    Raises
    ------
    NotFoundError
        There is no run.
    SceneError
        The scene was changed since.
    RunError
        The simulation failed, or a file is damaged.

    Examples
    --------
    >>> run = weft.run(scene, tmp / "resumed", {"run.duration": 0.1, "run.keep_checkpoint": True})
    >>> round(float(weft.resume(run, 0.2).times[-1]), 9)
    0.2
    """
    directory = _directory_of(run)
    Run(directory)  # raises if there is none
    _call(["resume", directory, "--quiet", *([] if until is None else ["--until", repr(float(until))]),
           *(["--force"] if force else [])], directory=directory, own=own)
    return Run(directory)


class Difference(NamedTuple):
    """What `weft diff` finds.

    Attributes
    ----------
    equal : bool
        Whether two runs are equal.
    report : str
        What it prints of them.
    """

    equal: bool
    report: str


def diff(a: RunLike, b: RunLike, tolerance: Optional[float] = None) -> Difference:
    """Compares two runs bit for bit at their common times, or with a tolerance, as `weft diff` does.

    Parameters
    ----------
    a, b : path or Run
        The runs.
    tolerance : float, optional
        [m], of the recorded positions.

    Returns
    -------
    Difference
        Whether they are equal, and a report.

    Raises
    ------
    NotFoundError
        A run is not there.
    RunError
        Their grids differ, or files are missing.

    Examples
    --------
    >>> weft.diff(weft.run(scene, tmp / "once"), weft.run(scene, tmp / "twice")).equal
    True
    """
    code, printed = _call(["diff", _directory_of(a), _directory_of(b),
                           *([] if tolerance is None else ["--tol", repr(float(tolerance))])], allowed=(0, 1))
    return Difference(code == 0, printed.strip())


def export(run: RunLike, format: str, frame: Union[int, str] = "last") -> list[Path]:  # noqa: A002 - as the program's
    """Writes frames of a run for other programs into its directory, as `weft export` does.

    Parameters
    ----------
    run : path or Run
        The run.
    format : str
        obj, ply, csv, and of all frames mdd, pc2, pvd.
    frame : int or str
        The number of a frame, "last" or "all".

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    NotFoundError
        The run is not there.
    RunError
        There is no such format or frame.

    Examples
    --------
    >>> [path.name for path in weft.export(weft.run(scene, tmp / "exported"), "obj", 30)]
    ['frame-000030.obj']
    """
    frames = [] if format in ("mdd", "pc2", "pvd") else ["--frame", str(frame)]
    return [Path(line) for line in _call(["export", _directory_of(run), "--format", format, *frames])[1].splitlines()]


class Page(Fixed):
    """A page of weft in a file. A notebook shows it; show() opens a browser elsewhere.

    Parameters
    ----------
    path : path
        The file.
    height : int
        [pixels] in a notebook.

    Raises
    ------
    NotFoundError
        The file is not there.

    Examples
    --------
    >>> weft.Page(weft.view(weft.run(scene, tmp / "paged"))).height
    640
    """

    __slots__ = ("_height", "_path", "__weakref__")

    def __init__(self, path: PathLike, height: int = 640) -> None:
        self._path, self._height = Path(path).resolve(), height
        if not self._path.exists():
            raise NotFoundError("%s: there is no such page" % path)

    @property
    def path(self) -> Path:
        """The file."""
        return self._path

    @property
    def height(self) -> int:
        """[pixels] in a notebook."""
        return self._height

    def __fspath__(self) -> str:
        return str(self.path)

    def __repr__(self) -> str:
        return "<weft.Page %s>" % self.path

    def _repr_html_(self) -> str:
        """The page within the notebook: it needs no file and no server, but has no access to the notebook."""
        return ('<iframe sandbox="allow-scripts allow-downloads allow-popups" allow="fullscreen" width="100%%" '
                'height="%d" style="border: 0" srcdoc="%s"></iframe>'
                % (self.height, html.escape(self.path.read_text(encoding="utf-8"))))

    def show(self) -> None:
        """Shows the page: in a notebook, also amid a cell; else in a browser."""
        ipython = sys.modules.get("IPython")
        shell = ipython.get_ipython() if ipython else None
        if shell is not None and hasattr(shell, "kernel"):
            from IPython.display import display
            display(self)  # type: ignore[no-untyped-call]
        else:
            webbrowser.open(self.path.as_uri())


def view(*runs: RunLike, out: Optional[PathLike] = None, height: int = 640) -> Page:
    """Makes a page of a run, of two side by side, or of a directory of batch(), as `weft view` does.

    Parameters
    ----------
    *runs : path or Run
        One or two runs, or the directory of a batch.
    out : path, optional
        The file that is written; by default run.html, compare.html or batch.html in the first directory.
    height : int
        [pixels] in a notebook.

    Returns
    -------
    Page
        The page.

    Raises
    ------
    NotFoundError
        A directory is not there.
    RunError
        It holds no run.

    Examples
    --------
    >>> weft.view(weft.run(scene, tmp / "viewed")).path.name
    'run.html'
    """
    _, url = _call(["view", *map(_directory_of, runs), *([] if out is None else ["--out", os.fspath(out)])])
    return Page(unquote(urlsplit(url.strip()).path), height)


_NO_FRAMES = "the run has not begun, or the file was removed"


def _directory_of(run: RunLike) -> str:
    """The path of a run's directory, which is there."""
    path = os.fspath(run)
    if not os.path.isdir(path):
        raise NotFoundError("%s: there is no such directory of a run" % path)
    return path


class Run(Fixed):
    """The files of one run (docs/reference/output.md); make it with weft.open(). Works while the run writes them, too.

    Parameters
    ----------
    directory : path
        Where they are.

    Raises
    ------
    NotFoundError
        There is no run; its properties raise it, too, of a file that is not there.

    Examples
    --------
    >>> run = weft.run(scene, tmp / "files")
    >>> run.positions.shape[0] == len(run.times) == len(run.series)
    True
    """

    __slots__ = ("_directory", "__weakref__")

    def __init__(self, directory: PathLike) -> None:
        self._directory = Path(directory)
        if not (self._directory / "scene.yaml").exists():
            raise NotFoundError("%s holds no run: it has no scene.yaml" % directory)

    @property
    def directory(self) -> Path:
        """Where the files are."""
        return self._directory

    def __fspath__(self) -> str:
        return str(self.directory)

    def __repr__(self) -> str:
        return "<weft.Run %s>" % self.directory

    def _repr_html_(self) -> str:
        return view(self)._repr_html_()

    def show(self, height: int = 640) -> None:
        """Plays the frames. A run that ends a cell of a notebook is shown, too.

        Parameters
        ----------
        height : int
            [pixels] in a notebook; elsewhere a browser opens.
        """
        view(self, height=height).show()

    def _file(self, name: str, why: str) -> Path:
        path = self.directory / name
        if not path.exists():
            raise NotFoundError("%s has no %s: %s" % (self.directory, name, why))
        return path

    def _yaml(self, name: str, why: str) -> dict[str, Any]:
        import yaml
        with self._file(name, why).open(encoding="utf-8") as file:
            return dict(yaml.load(file, Loader=yaml.SafeLoader))

    @property
    def scene(self) -> str:
        """The scene as run, for weft.load."""
        return (self.directory / "scene.yaml").read_text(encoding="utf-8")

    @property
    def result(self) -> dict[str, Any]:
        """How the run ended; NotFoundError: it has not."""
        return self._yaml("result.yaml", "the run has not ended")

    @property
    def manifest(self) -> dict[str, Any]:
        """Versions, method and every option in force."""
        return self._yaml("manifest.yaml", "the run has not begun")

    @property
    def series(self) -> pd.DataFrame:
        """series.csv: one row per frame.

        >>> float(weft.run(scene, tmp / "series").series["kinetic"].iloc[0])
        0.0
        """
        return _table(self._file("series.csv", "the run has not begun"))

    @property
    def shapes(self) -> pd.DataFrame:
        """shapes.csv: force [N] and torque [N m] of the cloth on each shape, one row per frame and shape."""
        return _table(self._file("shapes.csv", "its scene has no contact.shapes"))

    @property
    def final(self) -> pd.DataFrame:
        """final.csv: row, col (a mesh has vertex instead, several cloths have cloth and vertex), x, y, z [m], vx, vy, vz
        [m/s] at the end."""
        why = "its scene has record.final: false" if (self.directory / "result.yaml").exists() else "the run has not ended"
        return _table(self._file("final.csv", why))

    @property
    def cloths(self) -> dict[str, slice]:
        """The vertices of each of several cloths, by its name: run.positions[-1][run.cloths["shirt"]]."""
        found, first = {}, 0
        for cloth in self.manifest.get("cloths", []):
            found[cloth["name"]] = slice(first, first := first + cloth["vertices"])
        return found

    def _frames(self, path: str) -> Any:
        """Where the frames of a dataset lie in the file; h5py alone, kept open, would not see a run go on."""
        import h5py
        with h5py.File(self._file("run.vtkhdf", _NO_FRAMES), "r", locking=False) as file:
            if path not in file:
                name = path.rpartition("/")[2]
                raise MissingKeyError("%s has no %s: record.fields of its scene has no '%s'" % (self.directory, name, name))
            data, of = file[path], file["weft"].attrs
            sides = [int(of[name]) for name in (("vertices",) if "vertices" in of else ("rows", "cols"))]
            shape = (int(file["VTKHDF/Steps"].attrs["NSteps"]), *sides, *data.shape[1:])
            offset = data.id.get_offset()
            if offset is None or shape[0] == 0:  # packed by h5repack, or nothing there yet
                return data[:shape[0] * math.prod(sides)].reshape(shape)
            return np.memmap(self.directory / "run.vtkhdf", data.dtype, "r", offset, shape)

    @property
    def positions(self) -> Array:
        """(frames, rows, cols, 3) or, on a mesh, (frames, N, 3) [m], of the present frames: run.vtkhdf as memory,
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
        with h5py.File(self._file("run.vtkhdf", _NO_FRAMES), "r", locking=False) as file:
            times: Array = file["VTKHDF/Steps/Values"][:int(file["VTKHDF/Steps"].attrs["NSteps"])]
            return times


def open(directory: PathLike) -> Run:  # noqa: A001 - as numpy's and tarfile's
    """Opens the files of a run.

    Parameters
    ----------
    directory : path
        Where they are.

    Returns
    -------
    Run
        Which reads them.

    Raises
    ------
    NotFoundError
        There is no run.

    Examples
    --------
    >>> weft.open(weft.run(scene, tmp / "opened")).result["status"]
    'done'
    """
    return Run(directory)
