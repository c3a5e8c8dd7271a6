# SPDX-License-Identifier: BSD-3-Clause
"""Cases of motion: swings, plates that vibrate, lateral buckling, free fall, momenta."""
import math

import exact
import meshes
from figures import plot
from runs import IMPLICIT, run, runs

STILL = {"gravity": [0, 0, 0]}
EXTRAPOLATED = "structured mesh and grid: the step of the extrapolation from 12 and 18 cells (order 2), and 0.2 %; turned " \
               "lattice: 1.5 % with 18 triangles"
AS_SUPPORTED = "as plate-supported"
GRIDS = "The grid of springs has only the first mode of each plate."
LEISSA = "A. W. Leissa, *Vibration of plates*, NASA SP-160 (1969)"


def verlet(step):
    return {"plugin": "verlet", "method": "velocity_verlet", "fixed_step": step}


def signal(scene, files, duration, count, weights, axis):
    """The mean of a coordinate, with weights for the vertices, in count + 1 frames, and the interval [s] of frames.

    With the start as weights it has each mode by the square of its part of the start."""
    done = run({**scene, "run": {"duration": duration, "fps": count / duration}}, files, True)
    return [sum(w * x[axis] for w, x in zip(weights, frame)) for frame in done.frames], duration / count


def lowest(values, interval, width, modes):
    """omega^2 of the slow parts of a signal."""
    return exact.squares_of_frequencies(exact.smoothed(values, width), interval * (width // 2), modes)


def strongest(values, interval, width, modes):
    """omega [1/s] of the vibration with the largest amplitude in the slow parts of a signal."""
    values, interval = exact.smoothed(values, width), interval * (width // 2)
    found = [math.sqrt(v) for v in exact.squares_of_frequencies(values, interval, modes) if v > 1.0]
    waves = [[wave(omega * i * interval) for omega in found for wave in (math.cos, math.sin)] for i in range(len(values))]
    fit = exact.least_squares(waves, values)
    return max(zip(fit[::2], fit[1::2], found), key=lambda f: math.hypot(f[0], f[1]))[2]


def hanging_chain(n):
    """omega [1/s] of the three lowest swings of a chain of n springs, 1 m long, pushed by 1e-6 m/s."""
    stiffness = 2e4
    scene = {"cloth": {"grid": {"rows": n + 1, "cols": 1, "spacing": 1.0 / n}, "density": 0.2, "velocity": [1e-6, 0, 0],
                       "springs": {"stretch": {"stiffness": stiffness * n}}, "pins": ["top"]},
             "stepper": verlet(0.7 / n / math.sqrt(stiffness / 0.2))}
    values, interval = signal(scene, {}, 12.0, 960, [1.0] * n + [0.5], 0)
    squares = lowest(values, interval, 16, 5)
    return [math.sqrt(v) for v in squares if v > 0.0][:3], [(i * interval, v * 1e6 / n) for i, v in enumerate(values)][::4]


def swings():
    found = runs([(n,) for n in (8, 16, 32)], hanging_chain)
    rows, more = [], []
    for k, zero in enumerate((2.404825557695773, 5.520078110286311, 8.653727912911013)):
        want = 0.5 * zero * math.sqrt(9.81) / (2.0 * math.pi)
        values = [f[0][k] / (2.0 * math.pi) for f in found]
        limit = values[2] + (values[2] - values[1]) / 3.0
        rows.append(("swing %d [Hz]" % (k + 1), want, limit, (limit - values[2]) / 4 + 1e-4 * want))
        more.append(("swing %d" % (k + 1), *values, *("%.2f" % o for o in exact.order([v - want for v in values]))))
    return {
        "title": "A chain 1 m long hangs by one end and swings by some micrometres; 8, 16 and 32 springs.",
        "source": "D. Bernoulli (1733)", "formula": "omega_n = (j_n / 2) sqrt(g / L), j_n the zeros of the Bessel function J_0",
        "tolerance": "a quarter of the step of the extrapolation from 16 and 32 springs (order 2), and 1e-4, as the chain "
                     "stretches by 5e-5",
        "rows": rows, "tables": [(("[Hz]", "8", "16", "32", "order 8 to 16", "order 16 to 32"), more)],
        "figure": plot([("weft, 32 springs", found[2][1], "line")], "t [s]", "mean deflection [1e-6 m]"),
        "caption": "mean deflection of the chain by time",
        "text": "Frequencies are those of cosines fitted to the chain's mean deflection in 960 frames.",
    }


swings.quick = True


def plate(kind, n, held, shape, bend=(1.0, 1.0), twist=1.0):
    """omega of the lowest mode in a start of `shape` of a plate of 1 x 1 m, density 1 kg/m^2."""
    if kind == "grid":
        return plate_of_springs(n, held, shape, bend, twist)
    h, stretch = 1.0 / n, 10.0 * n * n
    points, triangles = (meshes.structured(n, n, 1.0, 1.0) if kind == "one diagonal"
                         else meshes.turned(n, n, 1.0, 1.0, kind))
    if held == "cantilever":
        points, triangles, pins = meshes.clamped(points, triangles, n, 1.0, h)
    elif held == "clamped":
        points, triangles = framed(points, triangles, n)
        pins = [i for i, (u, v) in enumerate(points) if not (1e-9 < u < 1 - 1e-9 and abs(v) < 0.5 - 1e-9)]
    else:
        pins = [i for i, (u, v) in enumerate(points) if not (1e-9 < u < 1 - 1e-9 and abs(v) < 0.5 - 1e-9)]
    held_ones = set(pins)
    start = {point: 0.0 if i in held_ones else 1e-6 * shape(point[0], point[1] + 0.5) for i, point in enumerate(points)}
    scene = {"cloth": {"mesh": {"file": "plate.obj"}, "pins": [{"vertices": pins}],
                       "fabric": {"density": 1, "stretch": stretch, "shear": stretch / 2, "coupling": 0,
                                  "bend": [bend[1], bend[0]], "twist": twist}},
             "forces": STILL, "stepper": verlet(0.04 * h * h)}
    guess = {"supported": 30.0, "clamped": 36.0, "cantilever": 6.0}[held]
    values, interval = signal(scene, {"plate.obj": meshes.text(points, triangles, lambda u, v: (u, v, start[u, v]))},
                              4.0 * math.pi / guess, 240, [1e6 * start[point] for point in points], 2)
    return strongest(values, interval, 6, 3)


def plate_of_springs(n, held, shape, bend, twist):
    """The same on a grid, which starts flat with one velocity: of the lowest mode. Two pinned lines clamp midway."""
    rim = {"supported": 0.0, "clamped": 0.5, "cantilever": 0.5}[held]  # [spacings] from the first line to the plate's edge
    a = 1.0 / (n + 0.5) if held == "cantilever" else 1.0 / n
    cols, rows, up = n + 1 + round(2 * rim), n + 1 + round(2 * rim * (held == "clamped")), rim * (held == "clamped")
    stretch, two = 10.0 * n * n, {"rows": "all", "cols": [0, 1]}
    pins = {"supported": ["top", "bottom", "left", "right"], "cantilever": [two],
            "clamped": [two, {"rows": "all", "cols": [-2, -1]}, {"rows": [0, 1], "cols": "all"}, {"rows": [-2, -1], "cols": "all"}]}
    scene = {"cloth": {"grid": {"rows": rows, "cols": cols, "spacing": [1.0 / n, a], "down": [0, 1, 0]}, "pins": pins[held],
                       "velocity": [0, 0, 1e-6], "fabric": {"density": 1, "stretch": stretch, "shear": stretch / 2,
                                                            "bend": [bend[1], bend[0]], "twist": twist}},
             "forces": STILL, "stepper": verlet(0.04 * a * a)}
    inside = [(min(max((c - rim) * a, 0.0), 1.0), min(max((r - up) / n, 0.0), 1.0)) for r in range(rows) for c in range(cols)]
    guess = {"supported": 30.0, "clamped": 36.0, "cantilever": 6.0}[held]
    values, interval = signal(scene, {}, 4.0 * math.pi / guess, 240, [1e6 * shape(*place) for place in inside], 2)
    return strongest(values, interval, 6, 3)


def framed(points, triangles, n):
    """The mesh of the unit square with a frame of cells around it."""
    h = 1.0 / n
    places = {(round(u * n), round((v + 0.5) * n)): i for i, (u, v) in enumerate(points)
              if abs(u * n - round(u * n)) < 1e-6 and abs((v + 0.5) * n - round((v + 0.5) * n)) < 1e-6
              and (round(u * n) in (0, n) or round((v + 0.5) * n) in (0, n))}
    points, triangles = list(points), list(triangles)

    def at(i, j):
        if (i, j) not in places:
            places[i, j] = len(points)
            points.append((i * h, j * h - 0.5))
        return places[i, j]

    for i in range(-1, n + 1):
        for j in range(-1, n + 1):
            if i in (-1, n) or j in (-1, n):
                a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
                triangles += [(a, b, c), (a, c, d)]
    return points, triangles


def plates(name, modes, title, source, formula, tolerance, text, sizes=(6, 12, 18)):
    """A case of frequencies: modes are (name, exact, held, shape, bend, twist)."""
    kinds = ("one diagonal", 20, "grid")
    tasks = [(mode, kind) for mode in modes for kind in (kinds if mode is modes[0] else kinds[:2])]
    found = runs([(kind, n, *mode[2:]) for mode, kind in tasks for n in sizes], plate)
    rows, more, curves = [], [], []
    for i, (mode, kind) in enumerate(tasks):
        values = found[i * len(sizes):][:len(sizes)]
        label = "%s, %s" % (mode[0], kind if isinstance(kind, str) else "%d degrees" % kind)
        limit = values[-1] + (values[-1] - values[-2]) / ((sizes[-1] / sizes[-2]) ** 2 - 1.0)
        if kind == 20:
            rows.append((label, mode[1], values[-1], 0.015 * mode[1]))
        else:
            rows.append((label, mode[1], limit, abs(limit - values[-1]) + 0.002 * mode[1]))
        errors = [v / mode[1] - 1.0 for v in values]
        more.append((label, *("%.5f" % e for e in errors),
                     *("%.2f" % (math.log(abs(a / b)) / math.log(q / p))
                       for a, b, p, q in zip(errors, errors[1:], sizes, sizes[1:]))))
        curves.append((label, [(n, abs(e)) for n, e in zip(sizes, errors)], "line"))
    head = ("relative error of", *map(str, sizes), "order", "order")
    return {"title": title, "source": source, "formula": formula, "tolerance": tolerance, "rows": rows,
            "tables": [(head, more)], "figure": plot(curves[:6], "triangles along an edge", "relative error", True, True),
            "caption": "error of frequencies against the number of triangles", "text": text}


def sine(m, n):
    return lambda x, y: math.sin(m * math.pi * x) * math.sin(n * math.pi * y)


def plate_supported():
    modes = [("omega_%d%d" % (m, n), math.pi ** 2 * (m * m + n * n), "supported", sine(m, n))
             for m, n in ((1, 1), (1, 2), (2, 2))]
    return plates("plate-supported", modes,
                  "A square plate with hinged edges, B = twist, vibrates by a micrometre; a structured mesh and a lattice turned "
                  "by 20 degrees, 6, 12 and 18 triangles along an edge.",
                  "S. Timoshenko, S. Woinowsky-Krieger, *Theory of plates and shells* (1959); Navier (1823)",
                  "omega a^2 sqrt(density / B) = pi^2 (m^2 + n^2)",
                  EXTRAPOLATED,
                  "Every pinned rim is a hinge. " + GRIDS)


plate_supported.quick = True


def plate_clamped():
    bump = lambda x, y: (1 - math.cos(2 * math.pi * x)) * (1 - math.cos(2 * math.pi * y))  # noqa: E731
    return plates("plate-clamped", [("omega_1", exact.square_plate(0.0, "clamped", 1)[0], "clamped", bump)],
                  "The same plate with clamped edges: a frame of pinned triangles around it.", LEISSA,
                  "Ritz with x^2 (1 - x)^2 y^2 (1 - y)^2 times Legendre polynomials, 49 terms (validation/exact.py); Leissa has 35.99 "
                  "[from memory]",
                  AS_SUPPORTED,
                  "The clamp is at the inner rim of the wholly pinned triangles, on the grid midway between two pinned lines.")


def plate_cantilever():
    soft = exact.square_plate(0.0, "cantilever", 2)
    stiff = exact.square_plate(0.3, "cantilever", 2)
    bending, torsion = (lambda x, y: x * x * (3 - x) / 2), (lambda x, y: x * x * (y - 0.5))
    modes = [("bending", soft[0], "cantilever", bending), ("torsion", soft[1], "cantilever", torsion)]
    case = plates("plate-cantilever", modes,
                  "A square plate that one edge clamps: bending and torsion. weft's fabric has D12 = 0: Poisson's ratio is 0.",
                  "M. V. Barton, J. Appl. Mech. 18, 129 (1951) for nu = 0.3, as code_aster's V2.03.001 (SDLS01) has it",
                  "Ritz with x^2 times Legendre polynomials, 49 terms (validation/exact.py)",
                  AS_SUPPORTED, "", sizes=(6, 12, 18))
    rows = case["rows"]
    case["rows"] = rows + [("bending, published for nu = 0.3", 3.492, rows[0][2], 0.01), ("torsion, published for nu = 0.3", 8.525, rows[3][2], 0.01)]
    case["text"] = ("The published plate has nu = 0.3, which weft's cannot have: the model disagrees, not the mesh. For nu = 0.3 "
                    "the Ritz computation has the upper bounds %.4f and %.4f, below the published ones."
                    % (stiff[0], stiff[1]))
    return case


def plate_woven():
    bx, by, twist = 1.0, 0.3, 0.2
    modes = [("omega_%d%d" % (m, n), math.pi ** 2 * math.sqrt(bx * m ** 4 + 2 * twist * m * m * n * n + by * n ** 4),
              "supported", sine(m, n), (bx, by), twist) for m, n in ((1, 1), (1, 2), (2, 1))]
    fine = runs([("one diagonal", n, *modes[1][2:]) for n in (24, 36)], plate)
    case = plates("plate-woven", modes, "A hinged plate whose weft is stiffer than its warp: B = 1 and 0.3, twist 0.2 N m.",
                  "S. G. Lekhnitskii, *Anisotropic plates* (1968)",
                  "density omega^2 = pi^4 (B_x m^4 + 2 twist m^2 n^2 + B_y n^4) / a^4, D12 = 0",
                  AS_SUPPORTED,
                  "")
    errors = [v / modes[1][1] - 1.0 for v in fine]
    case["text"] = ("On the structured mesh the error of omega_12 changes its sign between 6 and 12 triangles and is not yet of order 2 "
                    "at 18, as the extrapolation assumes. It goes to zero: %.5f with 24 triangles, %.5f with 36, order %.2f."
                    % (*errors, math.log(errors[0] / errors[1]) / math.log(1.5)))
    return case


def sideways(width, n, load, twist):
    """omega^2 of the lowest mode, sideways, of a strip 1 m long that one end clamps edge-on under its weight."""
    ny, stretch = max(2, round(n * width)), 1e4 / width ** 2
    points, triangles, pins = meshes.clamped(*meshes.structured(n, ny, 1.0, width), ny, width, 1.0 / n)
    scene = {"cloth": {"mesh": {"file": "strip.obj"}, "pins": [{"vertices": pins}],
                       "fabric": {"density": 1, "stretch": stretch, "shear": stretch / 2, "coupling": 0, "bend": 1, "twist": twist}},
             "forces": {"gravity": [0, -load, 0]}}
    still = run({**scene, "stepper": {**IMPLICIT, "fixed_step": 0.02}, "run": {"duration": 1, "fps": 1}},
                {"strip.obj": meshes.text(points, triangles, lambda u, v: (u, v, 0.0))})
    start = {point: (x[0], x[1], 1e-6 * max(point[0], 0.0) ** 2 * (1.5 - 0.5 * point[0] + point[1]))
             for point, x in zip(points, still.x)}
    values, interval = signal({**scene, "stepper": verlet(0.35 / n / math.sqrt(stretch))},
                              {"strip.obj": meshes.text(points, triangles, lambda u, v: start[u, v])},
                              1.5, 150, [1e6 * start[point][2] for point in points], 2)
    return lowest(values, interval, 8, 3)[0]


def threshold(loads, squares):
    """The load at which omega^2 is 0, by a parabola, in units of the first load."""
    fit = exact.least_squares([[1.0, g / loads[0], (g / loads[0]) ** 2] for g in loads], squares)
    return loads[0] * exact.bisect(lambda x: fit[0] + fit[1] * x + fit[2] * x * x, 0.9, 1.6)


def lateral_buckling():
    rod = round(exact.lateral_buckling(), 5)
    factors, widths = (0.88, 0.96, 1.04, 1.12), {0.2: (10, 20), 0.1: (20, 40), 0.05: (40, 80)}
    cases = [(twist, width, n) for twist in (1.0, 0.5) for width, sizes in widths.items() for n in sizes]

    def loads(twist, width):
        return [f * rod * math.sqrt(2.0 * twist) * (1.0 + 0.75 * width) for f in factors]

    found = runs([(width, n, load, twist) for twist, width, n in cases for load in loads(twist, width)], sideways)
    critical = {case: threshold(loads(*case[:2]), found[4 * i: 4 * i + 4]) for i, case in enumerate(cases)}
    rows, more = [], []
    for twist in (1.0, 0.5):
        limits = []
        for width, (coarse, fine) in widths.items():
            a, b = critical[twist, width, coarse], critical[twist, width, fine]
            limits.append(b + (b - a) / 3.0)
            more.append(("%g" % twist, "%g" % width, "%.3f" % a, "%.3f" % b, "%.3f" % limits[-1]))
        limit = exact.solve([[1.0, w, w * w] for w in widths], limits)[0]
        rows.append(("G at the threshold, twist = %g B" % twist, rod * math.sqrt(2.0 * twist), limit, 0.15))
    picture = [("twist B, w/L = %g, %d triangles" % (w, sizes[1]),
                list(zip(loads(1.0, w), found[4 * cases.index((1.0, w, sizes[1])):][:4])), "line") for w, sizes in widths.items()]
    return {
        "title": "A strip L x w, clamped edge-on, buckles sideways where its weight exceeds a threshold that depends on bending "
                 "and on twist. The rate of the lowest sideways mode is measured on both sides of it.",
        "source": "L. Prandtl (1899); S. Timoshenko, *Theory of elastic stability*; Romero et al. 2021, test \"Lateral Buckling\"",
        "formula": "density g w L^3 = 12.85376 sqrt(EI GJ), EI = B w, GJ = 2 twist w: G = 12.85376 sqrt(2 twist / B), rod "
                   "limit w << L",
        "tolerance": "0.15 (1 %): extrapolated with order 2 in the edge, from w/L = .2, .1, .05 to 0 by a parabola; the membrane "
                     "gives way in the plane by B / (C w^2 / 12) = 1/833",
        "rows": rows, "tables": [(("twist / B", "w / L", "coarse mesh", "fine mesh", "extrapolated"), more)],
        "figure": plot(picture, "G = density g L^3 / B", "omega^2 [1/s^2]; below 0 it grows", lines=(("threshold", 0.0),)),
        "caption": "square of the frequency against the load; growth below zero",
        "text": "The strip at rest in its plane is bent sideways by a micrometre and released without damping. Structured meshes, "
                "10 and 20, 20 and 40, 40 and 80 triangles along the strip.",
    }


def fall():
    """A tilted sheet of springs, thrown: largest distance [m] of its particles from their parabolas after 1 s."""
    velocity, n = (0.3, 2.0, -1.0), 9
    done = run({"cloth": {"grid": {"rows": n, "cols": n, "spacing": 0.05, "down": [0, -0.6, 0.8]}, "velocity": velocity,
                          "fabric": {"preset": "white-swim-solid", "damping": [1e-4, 1e-3]}},
                "stepper": verlet(1e-4), "run": {"duration": 1, "fps": 20}}, frames=True)
    drop = (0.0, -0.5 * 9.81, 0.0)
    return max(abs(b - a - v - d) for p, q in zip(done.frames[0], done.frames[-1]) for a, b, v, d in zip(p, q, velocity, drop)), \
        [(i / 20, sum(x[1] for x in frame) / len(frame)) for i, frame in enumerate(done.frames)]


def free_fall():
    far, path = fall()
    middle = path[0][1]
    return {
        "title": "A free sheet of a measured knit with damping, thrown with (0.3, 2, -1) m/s, for 1 s in 10 000 steps.",
        "source": "G. Galilei (1638)", "formula": "x = x0 + v t + g t^2 / 2 for every particle",
        "tolerance": "1e-11 m, roundoff of 10 000 steps",
        "rows": [("largest distance of a particle from its parabola [m]", 0.0, far, 1e-11)],
        "figure": plot([("parabola", [(t, middle + 2 * t - 0.5 * 9.81 * t * t) for t, _ in path], "line"),
                        ("weft, centre", path, "dots")], "t [s]", "height [m]"),
        "caption": "height of the centre of mass",
    }


free_fall.quick = True


def tumbling(step, n=8, side=0.2):
    """A strained free mesh after 0.1 s: drift of momentum, of angular momentum and of energy, each relative."""
    points, triangles = meshes.turned(n, n, side, side, 20)

    def start(u, v):
        return 1.05 * u, v + 0.3 * u * v, 0.3 * u * u + 0.1 * side * math.sin(30 * v)

    density, speed = 0.2, (0.1, 0.2, 0.3)
    done = run({"cloth": {"mesh": {"file": "sheet.obj"}, "velocity": speed,
                          "fabric": {"density": density, "stretch": 100, "shear": 20, "bend": 1e-4}},
                "forces": STILL, "stepper": verlet(step), "run": {"duration": 0.1, "fps": 1000}},
               {"sheet.obj": meshes.text(points, triangles, start)})
    mass = [0.0] * len(points)
    for t in triangles:
        (ax, ay), (bx, by), (cx, cy) = (points[i] for i in t)
        for i in t:
            mass[i] += density * abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 6.0

    def spin(xs, vs):
        return [sum(m * (x[i] * v[j] - x[j] * v[i]) for m, x, v in zip(mass, xs, vs)) for i, j in ((1, 2), (2, 0), (0, 1))]

    def moment(vs):
        return [sum(m * v[i] for m, v in zip(mass, vs)) for i in range(3)]

    first = [start(*point) for point in points]
    still = [speed] * len(points)
    pairs = ((moment(still), moment(done.v)), (spin(first, still), spin(done.x, done.v)))
    drift = [math.dist(a, b) / math.hypot(*a) for a, b in pairs]
    total = [row["kinetic"] + row["elastic"] for row in done.series]
    return drift[0], drift[1], [(row["time"], abs(e / total[0] - 1.0)) for row, e in zip(done.series, total)]


def momenta():
    coarse, fine = runs([(2e-5,), (1e-5,)], tumbling)
    most = [max(e for _, e in found[2]) for found in (coarse, fine)]
    return {
        "title": "A free, stretched and bent mesh without damping or gravity flies for 0.1 s; velocity Verlet "
                 "with steps of 20 and 10 microseconds.",
        "source": "I. Newton (1687); E. Hairer, C. Lubich, G. Wanner, *Geometric numerical integration* (2006)",
        "formula": "forces of springs, membrane and bending add up to no force and no torque; Verlet's energy swings by O(h^2) "
                   "and does not drift",
        "tolerance": "1e-11 for momenta, roundoff of 10 000 steps; 0.3 for the order 2 of the energy",
        "rows": [("relative drift of momentum", 0.0, fine[0], 1e-11), ("relative drift of angular momentum", 0.0, fine[1], 1e-11),
                 ("order of the largest error of the energy", 2.0, math.log2(most[0] / most[1]), 0.3)],
        "tables": [(("step [s]", "largest relative error of the energy"), [("2e-5", most[0]), ("1e-5", most[1])])],
        "figure": plot([("2e-5 s", coarse[2][1:], "line"), ("1e-5 s", fine[2][1:], "line")], "t [s]", "relative error of the energy",
                       logy=True),
        "caption": "error of the energy by time",
    }


momenta.quick = True
CASES = (free_fall, momenta, swings, plate_supported, plate_clamped, plate_cantilever, plate_woven, lateral_buckling)
