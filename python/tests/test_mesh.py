# SPDX-License-Identifier: BSD-3-Clause
"""Cloths of triangles from arrays and from other libraries' meshes."""
import copy
import pickle
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import weft
from weft import Mesh
from weft.mesh import flat_coordinates

DENIM = {"preset": "11oz-black-denim", "damping": [1e-5, 1e-5]}


def square(n, h=0.02):
    """(u, v) and triangles of n x n vertices."""
    r, c = np.mgrid[0:n, 0:n]
    i = (r * n + c)[:-1, :-1].ravel()
    return np.c_[c.ravel() * h, r.ravel() * -h], np.concatenate([np.c_[i, i + n, i + 1],
                                                                 np.c_[i + 1, i + n, i + n + 1]])


def sheet(**more):
    uv, triangles = square(5)
    return Mesh(uv, np.c_[uv, 0.002 * np.sin(60 * uv[:, 0])], triangles, **{"groups": {"top": np.arange(5)}, **more})


def hung(mesh, **cloth):
    return {"weft": 1, "cloth": {"mesh": mesh, "fabric": DENIM, "pins": [{"group": "top"}], **cloth},
            "stepper": {"plugin": "verlet", "method": "velocity_verlet", "fixed_step": 2e-5},
            "run": {"duration": 0.01, "fps": 200}}


def from_file(scene, folder):
    """The same scene with its mesh from a file."""
    scene["cloth"]["mesh"].write(folder / "mesh.obj")
    return {**scene, "cloth": {**scene["cloth"], "mesh": {"file": str(folder / "mesh.obj")}}}


def hashes(sim):
    return [sim.measure().hash for _ in sim.frames()]


def two_panels():
    """A seam along x = 0 of two squares, which are apart in the rest shape: rest, start, triangles, places."""
    uv, triangles = square(3, 1 / 64)
    left = np.c_[uv - [1 / 32, 0], np.zeros(9)]
    right = np.c_[uv, np.zeros(9)]
    number = np.arange(9, 18)
    number[[0, 3, 6]] = [2, 5, 8]
    kept = [1, 2, 4, 5, 7, 8]
    number[kept] = np.arange(9, 15)
    return (np.concatenate([uv, uv + [1, 0]]), np.concatenate([left, right[kept]]),
            np.concatenate([triangles, number[triangles]]), np.concatenate([triangles, triangles + 9]))


# ---- simulations -----------------------------------------------------------------------

def test_arrays_and_the_file_that_is_written_make_the_same_bits(tmp_path):
    mesh = sheet(fabrics={"hem": [0, 3, 7], "cuff": [5]})
    scene = hung(mesh, fabrics={"cuff": {**DENIM, "density": 1.0}, "hem": {**DENIM, "stretch": [900, 800]}},
                 pins=[{"group": "top"}, {"vertices": [24], "velocity": [0, 0, 0.1]}, {"near": [0.0, -0.08, 0]},
                       {"inside": {"shape": "sphere", "at": [0.04, -0.04, 0], "radius": 0.01}}],
                 loads=[{"vertices": np.array([20, 21]), "mass": 0.001}])
    arrays, file = weft.load(scene), weft.load(from_file(scene, tmp_path))
    assert np.flatnonzero(arrays.pinned).tolist() == [0, 1, 2, 3, 4, 12, 20, 24]
    assert (arrays.masses == file.masses).all() and (arrays.positions == mesh.start).all()
    assert {frozenset(t) for t in arrays.triangles.tolist()} == {frozenset(t) for t in mesh.triangles.tolist()}
    made = hashes(arrays)
    assert made == hashes(file) and len(set(made)) == 3
    run = weft.run(scene, tmp_path / "run")
    assert list(run.series["hash"]) == made
    assert run.positions.shape == (3, 25, 3)


def dome(**more):
    """A square that bulges, at rest where it starts."""
    uv, triangles = square(5)
    return Mesh("start", np.c_[uv, 4 * (uv ** 2).sum(axis=1)], triangles,
                **{"groups": {"top": np.arange(5)}, "angle": "flat", "warp": [0, 1, 0], **more})


def test_a_mesh_in_space_and_its_file_make_the_same_bits(tmp_path):
    mesh = dome(fabrics={"hem": [0, 3, 7]})
    scene = hung(mesh, fabrics={"hem": {**DENIM, "density": 1.0}})
    mesh.write(tmp_path / "dome.obj")
    assert "vt" not in (tmp_path / "dome.obj").read_text()
    file = {"file": str(tmp_path / "dome.obj"), "rest": "start", "angle": "flat", "warp": [0, 1, 0]}
    made = hashes(weft.load(scene))
    assert made == hashes(weft.load({**scene, "cloth": {**scene["cloth"], "mesh": file}})) and len(set(made)) == 3
    assert list(weft.run(scene, tmp_path / "run").series["hash"]) == made
    again = pickle.loads(pickle.dumps(mesh))
    assert again.keys == mesh.keys and made == hashes(weft.load({**scene, "cloth": {**scene["cloth"], "mesh": again}}))
    assert mesh.largest_stretch == 1.0 and 30 < mesh.smallest_angle <= 45


def test_what_is_neither_flat_nor_has_uv_can_rest_where_it_starts():
    mesh = dome()
    trimesh = SimpleNamespace(vertices=mesh.start, faces=mesh.triangles)
    with pytest.raises(weft.ArgumentError, match="rest='start' takes the start as it is"):
        Mesh.of(trimesh)
    of = Mesh.of(trimesh, rest="start", angle="flat")
    assert of.keys == {"rest": "start", "angle": "flat"} and (of.start == mesh.start).all()
    meshio = SimpleNamespace(points=mesh.start, cells=[SimpleNamespace(type="triangle", data=mesh.triangles)])
    assert Mesh.of(meshio, rest="start").keys == {"rest": "start"}
    sheet_of_uv = Mesh.of(sheet(), rest="start", warp=[1, 0, 0])
    assert sheet_of_uv.keys == {"rest": "start", "warp": [1.0, 0.0, 0.0]} and sheet_of_uv.groups["top"].tolist() == [0, 1, 2, 3, 4]
    assert Mesh.of(sheet(), angle="start").keys == {"angle": "start"}


@pytest.mark.parametrize("wrong, said", [
    ({"rest": "plane"}, "as a word it is 'start'"), ({"angle": "bent"}, "angle is 'flat' or 'start'"),
    ({"warp": [0, 0, 0]}, "not a direction"), ({"warp": [1, 0]}, r"warp has the shape"),
    ({"corner_uv": [[0, 1, 2]]}, "with corner_uv"), ({"start": None}, "with no start")])
def test_a_wrong_rest_shape_is_refused(wrong, said):
    with pytest.raises(weft.ArgumentError, match=said):
        Mesh(**{"rest": "start", "start": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], **wrong})


def test_a_warp_goes_with_a_rest_shape_in_space():
    with pytest.raises(weft.ArgumentError, match="it goes with rest='start'"):
        sheet(warp=[0, 1, 0])


def test_a_batch_takes_arrays_and_keeps_them_with_each_run(tmp_path):
    scene = {**hung(sheet()), "sweep": {"cloth.fabric.density": [0.3, 0.5]}}
    table = weft.batch(scene, tmp_path / "batch")
    assert list(table["status"]) == ["done", "done"]
    runs = [weft.open(tmp_path / "batch" / name) for name in table["directory"]]
    for run, density in zip(runs, (0.3, 0.5)):
        made = hashes(weft.load(hung(sheet()), {"cloth.fabric.density": density}))
        assert list(run.series["hash"]) == made
        assert hashes(weft.load(run.directory / "scene.yaml")) == made


def test_a_seam_shares_vertices_but_not_places(tmp_path):
    rest, start, triangles, places = two_panels()
    by_places = Mesh(rest, start, triangles, corner_uv=places, groups={"top": [0, 9]})
    by_corners = Mesh(rest[places], start, triangles, groups={"top": [0, 9]})
    assert len(by_corners.rest) == 18 and (by_corners.rest[by_corners.corner_uv] == rest[places]).all()
    scenes = [hung(by_places), hung(by_corners), from_file(hung(by_corners), tmp_path)]
    first, *others = [hashes(weft.load(scene)) for scene in scenes]
    assert all(other == first for other in others)
    whole = Mesh(np.where(rest[:, :1] >= 1, rest - [31 / 32, 0], rest)[places], start, triangles)
    assert len(whole.rest) == 15  # where the panels meet in the plane, there is no seam


@pytest.mark.parametrize("form", [
    lambda a: a.astype(np.float32).astype(np.float64), lambda a: np.asfortranarray(a), lambda a: a.tolist(),
    lambda a: np.repeat(a, 2, axis=0)[::2], lambda a: a.astype(">f8"), lambda a: a[::-1][::-1]])
def test_arrays_of_any_form_are_copied(form):
    uv, triangles = square(4, 0.25)
    start = np.c_[uv, np.zeros(16)]
    given = form(start.copy())
    mesh = Mesh(form(uv), given, triangles.astype(np.int16)[:, ::-1][:, ::-1])
    assert mesh.start.dtype == np.float64 and (mesh.start == start).all() and (mesh.triangles == triangles).all()
    if isinstance(given, np.ndarray):
        given[:] = 7
        assert (mesh.start == start).all()
    with pytest.raises(ValueError, match="read-only"):
        mesh.start[0] = 0


def test_angle_and_stretch_are_those_of_the_worst_triangle():
    mesh = Mesh([[0, 0], [1, 0], [0, 1], [3, 1]], [[0, 0, 0], [1, 0, 0], [0, 1.5, 0], [3, 1.5, 0]],
                [[0, 1, 2], [1, 3, 2]])
    assert mesh.smallest_angle == pytest.approx(np.degrees(np.arctan(0.5)))
    assert mesh.largest_stretch == pytest.approx(1.5)


def test_scenes_of_meshes_are_changed_saved_and_pickled():
    scene = hung(sheet())
    sim = weft.load(scene, {"run.fps": 100.0, "cloth.pins.1": {"vertices": [24]}, "cloth.fabric.density": 0.5,
                            "forces.damping": 1e-3})
    assert sim.fps == 100 and sim.pinned[24] and not weft.load(scene).pinned[24]
    assert 'file: "scene.obj"' in sim.scene and "vertices: [24]" in sim.scene and "damping: 0.001" in sim.scene
    sim.advance(0.005)
    again = pickle.loads(pickle.dumps(sim))
    sim.advance(0.01)
    again.advance(0.01)
    assert again.measure().hash == sim.measure().hash and again.scene == sim.scene
    assert (weft.load(scene, {"cloth.mesh.unit": 2}).rest == 2 * sim.rest).all()
    with pytest.raises(weft.SceneError, match="override cloth.pins.7"):
        weft.load(scene, {"cloth.pins.7": {"vertices": [1]}})


@pytest.mark.parametrize("shape", [
    {"shape": "plane", "at": [0, -0.045, 0], "normal": [0, 2, 0.1]},
    {"shape": "sphere", "at": [0.03, -0.05, 0.01], "radius": 0.03},
    {"shape": "capsule", "from": [0, -0.02, 0], "to": [0.05, -0.05, 0.01], "radius": 0.019},
    {"shape": "box", "at": [0.05, -0.05, 0], "half": [0.031, 0.021, 0.01], "rounding": 0.005}])
def test_pins_inside_a_shape_are_those_of_a_file(shape, tmp_path):
    scene = hung(sheet(), pins=[{"inside": shape}])
    pinned = weft.load(scene).pinned
    assert (pinned == weft.load(from_file(scene, tmp_path)).pinned).all() and 0 < pinned.sum() < 25


def test_contact_with_shapes_is_allowed_and_sees_the_mesh():
    scene = hung(sheet())
    scene["contact"] = {"shapes": [{"shape": "sphere", "at": [0.04, -0.12, 0], "radius": 0.03}]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", weft.SceneWarning)
        assert weft.load(scene).measure().gap == pytest.approx(0.01, abs=1e-3)
        scene["contact"]["shapes"][0]["at"] = [0.04, -0.08, 0]
        with pytest.raises(weft.Error, match=r"vertex \d+ .*shapes\[0\]"):
            weft.load(scene)
    scene["contact"] = {"self": True, "thickness": 0.05}
    with pytest.raises(weft.Error, match="half the smallest height"):
        weft.load(scene)
    scene["contact"]["thickness"] = 1e-3
    weft.load(scene)


def test_a_cut_is_meshed_by_the_program():
    scene = hung(sheet(), pins=[{"group": "outline"}])
    del scene["cloth"]["mesh"]
    scene["cloth"]["cut"] = {"outline": {"disc": 0.05}, "spacing": 0.02}
    with pytest.raises(weft.SceneError, match="cut needs the mesher of the program weft.*--garment"):
        weft.load(scene)


# ---- refusals --------------------------------------------------------------------------

UV, TRIANGLES = square(2)
START = np.c_[UV, np.zeros(4)]


@pytest.mark.parametrize("error, words, arguments", [
    (ValueError, r"rest has the shape \(4, 3\), not \(n, 2\)", (START, START, TRIANGLES)),
    (ValueError, r"start has the shape \(4, 2\), not \(n, 3\)", (UV, UV, TRIANGLES)),
    (ValueError, r"triangles has the shape \(3, 2\), not \(T, 3\)", (UV, START, TRIANGLES.T)),
    (ValueError, "triangle or more, not 0", (UV, START, np.zeros((0, 3), int))),
    (ValueError, "rest has 3 rows and start 4", (UV[:3], START, TRIANGLES)),
    (ValueError, r"rest has the shape \(1, 3, 2\), but there are 2", (UV[TRIANGLES][:1], START, TRIANGLES)),
    (ValueError, "start is None", (UV[TRIANGLES], None, TRIANGLES)),
    (ValueError, r"start\[2\] is \[0.0, nan, 0.0\], not finite",
     (UV, np.where(np.arange(4)[:, None] == 2, [0, np.nan, 0], START), TRIANGLES)),
    (ValueError, r"rest\[0\] is \[inf, 0.0\], not finite, the first of 4", (UV * 0 + [np.inf, 0], START, TRIANGLES)),
    (IndexError, r"triangles\[1\]\[2\] is 4, but there are 4 vertices: 0 to 3", (UV, START, TRIANGLES + [[0], [1]])),
    (IndexError, r"triangles\[0\]\[0\] is -1", (UV, START, TRIANGLES - 1)),
    (TypeError, "triangles consists of integers, not of float64", (UV, START, TRIANGLES * 1.0)),
    (TypeError, "start consists of real numbers, not of complex128", (UV, START * 1j, TRIANGLES)),
    (ValueError, "rest has masked elements", (np.ma.masked_greater(UV, 0.01), START, TRIANGLES)),
    (ValueError, "start has rows of different lengths", (UV, [[0, 0, 0], [1, 2]], TRIANGLES)),
    (ValueError, "vertex 3 is in no triangle", (UV, START, TRIANGLES[:1])),
])
def test_wrong_arrays_are_refused_in_a_sentence(error, words, arguments):
    with pytest.raises(error, match=words):
        Mesh(*arguments)


@pytest.mark.parametrize("error, words, more", [
    (IndexError, r"corner_uv\[0\]\[0\] is 9, but there are 4 rows of rest", {"corner_uv": TRIANGLES + 9}),
    (IndexError, r"group 'a'\[0\] is 4, but there are 4 vertices", {"groups": {"a": [4]}}),
    (ValueError, "one word without blanks", {"groups": {"a b": [1]}}),
    (TypeError, "groups are {NAME: vertices}, not a list", {"groups": [1]}),
    (TypeError, "fabrics are {NAME: triangles} or a list of names, not a int", {"fabrics": 3}),
    (ValueError, r"fabrics has \(1,\) names, but there are 2", {"fabrics": ["a"]}),
    (ValueError, r"fabric 'a' has \(3,\) flags, but there are 2", {"fabrics": {"a": np.ones(3, bool)}}),
])
def test_wrong_parts_are_refused_in_a_sentence(error, words, more):
    with pytest.raises(error, match=words):
        Mesh(UV, START, TRIANGLES, **more)


@pytest.mark.parametrize("words, rest, triangles", [
    ("is turned over in the rest shape", np.array([[0, 0], [1, 0], [0, 1], [0.2, 0.2]]), [[0, 1, 2], [1, 3, 2]]),
    ("in the same direction: one of them is flipped", UV, [[0, 2, 1], [1, 3, 2]]),
    ("degenerate at rest", UV * [1, 0], TRIANGLES),
    ("edge 0-1 has 3 triangles", np.array([[0, 0], [1, 0], [0.2, 1], [0.7, 1.1], [0.4, 1.2]]),
     [[0, 1, 2], [0, 1, 3], [0, 1, 4]]),
])
def test_meshes_that_are_no_cloth_are_refused_when_loaded(words, rest, triangles):
    with pytest.raises(weft.Error, match=words):
        weft.load(hung(Mesh(rest, None, triangles), pins=[]))


@pytest.mark.parametrize("error, words, cloth", [
    (weft.SceneError, "the mesh has no group 'tpo' .*did you mean 'top'", {"pins": [{"group": "tpo"}]}),
    (IndexError, r"pins\[0\].vertices\[1\] is 25, but there are 25 vertices", {"pins": [{"vertices": [3, 25]}]}),
    (ValueError, r"pins\[0\].vertices is empty", {"pins": [{"vertices": []}]}),
    (weft.SceneError, "scene:8:15: error: no vertex of the mesh starts inside this sphere",
     {"loads": [{"inside": {"shape": "sphere", "at": [9, 9, 9], "radius": 1.0}, "mass": 1}]}),
    (weft.SceneError, "the mesh has no usemtl 'hem'", {"fabrics": {"hem": DENIM}}),
    (weft.SceneError, "'at' needs a grid", {"pins": [{"at": "top"}]}),
    (weft.SceneError, "a shape must be a mapping .* not '3'", {"pins": [{"inside": 3}]}),
    (weft.SceneError, "shape must be plane, sphere, .* not the text 'cone'", {"pins": [{"inside": {"shape": "cone"}}]}),
    (weft.SceneError, "needs a grid: a mesh of triangles has a fabric", {"density": 0.1}),
])
def test_mistakes_of_a_scene_are_those_of_a_file(error, words, cloth):
    with pytest.raises(error, match=words):
        weft.load(hung(sheet(), **cloth))


# ---- other libraries -------------------------------------------------------------------

def bent(uv):
    return np.c_[uv[:, 0], uv[:, 1], 0.01 * np.cos(40 * uv[:, 1])]


def test_a_trimesh_has_its_rest_shape_in_uv_and_its_seams_are_sewn():
    trimesh = pytest.importorskip("trimesh")
    uv, triangles = square(4)
    visual = trimesh.visual.TextureVisuals(uv=uv)
    given = trimesh.Trimesh(bent(uv), triangles, visual=visual, process=False)
    scene = hung(given, pins=[{"vertices": [0, 3]}])
    assert hashes(weft.load(scene)) == hashes(weft.load(hung(Mesh(uv, bent(uv), triangles),
                                                             pins=[{"vertices": [0, 3]}])))
    rest, start, sewn, places = two_panels()
    apart = np.empty((18, 3))
    apart[places] = start[sewn]
    divided = trimesh.Trimesh(apart, places, visual=trimesh.visual.TextureVisuals(uv=rest), process=False)
    assert len(Mesh.of(divided).start) == 15 and len(Mesh.from_trimesh(divided, sew=False).start) == 18
    again = Mesh.of(divided)
    assert (again.start[again.triangles] == start[sewn]).all() and (again.rest[again.corner_uv] == rest[places]).all()


def test_a_file_with_seams_comes_back_through_trimesh(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    rest, start, triangles, places = two_panels()
    Mesh(rest, start, triangles, corner_uv=places).write(tmp_path / "seam.obj")
    again = Mesh.of(trimesh.load(tmp_path / "seam.obj", process=False))
    assert len(again.start) == 15 and len(again.rest) == 18
    lengths = [np.linalg.norm(np.roll(x, 1, axis=1) - x, axis=2).round(12).tolist()
               for x in (again.rest[again.corner_uv], rest[places], again.start[again.triangles], start[triangles])]
    assert sorted(lengths[0]) == sorted(lengths[1]) and sorted(lengths[2]) == sorted(lengths[3])


def test_a_flat_trimesh_has_its_plane_as_rest_shape_and_another_one_is_refused():
    trimesh = pytest.importorskip("trimesh")
    uv, triangles = square(4)
    flat = trimesh.Trimesh(np.c_[uv, np.full(16, 0.3)], triangles, process=False)
    assert (Mesh.of(flat).rest == uv).all()
    with pytest.raises(ValueError, match="has no u v, and is not flat"):
        Mesh.of(trimesh.Trimesh(bent(uv), triangles, process=False))


def test_coordinates_of_a_plane_keep_its_lengths():
    rng = np.random.default_rng(1)
    uv = rng.random((20, 2))
    for _ in range(20):
        turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        found = flat_coordinates(np.c_[uv, np.full(20, 0.7)] @ turn.T + [1, 2, 3])
        apart, exact = (np.linalg.norm(x[:, None] - x, axis=2) for x in (found, uv))
        assert np.abs(apart - exact).max() < 1e-14
    x = np.c_[uv, np.ones(20)]
    for order, columns in (([0, 1, 2], [0, 1]), ([0, 2, 1], [0, 2]), ([2, 1, 0], [2, 1])):  # x-y, x-z, z-y
        assert (flat_coordinates(x[:, order]) == x[:, order][:, columns]).all()


def test_a_meshio_mesh_has_groups_and_fabrics_of_gmsh():
    meshio = pytest.importorskip("meshio")
    uv, triangles = square(4)
    points = np.concatenate([[[9.0, 9.0, 9.0]], bent(uv)])  # the centre of a circle, in no triangle
    given = meshio.Mesh(points, [("line", [[1, 2], [2, 3]]), ("triangle", triangles + 1), ("vertex", [[0], [16]])],
                        point_data={"uv": np.concatenate([[[0.0, 0.0]], uv])},
                        cell_data={"gmsh:physical": [np.array([5, 5]), np.repeat([1, 2], 9), np.array([9, 9])]},
                        field_data={"the hem": np.array([2, 2]), "top": np.array([5, 1]), "end": np.array([9, 0])})
    with pytest.warns(weft.SceneWarning, match="vertex 0 is in no triangle and is dropped"):
        mesh = Mesh.of(given)
    assert (mesh.rest == uv).all() and (mesh.start == bent(uv)).all() and (mesh.triangles == triangles).all()
    assert mesh.groups["top"].tolist() == [0, 1, 2] and mesh.groups["end"].tolist() == [15]
    assert mesh.fabric_names == ["the_hem"] and mesh.fabric_of.tolist() == [0] * 9 + [1] * 9
    assert hashes(weft.load(hung(mesh)))
    with pytest.raises(ValueError, match="1 cells 'quad'"):
        Mesh.of(meshio.Mesh(uv, [("quad", [[0, 1, 5, 4]])]))
    with pytest.raises(KeyError, match="no point_data 'u'"):
        Mesh.from_meshio(given, rest="u")


def test_flat_points_of_meshio_may_have_two_coordinates():
    uv, triangles = square(3)
    block = SimpleNamespace(type="triangle", data=triangles)
    mesh = Mesh.of(SimpleNamespace(points=uv, cells=[block]))
    assert (mesh.rest == uv).all() and (mesh.start == np.c_[uv, np.zeros(9)]).all()


def test_what_is_no_mesh_is_refused():
    with pytest.raises(TypeError, match="a weft.Mesh, a trimesh.Trimesh or Scene, or a meshio.Mesh, not a object"):
        weft.load(hung(object()))


def two(**shirt):
    uv, triangles = square(4)
    skirt = Mesh(uv, np.c_[uv, np.ones(16)], triangles, groups={"top": [0, 1, 2]})
    return {"cloths": [{"name": "shirt", "mesh": Mesh(uv, np.c_[uv, np.zeros(16)], triangles), "fabric": {"preset": "royal-target"},
                        "velocity": [0.0, 0.0, 1.0], **shirt},
                       {"name": "skirt", "mesh": skirt, "fabric": {"preset": "royal-target"},
                        "pins": [{"group": "top"}]}],
            "stepper": {"plugin": "verlet", "method": "velocity_verlet", "fixed_step": 1e-4},
            "run": {"duration": 0.01, "fps": 100}}


def test_several_cloths_have_names_and_vertices_of_their_own(tmp_path):
    sim = weft.load(two())
    assert sim.cloths == {"shirt": slice(0, 16), "skirt": slice(16, 32)}
    assert (sim.velocities[sim.cloths["shirt"]] == [0.0, 0.0, 1.0]).all() and sim.pinned.nonzero()[0].tolist() == [16, 17, 18]
    again = pickle.loads(pickle.dumps(sim))
    sim.advance(0.01), again.advance(0.01)
    assert sim.measure().hash == again.measure().hash
    run = weft.run(two(), tmp_path / "two")
    assert run.cloths == sim.cloths and run.result["hash"] == sim.measure().hash
    assert (run.final[["cloth", "vertex"]].iloc[17] == ["skirt", 1]).all()
    assert weft.load(two(), {"cloths[0].velocity": [0.0, 0.0, 2.0]}).velocities[0, 2] == 2.0
    assert weft.load(hung(sheet())).cloths == {}
    with pytest.raises(weft.SceneError, match="has no group 'waist'"):
        weft.load(two(pins=[{"group": "waist"}]))


# ---- bodies of arrays -----------------------------------------------------------------

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
SIDES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                  [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


class Trimesh:
    """What a trimesh.Trimesh has of use here."""
    vertices, faces = 0.03 * CUBE, SIDES


def over_body(body, **more):
    """A square of cloth that falls onto a body, 5 cm below it."""
    return {"cloth": {"grid": {"rows": 9, "cols": 9, "spacing": 0.01, "origin": [-0.04, 0.05, -0.04], "down": [0, 0, 1]},
                      "density": 0.2, "springs": {"stretch": {"stiffness": 50, "damping": 0.01}}},
            "contact": {"thickness": 4e-3, "shapes": [{"shape": "mesh", "file": body, **more}]},
            "stepper": {"plugin": "arkode", "method": "dormand_prince", "rtol": 1e-4, "atol": 1e-4},
            "run": {"duration": 0.2}}


def triangles_of(vertices, triangles):
    """Each as the set of its corners: weft puts the vertices of a body into an order of its own."""
    return {frozenset(map(tuple, corners)) for corners in np.asarray(vertices)[np.asarray(triangles).astype(int)].tolist()}


def obj_file(folder, vertices):
    path = folder / "body.obj"
    path.write_text("".join("v %r %r %r\n" % tuple(v) for v in vertices.tolist())
                    + "".join("f %d %d %d\n" % tuple(c) for c in SIDES + 1), encoding="utf-8")
    return path


@pytest.mark.parametrize("form", [lambda v: Trimesh, lambda v: (v, SIDES), lambda v: (v.tolist(), SIDES.tolist()),
                                  lambda v: [np.asfortranarray(v), SIDES.astype(np.int16)]])
def test_a_body_of_arrays_is_that_of_a_file(form, tmp_path):
    vertices = 0.03 * CUBE
    sims = [weft.load(over_body(body)) for body in (obj_file(tmp_path, vertices), form(vertices))]
    for sim in sims:
        sim.advance(0.12)
    assert sims[0].measure().hash == sims[1].measure().hash
    assert sims[1].measure().touching > 0
    shape = sims[1].shapes[0]
    assert triangles_of(shape["vertices"], shape["triangles"]) == triangles_of(vertices, SIDES)
    assert 'file: "scene-shape0.obj"' in sims[1].scene


def test_key_frames_of_arrays_move_a_body():
    keys = np.array([0.03 * CUBE + [0, height, 0] for height in (0, 0, 0.01)])
    sim = weft.load(over_body((keys, SIDES), fps=20.0))
    assert sim.shapes[0]["keys"].shape == (3, 8, 3) and sim.shapes[0]["fps"] == 20
    still = weft.load(over_body((keys[0], SIDES)))
    for one in (sim, still):
        one.advance(0.15)
    assert sim.positions[:, 1].max() > still.positions[:, 1].max() + 5e-3


@pytest.mark.parametrize("again", [lambda sim: pickle.loads(pickle.dumps(sim)), copy.deepcopy, copy.copy])
@pytest.mark.parametrize("cloth", [None, lambda: {"mesh": sheet(), "fabric": DENIM}])
def test_a_simulation_with_a_body_of_arrays_is_copied(again, cloth):
    vertices = 0.03 * CUBE + [0.04, -0.03, 0]
    scene = over_body((vertices, SIDES), turn={"axis": [0, 1, 0], "rate": 2.0})
    if cloth is not None:
        scene = {**scene, "cloth": cloth()}
        scene["contact"]["shapes"][0]["at"] = [0, -0.3, 0]
    sim = weft.load(scene, {"contact.friction": 0.5})
    vertices[:] = 7  # the simulation has its own
    sim.advance(0.05)
    other = again(sim)
    sim.advance(0.1), other.advance(0.1)
    assert other.measure().hash == sim.measure().hash and other.scene == sim.scene and "friction: 0.5" in other.scene
    shape = other.shapes[0]
    assert triangles_of(shape["vertices"], shape["triangles"]) == triangles_of(0.03 * CUBE + [0.04, -0.03, 0], SIDES)


@pytest.mark.parametrize("at", [[0.0, 0.0, 0.0], [-0.3, 0.0, 0.2]])
def test_a_mesh_of_arrays_is_checked_where_it_is_and_not_at_the_origin(at, tmp_path):
    """Near a body, sewn and with groups and fabrics, in load(), a Batch, run() and gradient()."""
    uv, triangles = square(5)
    mesh = Mesh(uv, np.c_[uv[:, 0], np.full(25, 0.05), uv[:, 1]] + at, triangles, groups={"top": [0, 1]}, fabrics={"hem": [3]})
    body = {"shape": "mesh", "file": (0.04 * CUBE + at, SIDES)}
    scene = {"cloth": {"mesh": mesh, "fabric": DENIM, "fabrics": {"hem": DENIM}, "pins": [{"group": "top"}]},
             "contact": {"thickness": 2e-3, "friction": 0, "shapes": [body]},
             "stepper": {"method": "arkode/dormand_prince", "rtol": 1e-4, "atol": 1e-4}, "run": {"duration": 0.02, "fps": 50}}
    with warnings.catch_warnings():
        warnings.simplefilter("error", weft.SceneWarning)
        sim = weft.load(scene)
        batch = weft.Batch(scene, 2, threads=1)
    sim.advance(0.02), batch.advance(0.02)
    assert sim.measure().hash == batch[1].measure().hash == weft.run(scene, tmp_path / "run").result["hash"]
    mesh = Mesh(uv, np.c_[uv[:, 0], np.zeros(25), uv[:, 1]] + at, triangles)
    with pytest.raises(weft.Error, match="touches shapes") as caught:
        weft.load({**scene, "cloth": {"mesh": mesh, "fabric": DENIM}})
    assert "/tmp" not in str(caught.value)


def test_the_meshes_of_a_scene_of_trimesh_are_one_mesh_where_their_transforms_put_them(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    uv, triangles = square(4)
    visual = trimesh.visual.TextureVisuals(uv=uv)
    panel = trimesh.Trimesh(bent(uv), triangles, visual=visual, process=False)
    size, scene = uv.max(), trimesh.Scene()
    scene.add_geometry(panel, node_name="front")
    scene.add_geometry(panel, node_name="the back", transform=trimesh.transformations.translation_matrix([size, 0, 0]))
    mesh = Mesh.of(scene)
    assert len(mesh.triangles) == 2 * len(triangles) and len(mesh.start) == 32 - 4  # sewn along a side
    assert set(mesh.groups) == {"front", "the_back"} and len(mesh.groups["the_back"]) == 16
    assert np.abs(mesh.start[mesh.groups["the_back"]].max(axis=0)[0] - 2 * size) < 1e-15
    assert mesh.largest_stretch == pytest.approx(Mesh.of(panel).largest_stretch)
    weft.load(hung(scene, pins=[{"group": "front"}]))
    body = trimesh.Scene([trimesh.creation.box((0.04, 0.04, 0.04))])
    body.apply_translation([0, 0.01, 0])
    assert weft.load(over_body(body)).measure().hash == weft.load(over_body(
        trimesh.creation.box((0.04, 0.04, 0.04)).apply_translation([0, 0.01, 0]))).measure().hash
    with pytest.raises(ValueError, match="no mesh"):
        Mesh.of(trimesh.Scene())
    scene.add_geometry(trimesh.Trimesh(bent(uv), triangles, process=False))
    with pytest.raises(ValueError, match="some meshes of the trimesh.Scene have u v, and others have none"):
        Mesh.of(scene)
    with pytest.raises(TypeError, match="is a PointCloud, not a mesh"):
        Mesh.of(trimesh.Scene([trimesh.PointCloud(UV)]))


def test_welded_vertices_are_those_of_all_pairs_and_of_a_file(tmp_path):
    rng = np.random.default_rng(3)
    x = rng.random((300, 3)).round(3)
    x[::7] = x[1::7][:43]
    for distance in (0.0, 1e-3, 0.04, 0.08, 0.12, 0.2, 1e-300):
        wanted = np.arange(300)
        near = np.linalg.norm(x[:, None] - x, axis=2) <= distance * (1 + 1e-9)
        for _ in range(300):
            wanted = np.where(near, wanted, 300).min(axis=1)
        assert (weft.mesh._lowest(x, distance) == wanted).all()
    rest, start, sewn, places = two_panels()
    apart = np.empty((18, 3))
    apart[places] = start[sewn]
    mesh = Mesh(rest, apart, places, groups={"ends": [0, 17]}, fabrics={"hem": [1]})
    welded = mesh.weld()
    assert len(welded.start) == 15 and (welded.start[welded.triangles] == start[sewn]).all()
    assert (welded.rest[welded.corner_uv] == rest[places]).all() and welded.fabric_names == ["hem"]
    mesh.write(tmp_path / "apart.obj")
    scene = hung(welded, pins=[{"vertices": [0]}])
    file = {**scene, "cloth": {**scene["cloth"], "mesh": {"file": str(tmp_path / "apart.obj"), "weld": 0}}}
    assert hashes(weft.load(scene)) == hashes(weft.load(file))
    with pytest.raises(ValueError, match="makes one vertex of two corners of triangle 0, the first of"):
        mesh.weld(10.0)
    with pytest.raises(ValueError, match="distance is a number >= 0"):
        mesh.weld(-1)


def test_a_flat_file_is_the_mesh_of_its_arrays(tmp_path):
    uv, triangles = square(4)
    turn = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0]
    mesh = SimpleNamespace(vertices=np.vstack((np.c_[uv, np.full(16, 0.7)] @ turn.T, [[9, 9, 9]])), faces=triangles)
    with pytest.warns(weft.SceneWarning, match="vertex 16 is in no triangle"):
        given = Mesh.of(mesh)
    (tmp_path / "flat.obj").write_text("".join("v %r %r %r\n" % tuple(v) for v in mesh.vertices[:16].tolist())
                                       + "".join("f %d %d %d\n" % tuple(f) for f in triangles + 1), encoding="utf-8")
    ours = weft.load(hung(given, pins=[{"vertices": [0]}]))
    theirs = weft.load({**hung(given), "cloth": {**hung(given)["cloth"], "mesh": {"file": str(tmp_path / "flat.obj")},
                                                 "pins": [{"vertices": [0]}]}})
    ours.advance(0.01), theirs.advance(0.01)
    assert np.abs(ours.positions - theirs.positions).max() < 1e-9


def test_files_of_materials_and_tables_are_found_from_the_working_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.json").write_text('{"density": 0.2, "stretching": [[50, 5, 60, 20]%s], "bending": [%s]}' % (
        ", [50, 5, 60, 20]" * 5, ", ".join(["[4e-5, 4e-5, 4e-5, 4e-5, 4e-5]"] * 3)), encoding="utf-8")
    (tmp_path / "up.csv").write_text("t,x,y,z\n0,0,0,0\n1,0,0,1\n", encoding="utf-8")
    scene = hung(sheet(), pins=[{"vertices": [0], "path": "up.csv"}])
    scene["cloth"]["fabric"] = {"arcsim": "m.json"}
    made = hashes(weft.load(scene))
    assert list(weft.run(scene, "run").series["hash"]) == made


def test_files_of_a_dict_are_found_from_the_working_directory_by_all_doors(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = from_file(hung(sheet()), tmp_path)
    scene["cloth"]["mesh"] = {"file": "mesh.obj"}
    made = hashes(weft.load(scene))
    assert list(weft.run(scene, "run").series["hash"]) == made
    assert list(weft.batch(scene, "batch")["status"]) == ["done"]


@pytest.mark.parametrize("body, error", [
    ((CUBE[:, :2], SIDES), r"vertices of a body have the shape \(8, 2\)"), ((CUBE * np.nan, SIDES), "not finite"),
    ((CUBE, SIDES[:, :2]), r"triangles of a body has the shape \(12, 2\)"), ((CUBE, SIDES + 1), "is 8, but there are 8"),
    (7, "a path, a trimesh.Trimesh or"), ((CUBE,), "a path, a trimesh.Trimesh or")])
def test_arrays_that_are_no_body_are_refused(body, error):
    with pytest.raises((ValueError, TypeError, IndexError), match=error):
        weft.load(over_body(body))


def test_a_run_keeps_the_body_of_arrays(tmp_path):
    run = weft.run(over_body((np.array([0.03 * CUBE, 0.03 * CUBE + [0, 1e-3, 0]]), SIDES), fps=20.0), tmp_path / "run")
    assert run.shapes["fy"].min() < 0 and (tmp_path / "run" / "scene-shape0-0001.obj").exists()


def test_a_mesh_that_is_nearly_flat_has_its_plane_as_rest_shape():
    v = np.array([[0, 0, 0], [1.6, 0, 0.0002], [1.6, 1, 0], [0, 1, 0.0002]])
    with pytest.warns(weft.SceneWarning, match="the mesh has no u v and leaves its plane by .* its rest shape is the plane"):
        found = flat_coordinates(v)
    assert np.abs(found - v[:, :2]).max() < 1e-3
    with pytest.raises(ValueError, match="is not flat: it leaves its plane by"):
        flat_coordinates(v * [1, 1, 100])


def test_the_stretch_of_a_triangle_without_area_is_infinite():
    mesh = weft.Mesh([[0, 0], [1, 0], [2, 0], [0, 1]], np.eye(4, 3), [[0, 1, 2], [0, 1, 3]])
    assert mesh.largest_stretch == float("inf")
    with pytest.raises(ValueError, match="triangle 0 has no area at rest"):
        weft.garment.relaxed(mesh, 1)
