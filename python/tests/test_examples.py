# SPDX-License-Identifier: BSD-3-Clause
"""Every example of the docstrings and of the pages, the programs in examples/, and one simulation under valgrind."""
import doctest
import os
import re
import runpy
import shutil
import subprocess
import sys
from xml.etree import ElementTree

import pytest
from conftest import TREE, sheet

import weft


@pytest.mark.filterwarnings("ignore::weft.PerformanceWarning")
@pytest.mark.parametrize("module", [weft, weft.checks, weft.executors, weft.garment, weft.gradients, weft.library, weft.mesh,
                                    weft.parallel, weft.simulation, weft.runs], ids=lambda m: m.__name__)
def test_docstrings(module, doctest_folder):
    globs = {"weft": weft, "scene": sheet(), "tmp": doctest_folder}
    result = doctest.testmod(module, extraglobs=globs)
    assert result.failed == 0 and result.attempted > 0


@pytest.fixture
def in_a_tree(tmp_path, monkeypatch):
    """A folder with weft's scenes, and nothing that draws on a screen."""
    (tmp_path / "scenes").symlink_to(TREE / "scenes")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    return tmp_path


def blocks(page):
    """(code, what it prints) of each block of Python; the second is "" where no block <!-- prints --> follows."""
    return re.findall(r"^```python\n(.*?)^```\n(?:\n<!-- prints -->\n```text\n(.*?)^```)?", page.read_text(encoding="utf-8"),
                      re.DOTALL | re.MULTILINE)


@pytest.mark.filterwarnings("ignore::weft.PerformanceWarning", "ignore::weft.SceneWarning")
@pytest.mark.parametrize("page, least", [("guides/python.md", 5), ("guides/cut-and-sew.md", 2), ("guides/gradients.md", 1),
                                         ("guides/robot-learning.md", 2)])
def test_the_page_runs(in_a_tree, capsys, page, least):
    code = blocks(TREE / "docs" / page)
    assert len(code) >= least
    names = {}
    for block, printed in code:
        capsys.readouterr()
        exec(block, names)
        assert printed in ("", capsys.readouterr().out), block


def test_the_readme_is_five_lines_that_run(in_a_tree, capsys):
    readme = (TREE / "README.md").read_text(encoding="utf-8")
    code, = re.findall(r"^```python\n(.*?)^```", readme, re.DOTALL | re.MULTILINE)
    assert len(code.splitlines()) == 5
    exec(code, {})
    assert "max_strain" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["torch_gradient.py", "jax_gradient.py"])
def test_gradients_go_into_other_frameworks(name):
    """Or a message: these are no dependencies."""
    result = subprocess.run([sys.executable, TREE / "examples" / name], capture_output=True, text=True, timeout=600)
    assert result.returncode == 0, result.stderr
    assert "cloth.springs.stretch.stiffness" in result.stdout or "skipped: no " in result.stdout


@pytest.mark.filterwarnings("ignore")
def test_the_lecture_draws_its_picture(in_a_tree, capsys):
    runpy.run_path(str(TREE / "examples" / "lecture.py"))
    assert capsys.readouterr().out.strip() == "lecture.png"
    assert (in_a_tree / "lecture.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ["skirt", "tshirt", "dressed"])
def test_the_garments_are_those_of_the_scenes(name, in_a_tree, capsys):
    pytest.importorskip("scipy")
    runpy.run_path(str(TREE / "examples" / "garments.py"))
    angles = re.findall(r"least angle (\d+)", capsys.readouterr().out)
    assert len(angles) == 12 and min(map(int, angles)) >= 25
    shutil.copy(TREE / "scenes" / (name + ".yaml"), in_a_tree)
    shutil.copy(TREE / "scenes" / "dressed-body.obj", in_a_tree)
    made, shipped = weft.load(name + ".yaml"), weft.load("scenes/" + name + ".yaml")
    assert made.positions.shape == shipped.positions.shape
    assert abs(made.positions - shipped.positions).max() < 1e-5


def test_the_mannequin_is_that_of_the_scenes(in_a_tree, capsys, monkeypatch):
    script = str(TREE / "examples" / "mannequin.py")
    monkeypatch.setattr(sys, "argv", [script])
    runpy.run_path(script)
    assert capsys.readouterr().out == (TREE / "scenes" / "mannequin.obj").read_text()
    monkeypatch.setattr(sys, "argv", [script, "dressed-body.obj"])
    runpy.run_path(script)
    assert (in_a_tree / "dressed-body.obj").read_text() == (TREE / "scenes" / "dressed-body.obj").read_text()
    monkeypatch.setattr(sys, "argv", [script, "walk-%02d.obj"])
    runpy.run_path(script)
    made, shipped = sorted(in_a_tree.glob("walk-*.obj")), sorted((TREE / "scenes").glob("walk-*.obj"))
    assert [f.name for f in made] == [f.name for f in shipped] and len(made) == 13
    assert all(a.read_text() == b.read_text() for a, b in zip(made, shipped))


FLEXCOMP = """<mujoco><worldbody><flexcomp name="towel" type="grid" count="5 4 1" spacing=".1 .1 .1" pos="0 0 1" euler="0 0 30"
radius=".001" mass=".1" dim="2"><edge equality="true"/></flexcomp></worldbody></mujoco>"""


def test_a_flexcomp_of_mujoco_becomes_a_cloth(in_a_tree):
    pytest.importorskip("mujoco")
    recipe = runpy.run_path(str(TREE / "examples" / "from_mujoco.py"), run_name="recipe")
    (in_a_tree / "towel.xml").write_text(FLEXCOMP)
    scene = recipe["scene_of"]("towel.xml", "towel")
    mesh = scene["cloth"]["mesh"]
    assert mesh.start.shape == (20, 3) and len(mesh.triangles) == 24 and mesh.largest_stretch == pytest.approx(1.0)
    assert abs(mesh.start.mean(axis=0) - [0, 0, 1]).max() < 1e-12 and scene["forces"]["gravity"] == [0, 0, -9.81]
    sim = weft.load(scene)
    sim.advance(0.1)
    assert sim.positions[:, 2].min() < 0.97


USD = """#usda 1.0
( metersPerUnit = 0.01
  upAxis = "Z" )
def Xform "world" {
    double3 xformOp:translate = (0, 0, 50)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Mesh "cloth" {
        int[] faceVertexCounts = [4, 3]
        int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
        point3f[] points = [(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0), (20, 0, 0)]
        texCoord2f[] primvars:st = [(0, 0), (.1, 0), (.1, .1), (0, .1), (.5, 0), (.6, 0), (.5, .1)] ( interpolation = "faceVarying" )
    }
}
"""


def test_a_mesh_of_usd_becomes_a_cloth(in_a_tree):
    pytest.importorskip("pxr")
    recipe = runpy.run_path(str(TREE / "examples" / "from_usd.py"), run_name="recipe")
    (in_a_tree / "cloth.usda").write_text(USD)
    mesh = recipe["mesh_of"]("cloth.usda", "/world/cloth")
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2]]
    assert abs(mesh.start - [[0, 0, .5], [.1, 0, .5], [.1, .1, .5], [0, .1, .5], [.2, 0, .5]]).max() < 1e-7
    assert mesh.keys == {"rest": "start"}
    sewn = recipe["mesh_of"]("cloth.usda", st=1.0)
    assert len(sewn.rest) == 7 and sewn.largest_stretch == pytest.approx(1.0, abs=1e-6)
    with pytest.raises(ValueError, match="has no mesh /none"):
        recipe["mesh_of"]("cloth.usda", "/none")


UNDER_VALGRIND = """
import gc, warnings, weft
from weft._weft import ffi, lib
warnings.simplefilter("ignore")
def leak_on_purpose():
    lib.weft_registry_create(ffi.new("weft_registry_def *", lib.weft_registry_def_default()), ffi.new("weft_registry **"), ffi.NULL)
leak_on_purpose()
def load(scene):
    sim = weft.load(scene, force=lambda t, x, v, f: None, correct=lambda t, h, x, v: False)
    for i in sim.frames():
        sim.measure()
    sim.pin(40)
    sim.restore(sim.save())
    sim.add_shape("sphere", at=[0, -3, 0], radius=0.1)
    sim.step()
    return sim.grid
view = load(%r)
view.sum()
try:
    weft.load({})
except weft.SceneError:
    pass
del view
mesh = weft.Mesh([[0, 0], [1, 0], [0, 1]], None, [[0, 1, 2]], fabrics={"a": [0]}, groups={"b": [0]})
denim = {"preset": "11oz-black-denim"}
cloth = {"mesh": mesh, "fabric": denim, "fabrics": {"a": denim}, "pins": [{"group": "b"}, {"vertices": [2]}]}
weft.load({"weft": 1, "cloth": cloth, "stepper": {"plugin": "verlet", "method": "euler", "fixed_step": 1e-4},
           "run": {"duration": 1.0}}).step()
gc.collect()
"""


def test_valgrind_finds_no_error_and_no_leak(scene, tmp_path):
    if not shutil.which("valgrind"):
        pytest.skip("no valgrind")
    scene["run"]["duration"] = 0.05
    code, report = tmp_path / "code.py", tmp_path / "report.xml"
    code.write_text(UNDER_VALGRIND % scene)
    subprocess.run(["valgrind", "--leak-check=full", "--show-leak-kinds=definite,indirect", "--num-callers=40",
                    "--xml=yes", "--xml-file=%s" % report, sys.executable, str(code)],
                   env={**os.environ, "PYTHONMALLOC": "malloc"}, check=True, stdout=subprocess.PIPE)
    # Python and NumPy have their own errors; those that weft takes part in have its functions in the stack.
    stacks = [[name.text for name in error.iter("fn")] for error in ElementTree.parse(report).getroot().iter("error")]
    ours = [names for names in stacks if any(re.match("weft|_cffi_f_weft", name) for name in names)]
    on_purpose = [names for names in ours if "_cffi_f_weft_registry_create" in names]
    assert len(on_purpose) > 0 and [names for names in ours if names not in on_purpose] == []
