# SPDX-License-Identifier: BSD-3-Clause
"""Garments from sewing patterns: load() of the JSON files of GarmentCode and of the dataset of 3D garments before it.

M. Korosteleva, S.-H. Lee: Generating Datasets of 3D Garments with Sewing Patterns, NeurIPS Datasets 2021;
M. Korosteleva, O. Sorkine-Hornung: GarmentCode, ACM Trans. Graph. 42(6), 199, 2023. Needs SciPy."""
from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping
from typing import Any, NamedTuple, Union

import numpy as np

from weft.library import ArgumentError, Array, PathLike, SceneWarning
from weft.mesh import Mesh, as_word

_SMOOTHINGS = 12
_DOUBLINGS = 4
_LARGEST = 1e9  # of numbers of a file
_MOST_ACROSS = 2000  # [spacings] larger panels take minutes
_SMALL_ANGLE = 15.0  # [degrees] below it there is a warning


class _Panel(NamedTuple):
    name: str
    corners: Array
    """(n, 2) [m]"""
    edges: list[Any]
    """(first, last, control points or arc), in the order of the outline"""
    labels: list[str]
    rotation: Array
    translation: Array
    """[m]"""


class _Meshed(NamedTuple):
    points: Array
    """(n, 2) [m]; the outline first"""
    triangles: Any
    """(T, 3), in the direction of the outline"""
    along: list[Any]
    """points along each edge, in its direction"""


# ---- the file -------------------------------------------------------------------------

def _array(value: Any, shape: tuple[int, ...], what: str) -> Array:
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.full(1, np.nan)
    if len(array.shape) != len(shape) or not all(n in (m, -1) for m, n in zip(array.shape, shape)) or \
            not (np.abs(array) <= _LARGEST).all():
        raise ArgumentError("%s is %.60r, not finite numbers of shape %s, at most 1e9" % (what, value, str(shape).replace("-1", "n")))
    return array


def _member(value: Any, key: str, kind: type, what: str) -> Any:
    if not isinstance(value, Mapping) or not isinstance(value.get(key), kind):
        raise ArgumentError("%s has no '%s', a %s" % (what, key, "mapping" if kind is dict else kind.__name__))
    return value[key]


def _optional(value: Mapping[str, Any], key: str, kind: type, what: str) -> Any:
    """A member, or an empty one if it is absent or null."""
    return kind() if value.get(key) is None else _member(value, key, kind, what)


def _curve(of: Any, a: Array, b: Array, relative: bool, unit: float, what: str) -> Any:
    """Control points of an edge, or the radius of an arc and its two flags."""
    if of is None:
        return np.empty((0, 2))
    if not isinstance(of, (list, tuple, Mapping)):
        raise ArgumentError("%s has the curvature %.60r, not a point or a mapping" % (what, of))
    kind, values = ("quadratic", [of]) if isinstance(of, (list, tuple)) else (of.get("type"), of.get("params"))
    if kind == "circle":
        radius, large, left = _array(values, (3,), what + ".curvature.params")
        if not radius > 0 or (a == b).all():
            raise ArgumentError("%s is an arc of radius %g from %s to %s" % (what, radius, a.tolist(), b.tolist()))
        return float(radius) * unit, bool(large), bool(left)
    count = {"quadratic": 1, "cubic": 2}.get(kind) if isinstance(kind, str) else None
    if count is None:
        raise ArgumentError("%s has a curvature of type %.60r; there are quadratic, cubic and circle" % (what, kind))
    at = _array(values, (count, 2), what + ".curvature")
    along = b - a
    across = np.array([-along[1], along[0]])
    return a + at[:, :1] * along + at[:, 1:] * across if relative else at * unit


def _units(properties: Mapping[str, Any]) -> float:
    units = properties.get("units_in_meter", 100)
    if isinstance(units, bool) or not isinstance(units, (int, float)) or not 1e-6 <= units <= 1e6:
        raise ArgumentError("units_in_meter is %.60r, not a number from 1e-6 to 1e6" % (units,))
    return float(units)


def _read_panel(name: str, of: Any, properties: Mapping[str, Any]) -> _Panel:
    what = "panel '%s'" % name
    unit = 1.0 / _units(properties)
    corners = _array(_member(of, "vertices", list, what), (-1, 2), what + ".vertices") * unit
    edges, labels = [], []
    before = None
    listed = _member(of, "edges", list, what)
    for k, edge in enumerate(listed):
        place = "%s, edge %d" % (what, k)
        ends = _member(edge, "endpoints", list, place)
        if len(ends) != 2:
            raise ArgumentError("%s has the endpoints %.60r, not two" % (place, ends))
        first, last = ends
        if not all(type(end) is int and 0 <= end < len(corners) for end in ends) or first == last:
            raise ArgumentError("%s goes from vertex %r to %r; the panel has 0 to %d" % (place, first, last,
                                                                                     len(corners) - 1))
        if before not in (None, first):
            raise ArgumentError("%s begins at vertex %d, but the edge before it ends at %d" % (place, first, before))
        relative = properties.get("curvature_coords", "relative") != "absolute"
        edges.append((first, last, _curve(edge.get("curvature"), corners[first], corners[last], relative, unit, place)))
        labels.append(str(edge.get("label") or ""))
        before = last
    if len(edges) < 2 or edges[0][0] != before:
        raise ArgumentError("%s: its %d edges are no closed outline" % (what, len(edges)))
    translation = _array(of.get("translation", [0, 0, 0]), (3,), what + ".translation") * unit
    if properties.get("normalize_panel_translation", False):
        middle = corners.mean(axis=0)
        corners, translation = corners - middle, translation + [*middle, 0.0]
        edges = [(a, b, c if isinstance(c, tuple) else c - middle) for a, b, c in edges]
    x, y, z = np.radians(_array(of.get("rotation", [0, 0, 0]), (3,), what + ".rotation"))
    return _Panel(name, corners, edges, labels, _turn(2, z) @ _turn(1, y) @ _turn(0, x), translation)


def _turn(axis: int, angle: float) -> Array:
    turn, (i, j) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
    turn[[i, j], [i, j]] = np.cos(angle)
    turn[j, i] = np.sin(angle)
    turn[i, j] = -turn[j, i]
    return turn


# ---- edges ----------------------------------------------------------------------------

def _points(panel: _Panel, edge: int, t: Array) -> Array:
    """Of an edge, at t from 0 to 1."""
    first, last, curve = panel.edges[edge]
    a, b = panel.corners[first], panel.corners[last]
    if isinstance(curve, tuple):
        radius, large, left = curve
        half = 0.5 * (b - a)
        away = np.sqrt(max(radius * radius / (half @ half) - 1.0, 0.0)) * (1.0 if left != large else -1.0)
        centre = a + half + away * np.array([-half[1], half[0]])
        begin, end = (np.arctan2(p[1], p[0]) for p in (a - centre, b - centre))
        turn = (end - begin) % (2 * np.pi) - (0.0 if left else 2 * np.pi)
        angle = begin + t * turn
        points = centre + np.linalg.norm(a - centre) * np.c_[np.cos(angle), np.sin(angle)]
    else:
        points = np.tile(np.concatenate(([a], curve, [b]))[:, None], (1, len(t), 1))
        while len(points) > 1:  # de Casteljau
            points = points[:-1] + t[:, None] * (points[1:] - points[:-1])
        points = points[0]
    points[t == 0.0], points[t == 1.0] = a, b
    return np.asarray(points)


def _divided(panel: _Panel, edge: int, parts: int) -> Array:
    """Points that divide an edge into parts of one length."""
    fine = np.linspace(0.0, 1.0, 2049)
    length = np.r_[0.0, np.linalg.norm(np.diff(_points(panel, edge, fine), axis=0), axis=1).cumsum()]
    t = np.interp(np.linspace(0.0, length[-1], parts + 1), length, fine)
    t[0], t[-1] = 0.0, 1.0
    return _points(panel, edge, t)


def _length(panel: _Panel, edge: int) -> float:
    return float(np.linalg.norm(np.diff(_points(panel, edge, np.linspace(0.0, 1.0, 2049)), axis=0), axis=1).sum())


# ---- panels ---------------------------------------------------------------------------

def _inside(outline: Array, points: Array) -> Any:
    """Whether points are in a polygon."""
    a, b = outline, np.roll(outline, -1, axis=0)
    found = np.zeros(len(points), dtype=np.bool_)
    for first in range(0, len(points), 4096):
        x, y = points[first:first + 4096, :1], points[first:first + 4096, 1:]
        crosses = (a[:, 1] > y) != (b[:, 1] > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = a[:, 0] + (y - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
        found[first:first + 4096] = (crosses & (x < at)).sum(axis=1) % 2 == 1
    return found


def _area(x: Array) -> Any:
    """Twice the area of triangles (T, 3, 2)."""
    a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _delaunay(outline: Array, points: Array) -> Any:
    """Triangles inside the outline, whose points come first; counterclockwise."""
    from scipy.spatial import Delaunay
    triangles = Delaunay(points).simplices.astype(np.intp)
    area = _area(points[triangles])
    scale = float(np.ptp(points, axis=0).max()) ** 2
    triangles, area = triangles[np.abs(area) > 1e-13 * scale], area[np.abs(area) > 1e-13 * scale]
    triangles[area < 0] = triangles[area < 0][:, ::-1]
    return triangles[_inside(outline, points[triangles].mean(axis=1))]


def _rim(triangles: Any) -> Any:
    """Edges that one triangle has, as pairs of points; sorted."""
    pairs = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    found, count = np.unique(pairs, axis=0, return_counts=True)
    return found[count == 1]


def _mesh_panel(outline: Array, spacing: float) -> tuple[Array, Any, Any]:
    """Points and triangles of an outline, and the parts of it (each from its point on) that no triangle has."""
    from scipy.spatial import cKDTree
    low, high = outline.min(axis=0), outline.max(axis=0)
    rows, cols = np.ceil((high - low)[::-1] / [spacing * np.sqrt(0.75), spacing]).astype(int) + 2
    r, c = np.mgrid[0:rows, 0:cols]
    lattice = low + spacing * np.c_[(c + 0.5 * (r % 2)).ravel() - 0.5, np.sqrt(0.75) * r.ravel()]
    fine = np.concatenate([outline + f * (np.roll(outline, -1, axis=0) - outline) for f in (0, 0.25, 0.5, 0.75)])
    rim = cKDTree(fine)
    inner = lattice[_inside(outline, lattice)]
    inner = inner[rim.query(inner)[0] > 0.6 * spacing] if len(inner) > 0 else inner
    triangles = _delaunay(outline, np.concatenate((outline, inner)))
    for _ in range(_SMOOTHINGS):
        points, old = np.concatenate((outline, inner)), inner
        corner, n = triangles.ravel(), len(points)
        middle = points[triangles].mean(axis=1)
        weight = np.repeat(np.abs(_area(points[triangles])), 3)
        total = np.bincount(corner, weight, n)[len(outline):]
        moved = np.stack([np.bincount(corner, weight * np.repeat(middle[:, k], 3), n)[len(outline):] for k in (0, 1)], 1)
        inner = np.where(total[:, None] > 0, moved / np.where(total > 0, total, 1.0)[:, None], inner)
        if len(inner) > 0:
            inner = np.where((rim.query(inner)[0] > 0.45 * spacing)[:, None], inner, old)
        triangles = _delaunay(outline, np.concatenate((outline, inner)))
    points = np.concatenate((outline, inner))
    n = len(outline)
    part = np.sort(np.c_[np.arange(n), (np.arange(n) + 1) % n], axis=1)
    keys = part[:, 0] * len(points) + part[:, 1]
    found = _rim(triangles) @ [len(points), 1]
    missing = np.flatnonzero(~np.isin(keys, found))
    if len(missing) == 0 and len(found) != n:
        missing = np.arange(n)
    return points, triangles, missing


def _outline(panel: _Panel, parts: list[int]) -> tuple[Array, list[Any]]:
    """Its points, and their numbers along each edge."""
    points, along, count = [], [], sum(parts)
    for k, n in enumerate(parts):
        first = sum(parts[:k])
        points.append(_divided(panel, k, n)[:-1])
        along.append((first + np.arange(n + 1)) % count)
    return np.concatenate(points), along


# ---- stitches -------------------------------------------------------------------------

Side = tuple[str, int]


def _read_stitches(pattern: Mapping[str, Any], panels: Mapping[str, _Panel]) -> list[tuple[Side, Side, bool]]:
    """Two edges each, and whether they run in one direction if nothing else decides."""
    found: list[tuple[Side, Side, bool]] = []
    used: dict[Side, int] = {}
    stitches = pattern.get("stitches")
    for i, stitch in enumerate(stitches if isinstance(stitches, tuple)
                               else _optional(pattern, "stitches", list, "the pattern")):
        what = "stitch %d" % i
        if not isinstance(stitch, list) or len(stitch) < 2:
            raise ArgumentError("%s is %.60r, not a list of two edges" % (what, stitch))
        sides = []
        for side in stitch[:2]:
            panel, edge = _member(side, "panel", str, what), _member(side, "edge", int, what)
            if panel not in panels or not 0 <= edge < len(panels[panel].edges):
                raise ArgumentError("%s is of edge %d of panel '%s', which is not there" % (what, edge, panel))
            if (panel, edge) in used:
                raise ArgumentError("%s is of edge %d of panel '%s', as is stitch %d" % (what, edge, panel,
                                                                                     used[panel, edge]))
            used[panel, edge] = i
            sides.append((panel, edge))
        found.append((sides[0], sides[1], "right_wrong" in stitch[2:]))
    return found


def _directions(panels: Mapping[str, _Panel], stitches: list[Any]) -> tuple[list[bool], dict[str, bool]]:
    """Whether the two edges of each stitch run in one direction, and which panels are turned over, so that the cloth
    has two sides. A stitch is not twisted if its ends are nearer to each other, as the panels are placed, than if one
    edge were reversed. Stitches for which that is clearest decide first; later ones that join what is joined already
    follow."""
    def ends(side: Side) -> Array:
        panel = panels[side[0]]
        first, last, _ = panel.edges[side[1]]
        placed: Array = np.c_[panel.corners[[first, last]], [0.0, 0.0]] @ panel.rotation.T + panel.translation
        return placed

    votes = []
    for one, other, declared in stitches:
        a, b = ends(one), ends(other)
        same, reverse = (float(np.linalg.norm(a - c, axis=1).sum()) for c in (b, b[::-1]))
        length = float(np.linalg.norm(a[1] - a[0]) + np.linalg.norm(b[1] - b[0]))
        clear = abs(same - reverse) / length if length > 0 else 0.0
        votes.append((clear, same < reverse if clear > 1e-3 else declared))
    above = {name: (name, False) for name in panels}  # another panel, and whether turned over against it

    def root(name: str) -> tuple[str, bool]:
        turned = False
        while above[name][0] != name:
            name, more = above[name]
            turned ^= more
        return name, turned

    directions = [False] * len(stitches)
    for i in sorted(range(len(stitches)), key=lambda i: -votes[i][0]):
        (p, _), (q, _), _ = stitches[i]
        (top, turned), (bottom, over) = root(p), root(q)
        if top == bottom:
            directions[i] = turned != over
            if p != q and directions[i] != votes[i][1] and votes[i][0] > 0.5:
                warnings.warn("stitch %d of panels '%s' and '%s' is twisted: without it the cloth would have one side"
                              % (i, p, q), SceneWarning, stacklevel=4)
        else:
            directions[i] = votes[i][1]
            above[bottom] = (top, turned ^ over ^ directions[i])
    return directions, {name: root(name)[1] for name in panels}


def _joined(count: int, pairs: Any) -> Any:
    """The lowest of the vertices that pairs join each one to."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    return np.unique(label, return_index=True, return_inverse=True)[1:]


# ---- the start ------------------------------------------------------------------------

def _turn_of(stretch: Array) -> Array:
    """F (F^T F)^(-1/2) of each F (T, 3, 2): the nearest one that keeps lengths."""
    square = stretch.transpose(0, 2, 1) @ stretch
    a, b, c = square[:, 0, 0], square[:, 0, 1], square[:, 1, 1]
    root = np.sqrt(np.maximum(a * c - b * b, 1e-12 * (a + c) ** 2))  # a triangle that is a line has no nearest one
    inverse = np.array([[c + root, -b], [-b, a + root]]) / (root * np.sqrt(a + c + 2 * root))
    turn: Array = stretch @ inverse.transpose(2, 0, 1)
    return turn


def relaxed(mesh: Mesh, rounds: int) -> Array:
    """Computes start positions that are nearer to the lengths of the rest shape.

    `rounds` times, each triangle takes its rest shape, turned as it lies, and vertices the positions that fit these
    best (as rigid as possible: O. Sorkine, M. Alexa, SGP 2007). Neither bending nor bodies count. Needs SciPy.

    Parameters
    ----------
    mesh : Mesh
        Its `start` is where the first round begins.
    rounds : int
        How often; 0: none.

    Returns
    -------
    ndarray, shape (N, 3)
        [m]

    Examples
    --------
    >>> stretched = weft.Mesh([[0, 0], [1, 0], [0, 1]], [[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> x = weft.garment.relaxed(stretched, 1)
    >>> round(float(np.linalg.norm(x[1] - x[0])), 3)
    1.0
    """
    from scipy.sparse import coo_matrix, identity
    from scipy.sparse.linalg import splu
    x: Array = mesh.start.copy()
    if rounds < 1 or "rest" in mesh.keys:
        return x
    corner, rest = mesh.triangles.astype(np.intp), mesh.rest[mesh.corner_uv]
    sides = np.stack((rest[:, 1] - rest[:, 0], rest[:, 2] - rest[:, 0]), axis=2)
    flat = np.flatnonzero(np.linalg.det(sides) == 0.0)
    if len(flat) > 0:
        raise ArgumentError("triangle %d has no area at rest" % flat[0])
    inverse = np.linalg.inv(sides)
    slope = np.stack((-inverse.sum(axis=1), inverse[:, 0], inverse[:, 1]), axis=1)  # (T, 3, 2) of each corner
    area = 0.5 * np.abs(np.linalg.det(sides))
    values = area[:, None, None] * (slope @ slope.transpose(0, 2, 1))
    rows, cols = np.repeat(corner, 3, axis=1).ravel(), np.tile(corner, (1, 3)).ravel()
    matrix = coo_matrix((values.ravel(), (rows, cols)), shape=(len(x), len(x))).tocsc()
    hold = 1e-4 * matrix.diagonal().mean()
    solver = splu((matrix + hold * identity(len(x), format="csc")).tocsc())
    for _ in range(rounds):
        stretch = x[corner].transpose(0, 2, 1) @ slope
        force = area[:, None, None] * (slope @ _turn_of(stretch).transpose(0, 2, 1))
        right = np.stack([np.bincount(corner.ravel(), force[..., k].ravel(), len(x)) for k in range(3)], axis=1)
        x = solver.solve(right + hold * x)
    if not np.isfinite(x).all():
        raise ArgumentError("the pattern cannot be relaxed: positions of its vertices are not finite after %d rounds" % rounds)
    return x


# ---- the garment ----------------------------------------------------------------------

def _mesh_panels(panels: Mapping[str, _Panel], stitches: list[Any], spacing: float) -> dict[str, _Meshed]:
    for name, panel in panels.items():
        size = float(np.ptp(np.concatenate([panel.corners, *(c for _, _, c in panel.edges if not isinstance(c, tuple))]),
                            axis=0).max())
        size = max([size, *(c[0] for _, _, c in panel.edges if isinstance(c, tuple))])
        if not size <= _MOST_ACROSS * spacing:
            raise ArgumentError("panel '%s' is %.3g m large, more than %d times the spacing of %g m: is units_in_meter right?"
                             % (name, size, _MOST_ACROSS, spacing))
    parts = {(name, k): max(1, int(np.ceil(_length(panel, k) / spacing - 1e-9)))
             for name, panel in panels.items() for k in range(len(panel.edges))}
    partner = {a: b for one, other, _ in stitches for a, b in ((one, other), (other, one))}
    for side, other in partner.items():
        parts[side] = parts[other] = max(parts[side], parts[other])
    meshed: dict[str, _Meshed] = {}
    todo = set(panels)
    for attempt in range(_DOUBLINGS + 1):
        finer: set[Side] = set()
        for name in sorted(todo):
            panel = panels[name]
            outline, along = _outline(panel, [parts[name, k] for k in range(len(panel.edges))])
            points, triangles, missing = _mesh_panel(outline, spacing)
            around = float((outline[:, 0] * np.roll(outline[:, 1], -1) - outline[:, 1]
                            * np.roll(outline[:, 0], -1)).sum())
            meshed[name] = _Meshed(points, triangles if around > 0 else triangles[:, ::-1], along)
            finer.update((name, k) for k in range(len(along)) if np.isin(along[k][:-1], missing).any())
        if not finer:
            return meshed
        finer |= {partner[side] for side in finer if side in partner}
        for side in finer:
            parts[side] *= 2
        todo = {name for name, _ in finer}
    name, k = min(finer)
    raise ArgumentError("panel '%s' cannot be meshed at edge %d with a spacing of %g m: its outline crosses itself, or is "
                     "narrower than a hundredth of that" % (name, k, spacing))


def load(pattern: Union[PathLike, Mapping[str, Any]], *, spacing: float = 0.02, relax: int = 100) -> Mesh:
    """Makes a garment from a sewing pattern of GarmentCode.

    Stitched edges have equally many vertices, which they share; each side has its own UV coordinates in the rest shape, where
    panels lie side by side, u along their x, v along their y. The directions of stitches, which a file does not have,
    are those that do not twist. Panels are placed as in the file, sewn vertices at the mean of their places, and then
    relaxed(); no body keeps them apart. Fabrics and groups are named by panels. Labels of edges are groups, too, and
    edge k of a panel is PANEL.k.

    Parameters
    ----------
    pattern : path or dict
        A JSON file, or what is in it.
    spacing : float
        [m], of the edges of triangles.
    relax : int
        Rounds of relaxed().

    Returns
    -------
    Mesh
        For `cloth.mesh`.

    Raises
    ------
    ArgumentError
        The pattern is wrong: the message says what, and where.
    FileNotFoundError
        The file is not there.

    Warns
    -----
    SceneWarning
        Angles are below 15 degrees.

    Examples
    --------
    >>> square = {"vertices": [[0, 0], [20, 0], [20, 30], [0, 30]],
    ...           "edges": [{"endpoints": [k, (k + 1) % 4]} for k in range(4)]}
    >>> sides = [[{"panel": "front", "edge": k}, {"panel": "back", "edge": k}] for k in (1, 3)]
    >>> tube = {"pattern": {"panels": {"front": {**square, "translation": [0, 0, 5]}, "back": square},
    ...                     "stitches": sides}}
    >>> weft.garment.load(tube, spacing=0.05).groups["front.1"].shape
    (7,)
    """
    name = "pattern" if isinstance(pattern, Mapping) else os.fspath(pattern)
    try:
        if isinstance(pattern, Mapping):
            return _load(pattern, spacing, relax)
        with open(pattern, encoding="utf-8-sig") as file:
            return _load(json.load(file), spacing, relax)
    except json.JSONDecodeError as error:
        if error.doc[error.pos:error.pos + 2] in ("//", "/*"):
            raise ArgumentError("%s: a comment, which JSON does not have: line %d column %d"
                             % (name, error.lineno, error.colno)) from None
        raise ArgumentError("%s: %s" % (name, error)) from None
    except RecursionError:
        raise ArgumentError("%s: lists or mappings are nested too deeply" % name) from None
    except ValueError as error:
        raise ArgumentError("%s: %s" % (name, error)) from None


def _load(content: Any, spacing: float, relax: int) -> Mesh:
    if not spacing > 0:
        raise ArgumentError("a spacing of %r m is not above 0" % (spacing,))
    of = _member(content, "pattern", dict, "the file")
    properties = _optional(content, "properties", dict, "the file")
    panels = {name: _read_panel(name, panel, properties)
              for name, panel in _member(of, "panels", dict, "the pattern").items()}
    if not panels:
        raise ArgumentError("the pattern has no panels")
    stitches = _read_stitches(of, panels)
    directions, turned = _directions(panels, stitches)
    meshed = _mesh_panels(panels, stitches, spacing)
    order = list(panels)
    base = dict(zip(order, np.cumsum([0] + [len(meshed[name].points) for name in order])))
    rest, start, places, left = [], [], [], 0.0
    for name in order:
        panel, (points, triangles, _) = panels[name], meshed[name]
        low = points.min(axis=0)
        rest.append(points + [left - low[0], 0.0])
        left += float(np.ptp(points[:, 0])) + 2 * spacing
        start.append(np.c_[points, np.zeros(len(points))] @ panel.rotation.T + panel.translation)
        places.append(base[name] + (triangles[:, ::-1] if turned[name] else triangles))
    pairs = [np.empty((0, 2), dtype=np.intp)]
    for ((p, i), (q, j), _), same in zip(stitches, directions):
        a, b = base[p] + meshed[p].along[i], base[q] + meshed[q].along[j]
        pairs.append(np.c_[a, b if same else b[::-1]])
    x = np.concatenate(start)
    first, vertex = _joined(len(x), np.concatenate(pairs))
    count = np.bincount(vertex)
    x = np.stack([np.bincount(vertex, x[:, k]) / count for k in range(3)], axis=1)
    sizes = [len(part) for part in places]
    groups: dict[str, Any] = {}
    for name in order:
        _add(groups, name, vertex[base[name] + np.arange(len(meshed[name].points))])
        for k, along in enumerate(meshed[name].along):
            _add(groups, "%s.%d" % (name, k), vertex[base[name] + along])
            if panels[name].labels[k]:
                _add(groups, panels[name].labels[k], vertex[base[name] + along])
    corners = np.concatenate(places)
    fabrics = {as_word(name): np.arange(sum(sizes[:k]), sum(sizes[:k + 1])) for k, name in enumerate(order)}
    mesh = Mesh(np.concatenate(rest), x, vertex[corners], corner_uv=corners, fabrics=fabrics, groups=groups)
    if mesh.smallest_angle < _SMALL_ANGLE:
        warnings.warn("triangles of the panels have angles down to %.1f degrees" % mesh.smallest_angle, SceneWarning,
                      stacklevel=4)
    return mesh if relax < 1 else Mesh(mesh.rest, relaxed(mesh, relax), mesh.triangles, corner_uv=mesh.corner_uv,
                                       fabrics=fabrics, groups=groups)


def _add(groups: dict[str, Any], name: str, vertices: Any) -> None:
    groups[as_word(name)] = np.union1d(groups.get(as_word(name), np.empty(0, dtype=np.intp)), vertices)
