# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of rectangles as OBJ files: a structured one, and a lattice of equal triangles at any angle."""
import math
import random


def structured(nx, ny, length, width):
    """Points and triangles of nx x ny cells over (0, length) x (-width/2, width/2), one diagonal each."""
    points = [(length * i / nx, width * (j / ny - 0.5)) for i in range(nx + 1) for j in range(ny + 1)]
    triangles = []
    for i in range(nx):
        for j in range(ny):
            a = i * (ny + 1) + j
            b, c, d = a + ny + 1, a + ny + 2, a + 1
            triangles += [(a, b, c), (a, c, d)]
    return points, triangles


def turned(nx, ny, length, width, degrees):
    """The same rectangle, its inside filled with a lattice of equal triangles of which a row runs at an angle."""
    h = length / nx
    rim = [(length * i / nx, side * 0.5 * width) for i in range(nx + 1) for side in (-1, 1)]
    rim += [(end * length, width * (j / ny - 0.5)) for j in range(1, ny) for end in (0, 1)]
    a, inside = math.radians(degrees), []
    reach = int(2 * (length + width) / h) + 2
    for i in range(-reach, reach):
        for j in range(-reach, reach):
            p, q = h * (i + 0.5 * j + 0.25), h * math.sqrt(0.75) * (j + 0.5)
            x, y = math.cos(a) * p - math.sin(a) * q, math.sin(a) * p + math.cos(a) * q
            if 0.45 * h < x < length - 0.45 * h and abs(y) < 0.5 * width - 0.45 * h:
                inside.append((x, y))
    points = rim + inside
    return points, delaunay(points, h)


def delaunay(points, h):
    """Triangles by Bowyer's and Watson's insertion; ties are broken by moving what decides by 1e-7 h."""
    noise = random.Random(1)
    far = 1e3 * max(max(abs(x), abs(y)) for x, y in points)
    p = [(x + 1e-7 * h * noise.random(), y + 1e-7 * h * noise.random()) for x, y in points]
    p += [(-3 * far, -3 * far), (3 * far, -3 * far), (0.0, 3 * far)]
    n = len(points)

    def circle(a, b, c):
        (ax, ay), (bx, by), (cx, cy) = p[a], p[b], p[c]
        bx, by, cx, cy = bx - ax, by - ay, cx - ax, cy - ay
        d = 2.0 * (bx * cy - by * cx)
        x = (cy * (bx * bx + by * by) - by * (cx * cx + cy * cy)) / d
        y = (bx * (cx * cx + cy * cy) - cx * (bx * bx + by * by)) / d
        return ax + x, ay + y, x * x + y * y

    triangles = {(n, n + 1, n + 2): circle(n, n + 1, n + 2)}
    for i in sorted(range(n), key=lambda i: p[i]):
        x, y = p[i]
        hit = [t for t, (cx, cy, r2) in triangles.items() if (x - cx) ** 2 + (y - cy) ** 2 < r2]
        edges = set()
        for a, b, c in hit:
            del triangles[a, b, c]
            for edge in ((a, b), (b, c), (c, a)):
                if edge[::-1] in edges:
                    edges.discard(edge[::-1])
                else:
                    edges.add(edge)
        for a, b in edges:
            triangles[a, b, i] = circle(a, b, i)

    def area(t):
        (ax, ay), (bx, by), (cx, cy) = (points[k] for k in t)
        return 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))

    return sorted(t for t in triangles if max(t) < n and area(t) > 1e-4 * h * h)


def clamped(points, triangles, ny, width, h):
    """The mesh with a row of cells before x = 0, whose pinned triangles clamp it there; those vertices."""
    rim = sorted((i for i, (x, _) in enumerate(points) if abs(x) < 1e-9 * h), key=lambda i: points[i][1])
    n = len(points)
    points = points + [(-h, width * (j / ny - 0.5)) for j in range(ny + 1)]
    for j in range(ny):
        triangles = triangles + [(n + j, rim[j], rim[j + 1]), (n + j, rim[j + 1], n + j + 1)]
    return points, triangles, rim + list(range(n, n + ny + 1))


def text(points, triangles, start):
    """An OBJ file: where each vertex starts is start(u, v), its rest place (u, v)."""
    lines = ["v %.17g %.17g %.17g" % tuple(start(*point)) for point in points]
    lines += ["vt %.17g %.17g" % point for point in points]
    lines += ["f " + " ".join("%d/%d" % (i + 1, i + 1) for i in t) for t in triangles]
    return "\n".join(lines) + "\n"
