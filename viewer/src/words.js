// SPDX-License-Identifier: BSD-3-Clause
// words.js -- what the page says of the runs. All text goes in as text, never as HTML.
import { leaver } from './data.js';
import { batch, chosen } from './source.js';
import { parameters } from './values.js';

const element = (tag, text, className = '') => {
    const made = document.createElement(tag);
    made.textContent = text;
    made.className = className;
    return made;
};

const power = (text) => (Number(text) < 1e-3 ? Number(text).toExponential() : Number(text));
const grouped = (text) => Number(text).toLocaleString('en').replaceAll(',', '\u202f');

export const runName = (run) => run.report.get('name') || run.directory;

export const stepperName = (run) => {
    const [plugin, method] = [run.report.get('plugin.id'), run.report.get('method.name')];
    return plugin && method ? `${plugin} ${method}` : '';
};

/** Tolerance or step, the choice that tells runs of one method apart. */
export const stepperChoice = (run) => {
    const fixed = run.report.get('stepper.fixed_step');
    const asked = run.report.get('stepper.fixed_step_asked');
    const rtol = run.report.get('stepper.rtol');
    const short = (h) => power(Number(Number(h).toPrecision(6)));
    return fixed ? `h = ${short(fixed)} s${asked ? ` (at most ${short(asked)} s asked)` : ''}` : rtol ? `rtol ${power(rtol)}` : '';
};

function facts(run) {
    const { outcome } = run;
    const list = [stepperName(run), stepperChoice(run)];
    for (const [key, text] of [['steps', 'steps'], ['rejected', 'rejected'], ['rhs_calls', 'force evaluations']]) {
        if (outcome.has(key)) {
            list.push(`${grouped(outcome.get(key))} ${text}`);
        }
    }
    if (outcome.has('wall_time')) {
        list.push(`${Number(Number(outcome.get('wall_time')).toPrecision(3))} s of wall time`);
    }
    return list.filter(Boolean);
}

function status(run) {
    const { outcome } = run;
    if (run.result === null) {
        return 'no result.yaml: still running, or killed';
    }
    const reason = outcome.get('reason');
    return outcome.get('status') === 'done' ? '' : `${outcome.get('status')}${reason ? `: ${reason}` : ''}`;
}

const ROUND = [1, 2, 5, 10];
const ENOUGH = 10; // frames in which an onset is seen

/** How to record more frames of the onset, if there are few. */
function moreFrames(run, t) {
    const wanted = (5 * ENOUGH) / t;
    const power = 10 ** Math.floor(Math.log10(wanted));
    const fps = power * ROUND.find((m) => m * power >= wanted);
    return run.calm < ENOUGH ? `Record more frames of the onset with --set run.fps=${fps} --set run.duration=${Number((2 * t).toPrecision(2))}` : '';
}

/** "B blows up at 0.034 s: particle (0, 23) leaves the picture" */
function leaving(page, run, r) {
    const who = page.runs.length > 1 ? `${'AB'[r]} ` : '';
    return run.blown ? `${who}blows up at ${page.times[run.calm].toFixed(3)} s: ${leaver(page, run)} leaves the picture` : '';
}

/** What a run that blows up is shown as. */
function blowUp(page) {
    const said = page.runs.map((run, r) => leaving(page, run, r)).filter(Boolean).join(', ');
    if (page.all) {
        return [said, 'every frame has a scale of its own, colours and plots have powers of ten'];
    }
    const more = page.runs.map((run) => run.blown && moreFrames(run, page.times[run.calm])).find(Boolean);
    return [said, 'view, colours and plots fit the frames before, in which the cloth is at most twice as large as '
        + 'at the start; strain has powers of ten up to 100 %', more].filter(Boolean);
}

/** What has left each pane, and which frame it shows. */
export function writeCaptions(page, frame) {
    const { times } = page;
    document.querySelectorAll('#labels .caption').forEach((caption, r) => {
        const run = page.runs[r];
        const gone = run.blown && !page.all && frame >= run.calm;
        const shown = frame > run.held ? `; shown as at ${times[run.held].toFixed(3)} s` : '';
        caption.textContent = gone ? `${leaver(page, run)} left the picture at ${times[run.calm].toFixed(3)} s${shown}` : '';
    });
}

/** Of a run under way: 'live', 'lost' or 'over'. */
export function writeLive(page, how) {
    const [run] = page.runs;
    const words = { live: 'under way', lost: 'under way; its server does not answer' };
    const line = document.querySelector('#summary .run');
    line.replaceChildren(...facts(run).map((fact) => element('span', fact, 'fact')));
    if (words[how]) {
        line.append(element('span', words[how], how === 'live' ? 'fact live' : 'fact bad'));
    }
}

/** What is not shown, and why. */
function omissions(page) {
    const said = [];
    if (page.times.length < page.chosen && page.runs[0].live) {
        said.push(`${page.times.length} of ${page.chosen} frames: those that came in time`);
    } else if (page.times.length < page.chosen) {
        const step = page.runs[0].index[1] - page.runs[0].index[0];
        said.push(`thinned to ${page.times.length} of ${page.chosen} frames (every ${step}. and the last) to keep the page small`);
    }
    if (page.stride > 1) {
        said.push(`thinned to every ${page.stride}. of ${page.grid.join(' × ')} particles a side`);
    }
    const most = Math.max(...page.runs.map((run) => run.frames));
    if (page.chosen < most) {
        said.push(`shown at the ${page.chosen} times that both runs have`);
    }
    return said;
}

/** The way back to the batch that the run is of, and to all of its frames. */
function writeWay(page) {
    const link = (href, text) => Object.assign(element('a', text), { href });
    if (chosen) {
        const way = element('p', '');
        way.id = 'way';
        const where = parameters(batch).map((p) => `${p.label} ${p.words(p.text(chosen))}`).join(', ');
        way.append(link('?', `all runs of ${batch.directory}`), `\u00a0\u00b7 run ${chosen.number}${where && `: ${where}`}`);
        if (chosen.page && page.times.length < page.chosen) {
            way.append('\u00a0\u00b7 ', link(chosen.page, 'every frame of this run'));
        }
        document.querySelector('header').prepend(way);
    }
}

export function writeHeader(page) {
    writeWay(page);
    const names = [...new Set(page.runs.map(runName))];
    document.title = `${names.join(' / ')} - weft`;
    document.getElementById('name').textContent = names.join(' / ');
    const summary = document.getElementById('summary');
    const particles = page.mesh
        ? `${page.mesh.vertices} vertices, ${page.mesh.triangles} triangles${page.mesh.cloths ? ` in ${page.mesh.cloths.length} cloths` : ''}`
        : `${page.grid.join(' × ')} particles`;
    summary.append(element('span', particles, 'fact'));
    page.runs.forEach((run, i) => {
        const line = element('span', '', 'run');
        if (page.runs.length > 1) {
            line.append(element('b', 'AB'[i]));
        }
        facts(run).forEach((fact) => line.append(element('span', fact, 'fact')));
        summary.append(line);
    });
}

/** One line: what has gone wrong, and what is left out. */
export function writeNotes(page, isLive = false) {
    const failed = page.runs.map((run, r) => {
        const text = isLive ? '' : status(run);
        return text && page.runs.length > 1 ? `${'AB'[r]} ${text}` : text;
    }).filter(Boolean);
    const bad = [...page.blown ? blowUp(page).slice(0, 1) : [], ...failed];
    const rest = [...page.blown ? blowUp(page).slice(1) : [], ...omissions(page)];
    document.getElementById('said').replaceChildren(...bad.map((text) => element('span', text, 'fact bad')), ...rest.map((text) => element('span', text, 'fact')));
    document.getElementById('notes').hidden = bad.length + rest.length === 0;
    foldNotes();
}

/** Whether there is more than a line. */
export function foldNotes() {
    const [notes, said, more] = ['notes', 'said', 'more'].map((id) => document.getElementById(id));
    const isOpen = notes.classList.contains('open');
    more.hidden = !isOpen && said.scrollWidth <= said.clientWidth;
    more.textContent = isOpen ? 'less' : 'more';
    more.setAttribute('aria-expanded', isOpen);
}

/** What tells the panes apart, where there is more than one. */
export function writeLabels(page, stacked) {
    const labels = document.getElementById('labels');
    labels.className = stacked ? 'stacked' : '';
    const steppers = new Set(page.runs.map((run) => stepperName(run) + stepperChoice(run)));
    const alike = steppers.size < page.runs.length || steppers.has('');
    labels.replaceChildren(...page.runs.map((run, i) => {
        const label = element('span', '');
        if (page.runs.length > 1) {
            label.append(element('b', 'AB'[i]), ` ${alike ? run.directory : stepperName(run)} `, element('i', alike ? '' : stepperChoice(run)));
        }
        label.append(element('em', '', 'caption'));
        return label;
    }));
}

export function writeFiles(page) {
    const list = document.getElementById('files');
    for (const run of page.runs) {
        for (const name of ['scene', 'manifest', 'result']) {
            if (run[name]) {
                const details = document.createElement('details');
                details.append(element('summary', `${run.directory}/${name}.yaml`), element('pre', run[name]));
                list.append(details);
            }
        }
    }
    list.append(element('p', `made by weft ${page.weft}; three and uPlot inside, licences in the source of this page`));
}
