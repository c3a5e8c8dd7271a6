// SPDX-License-Identifier: BSD-3-Clause
// camera.js -- from where a cloth is looked at first: 25 degrees above it, and never along it.
import { Vector3 } from 'three';
import { fitted } from './data.js';

const RISE = (25 * Math.PI) / 180;
const AZIMUTH = Math.atan2(0.6, 1); // from z towards x
const TURNS = [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6].map((k) => (k * Math.PI) / 6);
const WIDE = 0.3; // of the area of a cloth that is enough to be seen
const TRIANGLES = 2000; // looked at

/** The area vectors of triangles in a frame, one after another. */
function areas(page, run, frame) {
    const [x, y, z] = [0, 1, 2].map((k) => run.blocks[frame].read(k, new Float64Array(page.count)));
    const { faces } = page.surface;
    const every = 3 * Math.ceil(faces.length / 3 / TRIANGLES);
    const list = [];
    for (let t = 0; t < faces.length; t += every) {
        const [a, b, c] = [faces[t], faces[t + 1], faces[t + 2]].map((i) => new Vector3(x[i], y[i], z[i]));
        list.push(b.sub(a).cross(c.sub(a)));
    }
    return list;
}

/** The direction from the cloth to the camera. */
export function direction(page) {
    const samples = page.runs.flatMap((run) => {
        const last = fitted(page, run.blocks, run.calm).length - 1;
        return [...new Set([0, last >> 1, last])].map((frame) => areas(page, run, frame));
    });
    const share = (way) => Math.min(...samples.map((list) => {
        const all = list.reduce((sum, area) => sum + area.length(), 0);
        return all > 0 ? list.reduce((sum, area) => sum + Math.abs(area.dot(way)), 0) / all : 1;
    }));
    const ways = TURNS.map((turn) => new Vector3(
        Math.cos(RISE) * Math.sin(AZIMUTH + turn), Math.sin(RISE), Math.cos(RISE) * Math.cos(AZIMUTH + turn),
    ));
    const shares = ways.map(share);
    const wide = shares.findIndex((part) => part >= WIDE);
    return ways[wide >= 0 ? wide : shares.indexOf(Math.max(...shares))];
}
