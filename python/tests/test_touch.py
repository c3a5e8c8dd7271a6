# SPDX-License-Identifier: BSD-3-Clause
"""Contact of triangles against a second program: the formulas of docs/theory/contact.md, pair by pair, without a search."""
import warnings
from itertools import combinations

import numpy as np
import pytest

import weft

Delaunay = pytest.importorskip("scipy.spatial").Delaunay

FABRICS = ["11oz-black-denim", "gray-interlock"]
SIZE = 0.1
THICKNESS = 2e-3
ENERGY = 1.3 ** 2 / 2
EXPONENT = 3
SLIP = 1e-3
AT = np.array([0.01, 0.02, 0.03])
ABOUT = np.array([0.03, 0, 0.01])
VELOCITY = np.array([0.1, 0.2, -0.3])


# ---- the formulas ----------------------------------------------------------------------

def window(y, x0):
    y = np.clip(y / x0, 0, 1)
    return y ** 4 * (35 - 84 * y + 70 * y ** 2 - 20 * y ** 3)


def phi(s):
    return s ** EXPONENT / (1 - s)


def dphi(s):
    return (EXPONENT * s ** (EXPONENT - 1) * (1 - s) + s ** EXPONENT) / (1 - s) ** 2


class Primitive:
    """A vertex, an edge or a triangle: its vertices, area as of a vertex, windows, density (None: of a body)."""

    def __init__(self, corners, area, windows, density):
        self.corners, self.area, self.windows, self.density = list(corners), area, windows, density


def primitives(triangles, rest, first, density):
    """Of a surface with these places at rest, whose vertices are numbered from `first` on."""
    areas = [np.linalg.norm(np.cross(rest[b] - rest[a], rest[c] - rest[a])) / 2 for a, b, c in triangles]
    vertex, edge = np.zeros(len(rest)), {}
    for corners, area in zip(triangles, areas):
        vertex[corners] += area / 3
        for pair in combinations(sorted(corners), 2):
            edge[pair] = edge.get(pair, 0) + area
    for i, area in enumerate(vertex):
        yield Primitive([first + i], area, [], density)
    for (p, q), area in edge.items():
        length = np.linalg.norm(rest[p] - rest[q])
        yield Primitive([first + p, first + q], area, [length] * 2, density)
    for corners, area in zip(triangles, areas):
        heights = [2 * area / np.linalg.norm(rest[corners[k - 1]] - rest[corners[k - 2]]) for k in range(3)]
        yield Primitive(first + corners, 2 * area, heights, density)


def feet(a, b, x):
    """The weights of the corners at the nearest points of two primitives; None: not inside both."""
    p, q = x[a.corners], x[b.corners]
    along = np.concatenate([p[1:] - p[0], q[0] - q[1:]]).T
    found = np.linalg.lstsq(along, q[0] - p[0], rcond=None)[0] if along.size else np.zeros(0)
    weights = [np.r_[1 - part.sum(), part] for part in np.split(found, [len(p) - 1])]
    return weights if min(map(min, weights)) > 0 else None


def energy(a, b, x, free):
    """U, W, M and the gap of a pair; None: it does not act."""
    weights = feet(a, b, x)
    densities = [side.density for side in (a, b) if side.density and free[side.corners].any()]
    if weights is None or not densities:
        return None
    gap = np.linalg.norm(weights[0] @ x[a.corners] - weights[1] @ x[b.corners])
    if gap >= THICKNESS:
        return None
    q, w, crossed = np.sqrt(1 + (THICKNESS / (8 * gap)) ** 2), 1.0, len(a.corners) == len(b.corners) == 2
    for side, foot in zip((a, b), weights):
        for length, s in zip(side.windows, foot):
            w *= window(s, min(THICKNESS / length, 0.3) / q)
    if crossed:
        c = np.cross(*(x[side.corners[1]] - x[side.corners[0]] for side in (a, b)))
        w *= window(c @ c / (a.windows[0] * b.windows[0]) ** 2, 0.25 / q ** 2)
    mass = min(densities) * (1 / 8 if crossed else 1) * a.area * b.area / (a.area + b.area)
    return mass * ENERGY * w * phi(1 - gap / THICKNESS), w, mass, gap


def force(a, b, x, v, free, damping, friction, out):
    """Adds -dU/dx by differences, damping and friction to `out`."""
    for i in a.corners + b.corners:
        for k in range(3):
            ends = []
            for h in (1e-8, -1e-8):
                moved = x.copy()
                moved[i, k] += h
                ends.append((energy(a, b, moved, free) or [0])[0])
            out[i, k] -= (ends[0] - ends[1]) / 2e-8
    _, w, mass, gap = energy(a, b, x, free)
    weights, s = feet(a, b, x), 1 - gap / THICKNESS
    apart, speed = (weights[0] @ of[a.corners] - weights[1] @ of[b.corners] for of in (x, v))
    normal = apart / gap
    n0 = mass * ENERGY * w * dphi(s) / THICKNESS
    stiffness = mass * ENERGY * w * (dphi(s + 1e-6) - dphi(s - 1e-6)) / 2e-6 / THICKNESS ** 2
    u = damping * (normal @ speed)
    push = n0 * (np.sqrt(1 + u * u) - u)
    slide = speed - (normal @ speed) * normal
    if w > 0:
        pull = (push - n0) * normal - friction * push * slide / np.sqrt(
            slide @ slide + SLIP ** 2 + (friction * push / (10 * np.sqrt(stiffness * mass))) ** 2)
        out[a.corners] += np.outer(weights[0], pull)
        out[b.corners] -= np.outer(weights[1], pull)


def contact_of(sides, meet, x, v, free, damping, friction):
    """The energy, and the force on each vertex."""
    total, out = 0.0, np.zeros_like(x)
    for a, b in combinations(sides, 2):
        kinds = len(a.corners), len(b.corners)
        if (min(kinds) == 1 or kinds == (2, 2)) and meet(a, b) and not set(a.corners) & set(b.corners):
            found = energy(a, b, x, free)
            if found:
                total += found[0]
                force(a, b, x, v, free, damping, friction, out)
    return total, out


# ---- the same by weft ------------------------------------------------------------------

def panel(n, seed, place):
    """Any triangulation of a square: (u, v), triangles and positions, almost level."""
    rng, grid = np.random.default_rng(seed), np.linspace(0, SIZE, n)
    uv = np.array([(a, b) for a in grid for b in grid])
    inside = ((uv > 0) & (uv < SIZE)).all(1)
    uv[inside] += rng.uniform(-0.25, 0.25, (inside.sum(), 2)) * grid[1]
    triangles = Delaunay(uv).simplices.astype(int)
    area = np.linalg.det(uv[triangles[:, 1:]] - uv[triangles[:, :1]])
    triangles[area < 0] = triangles[area < 0][:, ::-1]
    height = 0.1 * THICKNESS * (np.sin(40 * uv[:, 0] + 30 * uv[:, 1]) + rng.uniform(-1, 1, len(uv)))
    return uv, triangles[abs(area) > 1e-9 * SIZE ** 2], np.c_[uv, height] + place


def loaded(scene, seed):
    scene = {"weft": 1, **scene, "stepper": {"plugin": "arkode", "method": "dormand_prince", "rtol": 1e-6},
             "run": {"duration": 0.01, "fps": 200}}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", weft.SceneWarning)
        sim = weft.load(scene)
    sim.velocities = np.random.default_rng(seed).normal(0, 0.5, (sim.particles, 3)) * ~sim.pinned[:, None]
    return sim


def agree(scene, sides, meet, body=None, damping=0.0, friction=0.0):
    """Energy and forces of contact; body: positions and velocities of its vertices."""
    contact = {"thickness": THICKNESS, "stopping_speed": 1.3, "exponent": EXPONENT,
               "damping": damping, "friction": friction}
    floor = {"shape": "plane", "at": [0, 0, -5], "normal": [0, 0, 1]}
    sim = loaded({**scene, "contact": {**contact, **scene["contact"]}}, 1)
    apart = loaded({**scene, "contact": {**contact, "shapes": [floor]}}, 1)
    n = sim.particles
    got = [(one.rhs(0, one.state)[3 * n:].reshape(3, n)[:, sim.index].T * sim.masses[:, None])[~sim.pinned]
           for one in (sim, apart)]
    x, v = sim.positions, sim.velocities
    free = ~sim.pinned
    if body:
        x, v, free = np.r_[x, body[0]], np.r_[v, body[1]], np.r_[free, np.zeros(len(body[0]), bool)]
    total, out = contact_of(sides(sim), meet, x, v, free, damping, friction)
    assert total > 0 and sim.energy.contact == pytest.approx(total, rel=1e-12)
    want = out[:n][~sim.pinned]
    assert abs(got[0] - got[1] - want).max() < 1e-8 * abs(want).max()


LAWS = [{}, {"damping": 0.7, "friction": 0.4}]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("fabrics", [FABRICS[:1] * 2, FABRICS])
def test_two_cloths_touch_as_a_second_program_says(fabrics, law):
    panels = [panel(4, 5, [0.013, -0.017, 0.4 * THICKNESS]), panel(3, 6, [0, 0, 0])]
    cloths = [{"name": "ab"[k], "mesh": weft.Mesh(uv, start, triangles, groups={"held": [k]}), "pins": [{"group": "held"}],
               "fabric": {"preset": fabrics[k], "damping": [1e-5, 1e-5]}}
              for k, (uv, triangles, start) in enumerate(panels)]

    def sides(sim):
        first = [0, len(panels[0][0])]
        masses = np.split(sim.masses, first[1:])
        return [side for k, (uv, triangles, _) in enumerate(panels)
                for side in primitives(triangles, np.c_[uv, 0 * uv[:, 0]], first[k], masses[k].sum() / SIZE ** 2)]

    agree({"cloths": cloths, "contact": {"self": True}}, sides, lambda a, b: True, **law)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("turns", [False, True])
def test_a_cloth_touches_a_moving_body_as_a_second_program_says(turns, law):
    uv, triangles, start = panel(4, 5, [0, 0, 0.4 * THICKNESS])
    _, faces, places = panel(3, 6, [0.013, -0.017, 0])
    cloth = {"mesh": weft.Mesh(uv, start, triangles, groups={"held": [0]}), "pins": [{"group": "held"}],
             "fabric": {"preset": FABRICS[0], "damping": [1e-5, 1e-5]}}
    shape = {"shape": "mesh", "file": (places - AT, faces), "at": AT.tolist(), "velocity": VELOCITY.tolist(),
             "friction": law.get("friction", 0)}
    speeds = np.tile(VELOCITY, (len(places), 1))
    if turns:
        shape["turn"] = {"axis": [1, 2, 2], "about": ABOUT.tolist(), "rate": 1.5, "amplitude": 0.2, "frequency": 0.7}
        speeds += np.cross(np.array([1, 2, 2]) / 3 * (1.5 + 0.2 * 2 * np.pi * 0.7), places - ABOUT)

    def sides(sim):
        return [*primitives(triangles, np.c_[uv, 0 * uv[:, 0]], 0, sim.masses.sum() / SIZE ** 2),
                *primitives(faces, places, len(uv), None)]

    agree({"cloth": cloth, "contact": {"shapes": [shape]}}, sides,
          lambda a, b: (a.density is None) != (b.density is None), (places, speeds), **law)
