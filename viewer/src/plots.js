// SPDX-License-Identifier: BSD-3-Clause
// plots.js -- columns of series.csv against time, with a line at the frame shown.
import uPlot from 'uplot';
import { saveButtons, svg } from './chart.js';
import { fitted } from './data.js';
import { decades, powerText } from './decades.js';

const HEIGHT = 148;
const PAPER = 335; // px
const LABELS = 66; // px: of an axis labelled -2.25e-10
const SPAN = 1e3; // an axis that reaches so far beyond what it must show has powers of ten
const DASHES = [[], [5, 4]]; // first run, second run
const INKS = 6;
const TIME = 'time t [s]';

/** What a counter counts per frame: rows may be left out. */
const perFrame = (values, frames) => values?.map((v, i) => (i > 0 ? (v - values[i - 1]) / (frames[i] - frames[i - 1]) : null));
const times100 = (values) => values?.map((v) => 100 * v);
/** Without a limit its columns are there, and 0. */
const nonzero = (values) => (values?.some((v) => v !== 0) ? values : undefined);
const positive = (values) => values?.map((v) => (v > 0 ? v : null));

function total(columns) {
    const parts = ['kinetic', 'elastic', 'gravitational'].map((name) => columns.get(name));
    const contact = columns.get('contact') ?? [];
    return parts.every(Boolean) ? parts[0].map((v, i) => v + parts[1][i] + parts[2][i] + (contact[i] ?? 0)) : undefined;
}

const column = (name, ink, label = name) => ({ label, ink, of: (c) => c.get(name) });

/** Every plot: a title with its unit, and curves made of columns; a curve whose columns
 * a run does not have is left out. `brief` curves are those kept when two runs share it.
 * `early`: what is small at first must be seen, too; `least` is as small as it matters;
 * `onset`: the range of powers of ten in which a blow-up is seen to begin. */
const PLOTS = [
    {
        title: 'energy [J]',
        curves: [
            { ...column('kinetic', 0), brief: true },
            { ...column('elastic', 1), brief: true },
            column('gravitational', 2),
            { label: 'contact', ink: 5, of: (c) => nonzero(c.get('contact')) },
            column('dissipated', 3),
            { label: 'total', ink: 4, of: total, brief: true },
        ],
    },
    {
        title: 'energy error (residual) [J]',
        early: true,
        curves: [{ ...column('residual', 3), brief: true }],
    },
    {
        title: 'largest strain [%]',
        least: 1,
        onset: [0.1, 100],
        curves: [
            { label: 'strain', ink: 0, brief: true, of: (c) => times100(c.get('max_strain')) },
            { label: 'limited', ink: 3, of: (c) => times100(nonzero(c.get('limit_strain'))) },
        ],
    },
    {
        title: 'smallest gap [m]',
        log: true,
        curves: [
            { label: 'gap', ink: 2, brief: true, of: (c) => positive(c.get('min_gap')) },
            { label: 'to itself', ink: 0, of: (c) => positive(c.get('self_gap')) },
        ],
    },
    {
        title: 'step size [s]',
        log: true,
        curves: [{ label: 'h', ink: 1, brief: true, of: (c) => positive(c.get('step_size')) }],
    },
    {
        title: 'evaluations per frame',
        zero: true,
        curves: [{ label: 'calls', ink: 2, brief: true, of: (c) => perFrame(c.get('rhs_calls'), c.get('frame')) }],
    },
];

/** How far two runs are apart, at the frames shown. */
const difference = (page) => ({
    title: 'largest difference [m]',
    log: true,
    runs: [{ time: fitted(page, page.times), curves: [{
        label: 'difference', ink: 4, values: positive(fitted(page, page.apart).map((block) => block.range(0)[1])),
    }].filter((curve) => some(curve.values)) }],
});

const some = (values) => values?.some(Number.isFinite);
/** Gaps in the place of what is not finite. */
const finite = (values) => values?.map((v) => (Number.isFinite(v) ? v : null));

/** How many rows of a run are plotted: of one that blows up those to the frame in which it has left the stage. */
function rows(page, run, time) {
    const after = time.findIndex((t) => run.blown && !page.all && t >= page.times[run.calm]);
    return after < 0 ? time.length : after + 1;
}

function assemble(page, plot) {
    const runs = page.runs.map((run) => {
        const time = run.columns.get('time') ?? [];
        const count = rows(page, run, time);
        return {
            time: time.slice(0, count),
            curves: plot.curves
                .filter((curve) => page.runs.length === 1 || curve.brief)
                .map((curve) => ({ ...curve, values: finite(curve.of(run.columns))?.slice(0, count) }))
                .filter((curve) => some(curve.values)),
        };
    });
    return { ...plot, runs };
}

function short(v) {
    if (v === null || v === undefined) {
        return '–';
    }
    return v !== 0 && !(Math.abs(v) >= 1e-3 && Math.abs(v) < 1e7) ? v.toExponential(2) : Number(v.toPrecision(3)).toString();
}

const fromZero = (_, lo, hi) => [Math.min(0, lo), 1.1 * hi || 1];

/** What the sizes of a curve are above for most of the time. */
const usual = (sizes) => sizes.sort((a, b) => a - b)[Math.floor(0.1 * sizes.length)] ?? Infinity;

// Of lists too long for Math.max(...list).
const largest = (list) => list.reduce((a, b) => Math.max(a, b), -Infinity);
const smallest = (list) => list.reduce((a, b) => Math.min(a, b), Infinity);

/** The size up to which an axis is even before powers of ten follow; Infinity: it is even. */
function evenTo(plot, page, data, calm) {
    const sizes = data.slice(1).map((list) => list.filter((v) => v).map(Math.abs));
    const all = sizes.flat();
    const small = page.all ? Math.max(plot.least ?? 0, largest(calm.map(Math.abs))) || smallest(all)
        : plot.early ? smallest(sizes.map(usual)) : Infinity;
    const even = 10 ** Math.floor(Math.log10(small));
    return largest(all) > SPAN * even ? even : Infinity;
}

/** With room around, and no narrower than 1, 2, 5, 10 are apart. */
const padded = (_, lo, hi) => {
    const room = Math.max(0.05 * (hi - lo), 0.4 - (hi - lo) / 2);
    return [lo - room, hi + room];
};

export const LOGARITHMIC = {
    to: Math.log10, range: padded, ticks: (lo, hi) => decades(10 ** lo, 10 ** hi, 6),
};

/** Even up to a size, on both sides of 0, and logarithmic beyond. */
export function bothWays(even) {
    const to = (v) => Math.asinh(v / even);
    const side = (end, most) => (end > to(10 * even) ? decades(even, even * Math.min(Math.sinh(end), 1e300 / even), most) : []);
    return {
        to,
        range: (_, lo, hi) => padded(_, Math.min(lo, 0), Math.max(hi, 0)),
        ticks: (lo, hi) => {
            const most = lo < 0 && -lo > 0.3 * hi ? 2 : 4;
            return [...side(-lo, most).map((v) => -v).reverse(), 0, ...side(hi, most)]
                .filter((v) => v === 0 || Math.abs(to(v)) > 0.15 * (hi - lo));
        },
    };
}

/** How values become heights, their range, and the values with a line; uPlot's own even
 * axis where there is no `to`. Its logarithmic ones know no more than 1e16. */
function vertical(plot, page, data) {
    const onset = page.blown && !page.all;
    if (onset && plot.onset) {
        return { ...LOGARITHMIC, range: () => plot.onset.map(Math.log10), text: String };
    }
    if (plot.log || plot.zero) {
        return plot.log ? LOGARITHMIC : { range: fromZero };
    }
    const calm = plot.runs.flatMap(({ time, curves }, r) => curves.flatMap(({ values }) => values.filter(
        (v, i) => Number.isFinite(v) && !(time[i] >= page.times[page.runs[r].calm]),
    )));
    const even = evenTo(plot, page, data, calm);
    if (even < Infinity) {
        return bothWays(even);
    }
    if (!onset || calm.length === 0) {
        return {};
    }
    // A curve that leaves goes no farther than a canvas can draw.
    const range = uPlot.rangeNum(smallest(calm), largest(calm), 0.1, true);
    const beyond = 9 * (range[1] - range[0]);
    return { range: () => range, to: (v) => Math.min(Math.max(v, range[0] - beyond), range[1] + beyond) };
}

const label = (v) => (v !== 0 && (Math.abs(v) < 1e-3 || Math.abs(v) >= 1e6)
    ? Number(v.toPrecision(3)).toExponential() : Number(v.toPrecision(6)).toString());

export function axis(style, { to, ticks, text = powerText } = {}) {
    let shown = [];
    const own = ticks && {
        incrs: [1], // not looked at, but to be had
        space: 0,
        splits: (_, __, lo, hi) => {
            shown = ticks(lo, hi);
            return shown.map(to);
        },
        values: () => shown.map((t) => (t === 0 && text === powerText ? '0' : text(t))),
    };
    return {
        stroke: style('--ink-soft'),
        grid: { stroke: style('--line'), width: 1 },
        ticks: { stroke: style('--line'), width: 1, size: 4 },
        font: '11px system-ui, sans-serif',
        values: (_, list) => list.map(label),
        ...own,
    };
}

/** An axis along the bottom with its name and unit. */
export const named = (text) => ({ size: 24, label: text, labelSize: 15, labelGap: 0, labelFont: '11px system-ui, sans-serif' });

export class Plots {
    constructor(page, element, seek) {
        this.page = page;
        this.element = element;
        this.seek = seek;
        this.frame = 0;
        this.drawn = [];
        this.collect();
        new ResizeObserver(() => this.resize()).observe(element);
        matchMedia('print').addEventListener('change', () => this.resize());
    }

    /** Takes the columns as they are now. */
    collect() {
        const { page } = this;
        const all = [...(page.apart.length > 0 ? [difference(page)] : []), ...PLOTS.map((plot) => assemble(page, plot))];
        this.plots = all.filter((plot) => plot.runs.some((run) => run.curves.length > 0));
    }

    /** Draws all anew, in the colours of the theme in force. */
    draw() {
        const style = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();
        this.drawn.forEach((plot) => plot.destroy());
        this.element.replaceChildren();
        this.drawn = this.plots.map((plot) => this.drawOne(plot, style));
        this.show(this.frame);
    }

    drawOne(plot, style) {
        const tables = plot.runs.map((run) => [run.time, ...run.curves.map((curve) => curve.values)]);
        const data = tables.length > 1 ? uPlot.join(tables) : tables[0];
        const series = plot.runs.flatMap((run, r) => run.curves.map((curve) => ({
            label: plot.runs.length > 1 ? `${'AB'[r]} ${curve.label}` : curve.label,
            stroke: style(`--curve-${curve.ink % INKS}`),
            width: 1.5,
            dash: DASHES[r],
            spanGaps: plot.runs.length > 1,
            points: { show: data[0].length < 3 },
            value: (_, __, i, at) => short(at === null ? null : data[i][at]),
        })));
        const y = vertical(plot, this.page, data);
        const heights = y.to ? data.map((list, i) => (i === 0 ? list : finite(list.map((v) => (v === null ? v : y.to(v)))))) : data;
        const made = new uPlot({
            title: plot.title,
            class: series.length > 1 ? 'several' : 'single',
            width: this.element.clientWidth,
            height: HEIGHT,
            scales: { x: { time: false }, y: y.range ? { range: y.range } : {} },
            axes: [
                { ...axis(style), ...named(TIME) },
                { space: 22, ...axis(style, y), size: LABELS },
            ],
            series: [{ label: 't [s]' }, ...series],
            legend: { markers: { dash: (_, i) => (series[i - 1].dash.length > 0 ? 'dashed' : 'solid') } },
            cursor: { drag: { x: false, y: false }, y: false, points: { size: 6 } },
            hooks: { setSize: [() => this.place()], ready: [() => this.show(this.frame)] },
        }, heights, this.element);
        const line = document.createElement('div');
        line.className = 'now';
        made.over.append(line);
        this.listen(made);
        made.root.append(saveButtons(plot.title, {
            svg: () => svg(made, plot.title, TIME, series.map(({ points, ...look }) => look)),
            rows: () => [[TIME, ...series.map(({ label: name }) => `${name} ${/\[.*\]$/.exec(plot.title) ?? ''}`.trim())],
                ...data[0].map((t, i) => [t, ...data.slice(1).map((list) => list[i])])],
        }));
        return made;
    }

    /** A press or a drag goes to the frame at that time. */
    listen(plot) {
        const go = (event) => {
            const left = event.clientX - plot.over.getBoundingClientRect().left;
            this.seek(plot.posToVal(left, 'x'));
        };
        plot.over.addEventListener('pointerdown', (event) => {
            plot.over.setPointerCapture(event.pointerId);
            go(event);
        });
        plot.over.addEventListener('pointermove', (event) => event.buttons & 1 && go(event));
        plot.over.addEventListener('pointerleave', () => this.show(this.frame));
    }

    show(frame) {
        this.frame = frame;
        this.place();
        for (const plot of this.drawn) {
            if (!plot.over.matches(':hover')) {
                plot.setLegend({ idx: nearest(plot.data[0], this.page.times[frame]) });
            }
        }
    }

    place() {
        for (const plot of this.drawn) {
            // a live run may be ahead of its plots
            const left = Math.min(plot.valToPos(this.page.times[this.frame], 'x'), plot.over.clientWidth);
            plot.over.querySelector('.now').style.transform = `translateX(${left}px)`;
        }
    }

    /** A sheet of paper has two in a row. */
    resize() {
        const width = matchMedia('print').matches ? PAPER : this.element.clientWidth;
        this.drawn.filter((plot) => plot.width !== width).forEach((plot) => plot.setSize({ width, height: HEIGHT }));
    }
}

/** The index of the time next to t in sorted times. */
export function nearest(times, t) {
    let lo = 0;
    let hi = times.length - 1;
    while (lo < hi) {
        const mid = (lo + hi) >> 1;
        if (times[mid] < t) lo = mid + 1;
        else hi = mid;
    }
    return lo > 0 && t - times[lo - 1] < times[lo] - t ? lo - 1 : lo;
}
