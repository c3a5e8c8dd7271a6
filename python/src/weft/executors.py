# SPDX-License-Identifier: BSD-3-Clause
"""The runs of a sweep as tasks of an executor: Dask's, MPI's, a pool of processes."""
from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional

from weft.library import MissingPackageError, PathLike, SceneError
from weft.runs import RunError, _files, _process, _sets, _table
from weft.scenes import Scene, is_text, path_of

if TYPE_CHECKING:
    import pandas as pd

_MOST_TASKS = 1000  # each reads and checks the whole sweep, 50 us per run


def run_shard(arguments: Sequence[str], shard: str, stop: str) -> str:
    """The task: runs a part of the sweep, one run after the other, and returns what the program reported. A file
    `stop` ends it with valid results."""
    code, _, said = _process([*arguments, "--jobs", "1", "--shard", shard], stop=Path(stop))
    return said if code in (0, 1, 4, 130, 143) else "exit code %d: %s" % (code, said)


def _summary(arguments: Sequence[str], folder: str, out: Path) -> pd.DataFrame:
    """summary.csv, written again."""
    code, _, said = _process([*arguments, "--summary"], folder)
    if code == 3:
        raise SceneError(said)
    table = _table(out / "summary.csv") if code in (0, 1, 4) and (out / "summary.csv").exists() else None
    if table is None or (code == 4 and not table["status"].isin(["io_error", "changed", "busy", "unreadable"]).any()):
        raise RunError(said, code, out)
    return table


class _Now:
    """A future whose task has been done here."""

    def __init__(self, *task: Any) -> None:
        self.said = run_shard(*task)

    def result(self) -> str:
        return self.said


def _said_by(call: Callable[[], Any]) -> Any:
    """What it returns; a text: what it raised."""
    try:
        return call()
    except Exception as error:
        return "%s: %s" % (type(error).__name__, error)


def _run(executor: Any, tasks: Mapping[int, Sequence[Any]], stop: Path) -> dict[int, str]:
    """What the tasks reported or raised. Ctrl-C cancels those that have not begun and ends the others."""
    submit = partial(executor.submit, run_shard) if executor is not None else _Now
    futures: dict[int, Any] = {}
    try:
        for i, task in tasks.items():
            futures[i] = _said_by(partial(submit, *task))
        return {i: future if isinstance(future, str) else _said_by(future.result) for i, future in futures.items()}
    except BaseException:
        stop.touch()
        begun = [future for future in futures.values() if hasattr(future, "cancel") and not future.cancel()]
        for future in begun:
            _said_by(future.result)
        raise


def map(scene: Scene, sweep: Optional[Mapping[str, Any]] = None, out: Optional[PathLike] = None,  # noqa: A001
        overrides: Optional[Mapping[str, Any]] = None, *, executor: Any = None, timeout: Optional[float] = None,
        retry_failed: bool = False, force: bool = False) -> pd.DataFrame:
    """Runs a sweep as batch() does, into the same directories with the same bytes, as tasks of an executor.

    Nothing is raised for a run, and nothing repeated. Ctrl-C ends all runs with valid results. Repeated calls skip
    finished runs and continue others, also those of batch() or `weft batch`.

    Parameters
    ----------
    scene : path, str or dict
        As of load().
    sweep : dict, optional
        {"key.path": [values]}, as the scene's `sweep`, which it replaces; None: the scene's. With "sample": N, N values
        of the range of each list.
    out : path, optional
        The directory of the runs, which all machines of the executor must share; by default NAME-sweep of a scene NAME.
    overrides : dict, optional
        {"key.path": value}.
    executor : optional
        Of the kind of concurrent.futures: a ProcessPoolExecutor, Client.get_executor() of dask.distributed, an
        MPIPoolExecutor of mpi4py.futures. None: one run after the other, in this process.
    timeout : float, optional
        [s], of each run.
    retry_failed : bool
        Starts runs again that failed, crashed or took too long in an earlier call.
    force : bool
        Replaces runs of other scenes.

    Returns
    -------
    pandas.DataFrame
        The table of batch() and a column `error`: one row per run with its `status` and `directory`, and with the
        reason of a run that is not done, or what the executor raised.

    Raises
    ------
    SceneError
        Errors of the scene or of the sweep.
    NotFoundError
        The scene is not there.
    RunError
        The directory cannot be used.

    Examples
    --------
    >>> table = weft.map(scene, {"cloth.density": [0.1, 0.2]}, tmp / "mapped")
    >>> list(table["status"]), list(table["error"])
    (['done', 'done'], ['', ''])
    """
    try:
        import pandas  # noqa: F401
    except ImportError as error:
        raise MissingPackageError("weft.map returns a table of pandas, which is not installed: pip install pandas") from error
    name = scene.get("name", "scene-0") if isinstance(scene, Mapping) else \
        "scene-0" if is_text(scene) else Path(path_of(scene)).stem
    directory = Path(os.path.abspath(out if out is not None else "%s-sweep" % name))
    directory.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".map-", dir=directory) as folder:
        path, = _files([scene], folder)
        sets = {**(overrides or {}), **({} if sweep is None else {"sweep": sweep})}
        arguments = ["batch", os.path.abspath(path), "--out", str(directory), "--quiet", *_sets(sets),
                     *(["--force"] if force else []), *(["--retry-failed"] if retry_failed else []),
                     *([] if timeout is None else ["--timeout", repr(float(timeout))])]
        before = _summary(arguments, folder, directory)
        shards, stop = min(len(before), _MOST_TASKS), Path(folder, "stop")
        wanted = sorted({i % shards for i in range(len(before)) if before["status"][i] != "done"})
        try:
            said = _run(executor, {i: (arguments, "%d/%d" % (i + 1, shards), str(stop)) for i in wanted}, stop)
        finally:
            table = _summary(arguments, folder, directory)
    table["error"] = ["" if status == "done" else reason if isinstance(reason, str) else said.get(i % shards, "")
                      for i, (status, reason) in enumerate(zip(table["status"], table["reason"]))]
    return table
