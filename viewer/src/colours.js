// SPDX-License-Identifier: BSD-3-Clause
// colours.js -- quantities a cloth is coloured by, their ranges, and the bar beside it.
import { fitted } from './data.js';
import { gaps } from './shapes.js';

// From linen to dark red, darker all the way: calm cloth looks like cloth, and a person who
// sees no colours still sees the order.
const STOPS = ['#f1ead9', '#f3d694', '#f4b557', '#ea8537', '#d0532f', '#a62a3a', '#6f1640', '#3c0d38'].map((hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255));

/** Of several cloths that show no quantity, over and over: they differ in lightness, too. */
export const INKS = ['#c8553d', '#3b6ea5', '#e0b04c', '#4f8a63', '#8a5a9e', '#6cb2b8', '#d98aa8', '#6b5b4d'];

const MOST_STRAIN = 1; // of the colours of a run that blows up,
const LEAST_STRAIN = 0.1; // [%]
const SAMPLES = 12; // frames looked at for a range

/** sRGB of a place between 0 and 1. */
export function colourAt(x) {
    const place = Math.min(Math.max(x, 0), 1) * (STOPS.length - 1);
    const i = Math.min(Math.floor(place), STOPS.length - 2);
    return STOPS[i].map((c, k) => c + (place - i) * (STOPS[i + 1][k] - c));
}

const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const TABLE = new Float32Array(3 * 256);
for (let i = 0; i < 256; ++i) {
    TABLE.set(colourAt(i / 255).map(linear), 3 * i);
}

/** Linear colours of values into out[3 n]. */
export function paint(values, quantity, out) {
    for (let i = 0; i < values.length; ++i) {
        const x = quantity.place(values[i]);
        const k = 3 * (x > 0 ? Math.min(Math.round(255 * x), 255) : 0);
        out[3 * i] = TABLE[k];
        out[3 * i + 1] = TABLE[k + 1];
        out[3 * i + 2] = TABLE[k + 2];
    }
}

// The 99.5th percentile: a corner that tears at its pin does not blind the rest.
function highest(page, blocks, plane) {
    const step = Math.max(1, Math.floor(blocks.length / SAMPLES));
    const values = [];
    for (let i = blocks.length - 1; i >= 0; i -= step) {
        values.push(...blocks[i].read(plane, new Float32Array(page.count)).sort()
            .filter((_, k) => page.count < 256 || k % Math.ceil(page.count / 256) === 0));
    }
    values.sort((a, b) => a - b);
    return values[Math.floor(0.995 * (values.length - 1))] ?? 0;
}

const number = (x) => Number(x.toPrecision(3)).toString();

/** The next of 1, 1.2, 1.6, 2, ... 8, 10 times a power of ten: a quarter of it is short. */
function ceiling(x) {
    const power = 10 ** Math.floor(Math.log10(x));
    return power * [1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8, 10].find((m) => m * power >= 0.999 * x);
}

/** Even colours from 0 (and below) to `most`; numbers are told in `unit`, `factor` of them to 1. */
function evenly(most, unit, factor) {
    const top = most > 0 ? ceiling(most * factor) : 1;
    return {
        unit,
        place: (value) => (value * factor) / top,
        ticks: [0, 1, 2, 3, 4].map((k) => (k / 4) * top).map(number),
    };
}

const powerOfTen = (k) => (Math.abs(k) < 4 ? String(Number(`1e${k}`)) : `1e${k}`);

// Runs part by powers of ten: six of them below the largest distance, or from `least` on.
function decades(most, unit, factor = 1, least = 0) {
    const top = Math.ceil(Math.log10(most > 0 ? most * factor : 1e-12));
    const low = least > 0 ? Math.floor(Math.log10(least)) : top - 6;
    return {
        unit,
        place: (value) => (value > 0 ? (Math.log10(value * factor) - low) / (top - low) : 0),
        ticks: [0, 1, 2, 3].map((k) => low + Math.round((k / 3) * (top - low))).map(powerOfTen),
    };
}

/** Of a run that blows up, all of it: from what it was before, or a unit, by powers of ten. */
function blownUp(page, plane, unit, factor) {
    const calm = page.runs.flatMap((run) => run.blocks.slice(0, run.calm));
    const most = Math.max(...page.runs.flatMap((run) => run.blocks.map((block) => block.range(plane)[1])));
    return decades(most, unit, factor, Math.max(1, factor * highest(page, calm, plane)));
}

/** The closer to a shape or to other cloth the darker, from the thickness on, where forces begin. */
const closely = (thickness) => ({
    unit: 'mm',
    place: (gap) => 1 - gap / thickness,
    ticks: [4, 3, 2, 1, 0].map((k) => number((k / 4) * 1e3 * thickness)),
});

/** What the page offers, by name; `read(run, frame, out)` has the numbers. */
export function quantities(page) {
    const all = page.runs.flatMap((run) => fitted(page, run.blocks, run.calm));
    const units = Object.fromEntries(page.fields.filter((name) => name.startsWith('s_'))
        .map((name) => [name, [page.runs.every((run) => run.relative) ? 'm' : 'm per unit', 1]]));
    Object.assign(units, { strain: ['%', 100], speed: ['m/s', 1] });
    const list = page.fields.filter((name) => units[name]).map((name) => {
        const plane = 3 + page.fields.indexOf(name);
        const most = highest(page, all, plane);
        const scale = page.all ? blownUp(page, plane, ...units[name])
            : page.blown && name === 'strain' ? decades(MOST_STRAIN, '%', 100, LEAST_STRAIN)
                : evenly(most, ...units[name]);
        return { name, most, read: (run, frame, out) => run.blocks[frame].read(plane, out), ...scale };
    });
    if (page.runs.some((run) => run.obstacles.length > 0 || run.self)) {
        const most = Math.max(...page.runs.map((run) => run.thickness));
        list.push({ name: 'gap', read: (run, frame, out) => gaps(page, run, frame, out), ...closely(most) });
    }
    if (page.apart.length > 0) {
        const most = Math.max(...fitted(page, page.apart).map((block) => block.range(0)[1]));
        list.unshift({ name: 'difference', read: (_, frame, out) => page.apart[frame].read(0, out), ...decades(most, 'm') });
    }
    return list;
}

/** Each name behind its colour. */
function drawNames(cloths, root) {
    root.getElementById('legend-ticks').replaceChildren(...cloths.map(({ name }, i) => {
        const [line, ink] = ['span', 'b'].map((tag) => root.createElement(tag));
        ink.textContent = '\u25a0';
        ink.style.color = INKS[i % INKS.length];
        line.append(ink, ` ${name}`);
        return line;
    }));
}

/** Draws the bar, its numbers and its unit; for no quantity the names of several cloths. */
export function drawLegend(quantity, root, cloths = []) {
    const legend = root.getElementById('legend');
    legend.hidden = !quantity && cloths.length === 0;
    legend.classList.toggle('names', !quantity);
    if (!quantity) {
        root.getElementById('legend-title').textContent = '';
        drawNames(cloths, root);
        return;
    }
    root.getElementById('legend-title').textContent = `${quantity.name} [${quantity.unit}]`;
    const context = root.getElementById('legend-bar').getContext('2d');
    for (let i = 0; i < 256; ++i) {
        context.fillStyle = `rgb(${colourAt(i / 255).map((c) => Math.round(255 * c))})`;
        context.fillRect(i, 0, 1, 1);
    }
    const ticks = root.getElementById('legend-ticks');
    ticks.replaceChildren(...quantity.ticks.map((text) => {
        const tick = root.createElement('span');
        tick.textContent = text;
        return tick;
    }));
}
