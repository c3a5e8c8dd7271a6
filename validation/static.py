# SPDX-License-Identifier: BSD-3-Clause
"""Cases of cloth at rest: the heavy elastica, a catenary, a hanging sheet, a twisted ribbon."""
import math

import exact
import meshes
from figures import plot
from runs import IMPLICIT, run, runs

DENSITY, GRAVITY, LENGTH = 0.2, 9.81, 0.1
LOADS = (0.1, 0.5, 1, 2, 5, 8, 10, 20, 50, 100, 200, 1000)
REST = {"forces": {"wind": {"velocity": [0, 0, 0], "drag": 5}}, "stepper": {**IMPLICIT, "fixed_step": 0.05},
        "run": {"duration": 20, "fps": 1}}
ROMERO = "V. Romero et al., *Physical validation of simulators in computer graphics*, ACM Trans. Graph. 40(4) (2021), test " \
         "\"Cantilever\"; F. T. Peirce, J. Textile Inst. 21, T377 (1930)"
ELASTICA = "theta'' = -G (1 - s) cos theta, theta(0) = 0, theta'(1) = 0, G = density g L^3 / B; reach W, drop H of the tip; " \
           "solved by Runge-Kutta of order 4 and bisection"


def extrapolated(values, spacings):
    """The limit of values a + c spacing^2 through the last two."""
    (a, b), (p, q) = values[-2:], spacings[-2:]
    return b + (b - a) / ((p / q) ** 2 - 1.0)


def strip_of_springs(load, n):
    """(W/L, H/L) of a chain of n particles, clamped midway between the first two."""
    bend, a = DENSITY * GRAVITY * LENGTH ** 3 / load, LENGTH / (n - 1.5)
    done = run({"cloth": {"grid": {"rows": n, "cols": 1, "spacing": a, "origin": [-a / 2, 0, 0], "down": [1, 0, 0],
                                   "right": [0, 0, 1]},
                          "fabric": {"density": DENSITY, "stretch": 1e7 * bend / LENGTH ** 2, "bend": bend},
                          "pins": [{"rows": [0, 1], "cols": "all"}]}, **REST,
                "forces": {"damping": 50 * DENSITY * a}})
    return done.x[-1][0] / LENGTH, -done.x[-1][1] / LENGTH


def elastica_grid():
    sizes = (17, 33, 65)
    spacing = [1.0 / (n - 1.5) for n in sizes]
    found = runs([(load, n) for load in LOADS for n in sizes], strip_of_springs)
    rows, curves = [], {"exact": [], "weft": []}
    orders = []
    for k, load in enumerate(LOADS):
        reach, drop = exact.elastica(load)
        got = found[3 * k: 3 * k + 3]
        for name, want, values in (("W/L", reach, [g[0] for g in got]), ("H/L", drop, [g[1] for g in got])):
            limit = extrapolated(values, spacing)
            rows.append(("%s at G = %g" % (name, load), want, limit, abs(limit - values[-1]) + 2e-5))
            errors = [v - want for v in values]
            orders.append(("%s at G = %g" % (name, load), *values, *("%.2f" % o for o in exact.order(
                [e / s ** 2 * (spacing[0] * 0.5 ** i) ** 2 for i, (e, s) in enumerate(zip(errors, spacing))]))))
        curves["exact"].append((load, drop / reach))
        curves["weft"].append((load, got[-1][1] / got[-1][0]))
    return {
        "title": "A strip, clamped level, hangs by its weight: springs and bending of a grid, 17, 33 and 65 particles along it.",
        "source": ROMERO, "formula": ELASTICA,
        "tolerance": "the step of the extrapolation from the last two grids (order 2), and 2e-5 for the stretch of the strip "
                     "(C L^2 / B = 1e7)",
        "rows": rows, "tables": [(("quantity", "17", "33", "65", "order 17 to 33", "order 33 to 65"), orders)],
        "figure": plot([("exact", curves["exact"], "line"), ("weft, 65 particles", curves["weft"], "dots")],
                       "G = density g L^3 / B", "H / W", True, True),
        "caption": "drop by reach of the tip against the load",
        "text": "Spacings are L / (n - 1.5): two pinned rows clamp the strip midway.",
    }


elastica_grid.quick = True


def strip_of_triangles(kind, n):
    """(W/L, H/L) at G = 8 of a strip L x L/4, n triangles along it."""
    bend, width, h = DENSITY * GRAVITY * LENGTH ** 3 / 8, LENGTH / 4, LENGTH / n
    if kind == "random":
        cloth = {"cut": {"outline": [[-h, -width / 2], [LENGTH, -width / 2], [LENGTH, width / 2], [-h, width / 2]],
                         "lines": [[[0, -width / 2], [0, width / 2]]], "spacing": h, "right": [1, 0, 0], "down": [0, 0, -1]},
                 "pins": [{"inside": {"shape": "plane", "at": [0, 0, 0], "normal": [1, 0, 0]}}]}
        files = {}
    else:
        make = meshes.structured(n, n // 4, LENGTH, width) if kind == "one diagonal" else \
            meshes.turned(n, n // 4, LENGTH, width, kind)
        points, triangles, pins = meshes.clamped(*make, n // 4, width, h)
        cloth = {"mesh": {"file": "strip.obj"}, "pins": [{"vertices": pins}]}
        files = {"strip.obj": meshes.text(points, triangles, lambda u, v: (u, 0.0, -v))}
    stretch = 1e6 * bend / LENGTH ** 2
    cloth["fabric"] = {"density": DENSITY, "stretch": stretch, "shear": stretch / 2, "coupling": 0, "bend": bend}
    done = run({"cloth": cloth, **REST}, files)
    rest = done.mesh[0]
    tip = [x for x, (u, _) in zip(done.x, rest) if u > LENGTH * (1 - 1e-9)]
    return sum(x[0] for x in tip) / len(tip) / LENGTH, -sum(x[1] for x in tip) / len(tip) / LENGTH


def elastica_mesh():
    kinds, sizes = ("one diagonal", 0, 20, 45, "random"), (8, 16, 24)
    reach, drop = exact.elastica(8)
    found = runs([(kind, n) for kind in kinds for n in sizes], strip_of_triangles)
    rows, orders, curves = [], [], []
    for k, kind in enumerate(kinds):
        got = found[len(sizes) * k: len(sizes) * (k + 1)]
        name = kind if isinstance(kind, str) else "%d degrees" % kind
        for letter, want, values in (("W/L", reach, [g[0] for g in got]), ("H/L", drop, [g[1] for g in got])):
            rows.append((letter + ", " + name, want, values[-1], 0.003))
            errors = [v - want for v in values]
            orders.append((letter + ", " + name, *("%.5f" % e for e in errors),
                           *("%.2f" % (math.log(abs(a / b)) / math.log(q / p))
                             for a, b, p, q in zip(errors, errors[1:], sizes, sizes[1:]))))
        curves.append((name, [(n, abs(g[1] - drop)) for n, g in zip(sizes, got)], "line"))
    return {
        "title": "The same strip, L x L/4, of triangles at G = 8: a structured mesh, lattices of equal triangles turned by 0, 20 "
                 "and 45 degrees, and a random mesh of `cloth.cut`; 8, 16 and 24 triangles along the strip.",
        "source": "as elastica-grid", "formula": "as elastica-grid",
        "tolerance": "0.003 L at 24 triangles, three times the error that order 2 leaves of the .007 to .01 at 8",
        "rows": rows, "tables": [(("error of", "8", "16", "24", "order 8 to 16", "order 16 to 24"), orders)],
        "figure": plot(curves, "triangles along the strip", "error of H / L", True, True),
        "caption": "error of the drop against the number of triangles",
        "text": "Membranes are `chord`. Oblique meshes [lock](model.md#membrane-of-triangles) a little, which cancels part of the "
                "error of bending, so that their orders scatter.",
    }


elastica_mesh.quick = True


def chain_of_catenary(n):
    """Sag by length of n springs whose ends are at 0.8 of their length."""
    length = 1.0
    mass = DENSITY * length / n
    done = run({"cloth": {"grid": {"rows": 1, "cols": n + 1, "spacing": length / n, "scale": 0.8}, "mass": mass,
                          "springs": {"stretch": {"stiffness": 1e5 * n}}, "pins": ["left", "right"]},
                "forces": {"damping": 3 * mass}, "stepper": {**IMPLICIT, "fixed_step": 0.01}, "run": {"duration": 20, "fps": 1}})
    return -done.x[n // 2][1] / length, [(x[0], x[1]) for x in done.x]


def catenary():
    s = exact.bisect(lambda v: math.sinh(v) / v - 1.25, 0.1, 5.0)
    a = 0.4 / s
    sag, sizes = a * (math.cosh(s) - 1.0), (8, 16, 32)
    found = runs([(n,) for n in sizes], chain_of_catenary)
    values = [f[0] for f in found]
    limit = extrapolated(values, [1.0 / n for n in sizes])
    curve = [(0.02 * i, a * (math.cosh((0.02 * i - 0.4) / a) - math.cosh(0.4 / a))) for i in range(41)]
    return {
        "title": "A chain of 8, 16 and 32 springs, which stretch by at most 3e-5, between two points at 0.8 of its length.",
        "source": "Jac. Bernoulli, Leibniz, Huygens (1691)",
        "formula": "y = a cosh(x/a), sinh(s)/s = 1.25, s = 0.4 L/a; sag = a (cosh s - 1)",
        "tolerance": "the step of the extrapolation from 16 and 32 springs (order 2), and 1e-5 for the stretch",
        "rows": [("sag / L, extrapolated", sag, limit, abs(limit - values[-1]) / 4 + 1e-5)],
        "tables": [(("springs", "sag / L", "error"), [(str(n), v, "%.6f" % (v - sag)) for n, v in zip(sizes, values)])],
        "figure": plot([("exact", curve, "line"), ("weft, 16 springs", found[1][1], "dots")], "x / L", "y / L"),
        "caption": "the chain and the catenary",
        "text": "Orders: " + ", ".join("%.2f" % o for o in exact.order([v - sag for v in values])) + ".",
    }


catenary.quick = True
WIDTH, TENSILE, ETA = 0.02, 500.0, 0.5  # [m], [N/m], twist of a width


def twisted(kind, ny, stretch):
    """Energy [J], and (r, strain, area) of the triangles of the middle half, of a ribbon 5 widths long between pinned ends
    that are turned against each other, `stretch` rest lengths apart; r from -1/2 to 1/2."""
    length, nx = 5 * WIDTH, 5 * ny
    points, triangles = (meshes.structured(nx, ny, length, WIDTH) if kind == "one diagonal"
                         else meshes.turned(nx, ny, length, WIDTH, kind))

    def start(u, v):
        a = ETA * (u - 0.5 * length) / WIDTH
        return stretch * u, v * math.cos(a), v * math.sin(a)

    pins = [i for i, (u, _) in enumerate(points) if not 1e-9 < u < length - 1e-9]
    done = run({"cloth": {"mesh": {"file": "ribbon.obj"}, "pins": [{"vertices": pins}],
                          "fabric": {"density": DENSITY, "stretch": TENSILE, "shear": TENSILE / 2, "coupling": 0, "bend": 1e-6}},
                "forces": {"gravity": [0, 0, 0], "wind": {"velocity": [0, 0, 0], "drag": 5}},
                "stepper": {**IMPLICIT, "fixed_step": 0.01}, "run": {"duration": 1, "fps": 1}},
               {"ribbon.obj": meshes.text(points, triangles, start)})
    rest, faces = done.mesh
    strains = []
    for t in faces:
        (u0, v0), (u1, v1), (u2, v2) = (rest[i] for i in t)
        twice = (u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0)
        a, b, c = (done.x[i] for i in t)
        along = [((v2 - v0) * (q - p) - (v1 - v0) * (r - p)) / twice for p, q, r in zip(a, b, c)]
        if abs((u0 + u1 + u2) / 3 - 0.5 * length) < 0.25 * length:
            strains.append(((v0 + v1 + v2) / 3 / WIDTH, 0.5 * (sum(g * g for g in along) - 1.0), abs(twice)))
    return done.series[-1]["elastic"], strains


def ribbon():
    threshold, change = ETA ** 2 / 24, 1e-3
    cases = (("one diagonal", 6), ("one diagonal", 12), (45, 12))
    stretches = (1.0 - change, 1.0, 1.0 + change)
    found = runs([(*case, stretch) for case in cases for stretch in stretches], twisted)
    numbers = []  # of a case: strain of the middle, of the rim above it, tension: the last two over what is expected
    for k in range(len(cases)):
        below, at, above = found[3 * k: 3 * k + 3]
        middle, bend = exact.least_squares([[math.sqrt(a), math.sqrt(a) * r * r] for r, _, a in at[1]],
                                           [math.sqrt(a) * e for _, e, a in at[1]])
        tension = (above[0] - below[0]) / (2 * change * 5 * WIDTH) / (TENSILE * WIDTH)
        numbers.append((middle / threshold, bend / (12 * threshold), tension / threshold))
    limit = [extrapolated([a, b], [2.0, 1.0]) for a, b in zip(*numbers[:2])]
    names = ("strain of the middle fibre / (eta^2/24)", "strain of the rim less that of the middle / (eta^2/8)",
             "tension T / (eta^2/24) with a middle free of stress")
    rows = [(name + ", one diagonal", want, got, abs(got - fine) + 2e-3) for name, want, got, fine in
            zip(names, (0.0, 1.0, 1.0), limit, numbers[1])]
    rows += [(name + ", 45 degrees", want, got, 0.02) for name, want, got in zip(names, (0.0, 1.0, 1.0), numbers[2])]
    curves = [("%g rest lengths" % stretch, sorted((r, e) for r, e, _ in found[3 + i][1]), "dots") for i, stretch in enumerate(stretches)]
    curves += [("exact, %g" % stretch, [(0.05 * j - 0.5, 0.5 * (stretch ** 2 - 1 + (ETA * (0.05 * j - 0.5)) ** 2)) for j in range(21)], "line")
               for stretch in stretches]
    return {
        "title": "A ribbon of triangles, 5 widths long, is twisted by eta = 0.5 per width between ends that keep their distance.",
        "source": "A. E. Green, Proc. R. Soc. A 154, 430 (1936), 161, 197 (1937); J. Chopin, A. Kudrolli, PRL 111, 174302 (2013); "
                  "J. Chopin, V. Demery, B. Davidovitch, arXiv 1403.0267",
        "formula": "(derived here) strain at r widths from the middle: E = (stretch^2 - 1) / 2 + eta^2 r^2 / 2; its mean is the tension T (over "
                   "the stiffness and the width), so that E = T + eta^2 (r^2 - 1/12) / 2 and the middle is free of stress at "
                   "eta = sqrt(24 T)",
        "tolerance": "one diagonal: the step of the extrapolation from 6 and 12 triangles a width (order 2), and 0.2 %; lattice at 45 "
                     "degrees: 2 % with 12, without extrapolation",
        "rows": rows, "tables": [(("mesh", "strain of the middle", "rim less middle", "tension"),
                                  [("%s, %d" % (kind if isinstance(kind, str) else "%d degrees" % kind, n), *("%.4f" % v for v in of))
                                   for (kind, n), of in zip(cases, numbers)])],
        "figure": plot(curves, "r [widths]", "Green's strain along the ribbon"),
        "caption": "strain along the ribbon, across its width, of triangles of the middle half",
        "text": "T is the derivative of the energy by the distance of the ends, from two runs 0.1 % to either side.",
    }


CASES = (elastica_grid, elastica_mesh, catenary, ribbon)
