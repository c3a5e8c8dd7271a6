// SPDX-License-Identifier: BSD-3-Clause
// compare.js -- work and precision: the error of every method against what it costs.
import uPlot from 'uplot';
import { axis } from './plots.js';

const INKS = 10;
const REACH = 24; // px: a point nearer to the pointer is meant
const TOP = 1; // m: an error above is no solution, and not shown
const $ = (id) => document.getElementById(id);

const page = JSON.parse($('weft-data').textContent);
const state = { time: false, others: true, hidden: new Set(), lit: null };

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
const costOf = (method, point) => (state.time ? point.calls * method.callTime : point.calls);
const drawable = (point) => point.error > 0 && point.error <= TOP;

// Coloured are those that are the best somewhere, and the scene's; the others are grey.
const best = new Set(page.ranks.flatMap((rank) => [rank.best, rank.fastest]));
let ink = 0;
page.methods.forEach((method, i) => {
    method.colour = best.has(i) || method.own ? `--curve-${ink++ % INKS}` : '--curve-other';
    method.other = method.colour === '--curve-other';
});
const style = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();
const visible = (method) => !state.hidden.has(method) && (state.others || !method.other)
    && (!state.time || method.callTime > 0);
// Grey ones below.
const shown = () => page.methods.filter(visible).sort((a, b) => b.other - a.other);

const decade = (round, v) => 10 ** round(Math.log10(v));
const all = page.methods.flatMap((method) => method.points.filter(drawable));
const ERRORS = [decade(Math.floor, Math.min(TOP, ...all.map((p) => p.error))), decade(Math.ceil, Math.max(1e-12, ...all.map((p) => p.error)))];

let plot = null;

/** Along the ladder, whatever way its costs go. */
function line(u, method) {
    const lit = state.lit?.method === method;
    u.ctx.beginPath();
    method.points.filter(drawable).forEach((point) => u.ctx.lineTo(u.valToPos(costOf(method, point), 'x', true), u.valToPos(point.error, 'y', true)));
    u.ctx.lineWidth = (lit ? 3 : method.other ? 1 : 2) * devicePixelRatio;
    u.ctx.strokeStyle = style(lit && method.other ? '--ink' : method.colour);
    u.ctx.stroke();
}

function circle(u, method, point) {
    const x = u.valToPos(costOf(method, point), 'x', true);
    const y = u.valToPos(point.error, 'y', true);
    const lit = state.lit?.point === point;
    u.ctx.beginPath();
    u.ctx.arc(x, y, (lit ? 6 : method.other ? 2.5 : 3.5) * devicePixelRatio, 0, 2 * Math.PI);
    u.ctx.lineWidth = 1.5 * devicePixelRatio;
    u.ctx.strokeStyle = style(lit && method.other ? '--ink' : method.colour);
    u.ctx.fillStyle = point.error < page.near ? style('--card') : u.ctx.strokeStyle;
    u.ctx.fill();
    u.ctx.stroke();
}

/** What is nearer to the reference than its own error allows to be judged. */
function band(u) {
    const y = Math.max(u.valToPos(page.near, 'y', true), u.bbox.top);
    const bottom = u.bbox.top + u.bbox.height;
    if (page.near > 0 && y < bottom) {
        u.ctx.fillStyle = style('--band');
        u.ctx.fillRect(u.bbox.left, y, u.bbox.width, bottom - y);
        u.ctx.fillStyle = style('--ink-soft');
        u.ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
        u.ctx.textAlign = 'left';
        u.ctx.textBaseline = 'alphabetic';
        u.ctx.fillText('not judged: the reference is no better', u.bbox.left + 8 * devicePixelRatio, Math.min(y + 15 * devicePixelRatio, bottom - 4 * devicePixelRatio));
    }
}

/** The scene with its own settings: a diamond. */
function diamond(u) {
    const own = page.methods.find((method) => method.own);
    if (!page.own || !own || !visible(own) || !drawable(page.own)) {
        return;
    }
    const x = u.valToPos(costOf(own, page.own), 'x', true);
    const y = u.valToPos(page.own.error, 'y', true);
    const r = (state.lit?.point === page.own ? 10 : 7) * devicePixelRatio;
    u.ctx.beginPath();
    u.ctx.moveTo(x, y - r);
    u.ctx.lineTo(x + r, y);
    u.ctx.lineTo(x, y + r);
    u.ctx.lineTo(x - r, y);
    u.ctx.closePath();
    u.ctx.fillStyle = style(own.colour);
    u.ctx.strokeStyle = style('--card');
    u.ctx.lineWidth = 2 * devicePixelRatio;
    u.ctx.fill();
    u.ctx.stroke();
}

function drawPoints(u) {
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(u.bbox.left - 8, u.bbox.top - 8, u.bbox.width + 16, u.bbox.height + 16);
    u.ctx.clip();
    shown().forEach((method) => {
        line(u, method);
        method.points.filter(drawable).forEach((point) => circle(u, method, point));
    });
    diamond(u);
    u.ctx.restore();
}

/** 1, 2 and 5 times powers of ten; these alone where there are many. */
function round125(_, __, low, high) {
    const powers = [];
    for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); ++k) {
        powers.push(k);
    }
    const factors = powers.length > 4 ? [1] : [1, 2, 5];
    return powers.flatMap((k) => factors.map((m) => Number(`${m}e${k}`))).filter((v) => v >= low && v <= high);
}

const counts = (_, ticks) => ticks.map((t) => (t === null ? '' : t >= 1e6 ? `${t / 1e6}M` : t >= 1e3 ? `${t / 1e3}k` : String(Number(t.toPrecision(1)))));

function around(costs) {
    const own = page.methods.find((method) => method.own);
    const list = page.own && own && visible(own) ? [...costs, costOf(own, page.own)] : costs;
    return [0.8 * Math.min(...list), 1.25 * Math.max(...list)];
}

function draw() {
    plot?.destroy();
    const costs = shown().flatMap((method) => method.points.filter(drawable).map((p) => costOf(method, p)));
    const range = costs.length > 0 ? around(costs) : [1, 10];
    const width = $('plot').clientWidth;
    const xAxis = { ...axis(style, true), size: 44, label: state.time ? 'time [s]' : 'evaluations of the forces', labelSize: 18, labelFont: '12px system-ui, sans-serif', splits: round125, filter: (_, ticks) => ticks, grid: { stroke: style('--line'), width: 1 }, ticks: { stroke: style('--line'), width: 1, size: 4 }, values: counts };
    plot = new uPlot({
        width,
        height: Math.round(Math.min(Math.max(0.72 * width, 320), Math.max(360, innerHeight - 240))),
        padding: [10, 12, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, distr: 3, range: () => range }, y: { distr: 3, range: () => ERRORS } },
        axes: [xAxis, { ...axis(style, true), size: 56, label: 'error [m]', labelSize: 16, labelFont: '12px system-ui, sans-serif' }],
        series: [{}, {}],
        hooks: { drawAxes: [band], draw: [drawPoints] },
    }, [range, [null, null]], $('plot'));
    plot.over.addEventListener('pointermove', point);
    plot.over.addEventListener('pointerdown', point);
    plot.over.addEventListener('pointerleave', () => light(null));
}

// ---- the point under the pointer --------------------------------------------------

function nearest(left, top) {
    let found = null;
    const consider = (method, p) => {
        const far = Math.hypot(plot.valToPos(costOf(method, p), 'x') - left, plot.valToPos(p.error, 'y') - top);
        if (far < (found?.far ?? REACH)) {
            found = { method, point: p, far };
        }
    };
    shown().forEach((method) => method.points.filter(drawable).forEach((p) => consider(method, p)));
    const own = page.methods.find((method) => method.own);
    if (page.own && own && visible(own)) {
        consider(own, page.own);
    }
    return found;
}

function lines(method, p) {
    return [
        p === page.own ? 'the scene as it is' : settingOf(method, p),
        `error ${p.error.toExponential(1)} m (rms ${p.rms.toExponential(1)} m, velocity ${p.velocity.toExponential(1)} m/s)${p.error < page.near ? ': not judged' : ''}`,
        `${grouped(p.calls)} evaluations${method.callTime > 0 ? `, ${short(p.calls * method.callTime)} s` : ''}`,
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
        const { width, height } = $('tip').getBoundingClientRect();
        $('tip').style.left = `${Math.max(8, Math.min(event.clientX + 14, innerWidth - width - 8))}px`;
        $('tip').style.top = `${event.clientY + 18 + height > innerHeight ? event.clientY - height - 12 : event.clientY + 18}px`;
    }
    if (before?.point !== found?.point) {
        lightMethod();
    }
}

function lightMethod() {
    document.querySelectorAll('#legend button').forEach((button) => button.classList.toggle('lit', button.method === state.lit?.method));
    plot.redraw(false);
}

function point(event) {
    const box = plot.over.getBoundingClientRect();
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
    document.title = `${page.scene}: which stepper? - weft`;
    $('name').textContent = `${page.scene}: which stepper?`;
    $('summary').append(...[
        `${page.rows} × ${page.cols} particles`,
        `${page.methods.filter((m) => m.points.length > 0).length} methods over ${short(page.time)} s`,
        `at most ${grouped(page.budget)} evaluations of the forces a run`,
    ].map((text) => element('span', 'fact', text)));
    $('horizon').textContent = `The scene is ${page.horizon}.`;
    $('reference').textContent = `The reference: ${page.reference}.`;
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
        ...method.points.map((p) => row('td', [nameOf(method), settingOf(method, p), p.error.toExponential(2), grouped(p.calls), short(p.calls * method.callTime), grouped(p.rejected), short(100 * p.energy)])),
        ...(method.remark ? [element('tr', '', element('td', '', nameOf(method)), Object.assign(element('td', 'word', method.remark), { colSpan: head.length - 1 }))] : []),
    ]);
    $('files').append(
        element('details', '', element('summary', '', 'every run'), element('div', 'scroll', element('table', '', row('th', head), ...rows))),
        element('details', '', element('summary', '', 'the scene'), element('pre', '', page.yaml)),
        element('p', '', `made by weft ${page.weft}; uPlot inside, licences in the source of this page`),
    );
}

function update() {
    $('by-calls').setAttribute('aria-pressed', !state.time);
    $('by-time').setAttribute('aria-pressed', state.time);
    $('all').setAttribute('aria-pressed', state.others);
    document.querySelectorAll('#legend button').forEach((button) => {
        button.setAttribute('aria-pressed', !state.hidden.has(button.method));
        button.hidden = button.method.other && !state.others;
    });
    light(null);
    draw();
}

const prefersDark = matchMedia('(prefers-color-scheme: dark)');
const isDark = () => (document.documentElement.dataset.theme ?? (prefersDark.matches ? 'dark' : 'light')) === 'dark';

function toggleTheme() {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    draw();
}

function listen() {
    const on = (id, action) => $(id).addEventListener('click', action);
    on('by-calls', () => { state.time = false; update(); });
    on('by-time', () => { state.time = true; update(); });
    on('all', () => { state.others = !state.others; update(); });
    on('theme', toggleTheme);
    addEventListener('keydown', (event) => {
        if (event.key === 'd' && !event.ctrlKey && !event.metaKey && !event.altKey) {
            toggleTheme();
        }
    });
    prefersDark.addEventListener('change', draw);
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
window.weft = { page, state, get plot() { return plot; }, shown, costOf };
