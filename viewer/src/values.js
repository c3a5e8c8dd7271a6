// SPDX-License-Identifier: BSD-3-Clause
// values.js -- what a batch varies, and what its runs have come to.

/** Of a column of series.csv, as weft puts them into the page. */
export const STATISTICS = ['last', 'smallest', 'largest', 'mean'];

const STATED = ['at the end', 'minimum', 'maximum', 'mean']; // the same in a title

/** Columns of series.csv and summary.csv: name, unit, and what a number is multiplied by. */
const NAMES = {
    kinetic: ['kinetic energy', 'J'], elastic: ['elastic energy', 'J'], gravitational: ['gravitational energy', 'J'],
    contact: ['contact energy', 'J'], dissipated: ['dissipated energy', 'J'], residual: ['energy error (residual)', 'J'],
    energy_start: ['energy at the start', 'J'], energy_end: ['energy at the end', 'J'],
    elastic_stretch: ['energy of stretch', 'J'], elastic_shear: ['energy of shear', 'J'], elastic_bend: ['energy of bending', 'J'],
    dissipated_springs: ['energy dissipated in springs', 'J'], dissipated_drag: ['energy dissipated by drag', 'J'],
    dissipated_contact: ['energy dissipated in contact', 'J'], dissipated_friction: ['energy dissipated by friction', 'J'],
    work_wind: ['work of the wind', 'J'], work_pins: ['work of the pins', 'J'], work_limit: ['work of the limit', 'J'], shape_work: ['work of the shapes', 'J'],
    momentum_x: ['momentum along x', 'kg m/s'], momentum_y: ['momentum along y', 'kg m/s'], momentum_z: ['momentum along z', 'kg m/s'],
    max_strain: ['largest strain', '%', 100], limit_strain: ['strain before the limit', '%', 100],
    min_gap: ['smallest gap', 'm'], self_gap: ['smallest gap to itself', 'm'], touching: ['touching particles'], self_touching: ['particles that touch the cloth'],
    time: ['simulated time', 's'], wall_time: ['wall time', 's'], step_size: ['step size', 's'],
    rejected: ['rejected steps'], vetoed: ['steps rejected for contact'], rhs_calls: ['force evaluations'], limit_sweeps: ['sweeps of the limit'],
    linear_iterations: ['linear iterations'], newton_failures: ['Newton failures'],
};
// What a run cost, not what it came to.
const COSTS = new Set(['wall_time', 'time', 'frames', 'steps', 'rejected', 'vetoed', 'rhs_calls', 'step_size', 'warnings',
    'linear_iterations', 'factorisations', 'newton_failures', 'limit_sweeps', 'interpolated']);

const inUnit = (words, unit) => (unit ? `${words} [${unit}]` : words);

/** "largest strain, maximum [%]" of max_strain; without a statistic "largest strain [%]". */
export function titleOf(name, statistic) {
    const [words, unit] = NAMES[name] ?? [name];
    return inUnit(statistic === undefined ? words : `${words}, ${STATED[statistic]}`, unit);
}

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

/** "verlet euler 2e-3" of {plugin: verlet, method: euler, fixed_step: 2e-3}. */
const brief = (text) => (text.startsWith('{') ? text.replace(/[{}]/g, '').split(/,\s*/).map((part) => part.replace(/^[\w.]+:\s*/, '')).join(' ') : text);

/** What the levels of a parameter are called: in short, if that tells them apart. */
function wordsOf(levels) {
    const short = levels.map(brief);
    const known = new Map(levels.map((text, i) => [text, (new Set(short).size === levels.length ? short[i] : text) || '(default)']));
    return (text) => known.get(text);
}

/** A column of the summary whose runs differ: its places along an axis. */
function parameter(name, runs, names, unit) {
    const texts = [...new Set(runs.map((run) => run.text(name)))];
    const numeric = texts.every((text) => text === '' || isNumber(text)) && texts.some((text) => text !== '');
    const levels = numeric ? texts.sort((a, b) => (a === '') - (b === '') || a - b) : texts;
    const log = numeric && isWide(range(levels.filter((text) => text !== '').map(Number)), SPAN);
    const index = new Map(levels.map((text, i) => [text, i]));
    const place = numeric ? (text) => (text === '' ? NaN : log ? Math.log10(text) : Number(text)) : (text) => index.get(text);
    const label = shortName(name, names);
    return {
        name, label, title: inUnit(label, numeric ? unit?.split(' or ')[0] : ''), words: wordsOf(levels), numeric, levels, log,
        few: levels.length <= MOST_LEVELS,
        text: (run) => run.text(name),
        level: (run) => index.get(run.text(name)),
        place: (run) => place(run.text(name)),
    };
}

export function parameters({ varied, runs, units = {} }) {
    const names = [...varied, 'scene'];
    return names.map((name) => parameter(name, runs, names, units[name])).filter((p) => p.levels.length > 1);
}

const factor = (name) => NAMES[name]?.[2] ?? 1;

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
        .map((name) => ({ label: name, title: (k) => titleOf(name, k), of: (run, k) => factor(name) * (run.columns[name]?.[k] ?? NaN) }));
    const summary = names.slice(names.indexOf('status') + 1)
        .filter((name) => !['reason', 'directory', 'hash'].includes(name) && !series.some(({ label }) => label === name))
        .map((name) => ({ label: name, title: () => titleOf(name), of: (run) => factor(name) * number(run.text(name)) }));
    return [...series, ...summary].filter((q) => differs(q, runs));
}

/** What a page opens with: the largest strain, or the first result that differs from run to run, at the end if it does there. */
export function firstShown(known, runs) {
    const done = runs.filter((run) => run.done);
    const differing = (q, k) => { const [lo, hi] = range(finite(done.map((run) => q.of(run, k)))); return lo < hi; };
    const results = [...known].sort((a, b) => (b.label === 'max_strain') - (a.label === 'max_strain') || COSTS.has(a.label) - COSTS.has(b.label));
    for (const k of STATISTICS.keys()) {
        const value = results.find((q) => !COSTS.has(q.label) && differing(q, k));
        if (value) {
            return { value, of: k };
        }
    }
    return { value: results[0] ?? null, of: 0 };
}
