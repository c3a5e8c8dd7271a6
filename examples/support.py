#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the support of Cusick's drape test: a closed disc of 18 cm, 6 mm thick, whose edge is rounded by 1 mm; its top lies
in the plane y = 0.

    python3 support.py > support.obj"""
import math

RADIUS, THICK, ROUND, SIDES, ARC = 0.09, 0.006, 0.001, 72, 4
profile = [(RADIUS - ROUND + ROUND * math.sin(a), y + s * ROUND * math.cos(a))
           for s, y in ((1, -ROUND), (-1, ROUND - THICK))
           for a in (math.pi / 2 * (k if s > 0 else ARC - k) / ARC for k in range(ARC + 1))]
rings = [(RADIUS / 3, 0.0), (2 * RADIUS / 3, 0.0)] + profile + [(2 * RADIUS / 3, -THICK), (RADIUS / 3, -THICK)]

print("# made by examples/support.py\nv 0 0 0")
for r, y in rings:
    for a in (2 * math.pi * s / SIDES for s in range(SIDES)):
        print("v %.7f %.7f %.7f" % (r * math.cos(a), y, r * math.sin(a)))
print("v 0 %.7f 0" % -THICK)
at = lambda ring, side: 2 + ring * SIDES + side % SIDES  # noqa: E731
for s in range(SIDES):
    print("f 1", at(0, s + 1), at(0, s))
for r in range(len(rings) - 1):
    for s in range(SIDES):
        print("f", at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s))
for s in range(SIDES):
    print("f", 2 + len(rings) * SIDES, at(len(rings) - 1, s), at(len(rings) - 1, s + 1))
