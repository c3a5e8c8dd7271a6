// SPDX-License-Identifier: BSD-3-Clause
// compare.js -- work and precision: the error of every method against its cost.
import { decades, powerText } from './decades.js';
import { save } from './save.js';
import { toggleTheme } from './theme.js';
import { placeTip } from './tip.js';

const INKS = 10;
const REACH = 24; // px: a point nearer to the pointer is meant
const TOP = 1; // m: an error above is no solution, and not shown
const CALLS = 'evaluations of the forces (dashed: a part of the work)';
const $ = (id) => document.getElementById(id);

const page = JSON.parse($('weft-data').textContent);
const state = { time: true, others: true, hidden: new Set(), lit: null };

const element = (tag, className = '', ...children) => {
    const made = document.createElement(tag);
    made.className = className;
    made.append(...children);
    return made;
};
const nameOf = (method) => `${method.plugin} ${method.name}`;
const short = (v) => (v !== 0 && (Math.abs(v) < 1e-3 || Math.abs(v) >= 1e5)
    ? v.toExponential(1) : Number(v.toPrecision(3)).toString());
const grouped = (v) => v.toLocaleString('en').replaceAll(',', '\u202f');
const settingOf = (method, point) => (method.fixed ? `h = ${short(point.setting)} s` : `tolerance ${point.setting.toExponential(0)}`);
const costOf = (point) => (state.time ? point.time : point.calls);
const drawable = (point) => point.error > 0 && point.error <= TOP;

// Coloured are those that are the best somewhere, and the scene's; the others are grey.
const best = new Set(page.ranks.flatMap((rank) => [rank.best, rank.fewest]));
let ink = 0;
page.methods.forEach((method, i) => {
    method.colour = best.has(i) || method.own ? `--curve-${ink++ % INKS}` : '--curve-other';
    method.other = method.colour === '--curve-other';
});
const visible = (method) => !state.hidden.has(method) && (state.others || !method.other);
// Grey ones below.
const shown = () => page.methods.filter(visible).sort((a, b) => b.other - a.other);

const decade = (round, v) => 10 ** round(Math.log10(v));
const all = page.methods.flatMap((method) => method.points.filter(drawable));
const ERRORS = [decade(Math.floor, Math.min(TOP, ...all.map((p) => p.error))), decade(Math.ceil, Math.max(1e-12, ...all.map((p) => p.error)))];

// ---- the diagram --------------------------------------------------------------------

const LEFT = 66; // px around the curves
const RIGHT = 12;
const ABOVE = 10;
const BELOW = 48;
let plot = null; // { x, y }: px in the diagram of costs and of errors

function shape(tag, attributes, ...children) {
    const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
    Object.entries(attributes).forEach(([name, value]) => made.setAttribute(name, value));
    made.append(...children);
    return made;
}

const word = (x, y, text, className = '', more = {}) => shape('text', { x, y, class: className, ...more }, text);
const logarithmic = ([lo, hi], from, to) => (v) => from + ((to - from) * Math.log(v / lo)) / Math.log(hi / lo);
const count = (t) => (t >= 1e6 ? `${t / 1e6}M` : t >= 1e3 ? `${t / 1e3}k` : String(Number(t.toPrecision(1))));

/** The scene with its own settings. */
function own() {
    const method = page.methods.find((m) => m.own);
    return page.own && method && visible(method) && drawable(page.own) ? [{ method, point: page.own }] : [];
}

const points = () => [...shown().flatMap((method) => method.points.filter(drawable).map((p) => ({ method, point: p }))), ...own()];

function axes(range, [left, top, right, bottom]) {
    const grid = (x1, y1, x2, y2) => shape('line', { x1, y1, x2, y2, class: 'grid' });
    return [
        ...decades(...range, (right - left) / 50).flatMap((v) => [grid(plot.x(v), top, plot.x(v), bottom + 4), word(plot.x(v), bottom + 17, count(v), 'middle')]),
        ...decades(...ERRORS, 14).flatMap((v) => [grid(left - 4, plot.y(v), right, plot.y(v)), word(left - 8, plot.y(v) + 4, powerText(v), 'end')]),
        word((left + right) / 2, bottom + 38, state.time ? 'time [s]' : CALLS, 'middle'),
        word(0, 0, 'error [m]', 'middle', { transform: `translate(14 ${(top + bottom) / 2}) rotate(-90)` }),
    ];
}

/** What is nearer to the reference than its own error allows to be judged. */
function band([left, top, right, bottom]) {
    const y = Math.max(page.near > 0 ? plot.y(page.near) : bottom, top);
    return y >= bottom ? [] : [
        shape('rect', { x: left, y, width: right - left, height: bottom - y, class: 'band' }),
        word(left + 8, Math.min(y + 15, bottom - 4), 'not judged: the reference is no better'),
    ];
}

/** Along the ladder, whatever way its costs go. */
function curve(method) {
    const places = method.points.filter(drawable).map((p) => ({ p, x: plot.x(costOf(p)), y: plot.y(p.error) }));
    const made = shape('g', { class: `curve${method.other ? ' other' : ''}${method.implicit && !state.time ? ' partly' : ''}` }, shape('polyline', { points: places.map(({ x, y }) => `${x},${y}`).join(' ') }), ...places.map(({ p, x, y }) => {
        const dot = shape('circle', { cx: x, cy: y, r: method.other ? 2.5 : 3.5, class: p.error < page.near ? 'near' : '' });
        dot.point = p;
        return dot;
    }));
    made.method = method;
    made.style.setProperty('--ink-of', `var(${method.colour})`);
    return made;
}

function diamond({ method, point: p }) {
    const made = shape('path', { d: 'M0-7 7 0 0 7-7 0z', class: 'own', transform: `translate(${plot.x(costOf(p))} ${plot.y(p.error)})` });
    made.point = p;
    made.style.setProperty('--ink-of', `var(${method.colour})`);
    return made;
}

function draw() {
    const costs = points().map(({ point: p }) => costOf(p));
    const range = costs.length > 0 ? [0.8 * Math.min(...costs), 1.25 * Math.max(...costs)] : [1, 10];
    const width = Math.max($('plot').clientWidth, 160); // 0 before a phone has its layout
    const height = Math.round(Math.min(Math.max(0.72 * width, 320), Math.max(360, innerHeight - 240)));
    const sides = [LEFT, ABOVE, width - RIGHT, height - BELOW];
    plot = { x: logarithmic(range, sides[0], sides[2]), y: logarithmic(ERRORS, sides[3], sides[1]) };
    $('plot').replaceChildren(shape('svg', { width, height, viewBox: `0 0 ${width} ${height}`, 'aria-hidden': true }, ...band(sides), ...axes(range, sides), ...shown().map(curve), ...own().map(diamond)));
}

// ---- as a file ----------------------------------------------------------------------

const KEPT = ['fill', 'stroke', 'stroke-width', 'stroke-dasharray', 'font-size', 'font-family', 'text-anchor']; // inherited, all of them

/** A copy with the styles in force as attributes, for programs that know no style sheet. */
function frozen(live, parent = {}) {
    const style = getComputedStyle(live);
    const copy = live.cloneNode(false);
    ['class', 'style', 'aria-hidden'].forEach((name) => copy.removeAttribute(name));
    KEPT.filter((name) => style[name] !== parent[name]).forEach((name) => copy.setAttribute(name, style[name]));
    copy.append(...[...live.childNodes].map((child) => (child.nodeType === Node.TEXT_NODE ? child.data : frozen(child, style))));
    return copy;
}

/** The diagram with its scene's name, its names of coloured curves, and its background. */
function asFile() {
    const svg = $('plot').firstChild;
    const [width, height] = ['width', 'height'].map((name) => Number(svg.getAttribute(name)));
    const methods = shown().filter((method) => !method.other && method.points.some(drawable));
    const columns = Math.max(1, Math.floor((width - LEFT) / 190));
    const tall = height + 18 * Math.ceil(methods.length / columns) + 10;
    const names = methods.map((method, i) => {
        const [x, y] = [LEFT + 190 * (i % columns), height + 10 + 18 * Math.floor(i / columns)];
        const made = shape('g', { class: 'curve' }, shape('line', { x1: x, y1: y - 4, x2: x + 14, y2: y - 4 }), word(x + 20, y, nameOf(method)));
        made.style.setProperty('--ink-of', `var(${method.colour})`);
        return made;
    });
    const more = [shape('rect', { y: -30, width, height: tall + 30, class: 'card' }), word(LEFT, -12, page.scene, 'title'), ...names];
    svg.prepend(...more);
    const copy = frozen(svg);
    more.forEach((part) => part.remove());
    copy.setAttribute('viewBox', `0 -30 ${width} ${tall + 30}`);
    copy.setAttribute('height', tall + 30);
    return new XMLSerializer().serializeToString(copy);
}

// ---- the point under the pointer --------------------------------------------------

function nearest(left, top) {
    const found = points().map(({ method, point: p }) => ({
        method, point: p, far: Math.hypot(plot.x(costOf(p)) - left, plot.y(p.error) - top),
    })).filter(({ far }) => far < REACH);
    return found.reduce((least, one) => (one.far < (least?.far ?? Infinity) ? one : least), null);
}

function lines(method, p) {
    return [
        p === page.own ? 'the scene as it is' : settingOf(method, p),
        `error ${p.error.toExponential(1)} m (rms ${p.rms.toExponential(1)} m, velocity ${p.velocity.toExponential(1)} m/s)${p.error < page.near ? ': not judged' : ''}`,
        `${short(p.time)} s, ${grouped(p.calls)} evaluations`,
        `${grouped(p.steps)} steps, ${grouped(p.rejected)} rejected`,
        `energy within ${short(100 * p.energy)} %`,
    ].join('\n');
}

function light(found, event) {
    const before = state.lit;
    state.lit = found;
    $('tip').hidden = !found;
    if (found) {
        $('tip').replaceChildren(element('b', '', `${nameOf(found.method)}, order ${found.method.order || 'variable'}`), lines(found.method, found.point));
        placeTip($('tip'), event);
    }
    if (before?.point !== found?.point) {
        lightMethod();
    }
}

function lightMethod() {
    const { method, point: p } = state.lit ?? {};
    document.querySelectorAll('#legend button, .curve').forEach((made) => made.classList.toggle('lit', made.method === method));
    document.querySelectorAll('#plot circle, .own').forEach((made) => made.classList.toggle('lit', made.point === p));
}

function point(event) {
    const box = $('plot').getBoundingClientRect();
    light(nearest(event.clientX - box.left, event.clientY - box.top), event);
}

// ---- words and choices --------------------------------------------------------------

function swatch(method) {
    const made = element('span', 'ink');
    made.style.setProperty('--ink-of', `var(${method.colour})`);
    return made;
}

function fillLegend() {
    const methods = page.methods.filter((method) => method.points.some(drawable)).sort((a, b) => a.other - b.other);
    $('legend').append(...methods.map((method) => {
        const button = element('button', method.other ? 'other' : '', swatch(method), nameOf(method));
        button.method = method;
        button.addEventListener('click', () => {
            state.hidden[state.hidden.has(method) ? 'delete' : 'add'](method);
            update();
        });
        const over = () => {
            state.lit = { method };
            lightMethod();
        };
        button.addEventListener('pointerenter', over);
        button.addEventListener('pointerleave', () => {
            state.lit = null;
            lightMethod();
        });
        return button;
    }));
}

function fillWords() {
    document.title = `${page.scene}: which integrator? - weft`;
    $('name').textContent = `${page.scene}: which integrator?`;
    $('summary').append(...[
        page.size.replace(' x ', ' × '),
        `${page.methods.filter((m) => m.points.length > 0).length} methods over ${short(page.time)} s`,
        `at most ${grouped(page.budget)} evaluations of the forces a run`,
    ].map((text) => element('span', 'fact', text)));
    $('horizon').textContent = `The scene is ${page.horizon}.`;
    $('reference').textContent = `The reference: ${page.reference}.`;
    $('stiffness').textContent = page.stiffness && `The ${page.stiffness}.`;
    $('as-is').textContent = `${page.asIs}.`;
    $('ranks').append(...page.ranks.map((rank) => {
        const method = page.methods[rank.best];
        const [what, ...why] = rank.text.split('; ');
        return element('li', '', element('span', 'accuracy', `${rank.accuracy.toExponential(0)} m`),
            element('div', '', element('b', '', swatch(method), what), element('div', 'why', why.join('; '))));
    }));
    if (page.ranks.length === 0) {
        $('ranks').append(element('li', '', 'no method reaches an accuracy that can be judged'));
    }
}

function fillFiles() {
    const head = ['method', 'setting', 'error [m]', 'evaluations', 'time [s]', 'rejected', 'energy [%]'];
    const row = (tag, cells) => element('tr', '', ...cells.map((cell) => element(tag, '', cell)));
    const rows = page.methods.flatMap((method) => [
        ...method.points.map((p) => row('td', [nameOf(method), settingOf(method, p), p.error.toExponential(2), grouped(p.calls), short(p.time), grouped(p.rejected), short(100 * p.energy)])),
        ...(method.remark ? [element('tr', '', element('td', '', nameOf(method)), Object.assign(element('td', 'word', method.remark), { colSpan: head.length - 1 }))] : []),
    ]);
    $('files').append(
        element('details', '', element('summary', '', 'every run'), element('div', 'scroll', element('table', '', row('th', head), ...rows))),
        element('details', '', element('summary', '', 'the scene'), element('pre', '', page.yaml)),
        element('p', '', `made by weft ${page.weft}`),
    );
}

function update() {
    $('by-calls').setAttribute('aria-pressed', !state.time);
    $('by-time').setAttribute('aria-pressed', state.time);
    $('all').checked = state.others;
    document.querySelectorAll('#legend button').forEach((button) => {
        button.setAttribute('aria-pressed', !state.hidden.has(button.method));
        button.hidden = button.method.other && !state.others;
    });
    light(null);
    draw();
}

function listen() {
    const on = (id, action) => $(id).addEventListener('click', action);
    $('plot').addEventListener('pointermove', point);
    $('plot').addEventListener('pointerdown', point);
    $('plot').addEventListener('pointerleave', () => light(null));
    on('by-calls', () => { state.time = false; update(); });
    on('by-time', () => { state.time = true; update(); });
    on('all', () => { state.others = $('all').checked; update(); });
    on('save', () => save('compare.svg', 'image/svg+xml', asFile()));
    on('theme', toggleTheme);
    addEventListener('keydown', (event) => {
        if (event.key === 'd' && !event.ctrlKey && !event.metaKey && !event.altKey) {
            toggleTheme();
        }
    });
    let width = $('plot').clientWidth;
    new ResizeObserver(() => {
        if ($('plot').clientWidth !== width) {
            width = $('plot').clientWidth;
            draw();
        }
    }).observe($('plot'));
}

fillWords();
fillLegend();
fillFiles();
listen();
update();
document.documentElement.dataset.ready = '';
/** For tests and for the console. */
window.weft = { page, state, get plot() { return plot; }, shown, costOf };
