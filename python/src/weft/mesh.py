# SPDX-License-Identifier: BSD-3-Clause
"""Triangles of fabric from arrays: Mesh."""
from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, Optional

import numpy as np

from weft.library import (ArgumentError, ArgumentIndexError, ArgumentTypeError, Array, Fixed, MissingKeyError, PathLike,
                          SceneWarning, deprecated, real, renamed)

Indices = np.ndarray[Any, np.dtype[np.uint32]]

_FLAT = 1e-3  # of its extent: a surface that leaves its plane by less is flat,
_ROUNDED = 1e-6  # and by less than this without a warning


# ---- arrays ---------------------------------------------------------------------------

def _array(value: Any, name: str) -> Any:
    if np.ma.is_masked(value):
        raise ArgumentError("%s has masked elements" % name)
    try:
        return np.asarray(value)
    except ValueError:
        raise ArgumentError("%s has rows of different lengths" % name) from None


def _numbers(value: Any, name: str, columns: int) -> Array:
    """A copy (n, columns) of finite numbers. Zeros lose their sign, as in an OBJ file."""
    array = _array(value, name)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ArgumentError("%s has the shape %s, not (n, %d)" % (name, array.shape, columns))
    found = np.array(real(array, name, array.shape)) + 0.0
    bad = np.flatnonzero(~np.isfinite(found).all(axis=1))
    if len(bad) > 0:
        raise ArgumentError("%s[%d] is %s, not finite%s" % (name, bad[0], found[bad[0]].tolist(), _first_of(len(bad))))
    return found


def _first_of(count: int) -> str:
    return ", the first of %d" % count if count > 1 else ""


def _integers(value: Any, name: str, limit: int, of: str) -> np.ndarray[Any, np.dtype[np.intp]]:
    """A copy of indices below a limit, of which there are so many."""
    array = _array(value, name)
    if array.size > 0 and array.dtype.kind not in "iu":
        raise ArgumentTypeError("%s consists of integers, not of %s" % (name, array.dtype.name))
    bad = np.argwhere((array < 0) | (array >= limit))
    if len(bad) > 0:
        at = "".join("[%d]" % k for k in bad[0])
        raise ArgumentIndexError("%s%s is %d, but there are %d %s: 0 to %d%s"
                         % (name, at, array[tuple(bad[0])], limit, of, limit - 1, _first_of(len(bad))))
    return np.array(array, dtype=np.intp, order="C")


def _corners(value: Any, name: str, rows: Optional[int], limit: int, of: str) -> Indices:
    array = _array(value, name)
    if array.ndim != 2 or array.shape[1] != 3 or array.shape[0] != (array.shape[0] if rows is None else rows):
        raise ArgumentError("%s has the shape %s, not (%s, 3)" % (name, array.shape, "T" if rows is None else rows))
    return _integers(array, name, limit, of).astype(np.uint32)


def _members(value: Any, name: str, count: int, of: str) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Indices, each once and in order, from a list of them or from `count` flags."""
    array = _array(value, name)
    if array.dtype.kind == "b":
        if array.shape != (count,):
            raise ArgumentError("%s has %s flags, but there are %d %s" % (name, array.shape, count, of))
        return np.flatnonzero(array)
    if array.ndim != 1:
        raise ArgumentError("%s has the shape %s, not (n,)" % (name, array.shape))
    return np.unique(_integers(array, name, count, of))


def as_word(name: str) -> str:
    """A name with _ for what an OBJ file cannot hold in one."""
    return re.sub(r"[\s\x00#\\]+", "_", name) or "_"


def _word(name: Any, what: str) -> str:
    """A name that an OBJ file can hold."""
    if not isinstance(name, str) or not re.fullmatch(r"[^\s\x00#\\]+", name):
        raise ArgumentError("%s is named by one word without blanks, # or \\, not by %r" % (what, name))
    return name


def _read_only(array: Any) -> Any:
    array.flags.writeable = False
    return array


def _places_of(corners: Array, triangles: Indices) -> tuple[Array, Indices]:
    """Places and their numbers from (T, 3, 2) corners: a vertex has one for each different u v."""
    vertex, uv = triangles.ravel().astype(np.intp), corners.reshape(-1, 2)
    one = np.zeros((int(vertex.max()) + 1, 2))  # of each vertex
    one[vertex] = uv
    several = np.zeros(len(one), dtype=np.bool_)
    several[vertex[(uv != one[vertex]).any(axis=1)]] = True
    number = np.cumsum(~several) - 1
    places = number[vertex]
    rows = np.flatnonzero(several[vertex])
    if len(rows) == 0:
        return one, places.astype(np.uint32).reshape(-1, 3)
    rows = rows[np.lexsort((uv[rows, 1], uv[rows, 0], vertex[rows]))]
    new = np.r_[True, (vertex[rows[1:]] != vertex[rows[:-1]]) | (uv[rows[1:]] != uv[rows[:-1]]).any(axis=1)]
    places[rows] = number[-1] + np.cumsum(new)
    return np.concatenate((one[~several], uv[rows[new]])), places.astype(np.uint32).reshape(-1, 3)


def _keys_of(in_space: bool, angle: Optional[str], warp: Any) -> dict[str, Any]:
    """What `cloth.mesh` says of a mesh beside its file."""
    keys: dict[str, Any] = {"rest": "start"} if in_space else {}
    if angle not in (None, "flat", "start"):
        raise ArgumentError("angle is 'flat' or 'start', not %r" % (angle,))
    if warp is not None and not in_space:
        raise ArgumentError("warp is given, but the warp of a rest shape in the plane is v: it goes with rest='start'")
    if angle is not None:
        keys["angle"] = angle
    if warp is not None:
        direction = _numbers([_array(warp, "warp")], "warp", 3)[0]
        if not direction.any():
            raise ArgumentError("warp is [0, 0, 0], not a direction")
        keys["warp"] = direction.tolist()
    return keys


class Mesh(Fixed):
    """Triangles of fabric: where their vertices start, and their rest shape in the plane or in space.

    It stands in a scene, a dict, as `cloth.mesh`, for load(), Batch, run() and all others. Its arrays are copies, and
    read-only. Triangles that share vertices but not their UV coordinates are sewn there.

    Parameters
    ----------
    rest : array, shape (N, 2), (T, 3, 2) or (P, 2), or "start"
        [m] u (along the weft), v (along the warp) of the vertices, of the corners of the triangles, or of P points to
        which `corner_uv` refers; "start": the start shape in space is the rest shape.
    start : array, shape (N, 3), or None
        [m] at t = 0; None: u, v, 0.
    triangles : array, shape (T, 3)
        Vertices, in one order all over a panel.
    corner_uv : array, shape (T, 3), optional
        The row of `rest` of each corner, if rest has shape (P, 2).
    fabrics : dict or list, optional
        {NAME: triangles}, indices or flags, or a list of T names (None: no name), for `cloth.fabrics`.
    groups : dict, optional
        {NAME: vertices}, indices or flags, for pins and loads.
    places : array, optional
        Deprecated: `corner_uv`.
    angle : str, optional
        "flat": the cloth wants to be flat; "start": it is free of bending in the start shape. None: "start" with
        rest="start", else "flat".
    warp : array, shape (3,), optional
        With rest="start": the direction of the warp, projected into each triangle; None: alike in all directions.

    Raises
    ------
    ArgumentError, ArgumentTypeError, ArgumentIndexError
        An array has another shape, kind or range.

    Examples
    --------
    >>> mesh = weft.Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], None, [[0, 1, 2], [0, 2, 3]], groups={"top": [2, 3]})
    >>> cloth = {"mesh": mesh, "fabric": {"preset": "11oz-black-denim"}, "pins": [{"group": "top"}]}
    >>> weft.load({**scene, "cloth": cloth}).positions.shape
    (4, 3)
    """

    __slots__ = {"start": "(N, 3) [m], positions at t = 0.", "triangles": "(T, 3), vertices.",
                 "rest": "(P, 2) [m], UV coordinates; (0, 2) in space.",
                 "corner_uv": "(T, 3), the row of rest of each corner; (0, 3) in space.",
                 "keys": "What `cloth.mesh` has beside the file: rest, angle, warp.",
                 "fabric_names": "Names of fabrics.", "fabric_of": "(T,), the fabric k - 1 of fabric_names, or 0 without a name.",
                 "groups": "Vertices by names."}

    def __init__(self, rest: Any, start: Any, triangles: Any, *, corner_uv: Any = None, fabrics: Any = None,
                 groups: Optional[Mapping[str, Any]] = None, places: Any = None, angle: Optional[str] = None,
                 warp: Any = None) -> None:
        if places is not None:
            deprecated("Mesh(places=)", "corner_uv=")
            corner_uv = places
        in_space = isinstance(rest, str)
        if in_space and (rest != "start" or corner_uv is not None or start is None):
            raise ArgumentError("rest is %r with %s: as a word it is 'start', with a start and without corner_uv"
                                % (rest, "no start" if start is None else "a start" if corner_uv is None else "corner_uv"))
        self.keys: dict[str, Any] = _keys_of(in_space, angle, warp)
        rest = _array(np.zeros((0, 2)) if in_space else rest, "rest")
        shape = rest.shape
        uv = _numbers(rest.reshape(-1, 2) if len(shape) == 3 and shape[1:] == (3, 2) else rest, "rest", 2)
        if start is None:
            if len(shape) == 3 or corner_uv is not None:
                raise ArgumentError("start is None, but rest is not by vertices")
            start = np.c_[uv, np.zeros(len(uv))]
        self.start: Array = _numbers(start, "start", 3)
        count = len(self.start)
        self.triangles: Indices = _corners(triangles, "triangles", None, count, "vertices")
        if len(self.triangles) == 0:
            raise ArgumentError("a mesh has a triangle or more, not 0")
        self.rest: Array
        self.corner_uv: Indices
        if in_space:
            self.rest, self.corner_uv = uv, np.zeros((0, 3), dtype=np.uint32)
        elif len(shape) == 3:
            if corner_uv is not None:
                raise ArgumentError("rest has values per corner, and corner_uv is given, too")
            if shape[0] != len(self.triangles):
                raise ArgumentError("rest has the shape %s, but there are %d triangles" % (shape, len(self.triangles)))
            self.rest, self.corner_uv = _places_of(uv.reshape(-1, 3, 2), self.triangles)
        elif corner_uv is None:
            if len(uv) != count:
                raise ArgumentError("rest has %d rows and start %d: without corner_uv, both have one row per vertex"
                                 % (len(uv), count))
            self.rest, self.corner_uv = uv, self.triangles
        else:
            self.rest, self.corner_uv = uv, _corners(corner_uv, "corner_uv", len(self.triangles), len(uv), "rows of rest")
        used = np.bincount(self.triangles.ravel(), minlength=count)
        unused = np.flatnonzero(used == 0)
        if len(unused) > 0:
            raise ArgumentError("vertex %d is in no triangle%s" % (unused[0], _first_of(len(unused))))
        self.fabric_names: list[str]
        self.fabric_of: Indices
        self.fabric_names, self.fabric_of = self._fabrics(fabrics)
        if not isinstance(groups, (Mapping, type(None))):
            raise ArgumentTypeError("groups are {NAME: vertices}, not a %s" % type(groups).__name__)
        self.groups: dict[str, Any] = {
            _word(name, "a group"): _read_only(_members(of, "group '%s'" % name, count, "vertices"))
            for name, of in (groups or {}).items()}
        for array in (self.start, self.rest, self.triangles, self.corner_uv, self.fabric_of):
            _read_only(array)

    def _fabrics(self, fabrics: Any) -> tuple[list[str], Indices]:
        of = np.zeros(len(self.triangles), dtype=np.uint32)
        if fabrics is None:
            return [], of
        if not isinstance(fabrics, Iterable):
            raise ArgumentTypeError("fabrics are {NAME: triangles} or a list of names, not a %s" % type(fabrics).__name__)
        if not isinstance(fabrics, Mapping):
            array = np.asarray(fabrics if isinstance(fabrics, np.ndarray) and fabrics.dtype.kind == "U"
                               else [name or "" for name in fabrics], dtype=np.str_)
            if array.shape != of.shape:
                raise ArgumentError("fabrics has %s names, but there are %d triangles" % (array.shape, len(of)))
            names, inverse = np.unique(array, return_inverse=True)
            fabrics = {str(name): inverse == k for k, name in enumerate(names) if name}
        for k, (name, triangles) in enumerate(fabrics.items()):
            of[_members(triangles, "fabric '%s'" % _word(name, "a fabric"), len(of), "triangles")] = k + 1
        return list(fabrics), of

    def __repr__(self) -> str:
        return "<weft.Mesh: %d vertices, %d triangles>" % (len(self.start), len(self.triangles))

    def __reduce__(self) -> Any:
        return _again, (self.rest, self.start, self.triangles, self.corner_uv, self._fabric_flags(), self.groups, self.keys)

    def _fabric_flags(self) -> dict[str, Any]:
        return {name: self.fabric_of == k + 1 for k, name in enumerate(self.fabric_names)}

    places = renamed("places", "corner_uv")

    @property
    def smallest_angle(self) -> float:
        """[degrees], of all triangles at rest."""
        x = self.start[self.triangles] if "rest" in self.keys else self.rest[self.corner_uv]
        a, b = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
        cross = np.sqrt(np.maximum((a * a).sum(axis=2) * (b * b).sum(axis=2) - (a * b).sum(axis=2) ** 2, 0.0)) \
            if "rest" in self.keys else np.abs(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
        return float(np.degrees(np.arctan2(cross, (a * b).sum(axis=2)).min()))

    @property
    def largest_stretch(self) -> float:
        """Of all triangles at the start, in any direction; 1: none is stretched; inf: one has no area at rest."""
        if "rest" in self.keys:
            return 1.0
        x, rest = (of[:, 1:] - of[:, :1] for of in (self.start[self.triangles], self.rest[self.corner_uv]))
        area = rest[:, 0, 0] * rest[:, 1, 1] - rest[:, 0, 1] * rest[:, 1, 0]
        if (area == 0.0).any():
            return float("inf")
        return float(np.linalg.norm(np.linalg.solve(rest, x), ord=2, axis=(1, 2)).max())

    def write(self, path: PathLike) -> None:
        """Writes an OBJ file for `cloth.mesh.file`, which makes the same cloth to the last bit: v, vt, usemtl, f, and
        points p of each group g.

        Parameters
        ----------
        path : path
            The file.

        Examples
        --------
        >>> weft.Mesh([[0, 0], [1, 0], [0, 1]], None, [[0, 1, 2]]).write(tmp / "one.obj")
        >>> print((tmp / "one.obj").read_text().splitlines()[-1])
        f 1/1 2/2 3/3
        """
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            _rows(file, "v %r %r %r\n", self.start)
            _rows(file, "vt %r %r\n", self.rest)
            face, corners = ("f %d %d %d\n", (self.triangles,)) if "rest" in self.keys else \
                ("f %d/%d %d/%d %d/%d\n", (self.triangles, self.corner_uv))
            faces = np.stack(corners, axis=2).reshape(len(self.triangles), -1).astype(np.intp) + 1
            ends = np.flatnonzero(np.diff(self.fabric_of)) + 1
            for first, end in zip([0, *ends.tolist()], [*ends.tolist(), len(faces)]):
                name = self.fabric_of[first]
                if first > 0 or name > 0:
                    file.write("usemtl %s\n" % (self.fabric_names[name - 1] if name > 0 else ""))
                _rows(file, face, faces[first:end])
            for group, vertices in self.groups.items():
                file.write("g %s\n" % group)
                _rows(file, "p %d\n", vertices[:, None] + 1)

    def weld(self, distance: float = 0.0) -> Mesh:
        """Makes one of vertices that start near each other, as `cloth.mesh.weld` does of a file's.

        Their rest shapes stay: where those differ, the mesh is sewn. The lowest vertex keeps its place; the others are gone,
        and later ones are renumbered. Groups have the vertices that became theirs.

        Parameters
        ----------
        distance : float
            [m] Vertices at most so far apart are one, and chains of such; 0: those that start at the same point.

        Returns
        -------
        Mesh
            The mesh.

        Raises
        ------
        ArgumentError
            Two corners of a triangle become one, or the distance is no number >= 0.

        Examples
        --------
        >>> apart = weft.Mesh([[0, 0], [1, 0], [0, 1], [3, 0], [3, 1], [4, 0]], [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0],
        ...                   [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [3, 5, 4]])
        >>> apart.weld().triangles.tolist()
        [[0, 1, 2], [1, 3, 2]]
        """
        if not (isinstance(distance, (int, float, np.number)) and 0.0 <= distance < np.inf):
            raise ArgumentError("distance is a number >= 0 [m], not %r" % (distance,))
        lowest = _lowest(self.start, float(distance))
        kept = np.flatnonzero(lowest == np.arange(len(lowest)))
        number = np.zeros(len(lowest), dtype=np.intp)
        number[kept] = np.arange(len(kept))
        number = number[lowest]
        triangles = number[self.triangles]
        bad = np.flatnonzero((triangles == np.roll(triangles, 1, axis=1)).any(axis=1))
        if len(bad) > 0:
            raise ArgumentError("a weld of %g m makes one vertex of two corners of triangle %d%s"
                                % (distance, bad[0], _first_of(len(bad))))
        return _again(self.rest, self.start[kept], triangles, self.corner_uv, self._fabric_flags(),
                      {name: np.unique(number[of]) for name, of in self.groups.items()}, self.keys)

    @staticmethod
    def of(value: Any, *, rest: Optional[str] = None, angle: Optional[str] = None, warp: Any = None) -> Mesh:
        """Makes a mesh of what has the attributes of one: by from_trimesh() or from_meshio(); a Mesh is returned itself.

        Parameters
        ----------
        value : Mesh, trimesh.Trimesh, trimesh.Scene or meshio.Mesh
            Any of them. The meshes of a Scene become one, each where its transform puts it; their names are groups.
        rest : str, optional
            "start": the start shape in space is the rest shape, and u v are not read.
        angle, warp
            As of weft.Mesh.

        Returns
        -------
        Mesh
            The mesh.

        Raises
        ------
        ArgumentTypeError
            It is something else.
        """
        if rest not in (None, "start"):
            raise ArgumentError("rest is 'start' or None, not %r" % (rest,))
        mesh = Mesh._of(value, rest)
        if angle is None and warp is None:
            return mesh
        keys = {key: of for key, of in (("angle", angle), ("warp", warp)) if of is not None}
        return _again(mesh.rest, mesh.start, mesh.triangles, mesh.corner_uv, mesh._fabric_flags(), mesh.groups,
                      {**mesh.keys, **keys})

    @staticmethod
    def _of(value: Any, rest: Optional[str]) -> Mesh:
        if isinstance(value, Mesh):
            return value if rest is None or "rest" in value.keys else _again(
                value.rest, value.start, value.triangles, None, value._fabric_flags(), value.groups, {"rest": rest})
        if hasattr(value, "geometry"):
            return Mesh.from_trimesh(joined(value), rest=rest)
        if hasattr(value, "vertices") and hasattr(value, "faces"):
            return Mesh.from_trimesh(value, rest=rest)
        if hasattr(value, "points") and hasattr(value, "cells"):
            return Mesh.from_meshio(value, rest=rest)
        raise ArgumentTypeError("a mesh is a weft.Mesh, a trimesh.Trimesh or Scene, or a meshio.Mesh, not a %s" % type(value).__name__)

    @staticmethod
    def from_trimesh(mesh: Any, *, sew: bool = True, rest: Optional[str] = None) -> Mesh:
        """Makes a mesh of a trimesh.Trimesh, or of what has `vertices`, `faces` and perhaps `visual.uv`.

        Parameters
        ----------
        mesh : trimesh.Trimesh
            The rest shape is `visual.uv` [m]; without it the mesh itself, if it is flat: its plane's coordinates
            (flat_coordinates).
        sew : bool
            Vertices that start at the same point and have different u v become one, as trimesh divides those of a seam.
        rest : str, optional
            "start": the start shape in space is the rest shape, and u v are not read.

        Returns
        -------
        Mesh
            The mesh.

        Raises
        ------
        ArgumentError
            There is neither u v nor a plane.
        """
        start, triangles = np.asarray(mesh.vertices), np.asarray(mesh.faces)
        uv, groups = getattr(getattr(mesh, "visual", None), "uv", None), mesh.groups if isinstance(mesh, _Joined) else {}
        if rest is not None:
            return _used(rest, start, triangles, {}, groups, sew and uv is not None)
        if uv is None:
            return _used(_flat(start, triangles), start, triangles, {}, groups)
        if np.shape(uv) != (len(start), 2):
            raise ArgumentError("visual.uv has the shape %s, not (%d, 2)" % (np.shape(uv), len(start)))
        return _used(uv, start, triangles, {}, groups, sew)

    @staticmethod
    def from_meshio(mesh: Any, *, rest: Optional[str] = None) -> Mesh:
        """Makes a mesh of a meshio.Mesh, or of what has `points`, `cells`, `point_data`.

        It has the triangles; cells of lines and points are left out, others refused. `point_sets` are groups; physical groups
        of gmsh are fabrics, if they have triangles, or groups.

        Parameters
        ----------
        mesh : meshio.Mesh
            The mesh.
        rest : str, optional
            The rest shape [m] is point_data[rest]; by default "rest", "uv" or "obj:vt" if there is one, else the mesh
            itself, if it is flat (flat_coordinates). "start": the start shape in space.

        Returns
        -------
        Mesh
            The mesh.

        Raises
        ------
        ArgumentError
            It has other cells, or no rest shape.
        MissingKeyError
            There is no such point_data.
        """
        points = np.asarray(mesh.points)
        start = np.c_[points, np.zeros(len(points))] if points.ndim == 2 and points.shape[1] == 2 else points
        data = getattr(mesh, "point_data", {})
        if rest is None:
            rest = next((name for name in ("rest", "uv", "obj:vt") if name in data), None)
        elif rest != "start" and rest not in data:
            raise MissingKeyError("the mesh has no point_data %r; it has %s" % (rest, ", ".join(map(repr, data)) or "none"))
        triangles, fabrics, groups = _cells_of(mesh)
        if rest == "start":
            return _used(rest, start, triangles, fabrics, groups)
        uv = _flat(start, triangles) if rest is None else np.asarray(data[rest])
        if rest is not None and (uv.ndim != 2 or len(uv) != len(start) or uv.shape[1] < 2):
            raise ArgumentError("point_data[%r] has the shape %s, not (%d, 2)" % (rest, uv.shape, len(start)))
        return _used(uv[:, :2], start, triangles, fabrics, groups)


# ---- vertices that are one ------------------------------------------------------------

def _pairs_of_cells(cells: Array) -> Iterable[Indices]:
    """(n, 2) rows of cells, of which two vertices may be within the diagonal of one; cells are in lexical order."""
    axes = [np.unique(cells[:, k]) for k in range(3)]
    ranks = [np.searchsorted(axis, cells[:, k]) for k, axis in enumerate(axes)]
    key = (ranks[0] * len(axes[1]) + ranks[1]) * len(axes[2]) + ranks[2]
    steps = np.array(np.meshgrid(*[range(-2, 3)] * 3, indexing="ij")).reshape(3, -1).T[63:]  # one of two opposite ones
    for step in steps:
        there, beside = np.ones(len(cells), dtype=np.bool_), np.zeros(len(cells), dtype=np.intp)
        for k, axis in enumerate(axes):
            rank = np.minimum(np.searchsorted(axis, cells[:, k] + step[k]), len(axis) - 1)
            there &= axis[rank] == cells[:, k] + step[k]
            beside = beside * len(axis) + rank
        at = np.minimum(np.searchsorted(key, beside), len(key) - 1)
        there &= key[at] == beside
        yield np.stack((np.flatnonzero(there), at[there]), axis=1).astype(np.uint32)


def _joined_lowest(count: int, one: Any, other: Any) -> Any:
    """The lowest of the vertices that pairs join, of each vertex."""
    lowest = np.arange(count)
    while True:
        before = lowest
        least = np.minimum(lowest[one], lowest[other])
        lowest = lowest.copy()
        for end in (lowest[one], lowest[other], one, other):
            np.minimum.at(lowest, end, least)
        lowest = lowest[lowest]
        if (lowest == before).all():
            return lowest


def _lowest(x: Array, distance: float) -> Any:
    """Of each vertex, the lowest that it is one with. Vertices in one cell are near, and few cells are beside it."""
    low = x.min(axis=0)
    exact = distance <= 1e-12 * float((x - low).max())  # coordinates resolve no more
    cell = x if exact else np.floor((x - low) / (distance / np.sqrt(3.0)))
    cells, first, of = np.unique(cell, axis=0, return_index=True, return_inverse=True)
    of = of.ravel()
    one, other = [np.arange(len(x))], [first[of]]
    order = np.argsort(of, kind="stable")
    ends = np.searchsorted(of[order], np.arange(len(cells) + 1))
    for pairs in () if exact else _pairs_of_cells(cells):
        near = np.linalg.norm(x[first[pairs[:, 0]]] - x[first[pairs[:, 1]]], axis=1) <= distance * (1.0 + 1e-9)
        several = np.diff(ends)[pairs].max(axis=1) > 1 if len(pairs) > 0 else near
        for i in np.flatnonzero(several & ~near):
            a, b = (order[ends[k]:ends[k + 1]] for k in pairs[i])
            near[i] = (np.linalg.norm(x[a, None] - x[b], axis=2) <= distance * (1.0 + 1e-9)).any()
        one.append(first[pairs[near, 0]])
        other.append(first[pairs[near, 1]])
    return _joined_lowest(len(x), np.concatenate(one), np.concatenate(other))


def _again(rest: Any, start: Any, triangles: Any, corner_uv: Any, fabrics: Any, groups: Any,
           keys: Mapping[str, Any] = {}) -> Mesh:
    return Mesh(**{"rest": rest, "corner_uv": None if "rest" in keys else corner_uv, **keys}, start=start,
                triangles=triangles, fabrics=fabrics, groups=groups)


def _rows(file: Any, line: str, rows: Any) -> None:
    """Writes numbers by lines; many with one operator, as Python is slow line by line."""
    for first in range(0, len(rows), 1 << 15):
        some = rows[first:first + (1 << 15)]
        file.write(line * len(some) % tuple(some.ravel().tolist()))


# ---- meshes of other libraries --------------------------------------------------------

def flat_coordinates(points: Any) -> Array:
    """Coordinates of points in their plane: v along what lies in it of the y axis, u across.

    In the x-y plane that is x, y. In a plane nearer to the horizontal, v is along what lies in it of the z axis: x, z.

    Parameters
    ----------
    points : array, shape (N, 3)
        [m]

    Returns
    -------
    ndarray, shape (N, 2)
        [m] u, v

    Raises
    ------
    ArgumentError
        The points leave the plane by more than a thousandth of their extent.

    Warns
    -----
    SceneWarning
        They leave it by more than a millionth.

    Examples
    --------
    >>> weft.mesh.flat_coordinates([[0, 2, 5], [1, 2, 5], [1, 3, 5]]).tolist()
    [[0.0, 2.0], [1.0, 2.0], [1.0, 3.0]]
    """
    x = _numbers(points, "points", 3)
    if len(x) < 3:
        raise ArgumentError("%d points have no plane" % len(x))
    moved = x - x.mean(axis=0)
    normal = np.linalg.eigh(moved.T @ moved)[1][:, 0]
    away, extent = float(np.abs(moved @ normal).max()), float(np.ptp(moved, axis=0).max())
    if not away <= _FLAT * extent:
        raise ArgumentError("the mesh has no rest shape: it has no u v, and is not flat: it leaves its plane by %.3g of "
                         "its extent of %.3g; rest='start' takes the start as it is" % (away, extent))
    if away > _ROUNDED * extent:
        warnings.warn("the mesh has no u v and leaves its plane by %.3g of its extent of %.3g: its rest shape is the plane"
                      % (away, extent), SceneWarning, stacklevel=5)
    normal = np.where(np.abs(normal) < 1e-9, 0.0, normal)  # an axis stays one
    up = np.array([0.0, 1.0, 0.0]) if abs(normal[1]) <= np.sqrt(0.5) else np.array([0.0, 0.0, 1.0])
    along = up - normal * (up @ normal) / (normal @ normal)
    along /= np.linalg.norm(along)
    across = np.cross(along, normal / np.linalg.norm(normal))
    plane: Array = x @ np.stack((across * np.sign(across[np.abs(across).argmax()]), along), axis=1)
    return plane


def _flat(start: Any, triangles: Any) -> Array:
    """flat_coordinates of the vertices that triangles have; 0 of others."""
    points = _numbers(start, "points", 3)
    used = np.unique(_corners(triangles, "triangles", None, len(points), "vertices"))
    plane = np.zeros((len(points), 2))
    plane[used] = flat_coordinates(points[used])
    return plane


class _Joined(NamedTuple):
    """The meshes of a trimesh.Scene as one: what a Trimesh has of use here, and its groups."""

    vertices: Array
    faces: Any
    visual: Any
    groups: dict[str, Any]


class _Visual(NamedTuple):
    uv: Any


def joined(scene: Any) -> _Joined:
    """A trimesh.Scene as one mesh, each of its meshes where its transform puts it. Their names are groups. trimesh's own
    concatenation packs textures, and so changes UV coordinates."""
    vertices, faces, uvs, groups, count = [], [], [], {}, 0
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not hasattr(mesh, "faces"):
            raise ArgumentTypeError("'%s' of the trimesh.Scene is a %s, not a mesh of triangles" % (name, type(mesh).__name__))
        x, turn = np.asarray(mesh.vertices, dtype=np.float64), np.asarray(transform, dtype=np.float64)
        vertices.append(x if (turn == np.eye(4)).all() else x @ turn[:3, :3].T + turn[:3, 3])
        faces.append(np.asarray(mesh.faces) + count)
        uvs.append(getattr(getattr(mesh, "visual", None), "uv", None))
        groups[as_word(str(node))] = np.arange(count, count + len(x))
        count += len(x)
    if not vertices:
        raise ArgumentError("the trimesh.Scene has no mesh")
    bare = [uv is None for uv in uvs]
    if any(bare) and not all(bare):
        raise ArgumentError("some meshes of the trimesh.Scene have u v, and others have none")
    return _Joined(np.concatenate(vertices), np.concatenate(faces), _Visual(None if bare[0] else np.concatenate(uvs)), groups)


def _cells_of(mesh: Any) -> tuple[Any, dict[str, Any], dict[str, Any]]:
    """Triangles, fabrics by triangles and groups by vertices."""
    names = {(int(tag[1]), int(tag[0])): as_word(str(name)) for name, tag in getattr(mesh, "field_data", {}).items()
             if np.shape(tag) == (2,)}
    tags = getattr(mesh, "cell_data", {}).get("gmsh:physical", [None] * len(mesh.cells))
    triangles, kinds = [], []
    groups: dict[str, list[Any]] = {as_word(name): [of] for name, of in (getattr(mesh, "point_sets", None) or {}).items()}
    for block, tag in zip(mesh.cells, tags):
        data = np.asarray(block.data)
        dimension = {"triangle": 2, "vertex": 0}.get(block.type, 1 if block.type.startswith("line") else 3)
        if dimension == 3:
            raise ArgumentError("the mesh has %d cells '%s': cloth is made of cells 'triangle'" % (len(data), block.type))
        if dimension == 2:
            triangles.append(data)
            kinds.append(np.full(len(data), -1) if tag is None else np.asarray(tag))
        elif tag is not None:
            for kind in np.unique(tag):
                name = names.get((dimension, int(kind)))
                if name is not None:
                    groups.setdefault(name, []).append(data[np.asarray(tag) == kind])
    if not triangles:
        raise ArgumentError("the mesh has no cells 'triangle'")
    kind_of = np.concatenate(kinds)
    fabrics = {names[2, int(kind)]: kind_of == kind for kind in np.unique(kind_of) if (2, int(kind)) in names}
    return (np.concatenate(triangles), fabrics,
            {name: np.concatenate([np.ravel(part) for part in of]) for name, of in groups.items()})


def _used(uv: Any, start: Any, triangles: Any, fabrics: Any, groups: Mapping[str, Any], sew: bool = False) -> Mesh:
    """A mesh of the vertices that triangles have; sew: with equal ones as one."""
    start = _numbers(start, "start", 3)
    corners = _corners(triangles, "triangles", None, len(start), "vertices")
    flag = np.zeros(len(start), dtype=np.bool_)
    flag[corners] = True
    if not flag.all():
        warnings.warn("vertex %d is in no triangle and is dropped%s" % (np.argmin(flag), _first_of((~flag).sum())),
                      SceneWarning, stacklevel=4)
    number = np.cumsum(flag) - 1
    kept = np.flatnonzero(flag)
    vertex_of, first = np.arange(len(kept)), np.arange(len(kept))
    if sew:
        _, first, vertex_of = np.unique(start[kept], axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)  # vertices stay in their order
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        first, vertex_of = first[order], rank[vertex_of.ravel()]
    corner_uv = number[corners]
    members = {name: _integers(of, "group '%s'" % name, len(start), "vertices") for name, of in groups.items()}
    in_space = isinstance(uv, str)
    return Mesh(uv if in_space else np.asarray(uv)[kept], start[kept][first], vertex_of[corner_uv],
                corner_uv=None if in_space else corner_uv, fabrics=fabrics,
                groups={name: vertex_of[number[of[flag[of]]]] for name, of in members.items()})
