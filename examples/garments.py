# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# # Garments from panels
#
# Writes the OBJ files of scenes/skirt.yaml, scenes/tshirt.yaml and scenes/dressed.yaml, and shows what an OBJ of a garment holds:
# each panel flat (vt) with its triangles, one vertex (v) where panels are sewn, and where the garment starts (v).
# `python examples/garments.py` needs NumPy and SciPy.

# %%
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay


def along(corners, spacing):
    """Points along a polygonal line, evenly within each of its sides; the last corner is left out."""
    points = []
    for a, b in zip(np.array(corners[:-1], float), np.array(corners[1:], float)):
        count = max(1, round(np.linalg.norm(b - a) / spacing))
        points += [a + (b - a) * k / count for k in range(count)]
    return points


def even(curve, spacing):
    """Points along a curve at even distances."""
    curve = np.array(curve)
    length = np.append(0, np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1)))
    at = np.linspace(0, length[-1], max(1, round(length[-1] / spacing)) + 1)
    return [*zip(np.interp(at, length, curve[:, 0]), np.interp(at, length, curve[:, 1]))]


def inside(points, rim):
    """Which points lie in a polygon (even-odd rule)."""
    a, b = rim, np.roll(rim, -1, 0)
    u, v = points[:, :1], points[:, 1:]
    crosses = (a[:, 1] > v) != (b[:, 1] > v)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = u < a[:, 0] + (v - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return (crosses & left).sum(1) % 2 == 1


def triangles(places, rim, spacing):
    """Of Delaunay, counterclockwise: those in the polygon, without the flat ones along its sides."""
    corners = Delaunay(places).simplices
    a, b, c = (places[corners[:, k]] for k in range(3))
    twice = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    corners[twice < 0] = corners[twice < 0][:, ::-1]
    return corners[inside((a + b + c) / 3, rim) & (abs(twice) > 1e-3 * spacing**2)]


def panel(rim, spacing, rounds=30):
    """Triangles of a polygon: places (n, 2), of which the rim's come first, and corners (m, 3)."""
    rim = np.array(rim)
    low, high = rim.min(0), rim.max(0)
    rows = np.arange(low[1], high[1], spacing * np.sqrt(0.75))
    grid = [(u + spacing / 2 * (k % 2), v) for k, v in enumerate(rows) for u in np.arange(low[0], high[0], spacing)]
    free = np.array(grid)[inside(np.array(grid), rim)]
    far = np.min(np.linalg.norm(free[:, None] - rim[None], axis=2), axis=1) > 0.6 * spacing
    places = np.vstack([rim, free[far]])
    for _ in range(rounds):  # each point inside goes to the mean of its neighbours
        corners = triangles(places, rim, spacing)
        edges = np.vstack([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
        total, count = np.zeros_like(places), np.zeros(len(places))
        np.add.at(total, edges[:, 0], places[edges[:, 1]])
        np.add.at(count, edges[:, 0], 1)
        places[len(rim):] = (total / count[:, None])[len(rim):]
    return places, triangles(places, rim, spacing)


def least_angle(places, corners):
    a, b, c = (places[corners[:, k]] for k in range(3))
    angles = []
    for p, q, r in ((a, b, c), (b, c, a), (c, a, b)):
        x, y = q - p, r - p
        angles.append(np.degrees(np.arccos((x * y).sum(1) / np.linalg.norm(x, axis=1) / np.linalg.norm(y, axis=1))))
    return np.min(angles)


class Garment:
    """Panels whose vertices are one where they start at one point."""

    def __init__(self, comment):
        self.lines, self.vertices, self.places, self.faces, self.of = [comment], [], [], [], {}

    def add(self, name, places, corners, start, groups=()):
        """A panel; `start` gives the first position of a place, `groups` (name, places) what pins may hold."""
        print("%s: %d triangles, least angle %.0f degrees" % (name, len(corners), least_angle(places, corners)))
        numbers = []
        for place in places:
            point = tuple(np.round(start(place), 6) + 0.0)
            if point not in self.of:
                self.of[point] = len(self.vertices) + 1
                self.vertices.append(point)
            numbers.append(self.of[point])
        first = len(self.places) + 1
        self.places += [tuple(np.round(p, 6) + 0.0) for p in places]
        self.faces.append("g " + name)
        for face in corners:
            self.faces.append("f " + " ".join("%d/%d" % (numbers[k], first + k) for k in face))
        for group, members in groups:
            self.faces += ["g " + group, "p " + " ".join(str(numbers[k]) for k in members)]

    def write(self, path):
        text = ["# " + line for line in self.lines]
        text += ["v %.6g %.6g %.6g" % v for v in self.vertices] + ["vt %.6g %.6g" % p for p in self.places]
        Path(path).write_text("\n".join(text + self.faces) + "\n")
        print("%s: %d vertices" % (path, len(self.vertices)))


# %% [markdown]
# ## A skirt of two panels
#
# Each is half of a cone's side, flat a sector of a ring, so that the skirt starts without strain. It hangs from its waist.

# %%
def skirt(spacing, waist=0.11, length=0.45, flare=np.radians(24)):
    """Two panels of a cone: radius [m] at the waist, side [m], half the angle of the cone."""
    near = waist / np.sin(flare)
    half = np.pi / 2 * np.sin(flare)  # of the sector's angle
    polar = lambda r, a: (r * np.sin(a), -r * np.cos(a))
    count = lambda r: max(2, round(2 * half * r / spacing))
    side = max(2, round(length / spacing))
    rim = [polar(near + length, a) for a in np.linspace(-half, half, count(near + length), endpoint=False)]
    rim += [polar(r, half) for r in np.linspace(near + length, near, side, endpoint=False)]
    top = len(rim)
    rim += [polar(near, a) for a in np.linspace(half, -half, count(near), endpoint=False)]
    rim += [polar(r, -half) for r in np.linspace(near, near + length, side, endpoint=False)]
    places, corners = panel(rim, spacing)

    def start(place, back):
        r, turn = np.hypot(*place), np.arctan2(place[0], -place[1]) / half * np.pi / 2  # 0: the middle of the panel
        x, z = r * np.sin(flare) * np.sin(turn), r * np.sin(flare) * np.cos(turn)
        return x, -(r - near) * np.cos(flare), -z if back else z

    result = Garment("A skirt of two panels that starts as a cone, made by examples/garments.py")
    waistline = range(top, top + count(near) + 1)
    result.add("front", places, corners, lambda p: start(p, False), [("waist", waistline)])
    result.add("back", places * (-1, 1), corners[:, ::-1], lambda p: start(p * (-1, 1), True), [("waist", waistline)])
    return result


# %% [markdown]
# ## A T-shirt of four panels
#
# Front and back, cut square, and two sleeves that are folded along the arm. It starts as it lies when folded, but with its
# layers apart, and hangs from the seams of its shoulders.

# %%
NECK, SHOULDER, ARMPIT, HEM = (0.09, 0.0), (0.22, -0.045), (0.23, -0.235), (0.24, -0.62)
SLEEVE, CUFF = 0.17, 0.15  # [m] along the fold, and of each half across it
LAYER = 0.03  # [m] how far a layer is from the plane of the garment


def bulge(distance, layer=LAYER, slope=0.25):
    return layer * (1 - np.exp(-slope * distance / layer))


def distance(point, lines):
    """From the nearest of the lines between points (a, b)."""
    least = np.inf
    for a, b in lines:
        a, b = np.array(a), np.array(b)
        s = np.clip(np.dot(point - a, b - a) / np.dot(b - a, b - a), 0, 1)
        least = min(least, np.linalg.norm(point - a - s * (b - a)))
    return least


def mirror(points):
    return [(-u, v) for u, v in reversed(points)]


def body(spacing, scoop):
    """Rim of a front or a back with a neckline so deep [m], and the places of its shoulders."""
    neck = even([(NECK[0] * np.cos(a), -scoop * np.sin(a)) for a in np.linspace(0, np.pi, 200)], spacing)
    rim = along([mirror([HEM])[0], HEM], spacing)  # the hem, from the left
    sides = []
    for a, b in ((HEM, ARMPIT), (ARMPIT, SHOULDER), (SHOULDER, NECK)):
        sides += along([a, b], spacing)
    first = len(rim) + len(along([HEM, ARMPIT], spacing)) + len(along([ARMPIT, SHOULDER], spacing))
    count = len(along([SHOULDER, NECK], spacing))
    line = neck[:-1]
    left = mirror([tuple(p) for p in sides] + [NECK])[:-1]
    shoulders = [*range(first, first + count + 1)]
    total = len(rim) + len(sides) + len(line)
    shoulders += range(total, total + count + 1)
    return rim + sides + line + left, shoulders


def tshirt(spacing, layer=LAYER, slope=0.25, narrow=1.0):
    """`layer` [m] and `slope` of the layers away from the seams; `narrow` times as wide as flat."""
    seams = [(HEM, ARMPIT), (SHOULDER, NECK)]
    seams += [((-a[0], a[1]), (-b[0], b[1])) for a, b in seams]
    result = Garment("A T-shirt of four panels, made by examples/garments.py")
    for name, scoop, side in (("front", 0.09, 1), ("back", 0.025, -1)):
        rim, shoulders = body(spacing, scoop)
        places, corners = panel(rim, spacing)
        start = lambda p, side=side: (narrow * p[0], p[1], side * bulge(distance(p, seams), layer, slope))
        if side > 0:
            result.add(name, places, corners, start, [("shoulders", shoulders)])
        else:
            result.add(name, places * (-1, 1), corners[:, ::-1], lambda p: start(p * (-1, 1)), [("shoulders", shoulders)])

    # flat: u along the arm from the armhole, v across it, 0 at the fold; v < 0 in front
    down = np.array(ARMPIT) - np.array(SHOULDER)
    hole = np.linalg.norm(down)
    down /= hole
    out = np.array((-down[1], down[0]))
    count = len(along([ARMPIT, SHOULDER], spacing))
    cap = [(0.0, hole * (1 - k / count)) for k in range(2 * count)]  # as the body's armhole is divided
    rim = cap + along([(0.0, -hole), (SLEEVE, -CUFF)], spacing)
    rim += along([(SLEEVE, -CUFF), (SLEEVE, CUFF)], spacing) + along([(SLEEVE, CUFF), (0.0, hole)], spacing)
    places, corners = panel(rim, spacing)

    def arm(p, side):
        x, y = np.array(SHOULDER) + p[0] * out + abs(p[1]) * down
        apart = min(abs(p[1]), hole + (CUFF - hole) * p[0] / SLEEVE - abs(p[1]))
        return side * narrow * x, y, -np.sign(p[1]) * bulge(apart, layer, slope)

    result.add("left sleeve", places, corners, lambda p: arm(p, 1))
    result.add("right sleeve", places * (-1, 1), corners[:, ::-1], lambda p: arm(p * (-1, 1), -1))
    return result


# %%
skirt(0.02).write("skirt.obj")
skirt(0.035, waist=0.1).write("dressed-skirt.obj")
tshirt(0.022).write("tshirt.obj")
tshirt(0.03, layer=0.13, slope=0.9, narrow=0.82).write("dressed-shirt.obj")  # open, with room for a body
