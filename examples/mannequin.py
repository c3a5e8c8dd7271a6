#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a mannequin, a body for cloth: ellipsoids that overlap, in metres, y up, 1.74 m tall. Each is closed.

    python3 mannequin.py > mannequin.obj
    python3 mannequin.py walk-%02d.obj
    python3 mannequin.py dressed-body.obj

scenes/poncho.yaml has the first result. The second are coarser ones, key frames of a walk towards +z on the spot, KEYS to a
second, for scenes/walk.yaml. The third is slim and has its arms out, for the clothes of scenes/dressed.yaml."""
import math
import sys

# Centre x y z, half axes, turn about z [degrees], limb; with a mirror image if x is not 0.
PARTS = [
    ((0, 1.62, 0), (0.080, 0.115, 0.095), 0, None),    # head
    ((0, 1.47, 0), (0.055, 0.100, 0.055), 0, None),    # neck
    ((0, 1.24, 0), (0.165, 0.190, 0.110), 0, None),    # chest
    ((0.135, 1.365, 0), (0.085, 0.060, 0.065), -20, None),  # shoulders
    ((0, 1.04, 0), (0.135, 0.200, 0.095), 0, None),    # waist
    ((0, 0.90, 0), (0.175, 0.140, 0.120), 0, None),    # hips
    ((0.235, 1.190, 0), (0.050, 0.190, 0.050), 14, "arm"),
    ((0.300, 0.900, 0), (0.040, 0.170, 0.040), 10, "forearm"),
    ((0.090, 0.640, 0), (0.085, 0.270, 0.090), 0, "thigh"),
    ((0.090, 0.250, 0), (0.060, 0.250, 0.065), 0, "shin"),
]
ARMS_OUT = [
    ((0, 1.76, 0), (0.075, 0.115, 0.090), 0, None),
    ((0, 1.53, 0.003), (0.036, 0.150, 0.036), 0, None),
    ((0, 1.26, 0), (0.128, 0.170, 0.056), 0, None),
    ((0.105, 1.405, 0), (0.095, 0.045, 0.042), -6, None),
    ((0, 1.06, 0), (0.115, 0.180, 0.054), 0, None),
    ((0, 0.852, 0), (0.122, 0.115, 0.112), 0, None),
    ((0.290, 1.420, 0), (0.160, 0.033, 0.033), 2, None),
    ((0.530, 1.430, 0), (0.150, 0.027, 0.027), 2, None),
    ((0.065, 0.600, 0), (0.058, 0.240, 0.060), 0, None),
    ((0.065, 0.250, 0), (0.045, 0.250, 0.048), 0, None),
]
RINGS, SIDES = 16, 24
JOINTS = {"thigh": [("hip", 0.86)], "shin": [("knee", 0.47), ("hip", 0.86)],  # and their heights [m]
          "arm": [("shoulder", 1.36)], "forearm": [("elbow", 1.04), ("shoulder", 1.36)]}
WALK, KEYS, CYCLE = 3.0, 4, 1.25  # [s], [1/s], [s] of two paces


def bend(time, side):
    """The angle [rad] of each joint, forwards, in a walk that begins within the first second."""
    stride = 1 - (1 - min(time, 1)) ** 3
    phase = 2 * math.pi * time / CYCLE + (math.pi if side < 0 else 0)
    lift = (1 + math.cos(phase + 0.3)) ** 2 / 4
    return {"hip": 0.45 * stride * math.sin(phase), "knee": -0.9 * stride * lift,
            "shoulder": -0.4 * stride * math.sin(phase), "elbow": 0.35 * stride}


def pose(points, limb, angles):
    for joint, height in JOINTS.get(limb, []):
        sine, cosine = math.sin(angles[joint]), math.cos(angles[joint])
        points = [(x, height + cosine * (y - height) + sine * z, cosine * z - sine * (y - height)) for x, y, z in points]
    return points


def ellipsoid(centre, half, turn, rings, sides):
    """Vertices and faces: two poles, and rings between them."""
    sine, cosine = math.sin(math.radians(turn)), math.cos(math.radians(turn))
    points = [(0.0, 1.0, 0.0)]
    for r in range(1, rings):
        polar = math.pi * r / rings
        points += [(math.sin(polar) * math.cos(a), math.cos(polar), math.sin(polar) * math.sin(a))
                   for a in (2 * math.pi * s / sides for s in range(sides))]
    points.append((0.0, -1.0, 0.0))
    placed = []
    for point in points:
        x, y, z = (h * p for h, p in zip(half, point))
        placed.append((centre[0] + cosine * x - sine * y, centre[1] + sine * x + cosine * y, centre[2] + z))
    at = lambda ring, side: 1 + (ring - 1) * sides + side % sides  # noqa: E731
    faces = [(0, at(1, s + 1), at(1, s)) for s in range(sides)]
    faces += [(at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)) for r in range(1, rings - 1) for s in range(sides)]
    faces += [(len(points) - 1, at(rings - 1, s), at(rings - 1, s + 1)) for s in range(sides)]
    return placed, faces


def write(out, digits, rings=RINGS, sides=SIDES, time=0.0, parts=PARTS):
    first = 1
    print("# made by examples/mannequin.py", file=out)
    for centre, half, turn, limb in parts:
        for side in (1, -1) if centre[0] != 0 else (1,):
            points, faces = ellipsoid((side * centre[0], *centre[1:]), half, side * turn, rings, sides)
            for point in pose(points, limb, bend(time, side)):
                print("v " + " ".join("%.*f" % (digits, x) for x in point), file=out)
            print("\n".join("f " + " ".join(str(first + c) for c in face) for face in faces), file=out)
            first += len(points)


if len(sys.argv) < 2:
    write(sys.stdout, 5)
elif "%" not in sys.argv[1]:
    with open(sys.argv[1], "w") as body:
        write(body, 4, 10, 14, parts=ARMS_OUT)
else:
    for key in range(round(WALK * KEYS) + 1):
        with open(sys.argv[1] % key, "w") as frame:
            write(frame, 3, 6, 10, key / KEYS)
