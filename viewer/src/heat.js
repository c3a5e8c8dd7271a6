// SPDX-License-Identifier: BSD-3-Clause
// heat.js -- the mean of a quantity over the runs at each pair of two parameters.
import { colourAt } from './colours.js';
import { element, finite, isWide, range, STATISTICS } from './values.js';

const SPAN = 100; // values that reach so far are coloured by powers of ten
const WORDS_BELOW = 11; // columns: more have no room for numbers

const mean = (list) => list.reduce((a, b) => a + b, 0) / list.length;
const css = (rgb) => `rgb(${rgb.map((c) => Math.round(255 * c))})`;

export class HeatMap {
    constructor(root, short, { tip, open }) {
        Object.assign(this, { root, short, tip, open });
    }

    draw({ x, y, value, of }, runs) {
        this.root.hidden = !x?.few || !y?.few || !value;
        if (this.root.hidden) {
            return;
        }
        const cells = Map.groupBy(runs, (run) => x.level(run) + x.levels.length * y.level(run));
        const means = new Map([...cells].map(([key, list]) => [key, mean(finite(list.filter((run) => run.done).map((run) => value.of(run, of))))]));
        const [lo, hi] = range(finite([...means.values()]));
        const to = isWide([lo, hi], SPAN) ? Math.log : (v) => v;
        const place = (v) => (hi > lo ? (to(v) - to(lo)) / (to(hi) - to(lo)) : 0.5);
        const words = value.steady ? value.label : `${STATISTICS[of]} ${value.label}`;
        const line = (level) => element('tr', '', element('th', '', y.levels[level] || '(default)'), ...x.levels.map((_, i) => {
            const key = i + x.levels.length * level;
            return this.cell(cells.get(key), means.get(key), place, words, x.levels.length < WORDS_BELOW);
        }));
        // Numbers grow upwards.
        const order = y.levels.map((_, i) => (y.numeric ? y.levels.length - 1 - i : i));
        const foot = element('tr', '', element('th'), ...x.levels.map((text) => element('th', '', element('span', '', text || '(default)'))));
        this.root.replaceChildren(
            element('h2', '', words),
            element('div', 'scroll', element('table', x.levels.length < WORDS_BELOW ? 'wide' : '', ...order.map(line), foot)),
            element('p', '', `rows: ${y.label}, columns: ${x.label}`),
            this.bar(lo, hi, to !== Math.log),
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
