// SPDX-License-Identifier: BSD-3-Clause
// heat.js -- the mean of a quantity over the runs at each pair of two parameters.
import { colourAt } from './colours.js';
import { saveButtons, svgDocument, text } from './chart.js';
import { element, finite, isWide, range } from './values.js';

const SPAN = 100; // values that reach so far are coloured by powers of ten
const WORDS_BELOW = 11; // columns: more have no room for numbers

const mean = (list) => list.reduce((a, b) => a + b, 0) / list.length;
const css = (rgb) => `rgb(${rgb.map((c) => Math.round(255 * c))})`;

const [WIDE, TALL, LEFT, HEAD] = [62, 28, 130, 30]; // px of a cell, and of what is beside and above

/** The map as SVG; a cell without a number is empty. */
function picture({ x, y, words, order, means, place, short }) {
    const cells = order.flatMap((level, row) => x.levels.map((_, i) => {
        const v = means.get(i + x.levels.length * level);
        const [left, top] = [LEFT + WIDE * i, HEAD + TALL * row];
        return Number.isFinite(v) ? `<rect x="${left}" y="${top}" width="${WIDE}" height="${TALL}" fill="${css(colourAt(place(v)))}"/>`
            + text(left + WIDE / 2, top + TALL / 2 + 4, short(Number(v.toPrecision(2))), `text-anchor="middle" fill="${place(v) > 0.5 ? '#fff' : '#22262e'}"`) : '';
    }));
    const [wide, tall] = [LEFT + WIDE * x.levels.length, HEAD + TALL * order.length];
    return svgDocument(wide + 12, tall + 44, [
        text(12, 18, words, 'font-size="13" font-weight="600"'), ...cells,
        ...order.map((level, row) => text(LEFT - 6, HEAD + TALL * (row + 0.5) + 4, y.words(y.levels[level]), 'text-anchor="end"')),
        ...x.levels.map((level, i) => text(LEFT + WIDE * (i + 0.5), tall + 15, x.words(level), 'text-anchor="middle"')),
        text(12, tall + 34, `rows: ${y.title}, columns: ${x.title}`),
    ]);
}

export class HeatMap {
    constructor(root, short, { tip, open }) {
        Object.assign(this, { root, short, tip, open });
    }

    draw({ x, y, value, of, log }, runs) {
        this.root.hidden = !x?.few || !y?.few || !value;
        if (this.root.hidden) {
            return;
        }
        const cells = Map.groupBy(runs, (run) => x.level(run) + x.levels.length * y.level(run));
        const means = new Map([...cells].map(([key, list]) => [key, mean(finite(list.filter((run) => run.done).map((run) => value.of(run, of))))]));
        const [lo, hi] = range(finite([...means.values()]));
        const to = (log ?? isWide([lo, hi], SPAN)) && lo > 0 ? Math.log : (v) => v;
        const place = (v) => (hi > lo ? (to(v) - to(lo)) / (to(hi) - to(lo)) : 0.5);
        const words = value.title(of);
        const line = (level) => element('tr', '', element('th', '', y.words(y.levels[level])), ...x.levels.map((_, i) => {
            const key = i + x.levels.length * level;
            return this.cell(cells.get(key), means.get(key), place, words, x.levels.length < WORDS_BELOW);
        }));
        // Numbers grow upwards.
        const order = y.levels.map((_, i) => (y.numeric ? y.levels.length - 1 - i : i));
        const foot = element('tr', '', element('th'), ...x.levels.map((level) => element('th', '', element('span', '', x.words(level)))));
        this.root.replaceChildren(
            element('h2', '', words),
            element('div', 'scroll', element('table', x.levels.length < WORDS_BELOW ? 'wide' : '', ...order.map(line), foot)),
            element('p', '', `rows: ${y.title}, columns: ${x.title}`),
            this.bar(lo, hi, to !== Math.log),
            saveButtons(`map of ${words}`, {
                svg: () => picture({ x, y, words, order, means, place, short: this.short }),
                rows: () => [[y.title, x.title, words], ...[...means].map(([key, v]) => [
                    y.levels[Math.floor(key / x.levels.length)], x.levels[key % x.levels.length], v,
                ])],
            }),
        );
    }

    cell(runs, v, place, words, roomy) {
        if (!runs) {
            return element('td');
        }
        const made = element('td', Number.isFinite(v) ? '' : 'undone');
        const button = element('button', '', roomy && Number.isFinite(v) ? this.short(Number(v.toPrecision(2))) : '');
        const text = `${words}: ${Number.isFinite(v) ? this.short(v) : runs[0].text('status')}${runs.length > 1 ? `, mean of ${runs.length} runs` : ''}`;
        button.ariaLabel = text;
        if (Number.isFinite(v)) {
            button.style.background = css(colourAt(place(v)));
            button.style.color = place(v) > 0.5 ? '#fff' : '#22262e';
        }
        button.addEventListener('click', () => this.open(runs));
        button.addEventListener('pointermove', (event) => this.tip(runs[0], text, event));
        button.addEventListener('pointerleave', () => this.tip(null));
        made.append(button);
        return made;
    }

    bar(lo, hi, even) {
        const ticks = [0, 0.5, 1].map((x) => (even ? lo + x * (hi - lo) : lo * (hi / lo) ** x));
        const made = element('div', 'bar', element('i'), ...(Number.isFinite(lo) ? ticks : []).map((v) => element('span', '', this.short(v))));
        const stops = Array.from({ length: 12 }, (_, i) => css(colourAt(i / 11)));
        made.firstChild.style.background = `linear-gradient(to right, ${stops})`;
        return made;
    }
}
