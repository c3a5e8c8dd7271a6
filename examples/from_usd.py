#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""python3 examples/from_usd.py FILE.usd [/PATH/OF/MESH] [OUT.obj]: a mesh of a USD stage, as Newton, Warp and Isaac have
their cloths, as an OBJ file for cloth.mesh. Lengths become metres, and every transform above the mesh is applied. The rest
shape is the primvar st, if it is there for each vertex or corner and `st` gives its unit [m]; else the start shape: such
a file goes with cloth.mesh.rest: start.
pip install usd-core"""
import sys

import numpy as np
from pxr import Usd, UsdGeom

import weft


def triangles_of(counts, corners):
    """(T, 3) rows of the list of corners: faces as fans, each around its first corner."""
    first = np.cumsum(counts) - counts
    fan = [(at, at + k, at + k + 1) for at, count in zip(first, counts) for k in range(1, count - 1)]
    return np.array(fan, dtype=np.intp), np.asarray(corners)


def mesh_of(path, prim=None, st=None):
    """A mesh of a stage, the first by default, as a weft.Mesh; st: [m] one unit of its primvar st, if that is to be used."""
    stage = Usd.Stage.Open(path)
    found = [p for p in stage.Traverse() if p.IsA(UsdGeom.Mesh) and (prim is None or str(p.GetPath()) == prim)]
    if not found:
        raise ValueError("%s has no mesh %s" % (path, prim or ""))
    mesh = UsdGeom.Mesh(found[0])
    points = np.array(mesh.GetPointsAttr().Get(), dtype=np.float64)
    matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(found[0]))  # for rows
    start = (points @ matrix[:3, :3] + matrix[3, :3]) * UsdGeom.GetStageMetersPerUnit(stage)
    fans, corners = triangles_of(np.array(mesh.GetFaceVertexCountsAttr().Get()), mesh.GetFaceVertexIndicesAttr().Get())
    triangles = corners[fans]
    if st is None:
        return weft.Mesh("start", start, triangles)
    uv = st * np.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st").ComputeFlattened(), dtype=np.float64)
    return weft.Mesh(uv if len(uv) == len(start) else uv[fans], start, triangles)


if __name__ == "__main__":
    more = sys.argv[2:]
    prim = more.pop(0) if more and more[0].startswith("/") else None
    mesh = mesh_of(sys.argv[1], prim)
    mesh.write(more[0] if more else "cloth.obj")
    print(mesh)
