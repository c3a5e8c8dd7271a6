# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of Python in the form in which libweft and the program read them: dicts as YAML, arrays as OBJ files."""
from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, Optional, Union

from weft.library import ArgumentError, ArgumentTypeError, NotFoundError, PathLike, chars, settings, yaml_text
from weft.mesh import Mesh, _array, _corners, _members, _numbers, joined

Scene = Union[PathLike, Mapping[str, Any]]
Change = Callable[[Any, str], Any]

_TABLES = ("path", "table", "rows")  # keys whose value may be a CSV file


# ---- meshes and bodies ------------------------------------------------------------------

def _is_array_mesh(mesh: Any) -> bool:
    """Whether `mesh` of a cloth is neither absent nor a file's."""
    return mesh is not None and not isinstance(mesh, (Mapping, str, bytes, int, float, list, tuple))


def _each_cloth(scene: Mapping[str, Any], change: Change) -> dict[str, Any]:
    """The scene with each of its meshes changed, which is called with the suffix of its file's name."""
    def changed(cloth: Any, suffix: str) -> Any:
        mesh = cloth.get("mesh") if isinstance(cloth, Mapping) else None
        return cloth if mesh is None else change(cloth, suffix)

    cloths = scene.get("cloths")
    found = {**scene}
    if "cloth" in scene:
        found["cloth"] = changed(scene["cloth"], ".obj")
    if isinstance(cloths, (list, tuple)):
        found["cloths"] = [changed(one, "-%d.obj" % k) for k, one in enumerate(cloths)]
    return found


def _each_body(scene: Mapping[str, Any], change: Change) -> dict[str, Any]:
    contact = scene.get("contact")
    shapes = contact.get("shapes") if isinstance(contact, Mapping) else None
    if not isinstance(shapes, (list, tuple)):
        return {**scene}
    return {**scene, "contact": {**contact, "shapes": [  # type: ignore[dict-item]
        {**shape, "file": change(shape["file"], "-shape%d" % k)} if isinstance(shape, Mapping) and "file" in shape
        else shape for k, shape in enumerate(shapes)]}}


def _body(value: Any) -> Any:
    """The path of a body's file, or copies of its arrays: (vertices, triangles), of key frames (keys, n, 3)."""
    if isinstance(value, (str, os.PathLike)):
        return os.path.abspath(value)
    value = joined(value)[:2] if hasattr(value, "geometry") else value
    pair = value if isinstance(value, (tuple, list)) else (getattr(value, "vertices", None), getattr(value, "faces", None))
    if len(pair) != 2 or pair[0] is None or pair[1] is None:
        raise ArgumentTypeError("the file of a body is a path, a trimesh.Trimesh or (vertices, triangles), not %.100r" % (value,))
    array = _array(pair[0], "vertices of a body")
    if array.ndim not in (2, 3) or array.shape[-1] != 3 or 0 in array.shape:
        raise ArgumentError("vertices of a body have the shape %s, not (n, 3) or (keys, n, 3)" % (array.shape,))
    places = _numbers(array.reshape(-1, 3), "vertices of a body", 3).reshape(array.shape)
    return places, _corners(pair[1], "triangles of a body", None, places.shape[-2], "vertices")


def _write_body(body: Any, name: str) -> str:
    keys = body[0] if body[0].ndim == 3 else body[0][None]
    faces = "".join("f %d %d %d\n" % tuple(c) for c in body[1].astype(int) + 1)
    for key, places in enumerate(keys):
        file = name + ("-%04d" % key if body[0].ndim == 3 else "") + ".obj"
        Path(file).write_text("".join("v %.17g %.17g %.17g\n" % tuple(x) for x in places) + faces, encoding="utf-8")
    return name + ("-%04d.obj" if body[0].ndim == 3 else ".obj")


def _own_cloth(cloth: Mapping[str, Any], _suffix: str) -> dict[str, Any]:
    mesh = cloth["mesh"]
    if not _is_array_mesh(mesh):
        file = isinstance(mesh, Mapping) and isinstance(mesh.get("file"), (str, os.PathLike))
        return {**cloth, "mesh": {**mesh, "file": os.path.abspath(mesh["file"])}} if file else {**cloth}
    mesh, found = Mesh.of(mesh), {**cloth}
    for kind in ("pins", "loads"):
        items = cloth.get(kind)
        for i, item in enumerate(items if isinstance(items, (list, tuple)) else []):
            if isinstance(item, Mapping) and "vertices" in item:
                name = "%s[%d].vertices" % (kind, i)
                vertices = _members(item["vertices"], name, len(mesh.start), "vertices")
                if len(vertices) == 0:
                    raise ArgumentError("%s is empty" % name)
                found[kind] = [*found[kind]]
                found[kind][i] = {**item, "vertices": vertices.tolist()}
    return {**found, "mesh": mesh}


def _whole(value: Any, key: str = "") -> Any:
    """With the files of materials and of tables of times by their whole paths."""
    if isinstance(value, Mapping):
        return {name: _whole(of, str(name)) for name, of in value.items()}
    if isinstance(value, (list, tuple)):
        return [_whole(of) for of in value] if any(isinstance(of, Mapping) for of in value) else value
    file = isinstance(value, (str, os.PathLike)) and (key == "arcsim" or (key in _TABLES and str(value).endswith(".csv")))
    return os.path.abspath(value) if file else value


def own(scene: Mapping[str, Any]) -> dict[str, Any]:
    """The scene with copies of its arrays, and the files that it names by their whole paths."""
    found: dict[str, Any] = _whole(_each_cloth(_each_body(scene, lambda body, suffix: _body(body)), _own_cloth))
    return found


def written(scene: Mapping[str, Any], folder: PathLike, stem: str, whole: bool = False) -> dict[str, Any]:
    """The scene with files, those of arrays written to a folder: STEM.obj, STEM-0.obj of several cloths,
    STEM-shape0.obj; whole: with their whole paths, else for a scene in the same folder."""
    before = os.path.join(folder, "")

    def name(path: str) -> str:
        return path if whole else path[len(before):]

    def write(cloth: Any, suffix: str) -> Any:
        if not isinstance(cloth["mesh"], Mesh):
            return cloth
        cloth["mesh"].write(before + stem + suffix)
        return {**cloth, "mesh": {"file": name(before + stem + suffix), **cloth["mesh"].keys}}

    def body(of: Any, suffix: str) -> Any:
        return of if isinstance(of, str) else name(_write_body(of, before + stem + suffix))
    return _each_cloth(_each_body(own(scene), body), write)


def has_files(scene: Mapping[str, Any]) -> bool:
    """Whether a body of the scene is a file or arrays, or a mesh of it arrays."""
    found: list[Any] = []
    _each_body(scene, lambda body, suffix: found.append(body))
    _each_cloth(scene, lambda cloth, suffix: found.append(cloth) if _is_array_mesh(cloth["mesh"]) else None)
    return len(found) > 0


# ---- as libweft reads them ----------------------------------------------------------------

class Form(NamedTuple):
    """A scene as libweft reads it: a file, or a text; overrides; the folder where files of its arrays are, or "". again:
    what loads it again, once the folder is gone."""

    file: Optional[str]
    content: Optional[str]
    sets: list[str]
    folder: str
    again: Scene


def path_of(scene: PathLike) -> str:
    """The path of a scene's file, which is there."""
    path = os.fsdecode(scene)
    chars(path)
    if not os.path.lexists(path):
        raise NotFoundError("%s: there is no such scene; weft.scene(NAME) is one that comes with weft" % path)
    return path


def is_text(scene: Any) -> bool:
    return isinstance(scene, str) and "\n" in scene


@contextmanager
def formed(scene: Scene, overrides: Optional[Mapping[str, Any]] = None) -> Iterator[Form]:
    """While it lasts, the files of its arrays exist."""
    sets = settings(overrides)
    if not isinstance(scene, Mapping):
        file, content = (None, str(scene)) if is_text(scene) else (path_of(scene), None)
        yield Form(file, content, sets, "", scene)
    elif not has_files(scene):
        yield Form(None, yaml_text(scene), sets, "", scene)
    else:
        kept = own(scene)
        with tempfile.TemporaryDirectory() as folder:
            yield Form(None, yaml_text(written(kept, folder, "scene", whole=True)), sets, folder, kept)
