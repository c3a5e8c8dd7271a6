// SPDX-License-Identifier: BSD-3-Clause
// playground-run.js -- a cloth that steps in a worker, as the player's stage draws a run: its one
// frame is the present state.

const HELD = 1.5; // times its size at the start: particles farther out are drawn there,
const REACH = 10; // and the cloth is stepped until it is so large

/** The state as a block of the player's pages. */
class State {
    constructor(count) {
        this.count = count;
        this.planes = new Float32Array(4 * count);
    }

    plane(k) {
        return this.planes.subarray(k * this.count, (k + 1) * this.count);
    }

    range(k) {
        const finite = this.plane(k).filter(Number.isFinite);
        return [finite.reduce((a, b) => Math.min(a, b), Infinity), finite.reduce((a, b) => Math.max(a, b), -Infinity)];
    }

    read(k, out, offset = 0, step = 1) {
        const from = this.plane(k);
        for (let i = 0, to = offset; i < from.length; ++i, to += step) {
            out[to] = from[i];
        }
        return out;
    }

    box() {
        return [0, 1, 2].map((k) => this.range(k));
    }
}

export class Run {
    constructor(url, module, files) {
        this.worker = new Worker(url);
        this.waiting = new Map();
        this.id = 0;
        this.busy = false;
        this.worker.onmessage = ({ data }) => {
            this.waiting.get(data.id)(data);
            this.waiting.delete(data.id);
        };
        this.ask('load', { module, files });
    }

    ask(kind, what) {
        this.id += 1;
        this.worker.postMessage({ kind, id: this.id, ...what });
        return new Promise((done) => { this.waiting.set(this.id, done); });
    }

    /** Resolves to { scene, mistakes }. */
    async open(text, sets) {
        const answer = await this.ask('open', { text, sets });
        answer.mistakes ??= [{ line: 0, column: 0, warning: false, message: answer.failure }]; // the worker failed
        const { scene } = answer;
        if (scene) {
            this.scene = scene;
            this.blocks = [new State(scene.count)];
            Object.assign(this, scene, { onset: null, over: '', history: [] });
            this.take(answer);
            const box = this.blocks[0].box();
            this.middle = box.map(([lo, hi]) => (lo + hi) / 2);
            this.reach = HELD * Math.hypot(...box.map(([lo, hi]) => hi - lo)) / 2;
        }
        return answer;
    }

    take({ planes, numbers, took }) {
        const [block] = this.blocks;
        const finite = planes.every(Number.isFinite);
        Object.assign(this, { numbers, took: took ?? 0, fresh: true });
        if (numbers.sudden && !this.onset) {
            this.onset = { time: numbers.time, particle: finite ? this.farthest(planes) : '' };
        }
        if (finite) {
            block.planes = this.onset ? this.clipped(planes) : planes;
        }
        if (!finite || numbers.size > REACH) {
            this.onset ??= { time: numbers.time, particle: '' };
            this.over = `it is more than ${REACH} times as large as at the start`;
        }
        this.history.push([numbers.time, numbers.total ?? null, numbers.kinetic ?? null]);
    }

    /** Steps until `until` [s], if it does not step already and has not blown up. */
    async advance(until, budget, pull) {
        if (this.busy || this.over) {
            return;
        }
        this.busy = true;
        const { scene } = this;
        const answer = await this.ask('advance', { until, budget, ...pull });
        this.busy = false;
        if (scene !== this.scene) { // another was opened meanwhile
            return;
        }
        if (answer.planes) {
            this.take(answer);
        }
        this.onset ??= answer.failure ? { time: this.numbers.time, particle: '' } : null;
        this.over ||= answer.failure;
    }

    /** The state with each particle at most HELD times as far from the middle as the cloth is large. */
    clipped(planes) {
        const { count } = this.blocks[0];
        for (let i = 0; i < count; ++i) {
            const away = [0, 1, 2].map((k) => planes[k * count + i] - this.middle[k]);
            const part = Math.min(1, this.reach / Math.hypot(...away));
            away.forEach((x, k) => { planes[k * count + i] = this.middle[k] + part * x; });
        }
        return planes;
    }

    /** The particle that has moved farthest from where it was drawn last. */
    farthest(planes) {
        const [block] = this.blocks;
        const { count } = block;
        const far = (i) => Math.hypot(...[0, 1, 2].map((k) => planes[k * count + i] - block.planes[k * count + i]));
        let best = 0;
        for (let i = 1; i < count; ++i) {
            best = far(i) > far(best) ? i : best;
        }
        const { cols } = this.scene;
        return cols > 0 ? `particle (${Math.floor(best / cols)}, ${best % cols})` : `vertex ${best}`;
    }
}
