// SPDX-License-Identifier: BSD-3-Clause
// playground.js -- a scene that runs as it is watched: what is asked for, and what follows from it.
import { drawLegend } from './colours.js';
import { Dragging } from './playground-drag.js';
import { EnergyPlot } from './playground-plot.js';
import { Run } from './playground-run.js';
import { isSoftware, Stage } from './stage.js';
import { readSurface } from './surface.js';
import { isDark, onPreference, toggleTheme } from './theme.js';

const $ = (id) => document.getElementById(id);
const json = (id) => JSON.parse($(id).textContent);

const FIXED = ['euler', 'symplectic_euler', 'velocity_verlet', 'midpoint', 'rk4', 'backward_euler'];
const PLUGIN = {
    euler: 'verlet', symplectic_euler: 'verlet', velocity_verlet: 'verlet', midpoint: 'verlet', rk4: 'arkode',
    backward_euler: 'stiff', dormand_prince: 'arkode', bogacki_shampine: 'arkode', fehlberg87: 'arkode',
    esdirk324: 'arkode', ros2: 'stiff', rkc2: 'stiff',
};
const OWN = 'own'; // the scene's method
const SUBSTITUTE = 'dormand_prince'; // for one that this page does not have
const RATES = [1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
const BUDGET = 0.012; // [s] of stepping a picture
const THREADS_BELOW = 2500; // particles: more would be a grey veil
const LATEST = 0.2; // [s] between two pictures that count as running
const CAPTIONS = 80; // ms between two changes of the texts
const STRAIN = {
    name: 'strain',
    unit: '%',
    place: (v) => (v > 0 ? (Math.log10(100 * v) + 1) / 3 : 0),
    ticks: ['0.1', '1', '10', '100'],
    read: (run, _, out) => run.blocks[0].read(3, out),
};

const { names, texts, files } = json('scenes');
const state = {
    scene: names[0], text: '', method: OWN, other: 'euler', two: false, h: 0, k: 0, d: 0, rate: 1, plain: false,
};
let [playing, time, before, captioned, stale] = [true, 0, 0, 0, false];
let base = null; // the scene as its text has it
let runs = [];
let page = null;
let stage = null;
let drawn = ''; // what the stage was built for
const all = []; // what may run, once it was asked for
let reader = null; // reads scenes beside them
const plot = new EnergyPlot($('plots'));

// ---- the link ------------------------------------------------------------------------

const bytesOf = (text) => (Uint8Array.fromBase64 ? Uint8Array.fromBase64(text) : Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));

function readLink() {
    try {
        const text = location.hash.slice(1).replaceAll('-', '+').replaceAll('_', '/');
        Object.assign(state, JSON.parse(new TextDecoder().decode(bytesOf(text))));
        return true;
    } catch {
        return false;
    }
}

/** All that a colleague needs to see the same; the text only where it was edited. */
function link() {
    const { scene, text, ...numbers } = state;
    const bytes = new TextEncoder().encode(JSON.stringify(scene ? { scene, ...numbers } : { scene, text, ...numbers }));
    const base64 = btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join(''));
    return `#${base64.replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`;
}

// ---- what runs -----------------------------------------------------------------------

const scale = (key, by) => Object.entries(base.springs).map(([family, values]) => (
    `cloth.springs.${family}.${key}=${(values[key === 'stiffness' ? 0 : 1] * 10 ** by).toPrecision(12)}`));

function stepper(method) {
    if (method === OWN) {
        return base?.substituted ? stepper(SUBSTITUTE) : [];
    }
    const numbers = FIXED.includes(method) ? `fixed_step: ${state.h.toExponential(6)}` : 'rtol: 1.0e-4, atol: 1.0e-4';
    return [`stepper={plugin: ${PLUGIN[method]}, method: ${method}, ${numbers}}`];
}

function overrides(method) {
    const own = method === OWN && state.h !== base.step && base.step > 0 && !base.substituted
        ? [`stepper.fixed_step=${state.h.toExponential(6)}`] : [];
    return [
        ...(state.k === 0 ? [] : scale('stiffness', state.k)), ...(state.d === 0 ? [] : scale('damping', state.d)),
        ...stepper(method), ...own,
    ];
}

function tell(mistakes) {
    const [first] = mistakes.filter(({ warning }) => !warning);
    const where = (m) => (m.line > 0 ? `${m.line}:${m.column}: ` : '');
    $('mistake').hidden = !first;
    $('mistake').textContent = first ? where(first) + first.message : '';
    $('mistakes').replaceChildren(...mistakes.map((m) => {
        const button = document.createElement('button');
        button.className = m.warning ? 'warning' : 'error';
        button.textContent = `${where(m)}${m.warning ? 'warning' : 'error'}: ${m.message}`;
        button.onclick = () => select(m.line);
        const item = document.createElement('li');
        item.append(button);
        return item;
    }));
}

/** The line of the text with a mistake. */
function select(line) {
    const lines = $('text').value.split('\n');
    const start = lines.slice(0, line - 1).join('\n').length + (line > 1 ? 1 : 0);
    $('editing').open = true;
    $('text').focus();
    $('text').setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
}

/** Reads the scene's text as it is: its method, if this page has it, its springs, its steps. */
async function readBase() {
    const text = state.scene ? texts[state.scene] : state.text;
    let opened = await reader.open(text, []);
    const missing = opened.mistakes.find(({ message }) => /plugin '\w+' not found/.test(message));
    if (!opened.scene && missing) {
        opened = await reader.open(text, [`stepper={plugin: ${PLUGIN[SUBSTITUTE]}, method: ${SUBSTITUTE}, rtol: 1.0e-4, atol: 1.0e-4}`]);
        opened.scene = opened.scene && { ...opened.scene, substituted: true };
    }
    tell(opened.mistakes);
    // a cloth without vibrations has no limit: the slider is about something
    return opened.scene && { ...opened.scene, text, limit: opened.scene.limit || opened.scene.step || 1e-3 };
}

async function openScene(numbers = {}) {
    $('text').value = state.scene ? texts[state.scene] : state.text;
    $('scene').value = state.scene;
    const found = await readBase();
    if (found) {
        base = found;
        Object.assign(state, { h: base.step || base.limit / 2, k: 0, d: 0 }, numbers);
        await start();
    }
}

let [asked, starting] = [0, null];

/** From the start with the numbers as they are; once more if they change meanwhile. */
function start() {
    asked += 1;
    starting ??= (async () => {
        for (let last = 0; last !== asked;) {
            last = asked;
            await startOnce();
        }
    })().finally(() => { starting = null; });
    return starting;
}

async function startOnce() {
    const wanted = [state.method, ...(state.two ? [state.other] : [])];
    while (all.length < wanted.length) {
        all.push(makeRun());
    }
    const opened = await Promise.all(wanted.map((method, i) => all[i].open(base.text, overrides(method))));
    const mistakes = opened.flatMap((one) => one.mistakes);
    tell(mistakes);
    if (opened.some(({ scene }) => !scene)) {
        runs = [];
        return;
    }
    runs = all.slice(0, wanted.length);
    time = 0;
    page = makePage();
    build();
    write();
    plot.start(runs);
    captioned = 0;
    stale = true;
    show();
    writeCaptions();
}

function makePage() {
    const [{ scene }] = runs;
    const meta = scene.corners
        ? { mesh: { vertices: scene.count, corners: scene.corners.buffer, places: scene.corners.buffer, rest: new ArrayBuffer(0) } }
        : { shown: [scene.rows, scene.cols] };
    runs.forEach((run) => Object.assign(run, { calm: 1 }));
    return {
        ...meta, runs, surface: readSurface(meta, (buffer) => buffer), count: scene.count, pinned: scene.pinned, times: [0],
        fields: ['strain'], apart: [], calm: 1, all: false, blown: false,
    };
}

/** The box at the start and the room to fall into. */
function room() {
    const box = runs[0].blocks[0].box();
    const size = Math.hypot(...box.map(([lo, hi]) => hi - lo));
    const [x, y, z] = box;
    return [box, [x, [Math.min(y[0], y[1] - 0.6 * size), y[1] + 0.12 * size], z]];
}

/** The stage anew, if another cloth is to be seen. */
function build() {
    const { scene } = runs[0];
    const wanted = JSON.stringify([runs.length, scene.count, scene.rows, scene.pinned, scene.obstacles, room()]);
    if (wanted !== drawn) {
        drawn = wanted;
        if (stage) {
            stage.views.forEach(({ scene: view }) => view.traverse((object) => {
                [object.geometry, object.material, object.shadow].forEach((part) => part?.dispose());
            }));
            Object.assign(stage, { page, moved: false });
            stage.surround(room());
            stage.build();
        } else {
            makeStage();
        }
        stage?.setThreads(scene.count <= THREADS_BELOW);
        stage?.setInk(isDark());
        stage?.resize();
        stage?.fit();
    } else if (stage) {
        stage.page = page;
        stage.views.forEach(({ cloth, shapes }) => Object.assign(cloth, { page }) && Object.assign(shapes, { page }));
    }
}

function makeStage() {
    try {
        stage = new Stage($('canvas'), page, room(), !isSoftware());
        stage.controls.addEventListener('start', () => { stage.moved = true; });
    } catch {
        $('no-webgl').hidden = false;
    }
}

// ---- what is seen --------------------------------------------------------------------

const length = (h) => (h >= 1e-3 ? `${Number((1e3 * h).toPrecision(3))} ms` : `${Number((1e6 * h).toPrecision(3))} µs`);

function write() {
    if (!base) {
        return;
    }
    const [{ scene }] = runs;
    const fixed = runs.some((run) => run.scene.step > 0);
    const families = Object.entries(base.springs);
    $('about').textContent = `${scene.name}\u00a0· ${scene.cols > 0 ? `${scene.rows} × ${scene.cols} particles` : `${scene.count} vertices`}`
        + `${base.substituted ? '\u00a0· the scene asks for a method that this page does not have: dormand_prince steps it' : ''}`;
    $('method').options[0].text = `${base.substituted ? SUBSTITUTE : base.method} (scene)`;
    Object.assign($('method'), { value: state.method });
    Object.assign($('other'), { value: state.other });
    $('two').checked = state.two;
    $('rate').value = state.rate;
    $('plain').checked = state.plain;
    $('h').disabled = !fixed;
    $('h').value = Math.log10(state.h / base.limit);
    $('h-text').textContent = fixed ? length(runs.find((run) => run.scene.step > 0).scene.step) : 'adaptive';
    for (const [name, key] of [['k', 'stiffness'], ['d', 'damping']]) {
        const value = families[0]?.[1][name === 'k' ? 0 : 1] ?? 0;
        $(`${name}-row`).hidden = value === 0;
        $(name).value = state[name];
        $(`${name}-text`).textContent = `${Number((value * 10 ** state[name]).toPrecision(3))} ${name === 'k' ? 'N/m' : 'kg/s'}`;
        $(`${name}-row`).title = `${families[0]?.[0]} ${key}; the other springs change in proportion`;
    }
    writeLimits();
    drawLegend(state.plain ? null : STRAIN, document);
    history.replaceState(null, '', link());
}

/** How long steps may be, and whether they are longer. */
function writeLimits() {
    const { limit } = runs[0].scene;
    const parts = limit > 0 ? [`2/ω = ${length(limit)} of the stiffest vibration`] : [];
    for (const { scene } of runs) {
        if (scene.step > 0 && scene.stable > 0) {
            parts.push(`${scene.method} is stable up to ${length(scene.stable)}`);
        }
    }
    const over = runs.filter(({ scene }) => scene.step > 0 && scene.stable > 0 && scene.step > scene.stable);
    const warning = document.createElement('b');
    warning.textContent = over.length > 0 ? ` h is too long for ${over.map(({ scene }) => scene.method).join(' and ')}.` : '';
    $('limits').replaceChildren(parts.length > 0 ? `${parts.join('; ')}.` : '', warning);
}

/** Why it may have blown up: by how much a fixed step is too long. */
function cause({ scene }) {
    const by = scene.step / scene.stable;
    return scene.step > 0 && scene.stable > 0 && by > 1 ? `h is ${Number(by.toPrecision(2))} times the stable step` : '';
}

function blowUp(run) {
    if (!run.onset) {
        return run.over;
    }
    const when = run.numbers.steps > 0
        ? `${run.over ? 'blew' : 'blows'} up at t = ${run.onset.time.toFixed(4)} s` : 'blew up in its first step';
    const left = run.onset.particle ? `${run.onset.particle} left first` : '';
    const said = [left, cause(run)].filter(Boolean).join(', ');
    return said ? `${when}: ${said}` : when;
}

function caption(run) {
    const label = document.createElement('span');
    const name = document.createElement('b');
    name.textContent = run.scene.method;
    const step = document.createElement('i');
    const { steps, step: taken } = run.numbers;
    step.textContent = ` h = ${length(taken || run.scene.step)}, ${steps} ${steps === 1 ? 'step' : 'steps'}`;
    label.append(name, step);
    const said = blowUp(run);
    if (said) {
        const blown = document.createElement('b');
        blown.className = 'blown';
        blown.textContent = said;
        blown.title = run.over;
        label.append(blown);
    }
    return label;
}

function show() {
    page.times[0] = runs[0].numbers.time;
    const shown = stage?.show(0, state.plain ? null : STRAIN);
    $('scale').textContent = stage ? `floor: ${Number((stage.cell * (shown || 1)).toPrecision(3))} m a square` : '';
}

/** Not with each picture; what is skipped is written later, also where no picture follows. */
function writeCaptions() {
    if (!stale || performance.now() - captioned < CAPTIONS) {
        return;
    }
    captioned = performance.now();
    stale = false;
    $('labels').className = stage?.stacked ? 'stacked' : '';
    $('labels').replaceChildren(...runs.map(caption));
    const { frame, hash, time: now } = runs[0].numbers;
    $('clock').textContent = `${now.toFixed(3)} s`;
    $('last').textContent = `frame ${frame}: state ${hash}`;
    $('last').title = 'the hash of series.csv in a run of the program weft';
}

const pace = { pictures: 0, since: 0, time: 0 };

/** Pictures a second, and simulated seconds a second. */
function writePace(now) {
    const reached = runs[0].numbers.time;
    pace.pictures += 1;
    $('pace').dataset.took = Math.max(...runs.map((run) => run.took));
    $('canvas').dataset.strain = 100 * runs[0].blocks[0].range(3)[1];
    if (reached < pace.time) { // from the start again
        Object.assign(pace, { pictures: 0, since: now, time: reached });
    }
    if (now - pace.since > 1000) {
        const seconds = (now - pace.since) / 1000;
        const pictures = Math.round(pace.pictures / seconds);
        $('pace').textContent = `${pictures} ${pictures === 1 ? 'picture' : 'pictures'}/s, ${((reached - pace.time) / seconds).toFixed(2)}× real time`;
        Object.assign(pace, { pictures: 0, since: now, time: reached });
    }
}

/** The cloths that are behind step on; one that grows suddenly, a step a picture. */
function pump() {
    for (const run of runs.filter(({ over, busy, numbers, fresh }) => !over && !busy && numbers.time < time
        && !(fresh && numbers.sudden))) {
        run.advance(time, BUDGET, dragging.pull()).then(pump);
    }
}

/** Each picture: all cloths go to the same time, and the time waits for the slowest. */
function tick(now) {
    requestAnimationFrame(tick);
    const passed = Math.min((now - before) / 1000, LATEST) * state.rate;
    before = now;
    const going = runs.filter((run) => !run.over);
    if (playing && going.length > 0) {
        time = Math.min(time, Math.min(...going.map((run) => run.numbers.time)) + 1 / 60) + passed;
        pump();
    }
    if (runs.some((run) => run.fresh)) {
        runs.forEach((run) => { run.fresh = false; });
        show();
        writePace(now);
        stale = true;
    }
    writeCaptions();
    plot.draw(now);
}

async function step() {
    setPlaying(false);
    const going = runs.filter((run) => !run.over);
    await Promise.all(going.map((run) => run.advance(Infinity, 0)));
    time = Math.max(...runs.map((run) => run.numbers.time));
}

function setPlaying(on) {
    playing = on;
    $('play').classList.toggle('playing', on);
    $('play').setAttribute('aria-label', on ? 'pause' : 'run');
}

// ---- what is asked -------------------------------------------------------------------

const change = (values) => {
    Object.assign(state, values);
    if (base) { // else the text of a link is wrong
        start();
    }
};

const ACTIONS = {
    restart: () => start(),
    play: () => setPlaying(!playing),
    step,
    fit: () => {
        stage.moved = false;
        stage.fit();
    },
    theme: () => {
        toggleTheme();
        stage?.setInk(isDark());
        plot.start(runs);
    },
    link: async () => {
        history.replaceState(null, '', link());
        await navigator.clipboard?.writeText(location.href);
        $('link').textContent = 'copied';
        setTimeout(() => { $('link').textContent = 'link'; }, 1500);
    },
    versus: () => change({ method: 'velocity_verlet', other: 'euler', two: true }),
    run: () => {
        Object.assign(state, { scene: '', text: $('text').value });
        openScene();
    },
};

function listen() {
    for (const [id, action] of Object.entries(ACTIONS)) {
        $(id).addEventListener('click', () => (base || id === 'run') && action());
    }
    $('scene').addEventListener('change', () => {
        Object.assign(state, { scene: $('scene').value || state.scene, method: OWN });
        openScene();
    });
    $('method').addEventListener('change', () => change({ method: $('method').value }));
    $('other').addEventListener('change', () => change({ other: $('other').value, two: true }));
    $('two').addEventListener('change', () => change({ two: $('two').checked }));
    $('h').addEventListener('input', () => change({ h: (base?.limit ?? 1) * 10 ** $('h').valueAsNumber }));
    $('k').addEventListener('input', () => change({ k: $('k').valueAsNumber }));
    $('d').addEventListener('input', () => change({ d: $('d').valueAsNumber }));
    $('rate').addEventListener('change', () => {
        state.rate = Number($('rate').value);
        write();
    });
    $('plain').addEventListener('change', () => {
        state.plain = $('plain').checked;
        write();
    });
    $('text').addEventListener('keydown', (event) => {
        if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) {
            ACTIONS.run();
        }
    });
    const keys = { ' ': 'play', ArrowRight: 'step', Home: 'restart', r: 'fit', d: 'theme' };
    document.addEventListener('keydown', (event) => {
        if (keys[event.key] && !event.ctrlKey && !event.metaKey && !event.target.matches('textarea, select, input, button')) {
            event.preventDefault();
            $(keys[event.key]).click();
        }
    });
    new ResizeObserver(() => {
        stage?.resize();
        plot.resize();
    }).observe($('stage'));
    onPreference(() => stage?.setInk(isDark()));
}

function fill() {
    const option = (value, text = value) => new Option(text, value);
    $('scene').append(...names.map((name) => option(name)), option('', 'own text'));
    $('scene').lastChild.hidden = true;
    $('method').append(option(OWN), ...Object.keys(PLUGIN).map((name) => option(name)));
    $('other').append(...Object.keys(PLUGIN).map((name) => option(name)));
    $('rate').append(...RATES.map((rate) => option(rate, rate < 1 ? `1/${1 / rate}×` : '1×')));
}

const loading = WebAssembly.compile(bytesOf($('wasm').textContent));
const script = URL.createObjectURL(new Blob([$('worker').textContent], { type: 'text/javascript' }));
let module = null;
const inMemory = Object.entries(files).map(([name, text]) => [name, new TextEncoder().encode(text)]);
const makeRun = () => new Run(script, module, inMemory);
const dragging = new Dragging($('canvas'), () => ({ stage, runs }));

async function begin() {
    const whole = location.hash.length < 2 || readLink();
    fill();
    listen();
    document.body.inert = true; // nothing to change yet
    module = await loading;
    reader = makeRun();
    const { h, k, d } = state;
    await openScene(h > 0 ? { h, k, d } : {});
    document.body.inert = false;
    if (!whole) {
        $('mistake').textContent = 'The link holds no scene: it may have been cut off.';
        $('mistake').hidden = false;
    }
    requestAnimationFrame(tick);
    document.documentElement.dataset.ready = Math.round(performance.now());
}

begin();
