# SPDX-License-Identifier: BSD-3-Clause
"""weft: cloth as a network of masses and springs, under solvers that people trust.

>>> scene = {
...     "weft": 1,
...     "cloth": {
...         "grid": {"rows": 8, "cols": 10, "spacing": 0.1},
...         "density": 0.2,
...         "springs": {"stretch": {"stiffness": 100, "damping": 0.02}},
...         "pins": ["top-left", "top-right"],
...     },
...     "stepper": {"plugin": "verlet", "method": "velocity_verlet", "fixed_step": 1e-3},
...     "run": {"duration": 2.0, "fps": 30},
... }
>>> sim = weft.load(scene)
>>> sim.advance(0.5)
>>> sim.energy.kinetic > 0
True

SI units. docs/guides/python.md is a tour, docs/reference/scene.md lists the keys of a scene. The log of logging.getLogger("weft") has
loaded plugins and warnings of the simulation.
"""
from weft import garment
from weft._weft import ffi as _ffi
from weft._weft import lib as _lib
from weft.callbacks import CORRECT, EVENT, FORCE, PerformanceWarning
from weft.checks import Check, FabricTest, check, lab
from weft.executors import map
from weft.gradients import Gradient, gradient
from weft.library import (ArgumentError, ArgumentIndexError, ArgumentTypeError, Diagnostic, Error, Failure, Method,
                          MissingKeyError, MissingPackageError, NotFoundError, OutOfMemoryError, SceneError, SceneWarning,
                          Spring, StepError, UnknownAttributeError, amplification, fabrics, load_plugin, methods,
                          scene_help)
from weft.mesh import Mesh
from weft.parallel import Batch, BatchError
from weft.runs import (Difference, Fit, Page, Run, RunError, batch, compare, converge, diff, export, fit, open, program,
                       resume, run, scene, view)
from weft.simulation import Energy, Ledger, Measures, Sim, Stats, Stiffness, load

__version__: str = _ffi.string(_lib.weft_version()).decode()

__all__ = ["ArgumentError", "ArgumentIndexError", "ArgumentTypeError", "Batch", "BatchError", "CORRECT", "Check",
           "Diagnostic", "Difference", "EVENT", "Energy", "Error", "FORCE", "FabricTest", "Failure", "Fit", "Gradient",
           "Ledger", "Measures", "Mesh", "Method", "MissingKeyError", "MissingPackageError", "NotFoundError",
           "OutOfMemoryError", "Page", "PerformanceWarning", "Run", "RunError", "SceneError", "SceneWarning", "Sim",
           "Spring", "Stats", "StepError", "Stiffness", "UnknownAttributeError", "amplification", "batch", "check",
           "compare", "converge", "diff", "export", "fabrics", "fit", "garment", "gradient", "lab", "load",
           "load_plugin", "map", "methods", "open", "program", "resume", "run", "scene", "scene_help", "view"]
