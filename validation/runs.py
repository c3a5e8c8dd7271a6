# SPDX-License-Identifier: BSD-3-Clause
"""Runs of the program weft, and the numbers that they leave; nothing of physics. Python's own library suffices."""
import csv
import json
import os
import shutil
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

WEFT = Path(os.environ.get("BUILD", "build")).resolve() / "weft"
IMPLICIT = {"plugin": "stiff", "method": "backward_euler"}  # fixed_step: the largest damping, for rest


class Failed(Exception):
    """A run that ended with an error: what weft printed."""


class Run:
    """What a run has left: rows of series.csv, of final.csv, and positions in every frame."""

    def __init__(self, folder, frames):
        self.series = table(folder / "series.csv")
        self.shapes = table(folder / "shapes.csv") if (folder / "shapes.csv").exists() else []
        self.final = table(folder / "final.csv")
        self.x = [(row["x"], row["y"], row["z"]) for row in self.final]
        self.v = [(row["vx"], row["vy"], row["vz"]) for row in self.final]
        self.mesh = obj(folder / "scene.obj") if (folder / "scene.obj").exists() else None
        self.frames = []
        if frames:
            call("export", folder, "--format", "csv", "--frame", "all")
            for path in sorted((folder / "frames").glob("frame-*.csv")):
                self.frames.append([(row["x"], row["y"], row["z"]) for row in table(path)])


def table(path):
    """Rows of a CSV file as dictionaries of numbers."""
    with open(path, newline="") as file:
        return [{key: number(text) for key, text in row.items()} for row in csv.DictReader(file)]


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def obj(path):
    """Rest places (u, v) of vertices and triangles of an OBJ file that weft wrote."""
    rest, faces, at = [], [], {}
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["vt"]:
            rest.append((float(words[1]), float(words[2])))
        elif words[:1] == ["f"]:
            ends = [tuple(int(n) - 1 for n in word.split("/")) for word in words[1:]]
            faces.append(tuple(end[0] for end in ends))
            at.update(ends)
    return [rest[at[i]] for i in range(len(at))], faces


def call(*words):
    done = subprocess.run([str(WEFT), *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        raise Failed(done.stderr.strip() or done.stdout.strip())
    return done.stdout


def run(scene, files=(), frames=False):
    """Runs a scene, a dictionary, beside files {name: text}; returns what it left."""
    folder = Path(tempfile.mkdtemp(prefix="weft-validate-"))
    try:
        for name, text in dict(files).items():
            (folder / name).write_text(text)
        (folder / "scene.yaml").write_text(json.dumps({"weft": 1, "record": {"precision": "double"}, **scene}, indent=1))
        call("run", folder / "scene.yaml", "--out", folder / "out", "--quiet")
        return Run(folder / "out", frames)
    finally:
        shutil.rmtree(folder)


def run_file(name, changes):
    """Runs a scene of the folder scenes with overrides {key: value}."""
    with tempfile.TemporaryDirectory(prefix="weft-validate-") as folder:
        sets = [word for key, value in changes.items() for word in ("--set", "%s=%s" % (key, value))]
        call("run", "scenes/%s.yaml" % name, "--out", Path(folder) / "out", "--quiet", *sets)
        return Run(Path(folder) / "out", False)


def runs(tasks, function=run):
    """function(*task) of every task, as many at once as there are processors, in their order."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(lambda task: function(*task), tasks))
