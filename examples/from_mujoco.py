#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""python3 examples/from_mujoco.py MODEL.xml [FLEX]: the cloth of a MuJoCo model, as a flexcomp of dim 2 makes it (type grid
or mesh), hung by its first vertex for a moment. MuJoCo is z-up, and the gravity of the model stays as it is.
pip install mujoco"""
import sys

import mujoco
import numpy as np

import weft


def mesh_of(model, data, name=None):
    """A flex of a model as a weft.Mesh, whose rest shape is where its vertices start, as in MuJoCo."""
    flex = 0 if name is None else mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_FLEX, name)
    if not 0 <= flex < model.nflex:
        raise ValueError("the model has no flex %s" % (name or ""))
    if model.flex_dim[flex] != 2:
        raise ValueError("flex %d has %d dimensions, a cloth 2" % (flex, model.flex_dim[flex]))
    first, count = model.flex_vertadr[flex], model.flex_vertnum[flex]
    corner, triangles = model.flex_elemdataadr[flex], model.flex_elemnum[flex]
    start = data.flexvert_xpos[first:first + count]
    corners = model.flex_elem[corner:corner + 3 * triangles].reshape(-1, 3)
    return weft.Mesh("start", start, corners)


def scene_of(path, name=None):
    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return {"cloth": {"mesh": mesh_of(model, data, name), "fabric": {"density": 0.2, "stretch": 400, "coupling": 130,
                                                                        "shear": 135, "bend": 1e-5, "damping": [1e-5, 1e-5]},
                      "pins": [{"vertices": [0]}]},
            "forces": {"gravity": np.asarray(model.opt.gravity).tolist()},
            "stepper": {"method": "arkode/dormand_prince", "rtol": 1e-4}, "run": {"duration": 0.1}}


if __name__ == "__main__":
    sim = weft.load(scene_of(*sys.argv[1:]))
    sim.advance(0.1)
    print(sim.positions.min(axis=0))
