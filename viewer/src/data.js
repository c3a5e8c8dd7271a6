// SPDX-License-Identifier: BSD-3-Clause
// data.js -- what weft put into the page (docs/guides/view-and-export.md): a description as JSON and a
// block of numbers for each frame of each run.

import { shapeBoxes } from './shapes.js';
import { clothOf, readSurface } from './surface.js';

const bytesOf = (text) => (Uint8Array.fromBase64
    ? Uint8Array.fromBase64(text)
    : Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));

/** A block: smallest and largest of each plane, then 16 bits a number. */
class Block {
    constructor(element, planes, count) {
        this.element = element;
        this.planes = planes;
        this.count = count;
        this.bytes = null;
    }

    /** [lo, hi] of a plane, without decoding the rest. */
    range(plane) {
        if (!this.ranges) {
            const size = 8 * this.planes;
            const text = this.element.textContent.slice(0, 4 * Math.ceil(size / 3));
            this.ranges = new Float32Array(bytesOf(text).slice(0, size).buffer);
        }
        return [this.ranges[2 * plane], this.ranges[2 * plane + 1]];
    }

    /** The numbers of a plane, into out[offset], out[offset + step], ... */
    read(plane, out, offset = 0, step = 1) {
        if (!this.bytes) {
            this.range(0);
            this.bytes = bytesOf(this.element.textContent);
            this.element.textContent = '';
        }
        const start = 8 * this.planes + 2 * this.count * plane;
        const codes = new Uint16Array(this.bytes.buffer, start, this.count);
        const [lo, hi] = this.range(plane);
        const unit = (hi - lo) / 65535;
        for (let i = 0, k = offset; i < codes.length; ++i, k += step) {
            out[k] = lo + codes[i] * unit;
        }
        return out;
    }
}

// "\u00e9" and "\t" as in JSON; "\x07", "\U0001F9F5", "\e" and their like are YAML's own.
const NAMED = {
    0: '\0', a: '\x07', b: '\b', t: '\t', n: '\n', v: '\v', f: '\f', r: '\r', e: '\x1b',
    N: '\x85', _: '\xa0', L: '\u2028', P: '\u2029',
};
const unquote = (text) => text.replace(
    /\\(?:x([0-9a-fA-F]{2})|u([0-9a-fA-F]{4})|U([0-9a-fA-F]{8})|(.))/gs,
    (_, x, u, U, c) => (c === undefined
        ? String.fromCodePoint(parseInt(x ?? u ?? U, 16))
        : NAMED[c] ?? c),
);

/** The maps of manifest.yaml and result.yaml, as weft writes them: "method.name" -> text. */
export function readReport(text) {
    const found = new Map();
    const path = [];
    for (const line of (text ?? '').split('\n')) {
        const match = /^( *)([\w-]+):(?: (.*))?$/.exec(line);
        if (match) {
            const [, indent, key, value = ''] = match;
            path.length = indent.length / 2;
            path.push(key);
            found.set(path.join('.'), /^".*"$/.test(value) ? unquote(value.slice(1, -1)) : value);
        }
    }
    return found;
}

/** The columns of series.csv by name, NaN for an empty cell; a last row that was cut short is left out. */
export function readSeries(text) {
    const lines = (text ?? '').split('\n').filter((line) => line !== '');
    const names = (lines.shift() ?? '').split(',');
    const rows = lines.map((line) => line.split(',')).filter((r) => r.length === names.length);
    const columns = names.map((name, i) => [name, rows.map((row) => (row[i] === '' ? NaN : Number(row[i])))]);
    return new Map(columns);
}

const readRun = (run) => ({
    ...run,
    report: readReport(run.manifest),
    outcome: readReport(run.result),
    columns: readSeries(run.series),
});

const ONSET = 2; // times the size at the start: a cloth that blows up leaves the stage
const REACH = 10; // so many times as large it has blown up, and is no longer drawn

const box = (block) => [0, 1, 2].map((k) => block.range(k));
const length = (sides) => Math.hypot(...sides.map(([lo, hi]) => hi - lo));
const size = (block) => length(box(block));

/** Whether a particle of a block is within a box. */
function reaches(block, sides) {
    const [x, y, z] = [0, 1, 2].map((k) => block.read(k, new Float32Array(block.count)));
    const inside = (v, [lo, hi]) => v >= lo && v <= hi;
    return x.some((_, i) => inside(x[i], sides[0]) && inside(y[i], sides[1]) && inside(z[i], sides[2]));
}

/** Gives a run `blown`, `calm`: how many frames there are before it leaves the stage, and
 * `held`: the last frame that is drawn. All frames are, if it does not blow up. */
function findOnset(run) {
    const { blocks } = run;
    const most = size(blocks[0]);
    const end = blocks.findIndex((block) => size(block) > REACH * most);
    run.blown = end >= 0;
    run.calm = run.blown ? blocks.findLastIndex((block, i) => i < end && size(block) <= ONSET * most) + 1 : blocks.length;
    run.held = blocks.length - 1;
    if (run.blown) {
        run.held = end - 1;
        while (run.held >= run.calm && !reaches(blocks[run.held], box(blocks[0]))) {
            --run.held;
        }
    }
}

function findOnsets(page) {
    page.runs.forEach(findOnset);
    page.calm = Math.min(...page.runs.map((run) => run.calm));
    page.blown = page.runs.some((run) => run.blown);
}

/** The particle farthest from where the cloth started, as a run leaves the stage: "particle (0, 23)". */
export function leaver(page, run) {
    const centre = box(run.blocks[0]).map(([lo, hi]) => (lo + hi) / 2);
    const planes = centre.map((_, k) => run.blocks[run.calm].read(k, new Float32Array(page.count)));
    const far = planes[0].map((_, i) => Math.hypot(...planes.map((plane, k) => plane[i] - centre[k])));
    const at = far.reduce((best, d, i) => (d > far[best] ? i : best), 0);
    if (page.mesh) {
        const cloth = page.surface.cloths[clothOf(page.surface, at)];
        return cloth ? `a vertex of ${cloth.name}` : `vertex ${at}`;
    }
    const [row, col] = [Math.floor(at / page.shown[1]), at % page.shown[1]].map(
        (i, k) => Math.min(i * page.stride, page.grid[k] - 1),
    );
    return `particle (${row}, ${col})`;
}

export function readPage(root) {
    const meta = JSON.parse(root.getElementById('weft-data').textContent);
    const elements = [...root.querySelectorAll('script[type="weft/frame"]')];
    const surface = readSurface(meta, (text) => bytesOf(text).buffer);
    const { count } = surface;
    const runs = meta.runs.map(readRun);
    const stride = runs.length > 1 ? runs.length + 1 : 1;
    runs.forEach((run, r) => {
        run.blocks = meta.times.map(
            (_, i) => new Block(elements[i * stride + r], 3 + meta.fields.length, count),
        );
    });
    const apart = stride > 1
        ? meta.times.map((_, i) => new Block(elements[i * stride + runs.length], 1, count))
        : [];
    const page = { ...meta, surface, runs, apart, count, all: false };
    findOnsets(page);
    return page;
}

/** Appends a frame of a run under way: its index, number, time, and block as base64. */
export function addFrame(page, { index, number, time, block }) {
    const [run] = page.runs;
    run.index.push(index);
    run.numbers.push(number);
    run.blocks.push(new Block({ textContent: block }, 3 + page.fields.length, page.count));
    page.times.push(time);
    page.chosen = index + 1;
    run.frames = index + 1;
    findOnsets(page);
}

/** Appends rows of its series.csv that it does not have yet. */
export function addRows(run, text) {
    const names = [...run.columns.keys()];
    const last = run.columns.get('frame')?.at(-1) ?? -1;
    for (const row of text.split('\n').map((line) => line.split(','))) {
        if (row.length === names.length && Number(row[0]) > last) {
            names.forEach((name, i) => run.columns.get(name).push(row[i] === '' ? NaN : Number(row[i])));
        }
    }
}

/** Frames that view, colours and plots fit: all, or those before a run leaves the stage. */
export const fitted = (page, list, calm = page.calm) => (page.all ? list : list.slice(0, calm));

/** Where the runs are in a frame, and how many times as large as `most` [m]: 1, 2 or 5
 * times a power of ten, 1 at least. */
export function extent(page, frame, most) {
    const boxes = page.runs.map((run) => box(run.blocks[frame]));
    const sides = [0, 1, 2].map((k) => [Math.min(...boxes.map((b) => b[k][0])), Math.max(...boxes.map((b) => b[k][1]))]);
    const times = Math.max(1, length(sides) / most);
    const power = 10 ** Math.floor(Math.log10(times));
    return {
        centre: sides.map(([lo, hi]) => (lo + hi) / 2),
        scale: power * [1, 2, 5, 10].find((m) => m * power >= times),
    };
}

/** The box around each calm frame of each run, and around the shapes that are not much larger than
 * the cloth: [lo x, hi x], [lo y, hi y], [lo z, hi z]. */
export function boxes(page) {
    const list = page.runs.flatMap((run) => run.blocks.slice(0, run.calm)).map(box);
    return [...list, ...shapeBoxes(page, 2 * Math.max(...list.map(length)))];
}
