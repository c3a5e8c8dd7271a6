#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The sheets P(32) and P(100) of docs/speed.md by others, on this machine:

SciPy's solve_ivp (RK45) with NumPy slices, and symplectic Euler in NVIDIA Warp on the
CPU. Not part of `make bench`; what is not installed is skipped:

    make build/bench/steps
    python3 -m venv build/peers && build/peers/bin/pip install numpy scipy warp-lang
    build/peers/bin/python bench/peers/peers.py
"""
import statistics
import subprocess
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


def scipy_run(n, t):
    from scipy.integrate import solve_ivp

    x, inverse = sheet(n)
    half = x.size

    def rhs(_, y):
        v = y[half:].reshape(x.shape)
        a = accelerations(y[:half].reshape(x.shape), v, inverse, 1.0 / (n - 1))
        return np.concatenate((y[half:], a.ravel()))

    start = np.concatenate((x.ravel(), np.zeros(half)))
    began = time.perf_counter()
    done = solve_ivp(rhs, (0.0, t), start, rtol=1e-12, atol=1e-6, t_eval=[t])
    return time.perf_counter() - began, done.y[:half, -1].reshape(x.shape)


def warp_run(wp, n, t, h):
    x, inverse = sheet(n)
    ps, qs, ks, rest = [], [], [], []
    index = np.arange(n * n).reshape(n, n)
    for down, right, k in WAYS:
        p, q = ends(index, down, right)
        ps.append(p.ravel()), qs.append(q.ravel())
        ks.append(np.full(p.size, k)), rest.append(np.full(p.size, np.hypot(down, right) / (n - 1)))
    p, q = (wp.array(np.concatenate(a), dtype=int, device="cpu") for a in (ps, qs))
    k, s = (wp.array(np.concatenate(a), dtype=wp.float64, device="cpu") for a in (ks, rest))
    m = wp.array(inverse.ravel(), dtype=wp.float64, device="cpu")
    px = wp.array(x.reshape(-1, 3), dtype=wp.vec3d, device="cpu")
    pv, pf = wp.zeros_like(px), wp.zeros_like(px)
    steps = int(np.ceil(t / h))
    pull, move = KERNELS
    wp.launch(pull, dim=0, inputs=[px, pv, p, q, k, s, pf], device="cpu")
    wp.launch(move, dim=0, inputs=[px, pv, pf, m, wp.float64(t / steps)], device="cpu")
    began = time.perf_counter()
    for _ in range(steps):
        wp.launch(pull, dim=p.size, inputs=[px, pv, p, q, k, s, pf], device="cpu")
        wp.launch(move, dim=n * n, inputs=[px, pv, pf, m, wp.float64(t / steps)], device="cpu")
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


def best(run, *args, rounds=3):
    return sorted((run(*args) for _ in range(rounds)), key=lambda r: r[0])[rounds // 2]


def main():
    # the steps of `make bench BENCH=steps`: 858 and 1025
    for n, t, h in ((32, 0.5, 0.5 / 858), (100, 0.1, 0.1 / 1025)):
        seconds = None
        try:
            seconds, reference = best(scipy_run, n, t, rounds=1 if n > 32 else 3)
            print(f"peers P({n}) SciPy RK45, NumPy slices: {seconds:.4g} s", flush=True)
        except ImportError:
            print("peers: SciPy skipped, not installed")
        if wp is None:
            print("peers: Warp skipped, not installed")
            continue
        # round by round, so that both meet the same noise
        rounds = [(warp_run(wp, n, t, h), weft_run(n)) for _ in range(7)]
        elapsed = statistics.median(warp[0] for warp, _ in rounds)
        own = statistics.median(weft for _, weft in rounds)
        x = rounds[0][0][1]
        far = "" if seconds is None else f", {np.abs(x - reference).max():.1e} m from SciPy"
        print(f"peers P({n}) Warp symplectic Euler, h = {h:.3g} s: {elapsed:.4g} s{far}", flush=True)
        print(f"peers P({n}) weft verlet symplectic_euler: {own:.4g} s, ratio {elapsed / own:.2f}", flush=True)


if __name__ == "__main__":
    main()
