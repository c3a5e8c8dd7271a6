// SPDX-License-Identifier: BSD-3-Clause
// batch.js -- all runs of a batch: their results against the parameters, and a table.
import { HeatMap } from './heat.js';
import { Scatter } from './scatter.js';
import { batch } from './source.js';
import { onPreference, toggleTheme } from './theme.js';
import { placeTip } from './tip.js';
import { differs, element, firstShown, parameters, quantities, STATISTICS, titleOf } from './values.js';

const MOST_ROWS = 1000; // of the table: more would be slow
const $ = (id) => document.getElementById(id);
const { runs } = batch;
const varied = parameters(batch);
const known = quantities(batch);
const asked = new URLSearchParams(location.hash.slice(1)); // #x=stiffness&y=damping&value=max_strain&of=largest&sort=...&down=1

const called = (list, name, index) => list.find((one) => one.label === name) ?? list[index] ?? null;
const first = firstShown(known, runs);
const state = {
    x: called(varied, asked.get('x'), 0),
    y: asked.get('y') === '' ? null : called(varied, asked.get('y'), 1),
    value: called(known, asked.get('value')) ?? first.value,
    of: asked.has('of') || asked.has('value') ? Math.max(STATISTICS.indexOf(asked.get('of')), 0) : first.of,
    log: asked.has('log') ? asked.get('log') === '1' : null, // null: where values reach far
    sort: asked.get('sort') ?? '',
    down: asked.get('down') === '1',
    only: null, // runs of a cell of the heat map
};

const href = (run) => (run.root ? `?run=${encodeURIComponent(run.name)}` : run.page);
const short = (v) => (v !== 0 && (Math.abs(v) < 1e-3 || Math.abs(v) >= 1e6)
    ? v.toExponential(2).replace('+', '') : Number(v.toPrecision(4)).toString());

/** The state, in the address: a page that was left is found as it was. */
function remember() {
    const now = new URLSearchParams({
        x: state.x?.label ?? '', y: state.y?.label ?? '', value: state.value?.label ?? '', of: STATISTICS[state.of],
        sort: state.sort, down: state.down ? '1' : '0', ...(state.log === null ? {} : { log: state.log ? '1' : '0' }),
    });
    history.replaceState(null, '', `${location.search}#${now}`);
}

// ---- the table ----------------------------------------------------------------------

const LEFT_OUT = new Set(['hash', 'directory', 'reason', 'frames', 'energy_start']);
const isEmpty = (name) => runs.every((run) => run.text(name) === '');

/** Name, heading, and text of a run in each column; the chosen quantity is beside the status. */
function columns() {
    const of = (name, heading = titleOf(name), words = null) => ({ name, heading, words, text: (run) => run.text(name) });
    const rest = batch.names.slice(batch.names.indexOf('status') + 1).filter((name) => !LEFT_OUT.has(name) && !isEmpty(name));
    const { value } = state;
    const chosen = value && {
        name: 'value', heading: value.title(state.of), chosen: true,
        text: (run) => { const v = value.of(run, state.of); return Number.isFinite(v) ? String(v) : ''; },
    };
    return [
        { name: '', heading: 'run', text: (run) => String(run.number) },
        ...varied.map((p) => of(p.name, p.title, p.words)),
        of('status'),
        ...[chosen].filter(Boolean),
        ...rest.filter((name) => name !== value?.label).map((name) => of(name)),
    ];
}

const isNumber = (text) => text !== '' && Number.isFinite(Number(text));
const shown = (text) => (isNumber(text) && !/^\d+$/.test(text) ? short(Number(text)) : text);

/** Numbers before words, empty cells last whichever way. */
function compare(a, b, sign) {
    if (a === '' || b === '') {
        return (a === '') - (b === '');
    }
    const [numberA, numberB] = [a, b].map(isNumber);
    return sign * (numberA && numberB ? a - b : numberB - numberA || a.localeCompare(b));
}

function sorted() {
    const words = $('search').value.toLowerCase().split(' ');
    const column = columns().find(({ name }) => name === state.sort);
    const kept = runs.filter((run) => (!state.only || state.only.includes(run))
        && words.every((word) => `${run.name} ${run.text('status')}`.toLowerCase().includes(word)));
    const keyed = kept.map((run) => [column ? column.text(run) : '', run]);
    keyed.sort(([a, runA], [b, runB]) => compare(a, b, state.down ? -1 : 1) || runA.number - runB.number);
    return keyed.map(([, run]) => run);
}

function link(run, text) {
    const made = element(href(run) ? 'a' : 'span', '', text);
    made.title = href(run) ? `play ${run.name}` : `${run.name} has no frames in this page`;
    if (href(run)) {
        made.href = href(run);
    }
    return made;
}

function row(run, list) {
    const made = element('tr', run.done ? '' : 'undone');
    made.append(...list.map(({ name, text, chosen, words }) => {
        const told = text(run);
        const cell = element('td', [isNumber(told) ? 'number' : '', chosen ? 'chosen' : ''].join(' '), name === '' ? link(run, told) : words?.(told) ?? shown(told));
        cell.title = name === 'status' ? run.text('reason') : words ? told : '';
        return cell;
    }));
    made.run = run;
    return made;
}

function heading({ name, heading: words, chosen }) {
    const button = element('button', '', words);
    button.addEventListener('click', () => {
        state.down = state.sort === name && !state.down;
        state.sort = name;
        drawTable();
        remember();
    });
    const made = element('th', chosen ? 'chosen' : '', button);
    made.scope = 'col';
    made.ariaSort = state.sort !== name ? 'none' : state.down ? 'descending' : 'ascending';
    return made;
}

function drawTable() {
    const list = columns();
    const found = sorted();
    const head = element('tr');
    head.append(...list.map(heading));
    $('runs').tHead.replaceChildren(head);
    $('runs').tBodies[0].replaceChildren(...found.slice(0, MOST_ROWS).map((run) => row(run, list)));
    $('found').textContent = found.length > MOST_ROWS ? `the first ${MOST_ROWS} of ${found.length} runs`
        : found.length < runs.length ? `${found.length} of ${runs.length} runs` : '';
    $('everything').hidden = !state.only;
}

// ---- plots --------------------------------------------------------------------------

function tip(run, text, event) {
    $('tip').hidden = !run;
    if (run) {
        const where = varied.map((p) => `${p.label} ${p.words(run.text(p.name))}`).join(', ');
        $('tip').replaceChildren(element('b', '', text), `run ${run.number}: ${where || run.name}`);
        placeTip($('tip'), event);
    }
}

function open(run) {
    if (href(run)) {
        location.href = href(run);
    }
}

const heat = new HeatMap($('heat'), short, {
    tip,
    open(list) {
        if (list.length === 1) {
            open(list[0]);
        } else {
            state.only = list;
            drawTable();
            $('runs').scrollIntoView({ block: 'nearest' });
        }
    },
});
const actions = { tip, open, choose: (value) => choose('value', value) };
const main = new Scatter($('main'), 236, short, actions);
const small = new Scatter($('small'), 150, short, actions);

function drawPlots() {
    const done = runs.filter((run) => run.done);
    heat.draw(state, runs);
    main.draw(state, done, [state.value].filter(Boolean), $('inks'));
    small.draw(state, done, known.filter((value) => differs(value, done)));
    const left = runs.length - done.length;
    $('undone').textContent = left > 0 && state.x ? `${left} ${left === 1 ? 'run is' : 'runs are'} not done: no points${$('heat').hidden ? '' : ', stripes on the map'}` : '';
}

function draw() {
    ['x', 'y'].forEach((axis) => { $(axis).value = state[axis]?.label ?? ''; });
    $('value').value = state.value?.label ?? '';
    $('of').selectedIndex = state.of;
    $('log').value = state.log === null ? '' : Number(state.log);
    drawPlots();
    drawTable();
    remember();
}

function choose(what, one) {
    const other = what === 'x' ? 'y' : 'x';
    if (varied.includes(one) && state[other] === one) {
        state[other] = state[what];
    }
    state[what] = one;
    draw();
}

// ---- the page -----------------------------------------------------------------------

function fillWords() {
    const counts = Map.groupBy(runs, (run) => run.text('status'));
    $('name').textContent = `${batch.directory}: ${runs.length === 1 ? '1 run' : `${runs.length} runs`}`;
    document.title = `${$('name').textContent} - weft`;
    $('summary').append(...[...counts].map(([status, list]) => element('span', status === 'done' ? 'fact' : 'fact bad', `${list.length} ${status}`)));
    $('made').textContent = `made by weft ${batch.weft}; three and uPlot inside, licences in the source of this page`;
}

function fillChoices() {
    const options = (list) => list.map(({ label, title }) => new Option(title, label));
    $('x').append(...options(varied));
    $('y').append(new Option('nothing else', ''), ...options(varied));
    $('value').append(...known.map(({ label }) => new Option(titleOf(label), label)));
    $('of').append(...STATISTICS.map((name) => new Option(name)));
    $('asked').hidden = known.length === 0;
    $('against').hidden = varied.length === 0;
}

function listen() {
    ['x', 'y'].forEach((axis) => $(axis).addEventListener('change', () => choose(axis, called(varied, $(axis).value))));
    $('value').addEventListener('change', () => choose('value', called(known, $('value').value)));
    $('of').addEventListener('change', () => choose('of', $('of').selectedIndex));
    $('log').addEventListener('change', () => choose('log', $('log').value === '' ? null : $('log').value === '1'));
    $('search').addEventListener('input', drawTable);
    $('everything').addEventListener('click', () => {
        state.only = null;
        drawTable();
    });
    $('runs').tBodies[0].addEventListener('click', (event) => {
        const { run } = event.target.closest('tr') ?? {};
        if (run && !event.target.closest('a') && String(getSelection()) === '') {
            open(run);
        }
    });
    const theme = () => {
        toggleTheme();
        drawPlots();
    };
    $('batch-theme').addEventListener('click', theme);
    onPreference(drawPlots);
    addEventListener('keydown', (event) => {
        if (event.key === 'd' && event.target.localName !== 'input' && !event.ctrlKey && !event.metaKey && !event.altKey) {
            theme();
        }
    });
}

document.body.className = 'of-batch';
document.getElementById('player').remove();
document.getElementById('batch').hidden = false;
fillWords();
fillChoices();
listen();
draw();
document.documentElement.dataset.ready = '';
/** For tests and for the console. */
window.weft = { batch, state, varied, known, choose, sorted, main, small };
