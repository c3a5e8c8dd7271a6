# SPDX-License-Identifier: BSD-3-Clause
"""Times, points, fields and cells as VTK reads them, against the CSV files of the run."""
import csv
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree

import numpy
import vtk
from vtkmodules.util.numpy_support import vtk_to_numpy

BUILD = sys.argv[1]
WEFT = os.path.join(BUILD, "weft")
OUT = os.path.join(BUILD, "view", "runs")
SCENE = "scenes/curtain.yaml"
SHORT = ["--set", "run.duration=0.2"]


def weft(*arguments):
    return subprocess.run([WEFT, *arguments], check=True, stdout=subprocess.PIPE)


def run(name, *options, scene=SCENE):
    directory = os.path.join(OUT, name)
    shutil.rmtree(directory, ignore_errors=True)
    weft("run", scene, "--out", directory, "--quiet", *options)
    return directory


class Frames:
    """run.vtkhdf through vtkHDFReader."""

    def __init__(self, directory):
        self.reader = vtk.vtkHDFReader()
        self.reader.SetFileName(os.path.join(directory, "run.vtkhdf"))
        self.reader.UpdateInformation()
        steps = vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
        # a single step has no time in VTK
        self.times = self.reader.GetOutputInformation(0).Get(steps) or (0.0,)

    def at(self, i):
        self.reader.UpdateTimeStep(self.times[i])
        return self.reader.GetOutput()


def points(surface):
    return vtk_to_numpy(surface.GetPoints().GetData())


def field(surface, name):
    return vtk_to_numpy(surface.GetPointData().GetArray(name))


def cells(surface):
    found = []
    for i in range(surface.GetNumberOfCells()):
        ids = surface.GetCell(i).GetPointIds()
        found.append([ids.GetId(k) for k in range(ids.GetNumberOfIds())])
    return found


def rows_of(name):
    with open(name, newline="") as stream:
        return list(csv.DictReader(stream))


def table(rows, *names):
    return numpy.array([[float(row[name]) for name in names] for row in rows])


def quads(rows, cols):
    return [[a, a + cols, a + cols + 1, a + 1]
            for r in range(rows - 1) for a in range(r * cols, r * cols + cols - 1)]


def same_run(directory, real, dimensions):
    """Every frame of run.vtkhdf against series.csv and frames/*.csv."""
    series = rows_of(os.path.join(directory, "series.csv"))
    frames = Frames(directory)
    assert len(frames.times) == len(series)
    for i, row in enumerate(series):
        assert frames.times[i] == float(row["time"]), (i, frames.times[i])
        surface = frames.at(i)
        state = rows_of(os.path.join(directory, "frames/frame-%06d.csv" % i))
        x, v = points(surface), field(surface, "velocity")
        assert x.dtype == real and v.dtype == real
        assert (x == table(state, "x", "y", "z").astype(real)).all(), i
        assert (v == table(state, "vx", "vy", "vz").astype(real)).all(), i
        assert field(surface, "strain").max() == real(row["max_strain"]), i
        assert cells(surface) == quads(*dimensions), i
        for name in row:
            if name != "hash":
                value = surface.GetFieldData().GetArray(name).GetTuple1(0)
                assert value == float(row[name]) if row[name] else value != value, (i, name)


def check_run(precision, real):
    directory = run(precision, "--set", "record.precision=" + precision, *SHORT)
    weft("export", directory, "--format", "csv", "--frame", "all")
    final = rows_of(os.path.join(directory, "final.csv"))
    dimensions = [int(final[-1]["row"]) + 1, int(final[-1]["col"]) + 1]
    same_run(directory, real, dimensions)
    last = Frames(directory)
    surface = last.at(len(last.times) - 1)
    assert (points(surface) == table(final, "x", "y", "z").astype(real)).all()
    pinned = field(surface, "pinned") != 0
    assert pinned.any() and not pinned.all()
    assert (field(surface, "velocity")[pinned] == table(final, "vx", "vy", "vz").astype(real)[pinned]).all()
    return directory, dimensions


def check_exports(directory, dimensions):
    frames = Frames(directory)
    weft("export", directory, "--format", "pvd")
    listed = xml.etree.ElementTree.parse(os.path.join(directory, "run.pvd")).getroot().iter("DataSet")
    listed = [(float(entry.get("timestep")), entry.get("file")) for entry in listed if entry.get("part") == "0"]
    assert tuple(t for t, _ in listed) == tuple(frames.times)
    for i, (_, name) in enumerate(listed):
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(os.path.join(directory, name))
        reader.Update()
        wanted, surface = frames.at(i), reader.GetOutput()
        assert (points(surface) == points(wanted)).all()
        for field_name in ("velocity", "strain"):
            assert (field(surface, field_name) == field(wanted, field_name)).all()
        assert cells(surface) == quads(*dimensions)
    for suffix, reader in (("ply", vtk.vtkPLYReader()), ("obj", vtk.vtkOBJReader())):
        weft("export", directory, "--format", suffix, "--frame", "2")
        reader.SetFileName(os.path.join(directory, "frames/frame-000002." + suffix))
        reader.Update()
        surface = reader.GetOutput()
        read, wanted = points(surface), points(frames.at(2))
        if suffix == "ply":  # floats
            assert (read == wanted.astype(numpy.float32)).all()
        else:  # nine digits
            assert (abs(read - wanted) <= 5.1e-9 * abs(wanted)).all()
        assert cells(surface) == quads(*dimensions), suffix


def check_chain():
    directory = run("chain", *SHORT, scene="scenes/chain.yaml")
    n = len(rows_of(os.path.join(directory, "final.csv")))
    frames = Frames(directory)
    for i in range(len(frames.times)):
        assert cells(frames.at(i)) == [list(range(n))]


def check_mesh():
    """Vertices and triangles of an OBJ file, in its order."""
    rows, cols = 5, 7
    corners = [[a, a + cols, a + 1 + cols * k] for a, k in ((r * cols + c, k) for r in range(rows - 1)
               for c in range(cols - 1) for k in (0, 1))]
    corners = [t if t[2] == t[0] + 1 else [t[0] + 1, t[1], t[2]] for t in corners]
    with open(os.path.join(OUT, "sheet.obj"), "w") as file:
        for i in reversed(range(rows * cols)):  # another order than weft's
            file.write("v %g %g 0\nvt %g %g\n" % (2 * (i % cols / 10, -(i // cols) / 10)))
        for triangle in corners:
            file.write("f %s\n" % " ".join("%d/%d" % (2 * (rows * cols - i,)) for i in triangle))
    with open(os.path.join(OUT, "sheet.yaml"), "w") as file:
        file.write("weft: 1\ncloth:\n  mesh: {file: sheet.obj}\n  pins: [{vertices: [0]}]\n  fabric: {density: 0.2, "
                   "stretch: [100, 100], shear: 20, bend: [0, 0], damping: [1.0e-3, 0]}\n"
                   "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 0.2, fps: 10}\n")
    directory = run("sheet", scene=os.path.join(OUT, "sheet.yaml"))
    final = rows_of(os.path.join(directory, "final.csv"))
    assert [int(row["vertex"]) for row in final] == list(range(rows * cols))
    frames = Frames(directory)
    last = frames.at(len(frames.times) - 1)
    assert (points(last) == table(final, "x", "y", "z").astype(numpy.float32)).all()
    turned = sorted(sorted(rows * cols - 1 - i for i in triangle) for triangle in corners)
    found = cells(last)
    assert sorted(map(sorted, found)) == turned
    weft("export", directory, "--format", "pvd")
    weft("export", directory, "--format", "ply", "--frame", "2")
    for name, reader in (("vtp", vtk.vtkXMLPolyDataReader()), ("ply", vtk.vtkPLYReader())):
        reader.SetFileName(os.path.join(directory, "frames/frame-000002." + name))
        reader.Update()
        assert (points(reader.GetOutput()) == points(frames.at(2))).all(), name
        assert cells(reader.GetOutput()) == found, name


def check_shapes():
    """The ball of a run and its meshes: every point at its radius, quads that face outwards."""
    directory = run("ball", *SHORT, scene="scenes/ball.yaml")
    weft("export", directory, "--format", "pvd")
    weft("export", directory, "--format", "obj", "--frame", "2")
    for name, reader in (("vtp", vtk.vtkXMLPolyDataReader()), ("obj", vtk.vtkOBJReader())):
        reader.SetFileName(os.path.join(directory, "frames/frame-000002-shape-0." + name))
        reader.Update()
        surface = reader.GetOutput()
        away = points(surface) - numpy.array([0, -0.3, 0])
        assert (abs(numpy.linalg.norm(away, axis=1) - 0.3) < 1e-7).all()
        a, b, c, d = (away[list(corner)] for corner in zip(*cells(surface)))
        outwards = numpy.einsum("ij,ij->i", numpy.cross(c - a, d - b), a + b + c + d)
        assert (outwards > 0).all(), name


def check_kills(count):
    """Every frame that was committed is that of a run left in peace."""
    many = ["--set", "run.fps=3000", "--set", "run.duration=0.2"]
    reference = Frames(run("reference", *many))
    whole = [points(reference.at(i)).copy() for i in range(len(reference.times))]
    directory = os.path.join(OUT, "killed")
    found = 0
    for _ in range(count):
        shutil.rmtree(directory, ignore_errors=True)
        process = subprocess.Popen([WEFT, "run", SCENE, "--out", directory, "--quiet", *many])
        while not os.path.exists(os.path.join(directory, "run.vtkhdf")):
            assert process.poll() is None or os.path.exists(os.path.join(directory, "run.vtkhdf"))
            time.sleep(0.0002)
        time.sleep(random.uniform(0.0, 0.2))
        process.send_signal(signal.SIGKILL)
        process.wait()
        frames = Frames(directory)
        committed = len(frames.times)
        assert frames.times[:committed] == reference.times[:committed]
        for i in range(committed):
            assert (points(frames.at(i)) == whole[i]).all(), i
        found += committed
    return found


def check_reading_while_it_grows():
    directory = os.path.join(OUT, "growing")
    shutil.rmtree(directory, ignore_errors=True)
    process = subprocess.Popen([WEFT, "run", SCENE, "--out", directory, "--quiet", "--set", "run.duration=10000"])
    try:
        counts = []
        while not os.path.exists(os.path.join(directory, "run.vtkhdf")):
            assert process.poll() is None
            time.sleep(0.01)
        for _ in range(20):
            # VTK looks at NSteps and at the times one after the other, and overruns its memory when a frame
            # comes between (docs/reference/output.md): the file is one that a writer has stopped at, at any moment.
            process.send_signal(signal.SIGSTOP)
            os.waitid(os.P_PID, process.pid, os.WSTOPPED)
            frames = Frames(directory)
            counts.append(len(frames.times))
            assert len(points(frames.at(counts[-1] - 1))) > 0
            process.send_signal(signal.SIGCONT)
            time.sleep(random.uniform(0.0, 0.05))
    finally:
        process.kill()
        process.wait()
    assert counts == sorted(counts)


os.makedirs(OUT, exist_ok=True)
for precision, real in (("single", numpy.float32), ("double", numpy.float64)):
    check_exports(*check_run(precision, real))
check_chain()
check_mesh()
check_shapes()
check_reading_while_it_grows()
frames_after_kills = check_kills(20)
print("view: vtk %s ok, %d frames after 20 kills" % (vtk.VTK_VERSION, frames_after_kills))
