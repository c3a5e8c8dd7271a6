// SPDX-License-Identifier: BSD-3-Clause
// shapes.js -- bodies that a cloth touches: where they are, how far it is to them, meshes.
import {
    BufferGeometry, CircleGeometry, DoubleSide, Float32BufferAttribute, Group, Mesh, MeshLambertMaterial, Quaternion, SphereGeometry, Vector3,
} from 'three';
import { selfGaps } from './self.js';

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => a.map((x, k) => x - b[k]);
const unit = (a) => a.map((x) => x / Math.hypot(...a));

/** How it has turned at time t [s]. */
export function rotationAt({ turn }, t) {
    if (!turn) {
        return new Quaternion();
    }
    const angle = turn.rate * t + turn.amplitude * Math.sin(2 * Math.PI * turn.frequency * t);
    return new Quaternion().setFromAxisAngle(new Vector3(...turn.axis).normalize(), angle);
}

/** Where the point x of t = 0 is at time t [s]; its point `at` unless given. */
export function placeAt(shape, t, x = shape.at) {
    const about = shape.turn?.about ?? shape.at;
    const arm = new Vector3(...minus(x, about)).applyQuaternion(rotationAt(shape, t)).toArray();
    return arm.map(
        (r, k) => about[k] + r + shape.velocity[k] * t + shape.amplitude[k] * Math.sin(2 * Math.PI * shape.frequency * t),
    );
}

/** Keys on each side of a time that a place takes something from; those beyond have less than 1e-9. */
const KEYS_BESIDE = 16;

/**
 * The shares that keys have in a place at x, their number counted in keys: those of the natural cubic spline through
 * them (docs/guides/drape-on-a-body.md), as src/forces/contact/mesh_shape.c computes them.
 */
function keyShares(count, x) {
    if (!(x >= 0 && x < count - 1)) {
        return [[x > 0 ? count - 1 : 0, 1]];
    }
    const i = Math.floor(x);
    const first = Math.max(i + 1 - KEYS_BESIDE, 0);
    const share = new Array(Math.min(i + 1 + KEYS_BESIDE, count) - first).fill(0);
    const [pivot, part] = [share.slice(), share.slice()];
    const [at, s, r] = [i - first, x - i, 1 - (x - i)];
    share[at] += r;
    share[at + 1] += s;
    for (let j = 1; j + 1 < share.length; ++j) {
        const wanted = j === at ? r * (r * r - 1) : j === at + 1 ? s * (s * s - 1) : 0;
        pivot[j] = 1 / (4 - pivot[j - 1]);
        part[j] = pivot[j] * (wanted - part[j - 1]);
    }
    for (let j = share.length - 2; j > 0; --j) {
        part[j] -= pivot[j] * part[j + 1];
        share[j - 1] += part[j];
        share[j] -= 2 * part[j];
        share[j + 1] += part[j];
    }
    return share.map((of, k) => [first + k, of]);
}

/** Puts the vertices of a mesh that moves by keys where they are at time t [s]. */
function moveVertices(geometry, { keys, fps }, t) {
    const { position } = geometry.attributes;
    const shares = keyShares(keys.length, t * fps);
    for (let i = 0; i < position.array.length; ++i) {
        position.array[i] = shares.reduce((sum, [k, share]) => sum + share * keys[k][i], 0);
    }
    position.needsUpdate = true;
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
}

/** How far x is beyond the range from lo to hi. */
const beyond = (x, lo, hi) => Math.max(x - hi, 0) + Math.min(x - lo, 0);

/** The gap of a point r from `at`: the formulas of docs/theory/contact.md. */
const GAPS = {
    plane: (shape) => {
        const normal = unit(shape.normal);
        return (r) => dot(r, normal);
    },
    sphere: ({ radius }) => (r) => Math.hypot(...r) - radius,
    capsule: (shape) => {
        const way = minus(shape.to, shape.at);
        const axis = unit(way);
        const length = Math.hypot(...way);
        return (r) => {
            const along = dot(r, axis);
            const rho2 = Math.max(dot(r, r) - along * along, 0);
            return (rho2 ** 2 + beyond(along, 0, length) ** 4) ** 0.25 - shape.radius;
        };
    },
    box: ({ half, rounding }) => (r) => {
        const q = r.map((x, k) => beyond(x, rounding - half[k], half[k] - rounding));
        return (q[0] ** 4 + q[1] ** 4 + q[2] ** 4) ** 0.25 - rounding;
    },
};

/** The smallest gap [m] of each particle of a run in a frame: to the shapes but meshes and, within the
 * thickness, to other parts of the cloth. */
export function gaps(page, run, frame, out) {
    const [x, y, z] = [0, 1, 2].map((k) => run.blocks[frame].read(k, new Float32Array(out.length)));
    const near = run.obstacles.filter(({ shape }) => GAPS[shape]).map((shape) => {
        const gap = GAPS[shape.shape](shape);
        const back = rotationAt(shape, page.times[frame]).invert();
        const r = new Vector3();
        const turned = (from) => gap(r.set(...from).applyQuaternion(back).toArray());
        return [shape.turn ? turned : gap, placeAt(shape, page.times[frame])];
    });
    for (let i = 0; i < out.length; ++i) {
        out[i] = near.reduce((least, [gap, at]) => Math.min(least, gap([x[i] - at[0], y[i] - at[1], z[i] - at[2]])), Infinity);
    }
    return run.self ? selfGaps(page.surface.triangles, [x, y, z], run.thickness, out) : out;
}

/** A sphere's points, moved to the core of a shape and its distance from there; `core` is
 * half of the core's edges, `norm` the length of a direction in the norm of the gap. */
function around(core, radius, norm) {
    const made = new SphereGeometry(1, 64, 32);
    const { position, normal } = made.attributes;
    for (let i = 0; i < position.array.length; i += 3) {
        const n = [0, 1, 2].map((k) => (Math.abs(position.array[i + k]) < 1e-6 ? 0 : position.array[i + k]));
        const [length, slope] = norm(n);
        position.array.set(n.map((x, k) => Math.sign(x) * core[k] + (radius / length) * x), i);
        normal.array.set(unit(slope), i);
    }
    return made;
}

/** Length of n, and the direction in which it grows. */
const round = ([x, y, z]) => [((x * x + z * z) ** 2 + y ** 4) ** 0.25, [(x * x + z * z) * x, y ** 3, (x * x + z * z) * z]];
const cubic = (n) => [(n[0] ** 4 + n[1] ** 4 + n[2] ** 4) ** 0.25, n.map((x) => x ** 3)];

const MESHES = {
    plane: ({ normal }, size) => {
        const geometry = new CircleGeometry(6 * size, 64);
        const rim = Array.from({ length: geometry.attributes.position.count - 1 }, () => [1, 1, 1, 0]);
        geometry.setAttribute('color', new Float32BufferAttribute([[1, 1, 1, 1], ...rim].flat(), 4)); // fades into the distance
        const made = new Mesh(geometry);
        made.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...unit(normal)));
        return made;
    },
    sphere: ({ radius }) => new Mesh(new SphereGeometry(radius, 64, 32)),
    capsule: ({ at, to, radius }) => {
        const way = minus(to, at);
        const length = Math.hypot(...way);
        const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(...unit(way)));
        const geometry = around([0, length / 2, 0], radius, round).translate(0, length / 2, 0).applyQuaternion(turn);
        return new Mesh(geometry);
    },
    mesh: (shape) => {
        const geometry = new BufferGeometry();
        geometry.setAttribute('position', new Float32BufferAttribute(shape.keys[0], 3));
        geometry.setIndex(shape.corners);
        moveVertices(geometry, shape, 0);
        return new Mesh(geometry);
    },
    box: ({ half, rounding }) => new Mesh(around(half.map((x) => x - rounding), rounding, cubic)),
};

/** Six sectors about the axis of a shape that spins or turns, every other one darker: so that it is seen. */
function stripe(geometry, axis) {
    const { position, normal } = geometry.attributes;
    const flat = new Quaternion().setFromUnitVectors(axis, new Vector3(0, 1, 0));
    const tints = Array.from({ length: position.count }, (_, i) => {
        const { x, z } = new Vector3().fromBufferAttribute(normal, i).applyQuaternion(flat);
        return Math.sin(3 * Math.atan2(z, x)) > 0 ? 0.6 : 1;
    });
    geometry.setAttribute('color', new Float32BufferAttribute(tints.flatMap((v) => [v, v, v]), 3));
}

export class Shapes {
    constructor(page, run, size) {
        this.page = page;
        this.list = run.obstacles;
        this.spins = this.list.map(({ spin = [0, 0, 0] }) => new Vector3(...spin));
        const axes = this.list.map(({ turn }, i) => (turn && this.spins[i].length() === 0 ? new Vector3(...turn.axis) : this.spins[i]));
        this.group = new Group();
        this.list.forEach((shape, i) => {
            const made = MESHES[shape.shape](shape, size);
            const isPlane = shape.shape === 'plane'; // a veil: the floor's squares show the scale
            const isStriped = axes[i].length() > 0 && !isPlane && shape.shape !== 'box';
            if (isStriped) {
                stripe(made.geometry, axes[i].clone().normalize());
            }
            made.material = new MeshLambertMaterial({
                color: '#8d99ae', side: DoubleSide, transparent: isPlane, opacity: isPlane ? 0.3 : 1, depthWrite: !isPlane,
                vertexColors: isStriped || isPlane,
            });
            made.userData.rest = made.quaternion.clone();
            made.castShadow = !isPlane;
            made.receiveShadow = true;
            this.group.add(made);
        });
    }

    /** `place` as in Cloth. */
    show(frame, place) {
        const { scale = 1, from = [0, 0, 0], to = [0, 0, 0] } = place ?? {};
        this.group.scale.setScalar(1 / scale);
        this.group.position.set(...to.map((x, k) => x - from[k] / scale));
        this.list.forEach((shape, i) => {
            const made = this.group.children[i];
            const [t, spin] = [this.page.times[frame], this.spins[i]];
            made.position.set(...placeAt(shape, t));
            if (shape.shape === 'mesh' && shape.keys.length > 1) {
                moveVertices(made.geometry, shape, t);
            }
            made.quaternion.setFromAxisAngle(spin.clone().normalize(), spin.length() * t).multiply(made.userData.rest)
                .premultiply(rotationAt(shape, t));
        });
    }
}

/** Half the edges of the box around a shape, and the middle of it beside `at`; null of a plane. */
const extents = {
    plane: () => null,
    sphere: ({ radius }) => [[radius, radius, radius], [0, 0, 0]],
    capsule: ({ at, to, radius }) => {
        const half = minus(to, at).map((x) => x / 2);
        return [half.map((x) => Math.abs(x) + radius), half];
    },
    box: ({ half }) => [half, [0, 0, 0]],
    mesh: ({ keys }) => {
        const [low, high] = [Math.min, Math.max].map((most) => [0, 1, 2].map((k) => keys.flat().reduce(
            (far, x, i) => (i % 3 === k ? most(far, x) : far), most(Infinity, -Infinity) === Infinity ? -Infinity : Infinity,
        )));
        return [high.map((x, k) => (x - low[k]) / 2), high.map((x, k) => (x + low[k]) / 2)];
    },
};

/** The boxes of all shapes, no larger than `most` [m], in the first, middle and last frame. */
export function shapeBoxes(page, most) {
    const { times } = page;
    const looked = [times[0], times[times.length >> 1], times.at(-1)];
    return page.runs.flatMap((run) => run.obstacles).flatMap((shape) => {
        const [still, middle] = extents[shape.shape](shape) ?? [[Infinity, 0, 0]];
        const half = shape.turn ? still.map(() => Math.hypot(...still)) : still;
        return 2 * Math.hypot(...half) > most ? [] : looked.map(
            (t) => placeAt(shape, t, shape.at.map((x, k) => x + middle[k])).map((x, k) => [x - half[k], x + half[k]]),
        );
    });
}
