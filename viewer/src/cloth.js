// SPDX-License-Identifier: BSD-3-Clause
// cloth.js -- the surface of one run: where it is, its normals, colours, threads, pins.
import {
    BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Group, InstancedMesh,
    LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial, SphereGeometry,
} from 'three';
import { INKS, paint } from './colours.js';
import { clothOf, triangleNormals } from './surface.js';

const FRONT = new Color('#c8553d');
const BACK = new Color('#e3b27a');
const PIN = new Color('#69727e');
const PALE = 0.6; // opacity
const SEAM = '#274b73';

// The two sides of a plain cloth differ in colour, of several in lightness; one that shows a quantity glows a
// little, so that shade does not falsify it much.
function material() {
    const made = new MeshLambertMaterial({ side: DoubleSide, vertexColors: true });
    made.onBeforeCompile = (shader) => {
        shader.uniforms.back = made.userData.back;
        shader.uniforms.glow = made.userData.glow;
        shader.fragmentShader = `uniform vec3 back; uniform float glow;\n${shader.fragmentShader}`
            .replace('#include <color_fragment>', `#include <color_fragment>
                if (glow == 0.0 && !gl_FrontFacing) diffuseColor.rgb = back.r < 0.0 ? mix(diffuseColor.rgb, vec3(1.0), 0.45) : back;`)
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

/** The edges of one triangle alone. */
function rims(faces) {
    const found = new Map();
    faces.forEach((a, j) => {
        const b = faces[j % 3 === 2 ? j - 2 : j + 1];
        const key = Math.min(a, b) * 2 ** 26 + Math.max(a, b);
        found.set(key, found.has(key) ? null : [a, b]);
    });
    return [...found.values()].filter(Boolean).flat();
}

/** As three takes it: a list of plain numbers, or of words as they are. */
const index = (list) => (Array.isArray(list) ? list : new BufferAttribute(list, 1));

function coloured(count, faces) {
    const geometry = new BufferGeometry().setIndex(index(faces));
    for (const name of ['position', 'normal', 'color']) {
        const attribute = new BufferAttribute(new Float32Array(3 * count), 3);
        geometry.setAttribute(name, attribute.setUsage(DynamicDrawUsage));
    }
    return geometry;
}

/** Places with the pieces of a rest shape side by side along u, if the boxes of two overlap. */
function sideBySide(faces, uv) {
    const piece = Uint32Array.from({ length: uv.length / 2 }, (_, i) => i);
    const root = (i) => {
        while (piece[i] !== i) {
            i = piece[i] = piece[piece[i]];
        }
        return i;
    };
    faces.forEach((place, j) => { piece[root(place)] = root(faces[j - (j % 3)]); });
    const boxes = new Map();
    piece.forEach((_, i) => {
        const [u, v, at] = [uv[2 * i], uv[2 * i + 1], root(i)];
        const [a, b, c, d] = boxes.get(at) ?? [u, u, v, v];
        boxes.set(at, [Math.min(a, u), Math.max(b, u), Math.min(c, v), Math.max(d, v)]);
    });
    const list = [...boxes.values()];
    const overlap = (p, q) => p[0] < q[1] && q[0] < p[1] && p[2] < q[3] && q[2] < p[3];
    if (!list.some((p, i) => list.slice(i + 1).some((q) => overlap(p, q)))) {
        return uv;
    }
    let end = 0;
    const shift = new Map();
    boxes.forEach(([lo, hi], at) => {
        shift.set(at, end - lo);
        end += 1.05 * (hi - lo);
    });
    return uv.map((x, k) => (k % 2 === 0 ? x + shift.get(root(k / 2)) : x));
}

/** The flat rest shape of triangles, upright about `centre` and at most `size` large. */
export class RestShape {
    constructor({ faces, uv: flat, of }, centre, size) {
        const uv = sideBySide(faces, flat);
        const sides = [0, 1].map((k) => uv.filter((_, i) => i % 2 === k)).map((x) => [
            x.reduce((a, b) => Math.min(a, b)), x.reduce((a, b) => Math.max(a, b)),
        ]);
        const scale = Math.min(1, (0.8 * size) / Math.hypot(...sides.map(([lo, hi]) => hi - lo)));
        this.of = of;
        this.geometry = coloured(of.length, faces);
        const { position, normal } = this.geometry.attributes;
        of.forEach((_, i) => {
            sides.forEach(([lo, hi], k) => {
                position.array[3 * i + k] = centre[k] + scale * (uv[2 * i + k] - (lo + hi) / 2);
            });
            position.array[3 * i + 2] = centre[2];
        });
        triangleNormals(position.array, faces, normal.array);
        this.mesh = new Mesh(this.geometry, material());
        this.mesh.frustumCulled = false;
        this.lines = new LineSegments(new BufferGeometry().setIndex(index(rims(faces))), threadMaterial());
        this.lines.geometry.setAttribute('position', position);
        this.lines.frustumCulled = false;
        this.group = new Group().add(this.mesh, this.lines);
    }

    /** Each place in the colour of its particle. */
    show(cloth) {
        const from = cloth.geometry.attributes.color.array;
        const { color } = this.geometry.attributes;
        this.mesh.material.userData.glow.value = cloth.surface.material.userData.glow.value;
        this.of.forEach((particle, i) => {
            color.array.set(from.subarray(3 * particle, 3 * particle + 3), 3 * i);
        });
        color.needsUpdate = true;
    }
}

export class Cloth {
    constructor(page, run, size) {
        const { surface } = page;
        this.page = page;
        this.run = run;
        this.group = new Group();
        this.values = new Float32Array(page.count);
        this.chain = surface.chain;
        this.geometry = coloured(page.count, surface.faces);
        this.surface = new Mesh(this.geometry, material());
        this.surface.castShadow = true;
        this.surface.receiveShadow = true;
        this.inks = [FRONT];
        if (surface.cloths.length > 0) {
            this.inks = INKS.map((ink) => new Color(ink));
            this.surface.material.userData.back = { value: new Color(-1, 0, 0) };
        }
        this.lines = this.makeLines(surface.threads);
        this.seams = this.makeLines(surface.seams);
        this.seams.material.color.set(SEAM);
        this.beads = this.makeBeads(size);
        for (const object of [this.surface, this.lines, this.seams, this.beads]) {
            object.frustumCulled = false;
            this.group.add(object);
        }
        this.lines.castShadow = this.chain;
        this.lines.material.opacity = this.chain ? 0.8 : 0.16;
    }

    makeLines(ends) {
        const lines = new LineSegments(new BufferGeometry().setIndex(index(ends)), threadMaterial());
        lines.geometry.setAttribute('position', this.geometry.attributes.position);
        return lines;
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
        const { position, normal, color } = this.geometry.attributes;
        for (let k = 0; k < 3; ++k) {
            this.run.blocks[frame].read(k, position.array, k, 3);
            for (let i = k; place && i < position.array.length; i += 3) {
                position.array[i] = place.to[k] + (position.array[i] - place.from[k]) / place.scale;
            }
        }
        this.page.surface.normals(position.array, normal.array);
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

    /** Pale: as it was in an earlier frame. */
    fade(on) {
        const { material } = this.surface;
        material.needsUpdate = material.transparent !== on;
        Object.assign(material, { transparent: on, opacity: on ? PALE : 1 });
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
        const { inks, page: { surface } } = this;
        for (let i = 0; i < out.length; i += 3) {
            inks[Math.max(clothOf(surface, i / 3), 0) % inks.length].toArray(out, i);
        }
    }
}
