#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A cantilever and a spinning strip by weft and others, as a page: make bench BENCH=peers writes build/pages/theory/peers.md.

Each simulator has a class: its constructor is the whole set-up, whose lines are counted; advance() computes 0.05 s;
drop() is that of the tip; energy() the kinetic energy. Simulators that cannot be imported are skipped with the reason.
"""
import inspect
import importlib.metadata
import math
import os
import platform
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, "validation")
import meshes  # noqa: E402

DENSITY, GRAVITY, LENGTH, WIDTH, LOAD, FIRM = 0.2, 9.81, 1.0, 0.25, 8.0, 1e4
BEND = DENSITY * GRAVITY * LENGTH ** 3 / LOAD  # [N m]
STRETCH = FIRM * BEND / LENGTH ** 2            # [N/m]
THICK = math.sqrt(12 * BEND / STRETCH)         # [m] of a plate with both and Poisson's ratio 0
BRAKE, SPIN, FRAME, END = 8.0, 10.0, 0.05, 3.0      # [1/s], [1/s], [s], [s]
MOST = float(os.environ.get("PEERS_SECONDS", 60))  # [s] of processor time for each strip


def exact(steps=4000):
    """Drop of the tip of a heavy elastica that stretches by its tension, by bisection of its angle there."""
    def shoot(angle):
        a, slope, x, y, h = angle, 0.0, 0.0, 0.0, 1.0 / steps
        for i in range(steps):
            u = (i + 0.5) * h  # from the tip; a from the level
            slope += h * LOAD * u * math.cos(a) * (1 + LOAD / FIRM * u * math.sin(a))
            a -= h * slope
            x, y = x + h * math.cos(a) * (1 + LOAD / FIRM * u * math.sin(a)), y + h * math.sin(a) * (1 + LOAD / FIRM * u * math.sin(a))
        return a, y
    low, high = 0.0, 0.5 * math.pi
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if shoot(middle)[0] < 0.0 else (low, middle)
    return shoot(low)[1]


def places(n, spin):
    """(u, v) of a grid of cells 1/n wide, with a row of cells before the clamp at u = 0; triangles; masses, of a third of
    each triangle; which are held, which are the tip."""
    first = 0 if spin else -1
    points, triangles = meshes.structured(n - first, n // 4, LENGTH - first / n, WIDTH)
    points = np.array(points) + [first / n, 0.0]
    masses = np.zeros(len(points))
    np.add.at(masses, np.array(triangles).ravel(), DENSITY / n ** 2 / 6)
    return points, triangles, masses, (points[:, 0] < 1e-9) & (not spin), points[:, 0] > LENGTH - 1e-9


def spinning(x):
    r = x - x.mean(axis=0)
    return SPIN * np.stack([-r[:, 1], r[:, 0], 0 * r[:, 0]], axis=1)


class WeftMesh:
    """weft, triangles, backward Euler (the spin: velocity Verlet)"""
    package, sizes = "weft", (8, 16, 32)

    def __init__(self, n, spin):
        import weft
        points, triangles, self.masses, held, self.tip = places(n, spin)
        folder = Path(tempfile.mkdtemp())
        (folder / "strip.obj").write_text(meshes.text([tuple(p) for p in points], triangles, lambda u, v: (u, v, 0.0)))
        pins = ", ".join(str(i) for i in np.flatnonzero(held))
        step = "{plugin: stiff, method: backward_euler, fixed_step: 0.05}"
        if spin:
            step = "{plugin: verlet, method: velocity_verlet, fixed_step: %g}" % (0.3 / n / math.sqrt(STRETCH / DENSITY))
        (folder / "strip.yaml").write_text(f"""weft: 1
cloth:
  mesh: {{file: strip.obj}}
  fabric: {{density: {DENSITY}, stretch: {STRETCH}, shear: {STRETCH / 2}, coupling: 0, bend: {BEND}}}
  pins: {"[]" if spin else "[{vertices: [" + pins + "]}]"}
forces: {{gravity: [0, 0, {0 if spin else -GRAVITY}], damping: {0 if spin else BRAKE * DENSITY / n ** 2}}}
stepper: {step}
run: {{duration: {END}, fps: 1}}
""")
        self.sim = weft.load(str(folder / "strip.yaml"))
        if spin:
            self.sim.set_state(velocities=spinning(self.sim.positions))

    def advance(self):
        self.sim.advance(self.sim.time + FRAME)

    def drop(self):
        return -self.sim.positions[self.tip, 2].mean()

    def energy(self):
        return 0.5 * (self.masses * (self.sim.velocities ** 2).sum(axis=1)).sum()


class SciPy(WeftMesh):
    """SciPy's BDF (of solve_ivp, tolerances 1e-6) on weft's right-hand side and its Jacobian"""
    package, sizes = "scipy", (8, 16)

    def __init__(self, n, spin):
        from scipy.integrate import BDF
        super().__init__(n, spin)
        self.t, self.solver = 0.0, BDF(self.sim.rhs, 0.0, self.sim.state.copy(), 2 * END, jac=self.sim.jacobian, rtol=1e-6, atol=1e-6)

    def advance(self):
        self.t += FRAME
        while self.solver.t < self.t:
            self.solver.step()
        self.sim.state = self.solver.dense_output()(self.t)


class MuJoCo:
    """MuJoCo's flex (2D, elastic2d both), integrator discrete, 4 ms"""
    package, sizes, step = "mujoco", (8, 16, 32), 4e-3

    def __init__(self, n, spin):
        import mujoco
        self.mujoco, h, more = mujoco, 1 / n, 0 if spin else 1
        model = mujoco.MjModel.from_xml_string(f"""<mujoco>
<option timestep="{self.step}" integrator="discrete" gravity="0 0 {0 if spin else -GRAVITY}"/><size memory="200M"/><worldbody>
<flexcomp name="c" type="grid" dim="2" count="{n + 1 + more} {n // 4 + 1} 1" spacing="{h} {h} {h}" radius="0.001" mass="1">
<edge equality="false"/><contact selfcollide="none" contype="0" conaffinity="0"/>
<elasticity young="{STRETCH / THICK}" poisson="0" thickness="{THICK}" elastic2d="both"/>
{"" if spin else f'<pin gridrange="0 0 1 {n // 4}"/>'}</flexcomp></worldbody></mujoco>""")
        self.model, self.data = model, mujoco.MjData(model)
        mujoco.mj_forward(model, self.data)
        x = self.data.flexvert_xpos.copy()
        near = np.rint((x[:, :2] - x[:, :2].min(axis=0)) * n).astype(int)
        share = [0.5 ** ((i == 0) + (i == n + more) + (j == 0) + (j == n // 4)) for i, j in near]
        self.tip, self.free = near[:, 0] == n + more, [b for b in model.flex_vertbodyid if model.body_dofnum[b] == 3]
        for body, part, v in zip(model.flex_vertbodyid, share, spinning(x)):
            if model.body_dofnum[body] == 3:
                at = model.body_dofadr[body]
                model.body_mass[body] = DENSITY * h * h * part
                model.dof_damping[at:at + 3] = 0 if spin else BRAKE * model.body_mass[body]
                self.data.qvel[at:at + 3] = v if spin else 0
        mujoco.mj_setConst(model, self.data)

    def advance(self):
        self.mujoco.mj_step(self.model, self.data, round(FRAME / self.step))

    def drop(self):
        return -self.data.flexvert_xpos[self.tip, 2].mean()

    def energy(self):
        return 0.5 * sum(self.model.body_mass[b] * (self.data.qvel[self.model.body_dofadr[b]:][:3] ** 2).sum() for b in self.free)


class Newton:
    """Newton's VBD on the CPU, single precision, 10 iterations, 1/600 s, as its example cloth_hanging"""
    package, sizes, steps = "newton", (8, 16), 30

    def __init__(self, n, spin):
        import newton
        import warp as wp
        wp.config.quiet = True
        points, triangles, self.masses, held, self.tip = places(n, spin)
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0 if spin else -GRAVITY))
        builder.add_cloth_mesh(pos=wp.vec3(0.0), rot=wp.quat_identity(), scale=1.0, vel=wp.vec3(0.0), density=DENSITY,
                               vertices=[wp.vec3(u, v, 0.0) for u, v in points], indices=np.array(triangles).ravel().tolist(),
                               tri_ke=STRETCH / 2, tri_ka=0.0, tri_kd=0.0, tri_drag=0.0, tri_lift=0.0,
                               edge_ke=BEND * n, edge_kd=0.0, particle_radius=1e-3)
        for i in np.flatnonzero(held):
            builder.particle_mass[i], builder.particle_flags[i] = 0.0, 0
        builder.color(include_bending=True)
        model = builder.finalize(device="cpu")
        self.solver, self.control = newton.solvers.SolverVBD(model, iterations=10), model.control()
        self.now, self.next, self.spin = model.state(), model.state(), spin
        if spin:
            self.now.particle_qd.assign(spinning(np.c_[points, 0 * points[:, 0]]).astype(np.float32))

    def advance(self):
        for _ in range(self.steps):
            self.now.clear_forces()
            self.solver.step(self.now, self.next, self.control, None, FRAME / self.steps)
            self.now, self.next = self.next, self.now
            if not self.spin:
                self.now.particle_qd.numpy()[:] *= 1 - BRAKE * FRAME / self.steps

    def drop(self):
        return -self.now.particle_q.numpy()[self.tip, 2].mean()

    def energy(self):
        return 0.5 * (self.masses[:, None] * self.now.particle_qd.numpy() ** 2).sum()


class PyBullet:
    """PyBullet's deformable cloth, mass-spring with bending springs, 1/1000 s"""
    package, sizes, steps = "pybullet", (8, 16), 50

    def __init__(self, n, spin):
        import pybullet as p
        if spin:
            raise NotImplementedError("its interface sets no velocities of nodes")
        points, triangles, masses, held, self.tip = places(n, spin)
        file = Path(tempfile.mkdtemp()) / "strip.obj"
        file.write_text("".join("v %.9g %.9g 0\n" % tuple(x) for x in points) + "".join("f %d %d %d\n" % tuple(i + 1 for i in t) for t in triangles))
        p.connect(p.DIRECT)
        p.resetSimulation(p.RESET_USE_DEFORMABLE_WORLD)
        p.setGravity(0, 0, -GRAVITY)
        p.setTimeStep(FRAME / self.steps)
        self.p, self.body = p, p.loadSoftBody(str(file), mass=masses.sum(), useMassSpring=1, useBendingSprings=1, useNeoHookean=0,
                                              springElasticStiffness=STRETCH, springBendingStiffness=STRETCH,
                                              springDampingStiffness=0.1, springDampingAllDirections=1, useSelfCollision=0,
                                              collisionMargin=1e-4)
        for i in np.flatnonzero(held):
            p.createSoftBodyAnchor(self.body, int(i), -1, -1)

    def advance(self):
        for _ in range(self.steps):
            self.p.stepSimulation()

    def drop(self):
        x = np.array(self.p.getMeshData(self.body, -1, flags=self.p.MESH_DATA_SIMULATION_MESH)[1])
        return -x[self.tip, 2].mean()


def settle(peer, n):
    """(Seconds of processor time, drop) after every frame; the first frame, with what is compiled, apart."""
    sim = peer(n, False)
    history, spent = [], 0.0
    for _ in range(round(END / FRAME)):
        began = time.process_time()
        sim.advance()
        spent += time.process_time() - began if history or peer.package in ("weft", "scipy") else 0.0
        history.append((spent, float(sim.drop())))
        if spent > MOST:
            break
    return history


def reached(history, want, part):
    """Seconds until the drop stays within a part of what is wanted; None: it does not."""
    away = [i for i, (_, drop) in enumerate(history) if not abs(drop / want - 1) < part]
    last = away[-1] if away else -1
    return None if last + 1 >= len(history) - 5 else history[last + 1][0]


def drift(peer, n=8):
    try:
        sim = peer(n, True)
    except NotImplementedError as reason:
        return str(reason)
    before, began = sim.energy(), time.process_time()
    for i in range(round(1 / FRAME)):
        sim.advance()
        if time.process_time() - began > MOST:
            return "not within %g s" % MOST
    return "%+.2g %%" % (100 * (sim.energy() / before - 1))


def lines(peer):
    text = inspect.getsource(peer.__init__).splitlines()[1:]
    if peer is SciPy:
        text += inspect.getsource(WeftMesh.__init__).splitlines()[1:]
    return len(text)


def show(seconds):
    return "no" if seconds is None else "%.2g" % seconds


def main():
    want = exact()
    rows, notes, spins = [], [], []
    for peer in (WeftMesh, SciPy, MuJoCo, Newton, PyBullet):
        try:
            version = importlib.metadata.version(peer.package)
            drops, best = [], {0.01: None, 0.001: None}
            for n in peer.sizes:
                history = settle(peer, n)
                drops.append("%.4f%s" % (history[-1][1], "" if len(history) == round(END / FRAME) else " (after %.2g s)" % (FRAME * len(history))))
                for part in best:
                    took = reached(history, want, part)
                    best[part] = took if best[part] is None or (took is not None and took < best[part]) else best[part]
                print(peer.package, n, drops[-1], "%.3g s" % history[-1][0], flush=True)
            rows.append("| %s | %s | %s | %s | %s | %s | %d |" % (
                peer.__doc__, version, ", ".join("%s (%d)" % d for d in zip(drops, peer.sizes)), show(best[0.01]), show(best[0.001]),
                drift(peer), lines(peer)))
            print(rows[-1], flush=True)
        except Exception as reason:  # what is absent, or refuses the work, is named and the others go on
            notes.append("- %s: skipped, %s: %s" % (peer.__doc__, type(reason).__name__, str(reason).splitlines()[0] if str(reason) else ""))
            print(notes[-1], flush=True)
    text = Path(__file__).with_name("cantilever.md").read_text()
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.machine())
    machine = "%s, %d processors, Python %s, load %.1f" % (cpu, os.cpu_count(), platform.python_version(), os.getloadavg()[0])
    table = "\n".join(rows + ([""] + notes if notes else []))
    page = Path(os.environ["PAGES"], "theory/peers.md")
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(text.format(table=table, want="%.4f" % want, machine=machine, most="%g" % MOST, date=time.strftime("%Y-%m-%d")))
    print("written:", page)


if __name__ == "__main__":
    main()
