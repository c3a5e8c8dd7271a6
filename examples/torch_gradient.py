#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""weft's gradient in PyTorch: finds the stiffness and gravity of a run from where a corner of its sheet is, twice.

weft.gradient computes the value and all derivatives in one pass, backwards through the steps; `backward` hands them
to autograd. Prints the numbers; without PyTorch, a message."""
import sys

import numpy as np
import weft

try:
    import torch
except ImportError:
    sys.exit(print("torch_gradient.py skipped: no PyTorch"))

KEYS = ["cloth.springs.stretch.stiffness", "forces.gravity.1"]
SCENE = {
    "weft": 1,
    "cloth": {"grid": {"rows": 6, "cols": 6, "spacing": 0.1}, "density": 0.2,
              "springs": {"stretch": {"stiffness": 60, "damping": 0.02}, "shear": {"stiffness": 20}},
              "pins": ["top-left", "top-right"]},
    "forces": {"gravity": [0, -9.81, 0], "damping": 0.002},
    "stepper": {"plugin": "verlet", "method": "velocity_verlet", "fixed_step": 1e-3},
    "run": {"duration": 0.4, "fps": 30},
}


TRUE, TIMES = [40.0, -8.0], [0.3, 0.4]
TARGET = {}
for time in TIMES:
    sim = weft.load(SCENE, dict(zip(KEYS, TRUE)))
    sim.advance(time)
    TARGET[time] = sim.positions[-1].copy()


def corner(t, x, v):
    """How far the last particle is from where it was, half squared."""
    by = np.zeros(x.shape)
    by[-1] = x[-1] - TARGET[t]
    return 0.5 * (by**2).sum(), by


class Cloth(torch.autograd.Function):
    @staticmethod
    def forward(ctx, numbers):
        found = weft.gradient(SCENE, corner, KEYS, dict(zip(KEYS, numbers.tolist())), times=TIMES)
        ctx.save_for_backward(numbers.new_tensor([found.parameters[key] for key in KEYS]))
        return numbers.new_tensor(found.value)

    @staticmethod
    def backward(ctx, upstream):
        return upstream * ctx.saved_tensors[0]


scale = torch.tensor([60.0, -9.81], dtype=torch.float64)
logs = torch.zeros(2, dtype=torch.float64, requires_grad=True)
optimiser = torch.optim.LBFGS([logs], max_iter=40, tolerance_grad=1e-9, tolerance_change=1e-14, line_search_fn="strong_wolfe")


def closure():
    optimiser.zero_grad()
    loss = Cloth.apply(scale * torch.exp(logs))
    loss.backward()
    return loss


first = float(optimiser.step(closure).detach())
found = (scale * torch.exp(logs.detach())).tolist()
print("distance %.3f m before, %.2g m after" % ((2 * first)**0.5, (2 * float(closure().detach()))**0.5))
print(*("%s %.4g, true: %g" % line for line in zip(KEYS, found, TRUE)), sep="\n")
if not all(abs(a - b) < 1e-2 * abs(b) for a, b in zip(found, TRUE)):
    sys.exit("torch_gradient.py: these are other numbers")
