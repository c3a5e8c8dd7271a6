# SPDX-License-Identifier: BSD-3-Clause
"""Cases of contact and friction, and of sheets of springs in the literature: Provot, Lander."""
import math

import exact
import meshes
from figures import plot, sheets
from runs import run, run_file, runs

EULER = "L. Euler (1762), J. A. Eytelwein (1808)"


def capstan_pull(friction, n=24, duration=0.3):
    """Ratio of the tensions of a strip that slides over a cylinder by half a turn, n cells along the arc; its frames."""
    radius, gap, speed, stretch = 0.05, 1e-3, 0.1, 1.02
    arc, width = math.pi * (radius + gap), 0.02
    h, more = arc / n / stretch, n // 4
    count = n + 2 * more
    points, triangles = meshes.structured(count, 2, count * h, width)

    def start(u, v):
        s = stretch * (u - more * h)
        a = math.pi - min(max(s, 0.0), arc) / (radius + gap)
        beyond = min(s, 0.0) + min(arc - s, 0.0)
        return (radius + gap) * math.cos(a), (radius + gap) * math.sin(a) + beyond, v

    ends = [[i for i, (u, _) in enumerate(points) if abs(u - end) < 1e-9] for end in (0.0, count * h)]
    done = run({"cloth": {"mesh": {"file": "strip.obj"},
                          "fabric": {"density": 0.2, "stretch": 200, "shear": 100, "coupling": 0, "damping": [1e-3, 0]},
                          "pins": [{"vertices": ends[0], "velocity": [0, speed, 0]}, {"vertices": ends[1], "velocity": [0, -speed, 0]}]},
                "forces": {"gravity": [0, 0, 0]},
                "contact": {"thickness": gap, "friction": friction, "law": "coulomb", "slip": 0.02, "stopping_speed": 3,
                            "shapes": [{"shape": "capsule", "from": [0, 0, -0.2], "to": [0, 0, 0.2], "radius": radius}]},
                "stepper": {"plugin": "gsl", "method": "rkf45", "rtol": 1e-5, "atol": 1e-7},
                "run": {"duration": duration, "fps": 500}}, {"strip.obj": meshes.text(points, triangles, start)})
    touching = [math.hypot(x[0], x[1]) for x in done.x if x[1] > 0.2 * radius]
    lever = sum(touching) / len(touching)
    forces = [(row["time"], -row["fy"], -row["tz"] / lever) for row in done.shapes if row["time"] > 0.02]
    ratio = [(t, (both + more) / (both - more)) for t, both, more in forces]
    late = [(both, more) for t, both, more in forces if t > 0.1]
    both, more = (sum(f[i] for f in late) for i in (0, 1))
    return (both + more) / (both - more), ratio


def capstan():
    frictions = (0.2, 0.3, 0.5)
    found = runs([(mu,) for mu in frictions], capstan_pull)
    return {
        "title": "A taut strip of triangles without weight is drawn over a cylinder, by half a turn, with 0.1 m/s. Its tensions follow "
                 "from the force and the torque on the cylinder (shapes.csv).",
        "source": EULER, "formula": "T2 / T1 = exp(mu alpha), alpha = pi",
        "tolerance": "2 %, because vertices that come to and leave the cylinder let the ratio ripple; mean of 0.1 to 0.3 s",
        "rows": [("T2 / T1, mu = %g" % mu, math.exp(mu * math.pi), f[0], 0.02 * math.exp(mu * math.pi))
                 for mu, f in zip(frictions, found)],
        "figure": plot([("mu = %g" % mu, f[1][::3], "line") for mu, f in zip(frictions, found)], "t [s]", "T2 / T1",
                       lines=[("exp(mu pi)", math.exp(mu * math.pi)) for mu in frictions]),
        "caption": "ratio of the tensions by time",
        "text": "The strip starts at rest, stretched by 2 %. The law of friction is `coulomb`.",
    }


capstan.quick = True


def sliding(friction, degrees):
    """Speed [m/s] by time of a piece of cloth that slides down a slope, which gravity is turned by."""
    a = math.radians(degrees)
    push = 9.81 * math.cos(a) * 1e-3 / 0.5  # phi'(s) of the contact's law, phi = s^4 / (1 - s), that carries the weight
    s = exact.bisect(lambda s: (4 * s ** 3 - 3 * s ** 4) / (1 - s) ** 2 - push, 0.0, 0.9)
    done = run({"cloth": {"grid": {"rows": 4, "cols": 4, "spacing": 0.02, "origin": [0, 1e-3 * (1 - s), 0], "right": [1, 0, 0], "down": [0, 0, 1]},
                          "fabric": {"preset": "11oz-black-denim", "damping": [1e-4, 1e-4]}},
                "forces": {"gravity": [9.81 * math.sin(a), -9.81 * math.cos(a), 0]},
                "contact": {"thickness": 1e-3, "friction": friction, "law": "coulomb", "slip": 1e-3, "stopping_speed": 1,
                            "shapes": [{"shape": "plane", "at": [0, 0, 0], "normal": [0, 1, 0]}]},
                "stepper": {"plugin": "gsl", "method": "rkf45", "rtol": 1e-6, "atol": 1e-8}, "run": {"duration": 1, "fps": 20}})
    mass = 0.324 * 0.06 ** 2
    return [(row["time"], row["momentum_x"] / mass) for row in done.series]


def slope():
    tasks = ((0.2, 20), (0.3, 30), (0.5, 45))
    found = runs(tasks, sliding)
    wants = [9.81 * (math.sin(math.radians(a)) - mu * math.cos(math.radians(a))) for mu, a in tasks]
    return {
        "title": "A flat piece of denim slides down a slope from rest for a second.",
        "source": "C. A. Coulomb (1785)", "formula": "v = g (sin a - mu cos a) t",
        "tolerance": "0.001 m/s, the slip below which friction fades",
        "rows": [("speed [m/s], mu = %g, %d degrees" % (*task, ), want, f[-1][1], 0.001) for task, want, f in zip(tasks, wants, found)],
        "figure": plot([("mu = %g, %d degrees" % task, f, "dots") for task, f in zip(tasks, found)]
                       + [("exact", [(0, 0), (1, want)], "line") for want in wants], "t [s]", "v [m/s]"),
        "caption": "speed by time",
    }


slope.quick = True


def strains(done, side=17):
    """Largest strain of the stretch springs of a square grid of Provot's spacings."""
    most = 0.0
    for r in range(side):
        for c in range(side):
            p = done.x[r * side + c]
            if c + 1 < side:
                most = max(most, math.dist(p, done.x[r * side + c + 1]) / 0.0625 - 1.0)
            if r + 1 < side:
                most = max(most, math.dist(p, done.x[(r + 1) * side + c]) / 0.08838834764831845 - 1.0)
    return most


def wires(done, rows, cols, i, j):
    """Rows and columns of a grid as lines in the plane of coordinates i and j."""
    at = [(x[i], x[j]) for x in done.x]
    return [[at[r * cols + c] for c in range(cols)] for r in range(rows)] + [[at[r * cols + c] for r in range(rows)] for c in range(cols)]


def provot():
    tasks = (("provot", {"run.duration": 40}), ("provot-paper", {"limit.sweeps": 1}), ("provot-paper", {"limit.sweeps": 10}),
             ("provot-paper", {}))
    found = runs(tasks, run_file)
    names = ("without a limit", "one sweep", "ten sweeps", "100 sweeps")
    wants = (1.964, 0.326, 0.120, 0.1005)
    return {
        "title": "Provot's sheet of 17 x 17 masses, hung by two corners: springs near the corners stretch far more than cloth does; "
                 "his correction limits them to 10 %.",
        "source": "X. Provot, *Deformation constraints in a mass-spring model to describe rigid cloth behavior*, Graphics "
                  "Interface '95, which shows pictures only; the numbers by an independent program (tests/test_papers.c)",
        "formula": "a spring longer than 1.1 rest lengths is shortened to that after every step, sweep after sweep",
        "tolerance": "1 %: the independent program started from another side of the sheet",
        "rows": [("largest strain of a stretch spring, " + name, want, strains(done), 0.01 * want)
                 for name, want, done in zip(names, wants, found)],
        "figure": sheets([(names[k], wires(found[k], 17, 17, 0, 1)) for k in (0, 3)]),
        "caption": "the sheet without and with the limit",
    }


provot.quick = True


def areas(done, n):
    """Means of areas of cells over that at rest, and the mean of the cosines between neighbouring cells' normals."""
    def minus(a, b):
        return [p - q for p, q in zip(a, b)]

    def cross(a, b):
        return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])

    normal = {}
    for r in range(n - 1):
        for c in range(n - 1):
            p, q, s, t = (done.x[(r + i) * n + c + j] for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)))
            normal[r, c] = [0.5 * v for v in cross(minus(t, p), minus(s, q))]
    size = {at: math.hypot(*v) for at, v in normal.items()}
    cosines = [sum(a * b for a, b in zip(v, normal[other])) / (size[at] * size[other])
               for at, v in normal.items() for other in ((at[0] + 1, at[1]), (at[0], at[1] + 1)) if other in normal]
    return sum(size.values()) / len(size) / 0.0625 ** 2, sum(cosines) / len(cosines)


def lander():
    end = {"run.duration": 0.7}
    bend = {**end, "cloth.springs.bend": "{stiffness: 20, damping: 0.01}"}
    tasks = (("hung-stretch", end), ("hung-shear", end), ("hung-shear", bend))
    found = runs(tasks, run_file)
    (a0, f0), (a1, f1), (a2, f2) = (areas(done, 17) for done in found)
    return {
        "title": "A level sheet falls from two corners: stretch springs alone, with shear springs, with bend springs as well.",
        "source": "J. Lander, *Devil in the blue faceted dress*, Game Developer (May 1999); the lecture *Introduction to cloth* (CMU 15-864)",
        "formula": "none; their pictures show that stretch springs alone collapse, shear springs keep the cells, bend springs round the folds",
        "tolerance": "the signs of the differences",
        "rows": [("mean area of cells gained by shear springs (over that at rest)", (0.1, 1.0), a1 - a0, 0.0),
                 ("mean cosine between neighbouring cells gained by bend springs", (0.0, 2.0), f2 - f1, 0.0)],
        "tables": [(("springs", "mean area of cells / at rest", "mean cosine between neighbouring cells"),
                    [("stretch", a0, f0), ("stretch, shear", a1, f1), ("stretch, shear, bend", a2, f2)])],
        "figure": sheets([(name, wires(done, 17, 17, 0, 1)) for name, done in zip(("stretch", "stretch, shear", "stretch, shear, bend"), found)]),
        "caption": "the three sheets after 0.7 s",
    }


lander.quick = True
CASES = (capstan, slope, provot, lander)
