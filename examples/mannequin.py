#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a mannequin, a body for cloth: ellipsoids that overlap, in metres, y up, 1.74 m tall. Each is closed.

    python3 mannequin.py > mannequin.obj

scenes/poncho.yaml has the result."""
import math

# Centre x y z, half axes, turn about z [degrees]; with a mirror image if x is not 0.
PARTS = [
    ((0, 1.62, 0), (0.080, 0.115, 0.095), 0),    # head
    ((0, 1.47, 0), (0.055, 0.100, 0.055), 0),    # neck
    ((0, 1.24, 0), (0.165, 0.190, 0.110), 0),    # chest
    ((0.135, 1.365, 0), (0.085, 0.060, 0.065), -20),  # shoulders
    ((0, 1.04, 0), (0.135, 0.200, 0.095), 0),    # waist
    ((0, 0.90, 0), (0.175, 0.140, 0.120), 0),    # hips
    ((0.235, 1.190, 0), (0.050, 0.190, 0.050), 14),   # upper arms
    ((0.300, 0.900, 0), (0.040, 0.170, 0.040), 10),   # forearms
    ((0.090, 0.640, 0), (0.085, 0.270, 0.090), 0),    # thighs
    ((0.090, 0.250, 0), (0.060, 0.250, 0.065), 0),    # shins
]
RINGS, SIDES = 16, 24


def ellipsoid(centre, half, turn):
    """Vertices and faces: two poles, and rings between them."""
    sine, cosine = math.sin(math.radians(turn)), math.cos(math.radians(turn))
    points = [(0.0, 1.0, 0.0)]
    for r in range(1, RINGS):
        polar = math.pi * r / RINGS
        points += [(math.sin(polar) * math.cos(a), math.cos(polar), math.sin(polar) * math.sin(a))
                   for a in (2 * math.pi * s / SIDES for s in range(SIDES))]
    points.append((0.0, -1.0, 0.0))
    placed = []
    for point in points:
        x, y, z = (h * p for h, p in zip(half, point))
        placed.append((centre[0] + cosine * x - sine * y, centre[1] + sine * x + cosine * y, centre[2] + z))
    at = lambda ring, side: 1 + (ring - 1) * SIDES + side % SIDES  # noqa: E731
    faces = [(0, at(1, s + 1), at(1, s)) for s in range(SIDES)]
    faces += [(at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)) for r in range(1, RINGS - 1) for s in range(SIDES)]
    faces += [(len(points) - 1, at(RINGS - 1, s), at(RINGS - 1, s + 1)) for s in range(SIDES)]
    return placed, faces


def main():
    first = 1
    print("# made by examples/mannequin.py")
    for centre, half, turn in PARTS:
        for side in (1, -1) if centre[0] != 0 else (1,):
            points, faces = ellipsoid((side * centre[0], *centre[1:]), half, side * turn)
            print("\n".join("v %.5f %.5f %.5f" % point for point in points))
            print("\n".join("f " + " ".join(str(first + c) for c in face) for face in faces))
            first += len(points)


if __name__ == "__main__":
    main()
