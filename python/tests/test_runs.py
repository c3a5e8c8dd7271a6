# SPDX-License-Identifier: BSD-3-Clause
"""Runs of the program and their files."""
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import weft
from weft.__main__ import main


def test_a_run_has_its_files_as_tables_and_arrays(scene, tmp_path):
    run = weft.run(scene, tmp_path / "run", {"run.duration": 0.3, "record.precision": "double"})
    assert run.result["status"] == "done" and run.manifest["method"]["name"] == "velocity_verlet"
    sim = weft.load(run.scene)
    for i in sim.frames():
        assert (run.positions[i] == sim.grid).all()
        assert (run.velocities[i] == sim.grid_velocities).all()
        assert (run.strains[i].ravel() == sim.strains).all()
        assert run.times[i] == run.series["time"][i] == sim.time
    assert len(run.positions) == len(run.series) == i + 1
    assert (run.final[["x", "y", "z"]].to_numpy() == sim.positions).all()


def test_positions_are_read_as_they_are_used(scene, tmp_path):
    run = weft.run(scene, tmp_path / "run")
    positions = run.positions
    assert isinstance(positions, np.memmap) and positions.dtype == np.float32
    assert positions.shape == (61, 8, 10, 3) and run.strains.shape == (61, 8, 10)
    with pytest.raises(ValueError, match="read-only"):
        positions[0] = 0


def test_a_packed_file_has_the_same_frames(scene, tmp_path):
    if not shutil.which("h5repack"):
        pytest.skip("no h5repack (package hdf5-tools)")
    run = weft.run(scene, tmp_path / "run", {"run.duration": 0.2})
    before = np.array(run.positions)
    path = tmp_path / "run" / "run.vtkhdf"
    subprocess.run(["h5repack", "-f", "VTKHDF/Points:SHUF", "-f", "VTKHDF/Points:GZIP=1", path, tmp_path / "packed"],
                   check=True)
    (tmp_path / "packed").rename(path)
    assert np.array_equal(run.positions, before)


def test_a_run_under_way_can_be_read(scene, tmp_path):
    scene["run"]["duration"] = 100000
    (tmp_path / "long.yaml").write_text(weft.load(scene).scene)
    process = subprocess.Popen([weft.program(), "run", tmp_path / "long.yaml", "--out", tmp_path / "run", "--quiet"])

    def more_than(count):
        while process.poll() is None:
            try:
                positions = weft.open(tmp_path / "run").positions
            except OSError:  # not there yet
                continue
            if len(positions) > count:
                return positions
        raise AssertionError("the run ended")

    try:
        first = more_than(1)
        later = more_than(len(first))
        assert np.array_equal(later[:len(first)], first) and (later[-1] != first[0]).any()
        assert len(weft.open(tmp_path / "run").times) >= len(later)
    finally:
        process.terminate()
        process.wait()


def test_a_field_that_was_not_recorded_is_a_key_error(scene, tmp_path):
    run = weft.run(scene, tmp_path / "run", {"run.duration": 0.1, "record.fields": ["velocity"]})
    with pytest.raises(KeyError):
        _ = run.strains
    assert run.velocities.shape == (4, 8, 10, 3)


def test_shapes_have_a_table(scene, tmp_path):
    scene["contact"] = {"shapes": [{"shape": "sphere", "at": [0.5, -1.2, 0], "radius": 0.3}]}
    with pytest.warns(weft.SceneWarning, match="friction"):
        run = weft.run(scene, tmp_path / "run", {"run.duration": 0.1})
    assert list(run.shapes["frame"]) == [0, 1, 2, 3]


def test_a_wrong_scene_has_its_place_and_no_temporary_name(scene, tmp_path):
    scene["cloth"]["densty"] = 1
    with pytest.raises(weft.SceneError, match=r"^scene-0.yaml:\d+:5: error: unknown key 'densty'"):
        weft.run(scene, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_failed_run_leaves_its_frames(scene, tmp_path):
    scene["stepper"] = {"plugin": "verlet", "method": "euler", "fixed_step": 0.03}
    scene["run"]["duration"] = 100
    with pytest.raises(weft.RunError, match="not finite") as error:
        weft.run(scene, tmp_path / "run")
    assert error.value.code == 1
    run = weft.open(error.value.directory)
    assert run.result["status"] == "failed" and len(run.positions) > 10


def test_a_directory_in_use_is_refused_and_force_replaces_it(scene, tmp_path):
    short = {"run.duration": 0.1}
    weft.run(scene, tmp_path / "run", short)
    with pytest.raises(weft.RunError, match="run: not empty; choose another out, or force=True to replace it$"):
        weft.run(scene, tmp_path / "run", short)
    weft.run(scene, tmp_path / "run", {"run.duration": 0.2}, force=True)
    assert len(weft.open(tmp_path / "run").series) == 7
    with pytest.raises(FileNotFoundError, match="holds no run"):
        weft.open(tmp_path)


@pytest.mark.parametrize("words, call", [
    ("^jobs 0: not a number from 1 to", lambda scene, out: weft.batch(scene, out, jobs=0)),
    ("^timeout -1.0: not a number of seconds > 0$", lambda scene, out: weft.batch(scene, out, timeout=-1)),
    ("give it another out$", lambda scene, out: weft.batch([{**scene, "name": "one"}] * 2, out)),
    ("^methods: no method 'nix'", lambda scene, out: weft.compare(scene, out, methods=["nix"])),
    ("^until -1.0: not a time", lambda scene, out: weft.compare(scene, out, until=-1)),
    ("^sizes needs 2 to 16 increasing numbers", lambda scene, out: weft.converge(scene, [4])),
    ("^at nix is no column", lambda scene, out: weft.converge(scene, [4, 7], at="nix")),
    ("^clamp_midway: no pins", lambda scene, out: weft.converge(scene, [4, 7], clamp_midway=True)),
    ("^tolerance -1.0: must be", lambda scene, out: weft.diff(weft.run(scene, out), out, -1)),
    ("^frame 77: last, all or one", lambda scene, out: weft.export(weft.run(scene, out), "obj", 77)),
    ("^over: error: cloth.densty is not in this scene", lambda scene, out: weft.fit(scene, track(out), ["cloth.densty"], out)),
    ("^over: error: cloth.densty is not in this scene", lambda scene, out: weft.gradient(scene, None, ["cloth.densty"])),
    ("^sigma -1.0: not a length", lambda scene, out: weft.fit(scene, track(out), ["cloth.density"], out, sigma=-1))])
def test_messages_name_arguments_and_no_options_or_overrides_that_nobody_wrote(words, call, scene, tmp_path):
    scene["run"] = {"duration": 0.05, "fps": 20}
    with pytest.raises(weft.Error, match=words) as error:
        call(scene, tmp_path / "out")
    assert "--" not in str(error.value) and "override" not in str(error.value) and "weft: error" not in str(error.value)
    places = [one.place for one in getattr(error.value, "diagnostics", [])]
    assert "override sensitivity" not in places


def track(out):
    (out.parent / "track.csv").write_text("time,row,col,x,y,z\n0.05,2,2,0,0,0\n")
    return out.parent / "track.csv"


def test_keys_are_a_list():
    for over in ("cloth.density", ["a b"], [3], None):
        with pytest.raises(TypeError, match=r"over is a list of keys, such as \[\"cloth.density\"\]"):
            weft.gradient({}, None, over)


def test_a_missing_scene_is_one_documented_error_by_every_door(tmp_path):
    nowhere, out = str(tmp_path / "nowhere.yaml"), tmp_path / "out"
    doors = [weft.load, lambda of: weft.run(of, out), lambda of: weft.batch(of, out), lambda of: weft.batch([of], out),
             lambda of: weft.compare(of, out), lambda of: weft.converge(of, [4, 8]), lambda of: weft.map(of, {}, out),
             lambda of: weft.fit(of, "nowhere.csv", ["cloth.density"], out), lambda of: weft.gradient(of, None),
             lambda of: weft.Batch(of, 2), weft.open, weft.scene]
    for door in doors:
        for kind in (weft.NotFoundError, weft.Error, FileNotFoundError):
            with pytest.raises(kind, match="nowhere"):
                door(nowhere)
    assert not out.exists()
    again = pickle.loads(pickle.dumps(weft.NotFoundError("words")))
    assert weft.NotFoundError.__new__(weft.NotFoundError) is not None  # as others that unpickle do
    assert isinstance(again, weft.NotFoundError) and str(again) == "words" and again.status == "not found"


def test_a_file_that_a_run_lacks_is_named_with_the_reason(scene, tmp_path):
    run = weft.run(scene, tmp_path / "run", {"run.duration": 0.05, "record.final": False, "record.fields": []})
    for words, read in (("run has no shapes.csv: its scene has no contact.shapes", lambda: run.shapes),
                        ("run has no final.csv: its scene has record.final: false", lambda: run.final)):
        with pytest.raises(weft.NotFoundError, match=words):
            read()
    with pytest.raises(KeyError, match="run has no velocity: record.fields of its scene has no 'velocity'"):
        run.velocities
    for name in ("series.csv", "result.yaml", "run.vtkhdf"):
        (tmp_path / "run" / name).unlink()
    for read in (lambda: run.series, lambda: run.result, lambda: run.positions, lambda: run.times, lambda: run.final):
        with pytest.raises(weft.NotFoundError, match="run has no .*: the run has not (begun|ended)"):
            read()


def test_a_batch_is_one_row_per_run(scene, tmp_path):
    short = {"run.duration": 0.1}
    table = weft.batch({**scene, "name": "two/sheets", "sweep": {"cloth.density": [0.1, 0.2]}}, tmp_path / "b", short)
    assert list(table["cloth.density"]) == [0.1, 0.2] and list(table["status"]) == ["done", "done"]
    runs = [weft.open(tmp_path / "b" / name) for name in table["directory"]]
    assert all(run.positions.shape == (4, 8, 10, 3) for run in runs)
    again = weft.batch([scene, {**scene, "stepper": {"plugin": "verlet", "method": "euler", "fixed_step": 0.03},
                                "run": {"duration": 100}}], tmp_path / "c", jobs=2, timeout=600.0)
    assert list(again["status"]) == ["done", "failed"]


def test_compare_has_errors_that_shrink_with_the_step(scene, tmp_path):
    scene["stepper"] = {"plugin": "verlet", "method": "midpoint", "fixed_step": 1e-3}
    plugins = {method.plugin for method in weft.methods()}
    if not {"gsl", "arkode"} <= plugins:
        pytest.skip("the reference needs the plugins gsl and arkode")
    table = weft.compare(scene, tmp_path / "c", methods=["verlet/midpoint"], until=0.05)
    rows = table[(table["method"] == "midpoint") & (table["outcome"] == "done")].sort_values("setting")
    assert len(rows) >= 3 and rows["error"].iloc[0] < rows["error"].iloc[-1] / 10
    assert (tmp_path / "c" / "compare.html").exists()


def test_ctrl_c_leaves_a_complete_interrupted_run(scene, tmp_path):
    scene["cloth"]["grid"] = {"rows": 50, "cols": 50, "spacing": 0.02}
    scene["run"]["duration"] = 1000
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it

    def interrupt():
        while not (tmp_path / "run" / "run.vtkhdf").exists():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        weft.run(scene, tmp_path / "run", {"stepper.fixed_step": 1e-5})
    thread.join()
    assert weft.open(tmp_path / "run").result["status"] == "interrupted"


def test_the_package_is_the_program_as_a_command_and_as_a_module(scene, tmp_path):
    """`weft` beside python, as pip writes it, and python -m weft; with the program's output, exit code and signals."""
    command = Path(sys.executable).parent / "weft"
    assert command.exists()
    for call in ([str(command)], [sys.executable, "-m", "weft"]):
        version = subprocess.run([*call, "--version"], stdout=subprocess.PIPE, text=True)
        assert version.returncode == 0 and version.stdout.startswith("weft %s\n" % weft.__version__)
        wrong = subprocess.run([*call, "rnu"], stderr=subprocess.PIPE, text=True)
        assert wrong.returncode == 2 and "'run'" in wrong.stderr
        done = subprocess.run([*call, "new", "first"], cwd=tmp_path, stdout=subprocess.DEVNULL)
        assert done.returncode == 0 and weft.load(tmp_path / "first.yaml").particles > 0
        (tmp_path / "first.yaml").unlink()
    process = subprocess.Popen([sys.executable, "-m", "weft", "run", weft.scene("flag"), "--set", "run.duration=1000",
                                "--out", tmp_path / "run"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not (tmp_path / "run" / "run.vtkhdf").exists():
        time.sleep(0.01)
    process.terminate()
    assert process.wait() == 143 and weft.open(tmp_path / "run").result["status"] == "interrupted"


def test_a_package_without_the_program_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr("weft.runs._prefix", lambda: tmp_path)
    with pytest.raises(SystemExit, match="weft: error: there is no .*bin/weft"):
        main()
