# SPDX-License-Identifier: BSD-3-Clause
"""The membrane and the bending of a mesh, assembled a second time in NumPy from the formulas of docs/theory (model.md,
bending.md), by other ways where there are some: deformation gradients instead of edges, pseudo-inverses instead of pivoted QR."""

import numpy as np
import pytest
import weft

STRETCH, SHEAR, COUPLING = (1000.0, 700.0), 150.0, 100.0  # warp, weft [N/m]
BEND, TWIST = (2e-3, 1e-3), 1.5e-3  # warp, weft [N m]


def sheet(rows, cols, jitter, seed):
    rng = np.random.default_rng(seed)
    v, u = np.mgrid[:rows, :cols] * 0.03
    inside = np.zeros((rows, cols), bool)
    inside[1:-1, 1:-1] = True
    move = rng.uniform(-jitter, jitter, (2, rows, cols)) * inside * 0.03
    number = np.arange(rows * cols).reshape(rows, cols)
    corners = []
    for a, b, c, d in zip(*(x.ravel() for x in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))):
        corners += [[a, b, c], [a, c, d]] if rng.random() < 0.5 else [[a, b, d], [b, c, d]]
    return np.c_[(u + move[0]).ravel(), (v + move[1]).ravel()], np.array(corners)


def membrane(rest, triangles, x):
    """The forces of F S, S = C : (F^T F - 1) / 2, in each triangle."""
    force = np.zeros_like(x)
    for t in triangles:
        edges = (rest[t[1:]] - rest[t[0]]).T
        gradient = np.linalg.inv(edges)  # of the second and the third corner
        gradient = np.vstack([-gradient.sum(0), gradient])
        f = x[t].T @ gradient
        e = (f.T @ f - np.eye(2)) / 2
        s11 = STRETCH[1] * e[0, 0] + COUPLING * e[1, 1]
        s22 = STRETCH[0] * e[1, 1] + COUPLING * e[0, 0]
        s = np.array([[s11, 2 * SHEAR * e[0, 1]], [2 * SHEAR * e[0, 1], s22]])
        force[t] -= np.linalg.det(edges) / 2 * gradient @ s @ f.T
    return force


def fit(points, normal, metric):
    """The weights of a slope along the normal at 0, or None, and their size by that of the slope."""
    w, q = np.linalg.eigh(metric)
    root = q / np.sqrt(w) @ q.T
    a, b = root @ points.T
    rows = np.stack([np.ones_like(a), a, b, a * a / 2, b * b / 2, a * b], 1)
    weight = 1 / (0.3 + 0.675 * (a * a + b * b))
    d = np.r_[0, root @ normal, 0, 0, 0]
    normal_matrix = rows.T * weight @ rows
    inverse = np.linalg.pinv(normal_matrix, rcond=1e-10, hermitian=True)
    exact = np.linalg.norm(normal_matrix @ inverse @ d - d) < 1e-6 * np.linalg.norm(d)
    c = weight * (rows @ inverse @ d)
    return (c if exact else None), np.linalg.norm(c) / np.linalg.norm(d)


def rings(neighbours, begin):
    known = set(begin)
    yield set(known)
    while ring := set().union(*(neighbours[i] for i in known)) - known:
        known |= ring
        yield ring


def slope(rest, neighbours, p, q):
    """Of the edge p to q: particles and weights, along (t_v, -t_u)."""
    t = (rest[q] - rest[p]) / np.linalg.norm(rest[q] - rest[p])
    normal, middle = np.array([t[1], -t[0]]), (rest[p] + rest[q]) / 2
    around = list(rings(neighbours, [p, q]))
    patch = sorted(around[0] | around[1])
    y = rest[patch] - middle
    metric = y.T @ y / len(y)
    further = [i for ring in around[2:4] for i in ring]
    if len(further) < 12:
        further = [i for ring in around[2:6] for i in ring]
    w, root = np.linalg.eigh(metric)
    far = np.linalg.norm((rest[further] - middle) @ (root / np.sqrt(w)), axis=1)
    further = [i for _, i in sorted(zip(far, further))]
    far, best, size = sorted(far), None, np.inf
    for _ in range(13):
        if len(patch) >= 10 or not further:
            c, a = fit(rest[patch] - middle, normal, metric)
            if c is not None and a < size:
                best, size = (list(patch), c), a
            if size <= 1 or not further:
                break
        limit = far[0] + 1e-9
        while further and far[0] <= limit:
            patch.append(further.pop(0))
            far.pop(0)
    return best


def bending(rest, triangles):
    """K of Morley's energy with rebuilt slopes; edges of the rim are free."""
    n = len(rest)
    neighbours = [set() for _ in rest]
    beside = {}
    for t in triangles:
        for k in range(3):
            p, q = sorted((t[k], t[k - 2]))
            beside.setdefault((p, q), []).append(t)
            neighbours[p].add(q), neighbours[q].add(p)
    slopes = {e: slope(rest, neighbours, *e) for e, both in beside.items() if len(both) == 2}
    stiffness = np.array([[BEND[1], 0, 0], [0, BEND[0], 0], [0, 0, TWIST / 2]])
    matrix = np.zeros((n, n))
    for t in triangles:
        area = np.linalg.det((rest[t[1:]] - rest[t[0]]).T) / 2
        h, rim = np.zeros((3, n)), []
        for k in range(3):
            p, q = t[k], t[k - 2]
            length = np.linalg.norm(rest[q] - rest[p])
            tangent = (rest[q] - rest[p]) / length
            normal = np.array([tangent[1], -tangent[0]])
            nn, tn = np.outer(normal, normal), np.outer(tangent, normal)
            nn, tn = ([m[0, 0], m[1, 1], m[0, 1] + m[1, 0]] for m in (nn, (tn + tn.T) / 2))
            h[:, q] += np.array(tn) / area
            h[:, p] -= np.array(tn) / area
            edge = (min(p, q), max(p, q))
            if edge in slopes:
                particles, c = slopes[edge]
                h[:, particles] += length / area * (1 if p < q else -1) * np.outer(nn, c)
            else:
                rim.append(nn)
        m = np.array(rim).T if rim else np.zeros((3, 0))
        relaxed = stiffness - stiffness @ m @ np.linalg.pinv(m.T @ stiffness @ m) @ m.T @ stiffness
        matrix += area * h.T @ relaxed @ h
    return matrix


@pytest.mark.parametrize("rows, cols, jitter", [(9, 12, 0.0), (9, 12, 0.3), (7, 7, 0.2)])
def test_forces_are_those_of_an_assembly_in_numpy(rows, cols, jitter):
    rest, triangles = sheet(rows, cols, jitter, 3)
    start = np.c_[rest, np.zeros(len(rest))]
    fabric = {"density": 0.2, "stretch": list(STRETCH), "shear": SHEAR, "coupling": COUPLING,
              "bend": list(BEND), "twist": TWIST}
    sim = weft.load({
        "weft": 1,
        "cloth": {"mesh": weft.Mesh(rest, start, triangles), "fabric": fabric},
        "forces": {"gravity": [0, 0, 0]},
        "stepper": {"plugin": "verlet", "method": "velocity_verlet", "fixed_step": 1e-6},
        "run": {"duration": 0.1, "fps": 30},
    })
    x = start + np.random.default_rng(5).normal(size=start.shape) * 1e-3
    x[:, 2] += 0.05 * np.sin(8 * rest[:, 0])
    sim.set_state(x, np.zeros_like(x))
    n = len(rest)
    force = np.empty((n, 3))
    order = np.argwhere((sim.state[:3 * n].reshape(3, n).T[:, None] == x).all(2))
    force[order[:, 1]] = sim.rhs(0.0, sim.state)[3 * n:].reshape(3, n).T[order[:, 0]]
    force *= sim.masses[:, None]
    own = membrane(rest, triangles, x)
    for part in (own, own - bending(rest, triangles) @ x):
        assert np.abs(part).max() > 1e-3
    difference = np.abs(force - part).max() / np.abs(part).max()
    assert difference < 1e-11, difference
