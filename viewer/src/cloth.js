// SPDX-License-Identifier: BSD-3-Clause
// cloth.js -- the surface of one run: where it is, its normals, colours, threads, pins.
import {
    BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Group, InstancedMesh,
    LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial, SphereGeometry,
} from 'three';
import { paint } from './colours.js';

const FRONT = new Color('#c8553d');
const BACK = new Color('#e3b27a');
const PIN = new Color('#69727e');

/** Two triangles a cell, split along alternating diagonals. */
function faces(rows, cols) {
    const index = [];
    for (let r = 0; r + 1 < rows; ++r) {
        for (let c = 0; c + 1 < cols; ++c) {
            const a = r * cols + c;
            const b = a + 1;
            const d = a + cols;
            const e = d + 1;
            index.push(...((r + c) % 2 ? [a, d, b, b, d, e] : [a, d, e, a, e, b]));
        }
    }
    return index;
}

function threads(rows, cols) {
    const index = [];
    for (let r = 0; r < rows; ++r) {
        for (let c = 0; c < cols; ++c) {
            const a = r * cols + c;
            if (c + 1 < cols) index.push(a, a + 1);
            if (r + 1 < rows) index.push(a, a + cols);
        }
    }
    return index;
}

/** Unit normals of a grid of points by central differences, one-sided on the rim. */
export function normals(p, rows, cols, out) {
    for (let r = 0, k = 0; r < rows; ++r) {
        const up = r > 0 ? 3 * cols : 0;
        const down = r + 1 < rows ? 3 * cols : 0;
        for (let c = 0; c < cols; ++c, k += 3) {
            const left = k - (c > 0 ? 3 : 0);
            const right = k + (c + 1 < cols ? 3 : 0);
            const ux = p[right] - p[left];
            const uy = p[right + 1] - p[left + 1];
            const uz = p[right + 2] - p[left + 2];
            const vx = p[k - up] - p[k + down];
            const vy = p[k - up + 1] - p[k + down + 1];
            const vz = p[k - up + 2] - p[k + down + 2];
            const nx = uy * vz - uz * vy;
            const ny = uz * vx - ux * vz;
            const nz = ux * vy - uy * vx;
            const length = Math.hypot(nx, ny, nz) || 1;
            out[k] = nx / length;
            out[k + 1] = ny / length;
            out[k + 2] = nz / length;
        }
    }
}

// The two sides of a plain cloth differ in colour; one that shows a quantity glows a
// little, so that shade does not falsify it much.
function material() {
    const made = new MeshLambertMaterial({ side: DoubleSide, vertexColors: true });
    made.onBeforeCompile = (shader) => {
        shader.uniforms.back = made.userData.back;
        shader.uniforms.glow = made.userData.glow;
        shader.fragmentShader = `uniform vec3 back; uniform float glow;\n${shader.fragmentShader}`
            .replace('#include <color_fragment>', `#include <color_fragment>
                if (glow == 0.0 && !gl_FrontFacing) diffuseColor.rgb = back;`)
            .replace('#include <emissivemap_fragment>', `totalEmissiveRadiance = glow * diffuseColor.rgb;
                diffuseColor.rgb *= 1.0 - glow;`);
    };
    made.userData.back = { value: BACK };
    made.userData.glow = { value: 0 };
    return made;
}

/** The threads of a cloth lie on it: half the width of a pixel towards the viewer. */
function threadMaterial() {
    const made = new LineBasicMaterial({ color: '#000000', transparent: true });
    made.onBeforeCompile = (shader) => {
        shader.vertexShader = shader.vertexShader.replace(
            '#include <project_vertex>',
            '#include <project_vertex>\ngl_Position.z -= 4e-4 * gl_Position.w;',
        );
    };
    return made;
}

export class Cloth {
    constructor(page, run, size) {
        const [rows, cols] = page.shown;
        this.page = page;
        this.run = run;
        this.group = new Group();
        this.values = new Float32Array(page.count);
        this.chain = rows === 1 || cols === 1;
        this.geometry = new BufferGeometry();
        for (const name of ['position', 'normal', 'color']) {
            const attribute = new BufferAttribute(new Float32Array(3 * page.count), 3);
            this.geometry.setAttribute(name, attribute.setUsage(DynamicDrawUsage));
        }
        this.geometry.setIndex(faces(rows, cols));
        this.surface = new Mesh(this.geometry, material());
        this.surface.castShadow = true;
        this.surface.receiveShadow = true;
        this.lines = new LineSegments(
            new BufferGeometry().setIndex(threads(rows, cols)), threadMaterial(),
        );
        this.lines.geometry.setAttribute('position', this.geometry.attributes.position);
        this.beads = this.makeBeads(size);
        for (const object of [this.surface, this.lines, this.beads]) {
            object.frustumCulled = false;
            this.group.add(object);
        }
        this.lines.castShadow = this.chain;
        this.lines.material.opacity = this.chain ? 0.8 : 0.16;
    }

    /** Spheres at the pins; in a chain at every particle. */
    makeBeads(size) {
        const { page } = this;
        this.beadAt = this.chain ? Array.from({ length: page.count }, (_, i) => i) : page.pinned;
        const radius = size * (page.pinned.length > 32 ? 0.006 : 0.011);
        const beads = new InstancedMesh(
            new SphereGeometry(radius, 16, 12),
            new MeshLambertMaterial(), this.beadAt.length,
        );
        const pinned = new Set(page.pinned);
        this.beadAt.forEach((i, k) => beads.setColorAt(k, PIN));
        this.painted = this.beadAt.filter((i) => !pinned.has(i));
        beads.castShadow = this.chain;
        return beads;
    }

    /** `place`, if there is one: { from, scale, to }, p is drawn at to + (p - from) / scale. */
    show(frame, quantity, place) {
        const [rows, cols] = this.page.shown;
        const { position, normal, color } = this.geometry.attributes;
        for (let k = 0; k < 3; ++k) {
            this.run.blocks[frame].read(k, position.array, k, 3);
            for (let i = k; place && i < position.array.length; i += 3) {
                position.array[i] = place.to[k] + (position.array[i] - place.from[k]) / place.scale;
            }
        }
        normals(position.array, rows, cols, normal.array);
        this.colour(frame, quantity, color.array);
        const matrix = new Matrix4();
        this.beadAt.forEach((i, k) => {
            this.beads.setMatrixAt(k, matrix.makeTranslation(...position.array.subarray(3 * i, 3 * i + 3)));
        });
        const ink = new Color();
        this.painted.forEach((i) => this.beads.setColorAt(i, ink.fromArray(color.array, 3 * i)));
        for (const changed of [position, normal, color, this.beads.instanceMatrix, this.beads.instanceColor].filter(Boolean)) {
            changed.needsUpdate = true;
        }
    }

    /** The line of a chain lies on nothing but the background. */
    setInk(dark) {
        this.lines.material.color.set(this.chain && dark ? '#d9d5cc' : '#000000');
    }

    colour(frame, quantity, out) {
        this.surface.material.userData.glow.value = quantity ? 0.45 : 0;
        if (quantity) {
            quantity.read(this.run, frame, this.values);
            paint(this.values, quantity, out);
            return;
        }
        for (let i = 0; i < out.length; i += 3) {
            out[i] = FRONT.r;
            out[i + 1] = FRONT.g;
            out[i + 2] = FRONT.b;
        }
    }
}
