#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""weft's gradient in JAX: the derivative of a loss of a cloth by its numbers, by custom_vjp, under jit and grad.

The forward rule calls weft.gradient on the host and keeps the derivatives; the backward one multiplies them. Prints
the gradient and a difference of two values; without JAX, a message."""
import sys

import numpy as np
import weft

try:
    import jax
except ImportError:
    sys.exit(print("jax_gradient.py skipped: no JAX"))
jax.config.update("jax_enable_x64", True)
from jax import numpy as jnp  # noqa: E402 - after its precision

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


def corner(t, x, v):
    """How far the last particle is from a target, half squared."""
    by = np.zeros(x.shape)
    by[-1] = x[-1] - [0.5, -0.62, 0.0]
    return 0.5 * (by**2).sum(), by


def host(numbers):
    """The value, then its derivatives by the numbers."""
    found = weft.gradient(SCENE, corner, KEYS, dict(zip(KEYS, np.asarray(numbers).tolist())), times=[0.3])
    return np.array([found.value, *(found.parameters[key] for key in KEYS)])


def run(numbers):
    return jax.pure_callback(host, jax.ShapeDtypeStruct((1 + len(KEYS),), jnp.float64), numbers)


@jax.custom_vjp
def loss(numbers):
    return run(numbers)[0]


def forward(numbers):
    found = run(numbers)
    return found[0], found[1:]


def backward(slopes, upstream):
    return (upstream * slopes,)


loss.defvjp(forward, backward)

at = jnp.array([60.0, -9.81])
gradient = jax.jit(jax.grad(lambda logs: loss(at * jnp.exp(logs))))(jnp.zeros(2))
step = 1e-5 * jnp.array([0.6, 0.8])
difference = (loss(at * jnp.exp(step)) - loss(at * jnp.exp(-step))) / 2e-5
print("by the logarithms of %s, %s: %.9g, %.9g" % (*KEYS, *gradient))
print("along (0.6, 0.8): %.9g, by a difference %.9g" % (gradient @ step / 1e-5, difference))
if not abs(gradient @ step / 1e-5 - difference) < 1e-6 * abs(difference):
    sys.exit("jax_gradient.py: the difference is another")
