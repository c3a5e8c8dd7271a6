# SPDX-License-Identifier: BSD-3-Clause
"""Garments from sewing patterns."""
import json
import warnings

import numpy as np
import pytest

import weft
from weft import garment

pytest.importorskip("scipy")


def panel(corners, curves=None, **more):
    """A panel (cm) of an outline; curves: {edge: curvature}."""
    count = len(corners)
    edges = [{"endpoints": [k, (k + 1) % count]} for k in range(count)]
    for k, curve in (curves or {}).items():
        edges[k]["curvature"] = curve
    return {"vertices": corners, "edges": edges, "translation": [0, 0, 0], "rotation": [0, 0, 0], **more}


def pattern(panels, stitches=(), **properties):
    return {"pattern": {"panels": panels, "stitches": [[{"panel": p, "edge": i}, {"panel": q, "edge": j}]
                                                       for p, i, q, j in stitches]},
            "properties": {"curvature_coords": "relative", "units_in_meter": 100, **properties}}


def backwards(of):
    """The same panel with its outline the other way round, and the new number of each edge."""
    edges = [{**edge, "endpoints": edge["endpoints"][::-1]} for edge in of["edges"][::-1]]
    return {**of, "edges": edges}, lambda k: len(edges) - 1 - k


def euler(mesh):
    edges = {frozenset(pair) for t in mesh.triangles.tolist() for pair in (t[:2], t[1:], t[::2])}
    return len(mesh.start) - len(edges) + len(mesh.triangles)


def rims(mesh):
    """The number of closed lines that bound the cloth."""
    sides = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])
    there = set(map(tuple, sides.tolist()))
    after = {a: b for a, b in there if (b, a) not in there}
    count = 0
    while after:
        _, at = after.popitem()
        while at in after:
            at = after.pop(at)
        count += 1
    return count


def area(mesh):
    a, b = (mesh.rest[mesh.corner_uv[:, k]] - mesh.rest[mesh.corner_uv[:, 0]] for k in (1, 2))
    return float(np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2)


def hung(mesh, pins):
    return {"weft": 1, "cloth": {"mesh": mesh, "fabric": {"preset": "11oz-black-denim", "damping": [1e-5, 1e-5]},
                                 "pins": pins},
            "stepper": {"plugin": "arkode", "method": "dormand_prince", "rtol": 1e-6},
            "run": {"duration": 0.002, "fps": 500}}


SQUARE = [[0, 0], [20, 0], [20, 30], [0, 30]]
SIDES = [("front", 1, "back", 1), ("front", 3, "back", 3)]


# ---- curves ----------------------------------------------------------------------------

@pytest.mark.parametrize("large, left, turn", [(0, 1, 120), (1, 1, 240), (0, 0, -120), (1, 0, -240)])
def test_an_arc_has_its_radius_its_side_and_equal_parts(large, left, turn):
    chord = 2 * 10 * np.sin(np.radians(60))
    far = -40 if left == 1 else 40  # the panel is where the outline closes
    curved = panel([[0, 0], [chord, 0], [chord, -far], [0, -far]] if left else [[0, 0], [chord, 0], [chord, -40],
                                                                               [0, -40]],
                   {0: {"type": "circle", "params": [10, large, left]}})
    mesh = garment.load(pattern({"p": curved}), spacing=0.01)
    on = mesh.start[mesh.groups["p.0"]][:, :2] * 100
    parts = int(np.ceil(np.radians(abs(turn)) * 10 - 1e-9))
    middle = np.array([chord / 2, 5 if (large == 0) == (left == 1) else -5])
    assert len(on) == parts + 1
    assert np.linalg.norm(on - middle, axis=1) == pytest.approx(10, abs=1e-9)
    angle = np.sort(np.unwrap(np.sort(np.arctan2(*(on - middle).T))))
    step = np.diff(np.r_[angle, angle[0] + 2 * np.pi])
    gap = np.argmax(step)  # the part of the circle that the arc leaves out
    assert np.degrees(step[gap]) == pytest.approx(360 - abs(turn))
    assert np.degrees(np.delete(step, gap)) == pytest.approx(abs(turn) / parts, abs=1e-4)
    lowest, highest = on[:, 1].min(), on[:, 1].max()
    assert (lowest < -1 and highest < 1e-9) if left else (highest > 1 and lowest > -1e-9)


@pytest.mark.parametrize("older", [False, True])
def test_beziers_are_relative_to_their_edge_or_absolute(older):
    quadratic = {"type": "quadratic", "params": [[0.5, 0.3]]}
    whole = pattern({"p": panel(SQUARE, {1: [0.5, 0.3] if older else quadratic})})
    mesh = garment.load(whole, spacing=0.01)
    # B(t) = (1 - t)^2 a + 2 t (1 - t) c + t^2 b, c in the middle, 9 cm to the left of the edge: a parabola
    on = mesh.start[mesh.groups["p.1"]][:, :2] * 100
    assert on[:, 0] == pytest.approx(20 - 18 * (on[:, 1] / 30) * (1 - on[:, 1] / 30), abs=1e-6)
    parts = np.linalg.norm(np.diff(on[np.argsort(on[:, 1])], axis=0), axis=1)
    assert parts == pytest.approx(parts.mean(), rel=1e-3)
    absolute = pattern({"p": panel(SQUARE, {1: [11.0, 15.0]})}, curvature_coords="absolute")
    assert np.allclose(garment.load(absolute, spacing=0.01).start, mesh.start, atol=1e-9)
    straight = {1: {"type": "cubic", "params": [[1 / 3, 0], [2 / 3, 0]]}}
    assert area(garment.load(pattern({"p": panel(SQUARE, straight)}))) == pytest.approx(0.06, rel=1e-12)


def test_panels_are_turned_about_x_then_y_then_z_and_moved_and_have_units():
    placed = panel(SQUARE, translation=[1, 2, 3], rotation=[90, 0, 90])
    mesh = garment.load(pattern({"p": placed}, units_in_meter=10), spacing=0.5, relax=0)
    corner = mesh.start[np.flatnonzero((mesh.rest == [2, 3]).all(axis=1))[0]]  # (2, 3, 0) -> (2, 0, 3) -> (0, 2, 3)
    assert corner == pytest.approx(np.array([0, 2, 3]) + [0.1, 0.2, 0.3])
    middle = pattern({"p": {**placed, "rotation": [0, 0, 0]}}, normalize_panel_translation=True)
    assert garment.load(middle).start.mean(axis=0)[2] == pytest.approx(0.03)
    assert garment.load(middle).start.min(axis=0) == pytest.approx([0.01, 0.02, 0.03])


# ---- stitches --------------------------------------------------------------------------

@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("turned", [False, True])
def test_two_panels_make_a_tube_that_is_not_twisted(reverse, turned, tmp_path):
    back = panel([[x - 20, y] for x, y in SQUARE] if turned else SQUARE, translation=[0, 0, -5],
                 rotation=[0, 180, 0] if turned else [0, 0, 0])
    other = {1: 3, 3: 1} if turned else {1: 1, 3: 3}  # edge 1 of the front is right, as seen from the front
    if reverse:
        back, number = backwards(back)
        other = {k: number(v) for k, v in other.items()}
    whole = pattern({"front": panel(SQUARE, translation=[0, 0, 5]), "back": back},
                    [("front", k, "back", other[k]) for k in (1, 3)])
    (tmp_path / "tube.json").write_text(json.dumps(whole))
    mesh = garment.load(tmp_path / "tube.json", spacing=0.03)
    assert (euler(mesh), rims(mesh)) == (0, 2)
    sewn = np.intersect1d(mesh.groups["front"], mesh.groups["back"])
    assert len(sewn) == 22 and len(mesh.rest) == len(mesh.start) + 22
    placed = garment.load(tmp_path / "tube.json", spacing=0.03, relax=0)
    assert np.abs(placed.start[sewn][:, 2]).max() < 1e-12  # the mean of the two sides
    assert len(np.unique(placed.start[sewn].round(9), axis=0)) == 22  # at 11 heights on either side
    assert mesh.largest_stretch < 1.1 < 1.5 < placed.largest_stretch
    assert area(mesh) == pytest.approx(0.12, rel=1e-12)
    weft.load(hung(mesh, [{"group": "front.2"}]))  # has two sides


def test_the_declared_direction_counts_where_places_decide_nothing():
    def angle(more):
        whole = pattern({"a": panel(SQUARE), "b": panel(SQUARE, rotation=[90, 0, 0], translation=[20, 15, 15])})
        ends = [{"panel": "a", "edge": 1}, {"panel": "b", "edge": 3}]
        whole["pattern"]["stitches"] = [[*ends, *more]]
        mesh = garment.load(whole, spacing=0.05, relax=0)
        first = mesh.groups["a.1"][0]
        return first == mesh.groups["b.3"][0], euler(mesh)
    assert angle([])[1] == angle(["right_wrong"])[1] == 1


def test_a_dart_is_sewn_with_itself():
    corners = [[0, 0], [30, 0], [30, 20], [17, 20], [15, 8], [13, 20], [0, 20]]
    mesh = garment.load(pattern({"p": panel(corners)}, [("p", 3, "p", 4)]), spacing=0.02)
    assert (euler(mesh), rims(mesh)) == (1, 1)
    assert len(mesh.rest) == len(mesh.start) + 7  # the tip has one place, the 7 others of 12.2 cm have two
    assert len(np.intersect1d(mesh.groups["p.3"], mesh.groups["p.4"])) == 8
    weft.load(hung(mesh, [{"group": "p.0"}]))


def test_edges_of_different_length_have_equally_many_parts():
    wide = panel([[0, 0], [40, 0], [40, 10], [0, 10]], translation=[-10, -12, 0])
    mesh = garment.load(pattern({"a": panel(SQUARE), "b": wide}, [("a", 0, "b", 2)]), spacing=0.02)
    assert len(np.intersect1d(mesh.groups["a.0"], mesh.groups["b.2"])) == 21 and euler(mesh) == 1


def shirt():
    """Eight panels as of a shirt in GarmentCode: halves of front and back, fronts and backs of sleeves."""
    neck = {"type": "quadratic", "params": [[0.5, 0.3]]}
    hole = {"type": "cubic", "params": [[0.3, -0.2], [0.65, -0.25]]}
    cap = {"type": "cubic", "params": [[0.3, 0.2], [0.65, 0.25]]}
    front = panel([[0, 0], [26, 0], [26, 26], [18, 43], [8, 46], [0, 35]], {2: hole, 4: neck},
                  translation=[0, 95, 20])
    back = panel([[0, 0], [26, 0], [26, 26], [18, 43], [8, 46], [0, 42]], {2: hole}, translation=[0, 95, -15])
    sleeve = panel([[0, 0], [-30, 0], [-24, -19], [0, -19]], {1: cap}, translation=[52, 115, 12], rotation=[0, 0, -40])
    sleeve["edges"][3]["label"] = "both cuffs"
    left = {"ftorso": front, "btorso": back, "sleeve_f": sleeve, "sleeve_b": {**sleeve, "translation": [52, 115, -10]}}
    panels, stitches = {}, []
    for side, sign in (("left_", 1), ("right_", -1)):
        for name, of in left.items():
            panels[side + name] = {
                **of, "vertices": [[sign * x, y] for x, y in of["vertices"]],
                "translation": [sign * of["translation"][0], *of["translation"][1:]],
                "rotation": [0, 0, sign * of["rotation"][2]],
                "edges": [{**e, "curvature": {**e["curvature"], "params": [[a, sign * b] for a, b in
                                                                          e["curvature"]["params"]]}}
                          if "curvature" in e else e for e in of["edges"]]}
        stitches += [(side + p, i, side + q, j) for p, i, q, j in
                     [("ftorso", 1, "btorso", 1), ("ftorso", 3, "btorso", 3), ("sleeve_f", 0, "sleeve_b", 0),
                      ("sleeve_f", 2, "sleeve_b", 2), ("ftorso", 2, "sleeve_f", 1), ("btorso", 2, "sleeve_b", 1)]]
    stitches += [("left_ftorso", 5, "right_ftorso", 5), ("left_btorso", 5, "right_btorso", 5)]
    return pattern(panels, stitches)


def test_a_shirt_of_eight_panels_has_four_openings_and_runs(tmp_path):
    mesh = garment.load(shirt(), spacing=0.03)
    assert (euler(mesh), rims(mesh)) == (-2, 4)  # neck, hem, two sleeves
    assert mesh.fabric_names == list(shirt()["pattern"]["panels"]) and np.bincount(mesh.fabric_of)[0] == 0
    assert mesh.smallest_angle > 15 and mesh.largest_stretch < 1.3
    cuffs = [mesh.groups["%s_sleeve_%s.3" % (side, half)] for side in ("left", "right") for half in "fb"]
    assert set(mesh.groups["both_cuffs"]) == set(np.concatenate(cuffs))
    scene = hung(mesh, [{"group": "left_ftorso.3"}, {"group": "right_ftorso.3"}])
    sim = weft.load(scene)
    made = [sim.measure().hash for _ in sim.frames()]
    assert list(weft.run(scene, tmp_path / "run").series["hash"]) == made


# ---- meshes ----------------------------------------------------------------------------

def test_narrow_slits_get_smaller_parts():
    slit = [[0, 0], [40, 0], [40, 40], [20.1, 40], [20.1, 7], [19.9, 7], [19.9, 31], [19.9, 40], [0, 40]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", weft.SceneWarning)
        mesh = garment.load(pattern({"p": panel(slit)}), spacing=0.05)
    assert area(mesh) == pytest.approx(0.16 - 0.33 * 0.002, rel=1e-12) and euler(mesh) == 1


def test_small_angles_are_reported():
    with pytest.warns(weft.SceneWarning, match="angles down to 5.7 degrees"):
        garment.load(pattern({"p": panel([[0, 0], [10, 0], [10, 1]])}), spacing=1.0)


def test_a_mesh_at_rest_is_not_moved_by_relaxing():
    mesh = garment.load(pattern({"p": panel(SQUARE, rotation=[10, 20, 30])}), relax=0)
    assert mesh.largest_stretch == pytest.approx(1, abs=1e-12)
    assert np.abs(garment.relaxed(mesh, 20) - mesh.start).max() < 1e-12


# ---- refusals --------------------------------------------------------------------------

def changed(**more):
    return pattern({"p": {**panel(SQUARE), **more}})


@pytest.mark.parametrize("words, given", [
    ("the file has no 'pattern', a mapping", {}),
    ("the pattern has no panels", pattern({})),
    ("panel 'p' has no 'vertices', a list", pattern({"p": {}})),
    ("panel 'p'.vertices is .*, not finite numbers of shape", changed(vertices=[[0, 0], [1, float("nan")]])),
    ("panel 'p'.rotation is .*, not finite numbers of shape", changed(rotation=[1])),
    ("edge 0 goes from vertex 0 to 9; the panel has 0 to 3", changed(edges=[{"endpoints": [0, 9]}])),
    ("edge 1 begins at vertex 2, but the edge before it ends at 1",
     changed(edges=[{"endpoints": [0, 1]}, {"endpoints": [2, 3]}])),
    ("its 2 edges are no closed outline", changed(edges=[{"endpoints": [0, 1]}, {"endpoints": [1, 2]}])),
    ("edge 1 has a curvature of type 'spline'; there are quadratic, cubic and circle",
     pattern({"p": panel(SQUARE, {1: {"type": "spline", "params": []}})})),
    ("edge 1 is an arc of radius 0", pattern({"p": panel(SQUARE, {1: {"type": "circle", "params": [0, 0, 0]}})})),
    ("stitch 0 is of edge 7 of panel 'p', which is not there", pattern({"p": panel(SQUARE)}, [("p", 1, "p", 7)])),
    ("stitch 1 is of edge 1 of panel 'p', as is stitch 0",
     pattern({"p": panel(SQUARE)}, [("p", 1, "p", 3), ("p", 1, "p", 0)])),
    ("cannot be meshed at edge .*: its outline crosses itself",
     pattern({"p": panel([[0, 0], [20, 0], [0, 20], [20, 20]])})),
])
def test_wrong_patterns_are_refused_in_a_sentence(words, given):
    with pytest.raises(ValueError, match="^pattern: .*" + words):
        garment.load(given)


def test_a_file_that_is_no_json_is_named(tmp_path):
    (tmp_path / "a.json").write_text("{")
    with pytest.raises(ValueError, match=r"a\.json: Expecting"):
        garment.load(tmp_path / "a.json")
    with pytest.raises(ValueError, match="a spacing of 0 m is not above 0"):
        garment.load(pattern({"p": panel(SQUARE)}), spacing=0)


SQUARE = [[0, 0], [20, 0], [20, 30], [0, 30]]
TUBE = pattern({"front": panel(SQUARE, {1: [0.5, 0.1], 2: {"type": "quadratic", "params": [[0.5, 0.1]]}}),
                "back": panel(SQUARE, {0: {"type": "circle", "params": [40, 0, 1]}})},
               [("front", 1, "back", 1), ("front", 3, "back", 3)])
WRONG = (None, 0, -1, 1e9, 1e308, 10 ** 400, True, "", "front", [], [[0.5, 1e9]], {}, {"type": "cubic", "params": 3},
         {"type": ["cubic"]}, [0, 1, 2], float("nan"))


def places_in(value, path=()):
    """Paths of keys to every value in lists and mappings."""
    yield path
    if isinstance(value, (list, dict)):
        for key in (range(len(value)) if isinstance(value, list) else value):
            yield from places_in(value[key], (*path, key))


@pytest.mark.parametrize("wrong", range(len(WRONG)))
def test_whatever_stands_in_a_pattern_it_is_a_mesh_or_a_value_error(wrong):
    for path in list(places_in(TUBE))[1:]:
        copy = json.loads(json.dumps(TUBE))
        at = copy
        for key in path[:-1]:
            at = at[key]
        at[path[-1]] = WRONG[wrong]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", weft.SceneWarning)
            try:
                assert isinstance(garment.load(copy, spacing=0.1, relax=1), weft.Mesh)
            except ValueError as error:
                assert str(error).startswith("pattern: ")


def test_a_panel_of_very_many_spacings_is_refused():
    with pytest.raises(ValueError, match="panel 'front' is 300 m large, more than 2000 times the spacing of 0.02 m"):
        garment.load(pattern({"front": panel(SQUARE)}, units_in_meter=0.1))


@pytest.mark.parametrize("comment", ["// front", "/* front */"])
def test_a_comment_in_the_json_is_named(comment, tmp_path):
    file = tmp_path / "tube.json"
    file.write_text('{"pattern": {\n  %s\n "panels": {}}}' % comment)
    with pytest.raises(ValueError, match=r"tube.json: a comment, which JSON does not have: line 2 column 3"):
        garment.load(file)


def test_a_byte_order_mark_does_not_matter(tmp_path):
    file = tmp_path / "tube.json"
    file.write_text(json.dumps(TUBE), encoding="utf-8-sig")
    assert len(garment.load(file, spacing=0.1, relax=0).start) > 0
