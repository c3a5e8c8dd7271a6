// SPDX-License-Identifier: BSD-3-Clause
// scatter.js -- a small plot of every quantity against a parameter, coloured by another.
import uPlot from 'uplot';
import { colourAt } from './colours.js';
import { powerText } from './decades.js';
import { saveButtons, svg } from './chart.js';
import { axis, bothWays, LOGARITHMIC, named } from './plots.js';
import { isDark } from './theme.js';
import { element, isWide, range } from './values.js';

const SPAN = 1e3; // values that reach so far have powers of ten
const REACH = 24; // px: a point nearer to the pointer is meant
const HUGE = 1e12;
const INKS = 5;
const MOST_NAMES = 12; // of colours

const css = (rgb) => `rgb(${rgb.map((c) => Math.round(255 * c))})`;

/** Light to dark on paper; what would vanish there or on the dark page is left out. */
function ramp(share) {
    const [from, to] = isDark() ? [0.05, 0.65] : [0.3, 1];
    return css(colourAt(from + share * (to - from)));
}

function inks(y, style) {
    const count = y?.few ? y.levels.length : 1;
    return Array.from({ length: count }, (_, i) => (y?.numeric || count > INKS ? ramp(count > 1 ? i / (count - 1) : 1) : style(`--curve-${i}`)));
}

const plain = (v) => (v >= 1e-3 && v < 1e5 ? String(v) : powerText(v));

/** The axis of the parameter. */
function along(x) {
    if (!x.numeric) {
        const every = Math.ceil(x.levels.length / 5);
        const most = x.levels.length > 3 ? 9 : 15; // characters of a line
        const lines = (text) => text.split(' ').map((word) => (word.length > most ? `${word.slice(0, most - 1)}…` : word)).join('\n');
        return {
            to: Number, range: () => [-0.5, x.levels.length - 0.5],
            ticks: () => x.levels.map((_, i) => i).filter((i) => i % every === 0),
            text: (i) => lines(x.words(x.levels[i])),
            rows: Math.max(...x.levels.map((text) => x.words(text).split(' ').length)),
        };
    }
    return x.log ? { ...LOGARITHMIC, text: plain, ticks: (lo, hi) => LOGARITHMIC.ticks(lo, hi).filter((_, i, all) => i % Math.ceil(all.length / 5) === 0) } : {};
}

/** One list of places, and for each colour a list of values, with nulls where another has
 * the run. */
function table(points, count) {
    const lists = [points.map(({ x }) => x)];
    for (let k = 0; k < count; ++k) {
        lists.push(points.map((p) => (p.ink === k ? p.y : null)));
    }
    return lists;
}

/** Whether no colour has two runs at one number: then a line joins them. */
const isCurve = (x, points, count) => x.numeric && new Set(points.map((p) => `${p.ink} ${p.x}`)).size === points.length && points.length < 40 * count;

/** An even axis, with powers of ten on both sides of 0 for values that uPlot has no even ones for. */
function upwards(points) {
    const sizes = points.map((p) => Math.abs(p.y)).filter((v) => v > 0);
    const [least, most] = range(sizes);
    return most > HUGE ? bothWays(10 ** Math.floor(Math.log10(least))) : {};
}

export class Scatter {
    constructor(root, height, short, { tip, open, choose }) {
        Object.assign(this, { root, height, short, tip, open, choose, drawn: [] });
        new ResizeObserver(() => this.drawn.forEach((plot) => {
            const width = plot.root.parentElement.clientWidth;
            if (plot.width !== width) {
                plot.setSize({ width, height: this.height });
            }
        })).observe(root);
        // Only what is seen is drawn: a phone shows two of thirty.
        this.seen = new IntersectionObserver((list) => list.filter((one) => one.isIntersecting).forEach(({ target }) => {
            this.seen.unobserve(target);
            this.plot(target);
        }), { rootMargin: '200px' });
    }

    /** A plot of each of `list`; the names of the colours go into `names`. */
    draw(state, runs, list, names) {
        this.drawn.forEach((plot) => plot.destroy());
        this.seen.disconnect();
        Object.assign(this, { drawn: [], state, runs });
        const style = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();
        this.style = style;
        this.inks = inks(state.y, style);
        this.root.replaceChildren(...(state.x ? list : []).map((value) => this.card(value)));
        names?.replaceChildren(...this.names(state.y));
        for (const card of this.root.children) {
            this.seen.observe(card);
        }
    }

    /** The colours of the second parameter; of many the first, the last and some between. */
    names(y) {
        if (!y?.few) {
            return [];
        }
        const every = Math.ceil((y.levels.length - 1) / (MOST_NAMES - 1));
        return [element('b', '', y.title), ...y.levels.flatMap((text, i) => {
            if (i % every !== 0 && i + 1 < y.levels.length) {
                return [];
            }
            const dot = element('i');
            dot.style.background = this.inks[i];
            return [element('span', '', dot, y.words(text))];
        })];
    }

    card(value) {
        const chosen = value === this.state.value;
        const button = element('button', '', value.title(this.state.of));
        button.ariaPressed = chosen;
        button.title = 'show it above and in the table';
        button.addEventListener('click', () => this.choose(value));
        const made = element('div', chosen ? 'plot chosen' : 'plot', button);
        made.value = value;
        return made;
    }

    points(value) {
        const { x, y, of } = this.state;
        const count = this.inks.length;
        const list = this.runs.map((run) => {
            const ink = y?.few ? y.level(run) : 0;
            // side by side at a word
            return { run, ink, x: x.place(run) + (x.numeric ? 0 : (ink - (count - 1) / 2) / (2 * count)), y: value.of(run, of) };
        });
        return list.filter((p) => Number.isFinite(p.x) && Number.isFinite(p.y)).sort((a, b) => a.x - b.x);
    }

    plot(card) {
        const points = this.points(card.value);
        const [lo, hi] = range(points.map((p) => p.y));
        const { x, y, log: asked, of } = this.state;
        const log = asked === null ? isWide([lo, hi], SPAN) : asked && lo > 0;
        const curve = isCurve(x, points, this.inks.length);
        const [across, up] = [along(x), log ? LOGARITHMIC : upwards(points)];
        points.forEach((p) => { p.height = up.to?.(p.y) ?? p.y; });
        const bottom = named(x.title);
        const made = new uPlot({
            width: card.clientWidth,
            height: this.height,
            scales: { x: { time: false, range: across.range ?? ((_, a, b) => [a - 0.04 * (b - a), b + 0.04 * (b - a)]) }, y: up.range ? { range: up.range } : {} },
            axes: [{ ...axis(this.style, across), ...bottom, size: bottom.size + 17 * ((across.rows ?? 1) - 1) }, { space: 22, ...axis(this.style, up), size: 58 }],
            series: [{}, ...this.inks.map((stroke) => ({
                stroke, width: 1.5, points: { show: true, size: points.length > 200 ? 4 : 6, fill: stroke },
                spanGaps: true, ...(curve ? {} : { paths: () => null }),
            }))],
            legend: { show: false },
            cursor: { show: false },
        }, table(points.map((p) => ({ ...p, y: p.height })), this.inks.length), card);
        this.drawn.push(made);
        const title = card.value.title(of);
        card.append(saveButtons(title, {
            svg: () => svg(made, title, x.title, this.inks.map((stroke, i) => ({
                stroke, lines: curve, points: true, spanGaps: true, label: this.inks.length > 1 ? `${y.label} ${y.words(y.levels[i])}` : '',
            }))),
            rows: () => [['run', x.title, ...(y ? [y.title] : []), title],
                ...points.map(({ run, y: v }) => [run.name, x.text(run), ...(y ? [y.text(run)] : []), v])],
        }));
        this.listen(made, points, card.value);
    }

    listen(plot, points, value) {
        const nearest = (event) => {
            const box = plot.over.getBoundingClientRect();
            let best = null;
            let least = REACH ** 2;
            for (const p of points) {
                const far = (plot.valToPos(p.x, 'x') - event.clientX + box.left) ** 2 + (plot.valToPos(p.height, 'y') - event.clientY + box.top) ** 2;
                [best, least] = far < least ? [p, far] : [best, least];
            }
            return best;
        };
        const over = (event) => {
            const p = nearest(event);
            this.tip(p?.run, p && `${value.title(this.state.of)} ${this.short(p.y)}`, event);
            plot.over.style.cursor = p ? 'pointer' : 'default';
        };
        plot.over.addEventListener('pointermove', over);
        plot.over.addEventListener('pointerleave', () => this.tip(null));
        plot.over.addEventListener('click', (event) => {
            const p = nearest(event);
            if (p) {
                this.open(p.run);
            }
        });
    }
}

