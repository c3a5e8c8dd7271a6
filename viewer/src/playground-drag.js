// SPDX-License-Identifier: BSD-3-Clause
// playground-drag.js -- a particle under the pointer, moved in the plane of the picture.
import { Vector3 } from 'three';

const REACH = 26; // px from a particle

export class Dragging {
    /** `seen` returns { stage, runs } as they are. */
    constructor(canvas, seen) {
        Object.assign(this, { canvas, seen, particle: null, to: null });
        canvas.addEventListener('pointerdown', (event) => this.take(event), true);
        canvas.addEventListener('pointermove', (event) => this.move(event), true);
        for (const end of ['pointerup', 'pointercancel']) {
            canvas.addEventListener(end, (event) => this.release(event), true);
        }
    }

    /** The view under the pointer, and where in it: [-1, 1]. */
    place({ clientX, clientY }) {
        const { stage } = this.seen();
        const box = this.canvas.getBoundingClientRect();
        const [x, y] = [clientX - box.left, box.bottom - clientY];
        const view = this.view ?? stage.panes.findIndex(([left, bottom, width, height]) => (
            x >= left && x < left + width && y >= bottom && y < bottom + height));
        const [left, bottom, width, height] = stage.panes[Math.max(view, 0)];
        return { view, x: (2 * (x - left)) / width - 1, y: (2 * (y - bottom)) / height - 1, width, height };
    }

    take(event) {
        const { stage, runs } = this.seen();
        if (!stage || runs.length === 0 || !event.isPrimary || event.button !== 0) {
            return;
        }
        const { view, x, y, width, height } = this.place(event);
        const block = runs[view]?.blocks[0];
        let [best, nearest] = [null, REACH];
        for (let i = 0; block && i < block.count; ++i) {
            const at = new Vector3(block.plane(0)[i], block.plane(1)[i], block.plane(2)[i]);
            const seen = at.clone().project(stage.camera);
            const far = Math.hypot(((seen.x - x) * width) / 2, ((seen.y - y) * height) / 2);
            if (far < nearest) {
                [nearest, best] = [far, { i, at, depth: seen.z }];
            }
        }
        if (best) {
            Object.assign(this, { particle: best.i, to: best.at.toArray(), depth: best.depth, view });
            stage.controls.enabled = false;
            this.canvas.classList.add('dragging');
            this.canvas.setPointerCapture(event.pointerId);
            event.stopPropagation();
        }
    }

    move(event) {
        if (this.particle !== null) {
            const { x, y } = this.place(event);
            this.to = new Vector3(x, y, this.depth).unproject(this.seen().stage.camera).toArray();
            event.stopPropagation();
        }
    }

    release() {
        if (this.particle !== null) {
            Object.assign(this, { particle: null, to: null, view: undefined });
            this.canvas.classList.remove('dragging');
            this.seen().stage.controls.enabled = true;
        }
    }

    /** What the next message to each worker holds. */
    pull() {
        return { grab: this.particle ?? -1, drag: this.to };
    }
}
