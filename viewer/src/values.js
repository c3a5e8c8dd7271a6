// SPDX-License-Identifier: BSD-3-Clause
// values.js -- what a batch varies, and what its runs have come to.

/** Of a column of series.csv, as weft puts them into the page. */
export const STATISTICS = ['last', 'smallest', 'largest', 'mean'];

const MOST_LEVELS = 64; // of a parameter on the map, or of colours
const SPAN = 30; // a parameter that reaches so far has powers of ten

export const element = (tag, className = '', ...children) => {
    const made = document.createElement(tag);
    made.className = className;
    made.append(...children);
    return made;
};

export const finite = (list) => list.filter(Number.isFinite);
// Of lists too long for Math.min(...list).
export const range = (list) => list.reduce(([lo, hi], v) => [Math.min(lo, v), Math.max(hi, v)], [Infinity, -Infinity]);
export const isWide = ([lo, hi], span) => lo > 0 && hi > span * lo;

const isNumber = (text) => text.trim() !== '' && Number.isFinite(Number(text));

/** The shortest end of a path that no other one has. */
function shortName(name, names) {
    const parts = name.split('.');
    const ends = parts.map((_, i) => parts.slice(parts.length - 1 - i).join('.'));
    return ends.find((end) => names.filter((other) => other === end || other.endsWith(`.${end}`)).length === 1) ?? name;
}

/** A column of the summary whose runs differ: its places along an axis. */
function parameter(name, runs, names) {
    const texts = [...new Set(runs.map((run) => run.text(name)))];
    const numeric = texts.every((text) => text === '' || isNumber(text)) && texts.some((text) => text !== '');
    const levels = numeric ? texts.sort((a, b) => (a === '') - (b === '') || a - b) : texts;
    const log = numeric && isWide(range(levels.filter((text) => text !== '').map(Number)), SPAN);
    const index = new Map(levels.map((text, i) => [text, i]));
    const place = numeric ? (text) => (text === '' ? NaN : log ? Math.log10(text) : Number(text)) : (text) => index.get(text);
    return {
        name, label: shortName(name, names), numeric, levels, log,
        few: levels.length <= MOST_LEVELS,
        text: (run) => run.text(name),
        level: (run) => index.get(run.text(name)),
        place: (run) => place(run.text(name)),
    };
}

export function parameters({ varied, runs }) {
    const names = [...varied, 'scene'];
    return names.map((name) => parameter(name, runs, names)).filter((p) => p.levels.length > 1);
}

/** Whether any statistic of a quantity differs from run to run. */
export const differs = (quantity, runs) => STATISTICS.some((_, k) => {
    const [lo, hi] = range(finite(runs.map((run) => quantity.of(run, k))));
    return lo < hi;
});

const number = (text) => (text === '' ? NaN : Number(text));

/** Columns of every series, and of the summary those that no series has; `of` a run and a
 * statistic. Those in which no runs differ are left out. */
export function quantities({ names, runs }) {
    const series = [...new Set(runs.flatMap((run) => Object.keys(run.columns)))]
        .filter((name) => !['frame', 'time', 'hash'].includes(name))
        .map((name) => ({ label: name, of: (run, k) => run.columns[name]?.[k] ?? NaN }));
    const summary = names.slice(names.indexOf('status') + 1)
        .filter((name) => !['reason', 'directory', 'hash'].includes(name) && !series.some(({ label }) => label === name))
        .map((name) => ({ label: name, steady: true, of: (run) => number(run.text(name)) }));
    return [...summary.filter(({ label }) => label === 'wall_time'), ...series, ...summary.filter(({ label }) => label !== 'wall_time')]
        .filter((q) => differs(q, runs));
}
