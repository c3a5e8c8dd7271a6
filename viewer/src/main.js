// SPDX-License-Identifier: BSD-3-Clause
// main.js -- one state (frame, colour, rate, playing), and what follows from it.
import { Film, savePicture } from './capture.js';
import { drawLegend, quantities } from './colours.js';
import { boxes, readPage } from './data.js';
import { follow, isLive } from './live.js';
import { nearest, Plots } from './plots.js';
import { gaps } from './shapes.js';
import { fileName } from './save.js';
import { root } from './source.js';
import { isSoftware, Stage } from './stage.js';
import { placeTip } from './tip.js';
import { isDark, onPreference, toggleTheme } from './theme.js';
import { foldNotes, writeCaptions, writeFiles, writeHeader, writeLabels, writeLive, writeNotes } from './words.js';

const RATES = [0.01, 0.03, 0.1, 0.25, 0.5, 1, 2, 4];
const ONSET = 3; // s that the onset of a blow-up is played, at least
const VISIBLE = 0.01; // strain that is worth a colour
const RENEWAL = 500; // ms between two redraws of the plots of a live run
const THREADS_BELOW = 50; // particles along a side: more would be a grey veil
const $ = (id) => document.getElementById(id);
const asked = new URLSearchParams(location.hash.slice(1)); // #frame=30&colour=strain&all=1&play=0&quality=fine

const page = readPage(root);
const live = isLive(page);
page.all = page.blown && asked.get('all') === '1';
const { times } = page;
let colours = [null, ...quantities(page)];
const state = { frame: 0, colour: firstColour(), rate: RATES.indexOf(1), playing: false };
let stage = null;
let film = null;
try {
    const fine = asked.get('quality') ? asked.get('quality') === 'fine' : !isSoftware();
    stage = new Stage($('canvas'), page, boxes(page), fine);
} catch {
    $('no-webgl').hidden = false;
}
const plots = new Plots(page, $('plots'), (t) => {
    pause();
    seek(nearest(times, t));
});

/** Strain where there is some; of two runs their difference, unless it has no bounds. */
function firstColour() {
    const [difference, strain] = ['difference', 'strain'].map((name) => colours.findIndex((c) => c?.name === name));
    const first = difference > 0 && !page.blown ? difference : strain;
    if (page.surface.cloths.length > 0 && !page.blown && first !== difference) {
        return 0; // by cloths
    }
    return first === difference || page.blown || colours[first]?.most > VISIBLE ? Math.max(first, 0) : 0;
}

/** The last frame in which anything changes: of a run that blows up, the one after it has left. */
const lastShown = () => (page.all ? times.length - 1
    : Math.min(times.length - 1, Math.max(...page.runs.map((run) => (run.blown ? run.held + 1 : times.length - 1)))));

function seek(frame) {
    state.frame = Math.min(Math.max(Math.round(frame), 0), times.length - 1);
    const t = times[state.frame];
    const number = page.runs[0].numbers[state.frame];
    const scale = stage?.show(state.frame, colours[state.colour]);
    $('scale').textContent = stage ? `floor: ${Number((stage.cell * scale).toPrecision(3))} m a square` : '';
    plots.show(state.frame);
    writeCaptions(page, state.frame);
    $('scrub').value = state.frame;
    $('scrub').setAttribute('aria-valuetext', `frame ${number}, ${t.toFixed(3)} s`);
    $('clock').textContent = `${t.toFixed(3)} s`;
    $('clock').title = `frame ${number} of ${page.runs[0].numbers.at(-1)}`;
    $('canvas').setAttribute('aria-label', `the cloth at ${t.toFixed(3)} s, frame ${number}`);
    film?.take();
}

function tick(now) {
    if (!state.playing) {
        return;
    }
    const t = state.from.t + (RATES[state.rate] * (now - state.from.now)) / 1000;
    let frame = state.frame;
    const last = lastShown();
    while (frame < last && times[frame + 1] <= t) {
        ++frame;
    }
    if (film && frame > state.frame) { // a film has every frame, however slow the computer
        frame = state.frame + 1;
        state.from = { t: times[frame], now: performance.now() };
    }
    if (frame !== state.frame) {
        seek(frame);
    }
    if (frame >= last) {
        pause();
    } else {
        requestAnimationFrame(tick);
    }
}

function setPlaying(on) {
    state.playing = on;
    $('play').classList.toggle('playing', on);
    $('play').setAttribute('aria-label', on ? 'pause' : 'play');
}

function pause() {
    setPlaying(false);
    endFilm();
}

function play() {
    if (times.length < 2) {
        return;
    }
    if (state.frame >= lastShown()) {
        seek(0);
    }
    setPlaying(true);
    state.from = { t: times[state.frame], now: performance.now() };
    requestAnimationFrame(tick);
}

const toggle = () => (state.playing ? pause() : play());

function step(by) {
    pause();
    seek(state.frame + by);
}

function setColour(index) {
    state.colour = (index + colours.length) % colours.length;
    $('colour').selectedIndex = state.colour;
    drawLegend(colours[state.colour], document, page.surface.cloths);
    seek(state.frame);
}

function setRate(index) {
    state.rate = Math.min(Math.max(index, 0), RATES.length - 1);
    $('rate').selectedIndex = state.rate;
    state.from = { t: times[state.frame], now: performance.now() };
}

/** The flat rest shape of triangles beside the cloth. */
function setRest(on) {
    $('rest').checked = on && Boolean(page.surface.rest);
    stage?.setRest($('rest').checked);
    stage?.setInk(isDark());
    setThreads($('threads').checked);
    seek(state.frame);
}

function setThreads(on) {
    $('threads').checked = on;
    stage?.setThreads(on);
}

/** Of a run that blows up: fit every finite frame, or those before. */
function setAll(on) {
    page.all = page.blown && on;
    $('all').checked = page.all;
    colours = [null, ...quantities(page)];
    writeNotes(page);
    plots.collect();
    plots.draw();
    setColour(state.colour);
}

// ---- a run under way ------------------------------------------------------------------

let renewal = 0;
let underWay = live;

/** Colours, plots and notes of the frames that there are now. */
function renew() {
    renewal = 0;
    colours = [null, ...quantities(page)];
    $('fit-all').hidden = !page.blown;
    if (stage?.widen(boxes(page))) {
        stage.setInk(isDark());
        stage.setThreads($('threads').checked);
    }
    plots.collect();
    plots.draw();
    writeNotes(page, underWay);
    drawLegend(colours[state.colour], document, page.surface.cloths);
    seek(state.frame);
}

/** A page that shows the last frame follows the run. */
function onNews() {
    const last = Number($('scrub').max);
    $('scrub').max = times.length - 1;
    if (state.frame === last && !state.playing) {
        seek(times.length - 1);
    }
    renewal ||= setTimeout(renew, RENEWAL);
}

function onChange(how) {
    writeLive(page, how);
    if (how === 'over') {
        underWay = false;
        renew();
    }
}

function applyTheme() {
    stage?.setInk(isDark());
    plots.draw();
}

function switchTheme() {
    toggleTheme();
    applyTheme();
}

function showHelp() {
    if ($('keys').open) {
        $('keys').close();
    } else {
        $('keys').showModal();
    }
}

/** The cloth of this frame, or of all frames, into the view. */
function fit(close) {
    if (stage) {
        stage.moved = false;
        stage.fit(close);
    }
}

function setFollowing(on) {
    $('follow').checked = on;
    stage?.setFollowing(on);
}

/** Plays the run from its start into a film; once more: ends it there. */
function record() {
    if (film) {
        pause();
        return;
    }
    seek(0);
    film = new Film(stage, `${fileName(page.runs[0].directory)}.webm`);
    $('webm').setAttribute('aria-pressed', 'true');
    play();
}

function endFilm() {
    if (!film) {
        return;
    }
    film.end();
    film = null;
    $('webm').setAttribute('aria-pressed', 'false');
}

const KEYS = {
    ' ': toggle,
    ArrowLeft: (event) => step(event.shiftKey ? -10 : -1),
    ArrowRight: (event) => step(event.shiftKey ? 10 : 1),
    Home: () => step(-Infinity),
    End: () => step(Infinity),
    '+': () => setRate(state.rate + 1),
    '=': () => setRate(state.rate + 1),
    '-': () => setRate(state.rate - 1),
    c: () => setColour(state.colour + 1),
    t: () => setThreads(!$('threads').checked),
    p: () => setRest(!$('rest').checked),
    a: () => setAll(!page.all),
    r: () => fit(true),
    R: () => fit(false),
    f: () => setFollowing(!$('follow').checked),
    d: switchTheme,
    '?': showHelp,
};

/** Keys that an element under the focus needs itself. */
const taken = (target, key) => target.matches('select') || $('keys').open
    || (target.matches('button, summary, [type=checkbox]') && key === ' ');

function onKey(event) {
    const action = KEYS[event.key];
    if (action && !event.ctrlKey && !event.metaKey && !event.altKey && !taken(event.target, event.key)) {
        event.preventDefault();
        action(event);
    }
}

/** The name of the cloth under the pointer, of several. */
function nameCloth(event) {
    const name = event.buttons === 0 && event.type !== 'pointerleave' ? stage.clothAt(event) : null;
    $('tip').hidden = !name;
    $('tip').textContent = name ?? '';
    if (name) {
        placeTip($('tip'), event);
    }
}

function fillChoices() {
    const option = (text) => new Option(text);
    $('colour').append(...colours.map((c) => option(c ? c.name : 'plain')));
    $('rate').append(...RATES.map((rate) => option(`${rate}×`)));
    $('scrub').max = times.length - 1;
    $('fit-all').hidden = !page.blown;
    $('all').checked = page.all;
    $('rest-shape').hidden = !page.surface.rest;
}

function listen() {
    const on = (id, type, action) => $(id).addEventListener(type, action);
    on('play', 'click', toggle);
    on('first', 'click', () => step(-Infinity));
    on('last', 'click', () => step(Infinity));
    on('scrub', 'input', () => {
        pause();
        seek(Number($('scrub').value));
    });
    on('colour', 'change', () => setColour($('colour').selectedIndex));
    on('rate', 'change', () => setRate($('rate').selectedIndex));
    on('threads', 'change', () => setThreads($('threads').checked));
    on('rest', 'change', () => setRest($('rest').checked));
    on('all', 'change', () => setAll($('all').checked));
    on('follow', 'change', () => setFollowing($('follow').checked));
    on('reset', 'click', (event) => fit(!event.shiftKey));
    on('png', 'click', () => savePicture(stage, `${fileName(`${page.runs[0].directory}-frame-${page.runs[0].numbers[state.frame]}`)}.png`));
    on('webm', 'click', record);
    on('full', 'click', () => (document.fullscreenElement ? document.exitFullscreen() : $('player').requestFullscreen()));
    on('others', 'click', () => {
        $('others').setAttribute('aria-expanded', $('controls').classList.toggle('open'));
    });
    on('more', 'click', () => {
        $('notes').classList.toggle('open');
        foldNotes();
    });
    on('theme', 'click', switchTheme);
    on('help', 'click', showHelp);
    addEventListener('keydown', onKey);
    onPreference(applyTheme);
    if (stage && page.surface.cloths.length > 0) {
        ['pointermove', 'pointerdown', 'pointerleave'].forEach((type) => on('canvas', type, nameCloth));
    }
    stage?.controls.addEventListener('start', () => { stage.moved = true; });
}

function start() {
    writeHeader(page);
    writeNotes(page, underWay);
    writeFiles(page);
    fillChoices();
    listen();
    new ResizeObserver(foldNotes).observe($('said'));
    writeLabels(page, false);
    if (stage) {
        new ResizeObserver(() => {
            stage.resize();
            writeLabels(page, stage.stacked);
            writeCaptions(page, state.frame);
        }).observe($('canvas'));
        stage.resize();
    }
    ['png', 'webm', 'follow'].forEach((id) => { $(id).disabled = !stage; });
    applyTheme();
    if (page.blown && !page.all) { // slow enough to be seen
        const until = times[Math.min(lastShown(), times.length - 1)] - times[0];
        state.rate = Math.max(RATES.findLastIndex((rate) => rate <= 1 && until / rate >= ONSET), 0);
    }
    setRate(state.rate);
    setThreads(asked.has('threads') ? asked.get('threads') === '1' : page.surface.fine < THREADS_BELOW);
    const wanted = colours.findIndex((c) => (c ? c.name : 'plain') === asked.get('colour'));
    setColour(wanted < 0 ? state.colour : wanted);
    if (asked.get('rest') === '1') {
        setRest(true);
    }
    seek(Number(asked.get('frame') ?? (live ? Infinity : 0)) || 0);
    setFollowing(asked.has('follow') ? asked.get('follow') === '1' : stage?.following);
    stage?.fit(stage.following);
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (live) {
        follow(page, { news: onNews, changed: onChange });
    } else if (asked.get('play') !== '0' && !asked.has('frame') && !calm) {
        play();
    }
    document.documentElement.dataset.ready = '';
}

start();

/** For tests and for the console. */
window.weft = { page, state, stage, plots, seek, play, pause, setColour, gaps };
