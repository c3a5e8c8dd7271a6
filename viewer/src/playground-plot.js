// SPDX-License-Identifier: BSD-3-Clause
// playground-plot.js -- the energies of the cloths against time, even near 0 and by powers of ten
// beyond what they were at first.
import uPlot from 'uplot';
import { powerText } from './decades.js';

const MOST = 3000; // points; then every other one is dropped
const HIGHEST = 1e3; // times the even part of the axis: a curve that blows up leaves the plot there
const EVERY = 150; // ms between two drawings

const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Even numbers up to `unit`, beyond it powers of ten of both signs. */
function splits(unit, lo, hi) {
    const most = Math.max(-lo, hi);
    if (most <= 10 * unit) {
        const step = 10 ** Math.floor(Math.log10((hi - lo) / 2));
        const every = [1, 2, 5, 10].map((m) => m * step).find((s) => (hi - lo) / s <= 6);
        return Array.from({ length: Math.floor(hi / every) - Math.ceil(lo / every) + 1 }, (_, i) => (Math.ceil(lo / every) + i) * every);
    }
    const first = Math.ceil(Math.log10(unit));
    const last = Math.floor(Math.log10(most));
    const every = Math.max(1, Math.ceil((last - first + 1) / 4));
    const powers = Array.from({ length: Math.floor((last - first) / every) + 1 }, (_, i) => 10 ** (last - i * every)).reverse();
    const to = (v) => Math.asinh(v / unit);
    const isApart = (v) => v === 0 || Math.abs(to(v)) > 0.1 * (to(hi) - to(lo));
    return [...powers.map((v) => -v).reverse(), 0, ...powers].filter((v) => v >= lo && v <= hi && isApart(v));
}

/** What the axis shows of values from lo to hi: room around them, but no blow-up in full. */
function range(unit, lo, hi) {
    const clip = (v) => Math.min(Math.max(v, -HIGHEST * unit), HIGHEST * unit);
    const room = 0.05 * (clip(hi) - clip(lo)) || unit;
    return [clip(lo ?? 0) - room, clip(hi ?? 0) + room];
}

const text = (v) => (Math.abs(v) >= 1e4 ? powerText(v) : Number(v.toPrecision(3)).toString());

export class EnergyPlot {
    constructor(root) {
        this.root = root;
        this.drawn = 0;
    }

    /** Two curves of one cloth, or one of each. */
    start(runs) {
        this.runs = runs;
        this.plot?.destroy();
        const soft = style('--ink-soft');
        const axis = { stroke: soft, grid: { stroke: style('--line'), width: 1 }, font: '11px system-ui' };
        const inks = [style('--curve-0'), style('--curve-1')];
        const curves = runs.length > 1
            ? runs.map((run, i) => ({ label: `total, ${run.scene.method}`, stroke: inks[i], width: 1.75 }))
            : [{ label: 'total', stroke: style('--curve-4'), width: 1.75 }, { label: 'kinetic', stroke: inks[0], width: 1.5 }];
        const unit = this.unit();
        this.even = unit;
        this.plot = new uPlot({
            title: 'energy [J]',
            width: this.root.clientWidth || 300,
            height: 170,
            cursor: { show: false },
            legend: { live: false },
            scales: { x: { time: false }, y: { distr: 4, asinh: unit, range: (_, lo, hi) => range(unit, lo, hi) } },
            axes: [
                { ...axis, label: 't [s]', labelSize: 16, labelFont: '11px system-ui', size: 28, values: (_, list) => list.map(text) },
                { ...axis, size: 58, splits: (_, __, lo, hi) => splits(unit, lo, hi), values: (_, list) => list.map(text), filter: (_, list) => list },
            ],
            series: [{}, ...curves.map((curve) => ({ ...curve, points: { show: false } }))],
        }, this.data(), this.root);
    }

    /** [J] up to which the axis is even: the weight of the cloth times its size, some */
    unit() {
        return Math.max(1e-6, ...this.runs.map((run) => 10 * Math.abs(run.numbers?.total ?? 0)), 0.1);
    }

    data() {
        const columns = this.runs.map(({ history }) => [0, 1, 2].map((k) => history.map((row) => row[k])));
        return columns.length > 1
            ? uPlot.join(columns.map(([t, total]) => [t, total]))
            : columns[0];
    }

    draw(now) {
        if (!this.plot || now - this.drawn < EVERY) {
            return;
        }
        this.drawn = now;
        for (const run of this.runs) {
            if (run.history.length > MOST) {
                run.history = run.history.filter((_, i) => i % 2 === 0);
            }
        }
        this.plot.setData(this.data());
        this.root.dataset.highest = this.plot.scales.y.max / this.even;
    }

    resize() {
        this.plot?.setSize({ width: this.root.clientWidth, height: 170 });
    }
}
