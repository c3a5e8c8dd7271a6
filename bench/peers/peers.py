#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The sheets P(32) and P(100) of docs/project/speed.md by others, on this machine:

SciPy's solve_ivp (RK45) with NumPy slices and with Numba's loop over a list of springs,
boost::odeint's dopri5 with that loop in C++ (odeint.cpp, Debian's libboost-dev), all at
a tolerance of 1e-6; and symplectic Euler in NVIDIA Warp on the CPU, which uses one
thread. Not part of `make bench`; what is not installed is skipped:

    make build/bench/steps
    python3 -m venv build/peers && build/peers/bin/pip install numpy scipy numba warp-lang
    build/peers/bin/python bench/peers/peers.py
"""
import os
import statistics
import subprocess
import tempfile
import time

import numpy as np

GRAVITY = np.array([0.0, -9.81, 0.0])
# down, right, stiffness [N/m]; damping is 5e-4 s times that
WAYS = ((0, 1, 100.0), (1, 0, 100.0), (1, 1, 50.0), (1, -1, 50.0), (0, 2, 10.0), (2, 0, 10.0))


def sheet(n):
    """Positions (n, n, 3), inverse mass (n, n, 1)."""
    x = np.zeros((n, n, 3))
    x[:, :, 0], x[:, :, 2] = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    inverse = np.full((n, n, 1), n * n / 0.2)
    inverse[0, 0] = inverse[0, -1] = 0.0
    return x, inverse


def ends(a, down, right):
    """The particles that springs of a kind start at, and those they end at."""
    rows, cols = a.shape[0], a.shape[1]
    near = slice(max(0, -right), cols - max(0, right))
    far = slice(max(0, right), cols + min(0, right))
    return a[: rows - down, near], a[down:, far]


def accelerations(x, v, inverse, cell):
    f = np.zeros_like(x)
    for down, right, k in WAYS:
        p, q = ends(x, down, right)
        vp, vq = ends(v, down, right)
        fp, fq = ends(f, down, right)
        d, w = q - p, vq - vp
        length = np.sqrt((d * d).sum(axis=2, keepdims=True))
        rate = (w * d).sum(axis=2, keepdims=True) / length
        pull = (k * (length - cell * np.hypot(down, right)) + 5e-4 * k * rate) / length * d
        fp += pull
        fq -= pull
    return np.where(inverse > 0.0, GRAVITY + inverse * f, 0.0)


def spring_list(n):
    """Ends, stiffness [N/m] and rest length [m] of every spring."""
    index = np.arange(n * n).reshape(n, n)
    parts = [(*(a.ravel() for a in ends(index, down, right)), k, np.hypot(down, right) / (n - 1))
             for down, right, k in WAYS]
    p, q = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
    k, s = (np.concatenate([np.full(part[0].size, part[i]) for part in parts]) for i in (2, 3))
    return p, q, k, s


def solve(rhs, n, t):
    """Seconds and final positions of SciPy's RK45 from rest."""
    from scipy.integrate import solve_ivp

    x, _ = sheet(n)
    start = np.concatenate((x.ravel(), np.zeros(x.size)))
    began = time.perf_counter()
    done = solve_ivp(rhs, (0.0, t), start, rtol=1e-12, atol=1e-6, t_eval=[t])
    return time.perf_counter() - began, done.y[: x.size, -1].reshape(x.shape)


def numpy_run(n, t):
    x, inverse = sheet(n)
    half = x.size

    def rhs(_, y):
        v = y[half:].reshape(x.shape)
        a = accelerations(y[:half].reshape(x.shape), v, inverse, 1.0 / (n - 1))
        return np.concatenate((y[half:], a.ravel()))

    return solve(rhs, n, t)


def list_loop(y, p, q, k, s, inverse):
    n = inverse.size
    x, v = y[: 3 * n].reshape(n, 3), y[3 * n :].reshape(n, 3)
    out = np.zeros(6 * n)
    out[: 3 * n] = y[3 * n :]
    a = out[3 * n :].reshape(n, 3)
    for i in range(p.size):
        d0, d1, d2 = x[q[i], 0] - x[p[i], 0], x[q[i], 1] - x[p[i], 1], x[q[i], 2] - x[p[i], 2]
        w0, w1, w2 = v[q[i], 0] - v[p[i], 0], v[q[i], 1] - v[p[i], 1], v[q[i], 2] - v[p[i], 2]
        length = np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        rate = (w0 * d0 + w1 * d1 + w2 * d2) / length
        pull = (k[i] * (length - s[i]) + 5e-4 * k[i] * rate) / length
        a[p[i], 0] += pull * d0
        a[p[i], 1] += pull * d1
        a[p[i], 2] += pull * d2
        a[q[i], 0] -= pull * d0
        a[q[i], 1] -= pull * d1
        a[q[i], 2] -= pull * d2
    for i in range(n):
        for j in range(3):
            a[i, j] *= inverse[i]
        if inverse[i] > 0.0:
            a[i, 1] -= 9.81
    return out


def numba_run(n, t):
    import numba

    springs = spring_list(n)
    x, inverse = sheet(n)
    loop = COMPILED.setdefault("loop", numba.njit(list_loop))
    loop(np.concatenate((x.ravel(), np.zeros(x.size))), *springs, inverse.ravel())
    return solve(lambda _, y: loop(y, *springs, inverse.ravel()), n, t)


def odeint_run(n, t):
    if "odeint" not in COMPILED:
        program = os.path.join(tempfile.mkdtemp(), "odeint")
        source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "odeint.cpp")
        made = subprocess.run(["c++", "-std=c++17", "-O3", "-march=native", "-o", program, source],
                              capture_output=True)
        if made.returncode != 0:
            raise ImportError("boost")
        COMPILED["odeint"] = program
    with tempfile.NamedTemporaryFile() as out:
        told = subprocess.run([COMPILED["odeint"], str(n), str(t), out.name], check=True, capture_output=True)
        return float(told.stdout), np.fromfile(out.name).reshape(n, n, 3)


COMPILED = {}


def warp_run(n, t, steps, recorded):
    """With recorded launches Python packs arguments once, not at every step."""
    x, inverse = sheet(n)
    springs = spring_list(n)
    p, q = (wp.array(a, dtype=int, device="cpu") for a in springs[:2])
    k, s = (wp.array(a, dtype=wp.float64, device="cpu") for a in springs[2:])
    m = wp.array(inverse.ravel(), dtype=wp.float64, device="cpu")
    px = wp.array(x.reshape(-1, 3), dtype=wp.vec3d, device="cpu")
    pv, pf = wp.zeros_like(px), wp.zeros_like(px)
    pull, move = KERNELS
    launches = ((pull, p.size, [px, pv, p, q, k, s, pf]), (move, n * n, [px, pv, pf, m, wp.float64(t / steps)]))
    kept = [wp.launch(what, dim=dim, inputs=inputs, device="cpu", record_cmd=True) for what, dim, inputs in launches]
    began = time.perf_counter()
    for _ in range(steps):
        if recorded:
            kept[0].launch()
            kept[1].launch()
        else:
            for what, dim, inputs in launches:
                wp.launch(what, dim=dim, inputs=inputs, device="cpu")
    return time.perf_counter() - began, px.numpy().reshape(n, n, 3)


try:
    import warp as wp

    @wp.kernel
    def pull_springs(x: wp.array(dtype=wp.vec3d), v: wp.array(dtype=wp.vec3d), p: wp.array(dtype=int),
                     q: wp.array(dtype=int), k: wp.array(dtype=wp.float64), s: wp.array(dtype=wp.float64),
                     f: wp.array(dtype=wp.vec3d)):
        i = wp.tid()
        a, b = p[i], q[i]
        d = x[b] - x[a]
        length = wp.length(d)
        rate = wp.dot(v[b] - v[a], d) / length
        pull = (k[i] * (length - s[i]) + wp.float64(5e-4) * k[i] * rate) / length
        wp.atomic_add(f, a, pull * d)
        wp.atomic_add(f, b, -pull * d)

    @wp.kernel
    def move_particles(x: wp.array(dtype=wp.vec3d), v: wp.array(dtype=wp.vec3d), f: wp.array(dtype=wp.vec3d),
                       inverse: wp.array(dtype=wp.float64), h: wp.float64):
        i = wp.tid()
        if inverse[i] > wp.float64(0.0):
            v[i] = v[i] + h * (inverse[i] * f[i] + wp.vec3d(wp.float64(0.0), wp.float64(-9.81), wp.float64(0.0)))
        x[i] = x[i] + h * v[i]
        f[i] = wp.vec3d()

    KERNELS = (pull_springs, move_particles)
except ImportError:
    wp = None


def weft_run(n, t, steps):
    return float(subprocess.run(["build/bench/steps", "euler", str(n), str(t), str(steps)], check=True, capture_output=True).stdout)


def middle(run, *args, rounds):
    return sorted((run(*args) for _ in range(rounds)), key=lambda r: r[0])[rounds // 2]


def adaptive(n, t, rounds):
    """Runge-Kutta with error control; positions at the end by the first there is."""
    reference = None
    for name, run in (("boost::odeint dopri5, spring list in C++", odeint_run),
                      ("SciPy RK45, NumPy slices", numpy_run),
                      ("SciPy RK45, Numba's loop over springs", numba_run)):
        try:
            seconds, x = middle(run, n, t, rounds=rounds)
        except ImportError as missing:
            print(f"peers: {name} skipped, not installed: {missing.name or missing}")
            continue
        far = "" if reference is None else f", {np.abs(x - reference).max():.1e} m from the first"
        reference = x if reference is None else reference
        print(f"peers P({n}) {name}: {seconds:.4g} s{far}", flush=True)
    return reference


def fixed(n, t, steps, reference):
    """Symplectic Euler, round by round so that both meet the same noise."""
    if wp is None:
        print("peers: Warp skipped, not installed")
        return
    rounds = [(warp_run(n, t, steps, False), warp_run(n, t, steps, True), weft_run(n, t, steps)) for _ in range(7)]
    plain, kept = (statistics.median(r[i][0] for r in rounds) for i in (0, 1))
    own = statistics.median(r[2] for r in rounds)
    x = rounds[0][0][1]
    far = "" if reference is None else f", {np.abs(x - reference).max():.1e} m from the first"
    print(f"peers P({n}) Warp symplectic Euler, {steps} steps: {plain:.4g} s, launches recorded {kept:.4g} s{far}")
    print(f"peers P({n}) weft verlet symplectic_euler, {steps} steps: {own:.4g} s, "
          f"ratio {plain / own:.2f}, recorded {kept / own:.2f}", flush=True)


def main():
    # steps of 0.9 of the largest stable one, as in `make bench BENCH=steps`
    for n, t, steps in ((32, 0.5, 858), (100, 0.1, 1025)):
        fixed(n, t, steps, adaptive(n, t, 3 if n == 32 else 1))


if __name__ == "__main__":
    main()
