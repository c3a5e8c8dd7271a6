# SPDX-License-Identifier: BSD-3-Clause
"""Sweeps by weft.map on executors, and by Snakemake: the files of `weft batch`."""
import concurrent.futures
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import weft
from conftest import TREE
from weft.library import yaml_text

SWEEP = {"cloth.springs.stretch.stiffness": [50, 100], "cloth.density": [0.1, 0.2]}


def files(directory):
    """All files below it, {path: bytes}, without the times of the clock."""
    found = {}
    for path in sorted(p for p in Path(directory).rglob("*") if p.is_file()):
        content = path.read_bytes()
        if path.name == "result.yaml":
            content = re.sub(rb"(?m)^wall_time: .*$", b"", content)
        if path.name == "summary.csv":
            content = re.sub(rb"(?m),[^,]*$", b"", content)
        found[str(path.relative_to(directory))] = content
    return found


def written(scene, folder):
    folder.mkdir(exist_ok=True)
    (folder / "sheet.yaml").write_text(yaml_text(scene))
    return folder / "sheet.yaml"


@pytest.fixture
def file(scene, tmp_path):
    """A scene file whose runs take 0.2 s."""
    scene["run"]["duration"] = 0.2
    return written(scene, tmp_path)


@pytest.fixture
def expected(file, scene, tmp_path):
    """The files of `weft batch`, of a scene with the sweep."""
    swept = written({**scene, "sweep": SWEEP}, tmp_path / "swept")
    subprocess.run([weft.program(), "batch", swept, "--out", tmp_path / "expected", "--quiet"], check=True)
    return files(tmp_path / "expected")


def dask():
    distributed = pytest.importorskip("distributed")
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    client = distributed.Client(cluster)
    executor = client.get_executor()
    executor.close = lambda: (client.close(), cluster.close())
    return executor


EXECUTORS = {"serial": lambda: None, "processes": lambda: concurrent.futures.ProcessPoolExecutor(2),
             "threads": lambda: concurrent.futures.ThreadPoolExecutor(3), "dask": dask}


@pytest.mark.parametrize("kind", EXECUTORS)
def test_the_files_are_those_of_weft_batch_on_any_executor(kind, file, expected, tmp_path):
    executor = EXECUTORS[kind]()
    try:
        table = weft.map(file, SWEEP, tmp_path / "mapped", executor=executor)
    finally:
        getattr(executor, "close", getattr(executor, "shutdown", lambda: None))()
    assert files(tmp_path / "mapped") == expected and len(expected) > 4 * 5
    assert list(table["status"]) == ["done"] * 4 and list(table["error"]) == [""] * 4
    assert list(table["cloth.density"]) == [0.1, 0.2, 0.1, 0.2]
    for name in table["directory"]:
        assert weft.open(tmp_path / "mapped" / name).result["status"] == "done"


def test_dicts_texts_and_the_scene_s_own_sweep_are_taken(scene, tmp_path, monkeypatch):
    scene["run"]["duration"], scene["name"] = 0.1, "small"
    monkeypatch.chdir(tmp_path)
    table = weft.map({**scene, "sweep": SWEEP}, executor=concurrent.futures.ThreadPoolExecutor(2))
    assert len(table) == 4 and files("small-sweep") == files_of_batch({**scene, "sweep": SWEEP}, tmp_path)
    with pytest.raises(weft.SceneError, match="densty"):
        weft.map(scene, {"cloth.densty": [1, 2]}, tmp_path / "wrong")
    text = weft.load(scene).scene
    drawn = weft.map(text, {"sample": 5, "seed": 2, "cloth.density": [0.1, 0.2]}, tmp_path / "drawn", {"run.fps": 60})
    assert sorted((drawn["cloth.density"] - 0.1) // 0.02) == [0, 1, 2, 3, 4]


def files_of_batch(scene, tmp_path):
    weft.batch(scene, tmp_path / "batch")
    return files(tmp_path / "batch")


def test_a_mesh_of_arrays_goes_to_the_tasks(tmp_path):
    square = weft.Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], [[0, 1, 2], [0, 2, 3]])
    scene = {"weft": 1, "cloth": {"mesh": square, "fabric": {"preset": "11oz-black-denim", "damping": [1e-5, 1e-5]}, "pins": [{"vertices": [0, 1]}]},
             "stepper": {"plugin": "verlet", "method": "velocity_verlet", "fixed_step": 1e-5},
             "run": {"duration": 0.01, "fps": 100}, "sweep": {"cloth.fabric.density": [0.3, 0.5]}}
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        table = weft.map(scene, None, tmp_path / "mapped", executor=pool)
    assert list(table["status"]) == ["done", "done"], list(table["error"])
    assert files(tmp_path / "mapped") == files_of_batch(scene, tmp_path)


def test_a_run_that_fails_has_its_error_and_is_not_repeated(file, tmp_path):
    out, sweep = tmp_path / "out", {"stepper.fixed_step": [1e-3, 0.2], "run.duration": [60]}
    table = weft.map(file, sweep, out)
    assert list(table["status"]) == ["done", "failed"]
    assert table["error"][0] == "" and "not finite" in table["error"][1]
    result = out / table["directory"][1] / "result.yaml"
    before = result.stat().st_mtime_ns
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        again = weft.map(file, sweep, out, executor=pool)
        assert list(again["error"]) == list(table["error"]) and result.stat().st_mtime_ns == before
        weft.map(file, sweep, out, executor=pool, retry_failed=True)
    assert result.stat().st_mtime_ns != before


def test_runs_of_another_scene_and_runs_that_take_too_long_say_so(file, tmp_path):
    weft.map(file, {"cloth.density": [0.1]}, tmp_path / "out")
    table = weft.map(file, {"cloth.density": [0.1]}, tmp_path / "out", {"run.fps": 10})
    assert list(table["status"]) == ["changed"] and "holds a run of another scene" in table["error"][0]
    assert list(weft.map(file, {"cloth.density": [0.1]}, tmp_path / "out", {"run.fps": 10}, force=True)["status"]) == ["done"]
    late = weft.map(file, {"run.duration": [1e5]}, tmp_path / "late", timeout=0.3)
    assert list(late["status"]) == ["timeout"] and "0.3 s" in late["error"][0]


class Refuses(concurrent.futures.Executor):
    """Takes the first task, which dies, and no other."""

    def __init__(self):
        self.taken = 0

    def submit(self, *task):
        self.taken += 1
        if self.taken > 1:
            raise RuntimeError("it is full")
        future = concurrent.futures.Future()
        future.set_exception(OSError("the worker died"))
        return future


def test_what_the_executor_raises_is_the_error_of_the_run(file, expected, tmp_path):
    table = weft.map(file, SWEEP, tmp_path / "out", executor=Refuses())
    assert list(table["status"]) == ["missing"] * 4
    assert list(table["error"]) == ["OSError: the worker died"] + ["RuntimeError: it is full"] * 3
    weft.map(file, SWEEP, tmp_path / "out")
    assert files(tmp_path / "out") == expected


# Runs of 2 s: those of a pool look twice a second whether they are to stop.
LONG = {"cloth.springs.stretch.stiffness": [50, 100], "run.duration": [1000], "run.fps": [1]}


@pytest.mark.parametrize("pool", ["None", "concurrent.futures.ProcessPoolExecutor(2)"])
def test_interrupted_it_is_continued_by_weft_batch_and_the_other_way_round(pool, file, tmp_path):
    code = "import concurrent.futures, weft\nif __name__ == '__main__': weft.map(%r, %r, %r, executor=%s)" % (
        str(file), LONG, str(tmp_path / "out"), pool)
    process = subprocess.Popen([sys.executable, "-c", code], start_new_session=True, stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))  # ignored in a job of `&`
    checkpoints = lambda: list((tmp_path / "out").glob("*/checkpoint.weft"))  # noqa: E731
    deadline = time.monotonic() + 120
    while len(checkpoints()) < (1 if pool == "None" else 2) and time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)  # to it alone, not to the processes of the pool
    said = process.communicate(timeout=120)[1]
    assert process.returncode != 0 and "KeyboardInterrupt" in said
    left = weft.runs._table(tmp_path / "out" / "summary.csv")
    assert set(left["status"]) <= {"done", "interrupted", "missing"} and "interrupted" in set(left["status"])
    assert not list((tmp_path / "out").glob(".map-*"))
    shutil.copytree(tmp_path / "out", tmp_path / "copy")
    sweep = "sweep={cloth.springs.stretch.stiffness: [50, 100], run.duration: [1000], run.fps: [1]}"
    (tmp_path / "whole").mkdir()
    for out in ("out", "whole"):
        subprocess.run([weft.program(), "batch", file, "--out", tmp_path / out, "--quiet", "--set", sweep], check=True)
    weft.map(file, LONG, tmp_path / "copy")
    whole = files(tmp_path / "whole")
    for out in ("out", "copy"):
        found = files(tmp_path / out)
        assert found.keys() == whole.keys()
        assert [name for name in whole if found[name] != whole[name] and Path(name).name != "log.txt"] == []


def test_without_pandas_it_says_what_is_missing(file, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        weft.map(file, SWEEP, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_snakemake_makes_the_same_files(file, expected, tmp_path):
    snakemake = Path(sys.executable).with_name("snakemake")
    if not snakemake.exists():
        pytest.skip("no snakemake in this environment")
    (tmp_path / "work").mkdir()
    command = [snakemake, "--snakefile", TREE / "examples" / "Snakefile", "--cores", "2", "--config",
               "scene=" + str(tmp_path / "swept" / "sheet.yaml"), "out=out"]
    environment = {**os.environ, "PATH": str(weft.program().parent) + os.pathsep + os.environ["PATH"]}
    run = lambda: subprocess.run(command, cwd=tmp_path / "work", env=environment, capture_output=True, text=True)  # noqa: E731
    first = run()
    assert first.returncode == 0, first.stderr
    assert files(tmp_path / "work" / "out") == expected
    again = run()
    assert again.returncode == 0 and "Nothing to be done" in again.stdout + again.stderr
