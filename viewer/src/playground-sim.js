// SPDX-License-Identifier: BSD-3-Clause
// playground-sim.js -- a simulation in WebAssembly (packaging/wasm/page.c), as the worker and tests call it.
import { wasi } from './wasi.js';

/** weft's own status codes that a page tells apart. */
const OK = 0;

export class Simulation {
    constructor(module, files) {
        this.files = new Map(files);
        const host = wasi({ files: this.files });
        const instance = new WebAssembly.Instance(module, host.imports);
        host.attach(instance);
        this.calls = instance.exports;
        this.calls._initialize();
    }

    bytes(at, size) {
        return new Uint8Array(this.calls.memory.buffer, at, size);
    }

    text(at) {
        const all = new Uint8Array(this.calls.memory.buffer);
        return new TextDecoder().decode(all.slice(at, all.indexOf(0, at)));
    }

    json(at) {
        return JSON.parse(this.text(at));
    }

    put(text) {
        const bytes = new TextEncoder().encode(`${text}\0`);
        const at = this.calls.room(bytes.length);
        this.bytes(at, bytes.length).set(bytes);
        return at;
    }

    /** The scene with overrides: { scene } as it runs, or none; { mistakes } in it. */
    open(text, sets) {
        this.files.set('scene.yaml', new TextEncoder().encode(text));
        const list = this.calls.room(4 * sets.length + 4);
        sets.map((set) => this.put(set)).forEach((at, i) => {
            new DataView(this.calls.memory.buffer).setUint32(list + 4 * i, at, true);
        });
        const status = this.calls.open(sets.length, list);
        const mistakes = this.json(this.calls.mistakes());
        return { mistakes, scene: status === OK ? this.describe() : null };
    }

    describe() {
        const scene = this.json(this.calls.describe());
        const triangles = this.calls.triangles(0);
        if (triangles > 0) {
            const corners = this.calls.room(12 * triangles);
            this.calls.triangles(corners);
            scene.corners = new Uint32Array(this.calls.memory.buffer.slice(corners, corners + 12 * triangles));
        }
        this.count = scene.count;
        return scene;
    }

    /** Until the time `until` [s], for `budget` [s] at most; '' or why it failed. */
    advance(until, budget) {
        return this.calls.advance(until, budget) === OK ? '' : this.json(this.calls.mistakes())[0]?.message ?? 'failed';
    }

    /** Planes x, y, z, strain in single precision, and what was measured. */
    look() {
        const n = this.count;
        const planes = new Float32Array(4 * n);
        const places = new Float32Array(this.calls.memory.buffer, this.calls.places(), 3 * n);
        places.forEach((x, i) => { planes[(i % 3) * n + (i - (i % 3)) / 3] = x; });
        planes.set(new Float64Array(this.calls.memory.buffer, this.calls.strains(), n), 3 * n);
        return { planes, numbers: this.json(this.calls.measure()) };
    }
}
