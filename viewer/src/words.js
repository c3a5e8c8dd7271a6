// SPDX-License-Identifier: BSD-3-Clause
// words.js -- what the page says of the runs. All text goes in as text, never as HTML.
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

/** Of a run under way: 'live', 'lost' or 'over'. */
export function writeLive(page, how) {
    const [run] = page.runs;
    const words = { live: 'under way', lost: 'under way; its server does not answer' };
    const line = document.querySelector('#summary .run');
    line.replaceChildren(...facts(run).map((fact) => element('span', fact, 'fact')));
    const text = how === 'over' ? status(run) : words[how];
    if (text) {
        line.append(element('span', text, how === 'live' ? 'fact live' : 'fact bad'));
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
    if (page.blown) {
        said.push(`blows up by ${page.times[page.calm].toFixed(3)} s: ${page.all
            ? 'every frame has a scale of its own, colours and plots have powers of ten'
            : 'view, colours and plots fit the frames before'}`);
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
        const where = parameters(batch).map((p) => `${p.label} ${p.text(chosen)}`).join(', ');
        way.append(link('?', `all runs of ${batch.directory}`), ` \u00b7 run ${chosen.number}${where && `: ${where}`}`);
        if (chosen.page && page.times.length < page.chosen) {
            way.append(' \u00b7 ', link(chosen.page, 'every frame of this run'));
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
        ? `${page.mesh.vertices} vertices, ${page.mesh.triangles} triangles`
        : `${page.grid.join(' × ')} particles`;
    summary.append(element('span', particles, 'fact'));
    page.runs.forEach((run, i) => {
        const line = element('span', '', 'run');
        if (page.runs.length > 1) {
            line.append(element('b', 'AB'[i]));
        }
        facts(run).forEach((fact) => line.append(element('span', fact, 'fact')));
        if (status(run)) {
            line.append(element('span', status(run), 'fact bad'));
        }
        summary.append(line);
    });
}

export function writeNotes(page) {
    const notes = document.getElementById('notes');
    notes.replaceChildren(...omissions(page).map((text) => element('span', text, 'fact')));
    notes.hidden = notes.childElementCount === 0;
}

/** What tells the panes apart, where there is more than one. */
export function writeLabels(page, stacked) {
    const labels = document.getElementById('labels');
    labels.className = stacked ? 'stacked' : '';
    const steppers = new Set(page.runs.map((run) => stepperName(run) + stepperChoice(run)));
    const alike = steppers.size < page.runs.length || steppers.has('');
    labels.replaceChildren(...(page.runs.length < 2 ? [] : page.runs.map((run, i) => {
        const label = element('span', '');
        label.append(element('b', 'AB'[i]), ` ${alike ? run.directory : stepperName(run)} `, element('i', alike ? '' : stepperChoice(run)));
        return label;
    })));
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
