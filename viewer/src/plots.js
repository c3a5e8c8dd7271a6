// SPDX-License-Identifier: BSD-3-Clause
// plots.js -- columns of series.csv against time, with a line at the frame shown.
import uPlot from 'uplot';

const HEIGHT = 132;
const DASHES = [[], [5, 4]]; // first run, second run
const INKS = 5;

const perRow = (values) => values?.map((v, i) => (i > 0 ? v - values[i - 1] : null));
const times100 = (values) => values?.map((v) => 100 * v);
/** Without a limit its columns are there, and 0. */
const nonzero = (values) => (values?.some((v) => v !== 0) ? values : undefined);
const positive = (values) => values?.map((v) => (v > 0 ? v : null));

function total(columns) {
    const parts = ['kinetic', 'elastic', 'gravitational'].map((name) => columns.get(name));
    return parts.every(Boolean) ? parts[0].map((v, i) => v + parts[1][i] + parts[2][i]) : undefined;
}

const column = (name, ink, label = name) => ({ label, ink, of: (c) => c.get(name) });

/** Every plot: a title with its unit, and curves made of columns; a curve whose columns
 * a run does not have is left out. `brief` curves are those kept when two runs share it. */
const PLOTS = [
    {
        title: 'energy [J]',
        curves: [
            { ...column('kinetic', 0), brief: true },
            { ...column('elastic', 1), brief: true },
            column('gravitational', 2),
            column('dissipated', 3),
            { label: 'total', ink: 4, of: total, brief: true },
        ],
    },
    {
        title: 'largest strain [%]',
        curves: [
            { label: 'strain', ink: 0, brief: true, of: (c) => times100(c.get('max_strain')) },
            { label: 'limited', ink: 3, of: (c) => times100(nonzero(c.get('limit_strain'))) },
        ],
    },
    {
        title: 'step size [s]',
        log: true,
        curves: [{ label: 'h', ink: 1, brief: true, of: (c) => positive(c.get('step_size')) }],
    },
    {
        title: 'evaluations of the forces a frame',
        zero: true,
        curves: [{ label: 'calls', ink: 2, brief: true, of: (c) => perRow(c.get('rhs_calls')) }],
    },
];

/** How far two runs are apart, at the frames shown. */
const difference = (page) => ({
    title: 'largest difference [m]',
    log: true,
    runs: [{ time: page.times, curves: [{
        label: 'difference', ink: 4, values: positive(page.apart.map((block) => block.range(0)[1])),
    }] }],
});

const some = (values) => values?.some((v) => Number.isFinite(v));

function assemble(page, plot) {
    const runs = page.runs.map((run) => ({
        time: run.columns.get('time') ?? [],
        curves: plot.curves
            .filter((curve) => page.runs.length === 1 || curve.brief)
            .map((curve) => ({ ...curve, values: curve.of(run.columns) }))
            .filter((curve) => some(curve.values)),
    }));
    return { ...plot, runs };
}

function short(v) {
    if (v === null || v === undefined) {
        return '–';
    }
    return v !== 0 && !(Math.abs(v) >= 1e-3 && Math.abs(v) < 1e7) ? v.toExponential(2) : Number(v.toPrecision(3)).toString();
}

const fromZero = (_, lo, hi) => [Math.min(0, lo), 1.1 * hi || 1];

/** Of a run that blows up the axis of what was before, up to time t; it goes on beyond. */
function before(data, t, log) {
    const values = data.slice(1).flatMap((list) => list.filter((v, i) => data[0][i] <= t && Number.isFinite(v)));
    const [lo, hi] = [Math.min(...values), Math.max(...values)];
    return () => (log ? uPlot.rangeLog(lo, hi, 10, true) : uPlot.rangeNum(lo, hi, 0.1, true));
}

/** Lines of a logarithmic axis: at powers of ten, and where these are few at 2 and 5 too. */
function decades(_, ticks) {
    const wide = ticks.at(-1) / ticks[0] > 50;
    return ticks.map((t) => ((wide ? /^1e/ : /^[125]e/).test(t.toExponential(0)) ? t : null));
}

export function axis(style, log) {
    const filter = log ? { filter: decades } : {};
    return {
        stroke: style('--ink-soft'),
        grid: { stroke: style('--line'), width: 1, ...filter },
        ticks: { stroke: style('--line'), width: 1, size: 4, ...filter },
        font: '11px system-ui, sans-serif',
        ...filter,
        ...(log ? { values: (_, ticks) => ticks.map((t) => t?.toExponential(0) ?? '') } : {}),
    };
}

export class Plots {
    constructor(page, element, seek) {
        this.page = page;
        this.element = element;
        this.seek = seek;
        this.frame = 0;
        this.plots = PLOTS.map((plot) => assemble(page, plot));
        if (page.apart.length > 0) {
            this.plots.unshift(difference(page));
        }
        this.plots = this.plots.filter((plot) => plot.runs.some((run) => run.curves.length > 0));
        this.drawn = [];
        new ResizeObserver(() => this.resize()).observe(element);
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
            value: (_, v) => short(v),
        })));
        const { times, calm } = this.page;
        const ends = calm < times.length ? before(data, times[calm - 1], plot.log) : undefined;
        const range = plot.zero ? fromZero : ends;
        const made = new uPlot({
            title: plot.title,
            class: series.length > 1 ? 'several' : 'single',
            width: this.element.clientWidth,
            height: HEIGHT,
            scales: { x: { time: false }, y: { distr: plot.log ? 3 : 1, ...(range ? { range } : {}) } },
            axes: [
                { ...axis(style), size: 28 },
                { ...axis(style, plot.log), size: 54 },
            ],
            series: [{ label: 't [s]' }, ...series],
            cursor: { drag: { x: false, y: false }, y: false, points: { size: 6 } },
            hooks: { setSize: [() => this.place()], ready: [() => this.show(this.frame)] },
        }, data, this.element);
        const line = document.createElement('div');
        line.className = 'now';
        made.over.append(line);
        this.listen(made);
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
            const left = plot.valToPos(this.page.times[this.frame], 'x');
            plot.over.querySelector('.now').style.transform = `translateX(${left}px)`;
        }
    }

    resize() {
        const width = this.element.clientWidth;
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
