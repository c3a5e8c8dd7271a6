// SPDX-License-Identifier: BSD-3-Clause
// chart.js -- a drawn plot as SVG and its numbers as CSV, and the buttons that save them.
import { csv, fileName, save } from './save.js';

const FONT = 'font-family="system-ui, sans-serif" font-size="11"';
const HEAD = 24; // px: the title
const LINE = 18; // px: a line of names of curves

const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const round = (x) => Math.round(x * 100) / 100;

export const text = (x, y, words, more = '') => `<text x="${round(x)}" y="${round(y)}" ${more}>${escaped(words)}</text>`;

/** An SVG document of `inside`, on the paper of the theme in force. */
export function svgDocument(width, height, inside) {
    const style = getComputedStyle(document.body);
    const [paper, ink] = ['--card', '--ink'].map((name) => style.getPropertyValue(name).trim());
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${round(width)} ${round(height)}" width="${round(width)}" height="${round(height)}" ${FONT} fill="${ink}">\n`
        + `<rect width="100%" height="100%" fill="${paper}"/>\n${inside.join('\n')}\n</svg>\n`;
}

/** The places of a curve, in pieces without gaps. */
function pieces(plot, list, spanGaps) {
    const found = [[]];
    list.forEach((v, i) => {
        if (Number.isFinite(v)) {
            found.at(-1).push([plot.valToPos(plot.data[0][i], 'x'), plot.valToPos(v, 'y')]);
        } else if (!spanGaps && found.at(-1).length > 0) {
            found.push([]);
        }
    });
    return found.filter((part) => part.length > 0);
}

function curve(plot, { stroke, dash = [], lines = true, points = false, spanGaps = false }, list) {
    const parts = pieces(plot, list, spanGaps);
    const drawn = lines ? parts.map((part) => `<polyline fill="none" stroke="${stroke}" stroke-width="1.5" stroke-dasharray="${dash.join(' ')}" points="${part.map((p) => p.map(round)).join(' ')}"/>`) : [];
    const dots = points ? parts.flat().map(([x, y]) => `<circle cx="${round(x)}" cy="${round(y)}" r="3" fill="${stroke}"/>`) : [];
    return [...drawn, ...dots];
}

function axes(plot, wide, tall) {
    const [across, up] = plot.axes;
    const [xs, ys] = [across, up].map(({ _splits, _values }, k) => (_splits ?? []).map((v, i) => [plot.valToPos(v, k ? 'y' : 'x'), _values[i]]));
    return [
        ...xs.map(([x]) => `<path d="M${round(x)} 0V${tall}" stroke="#8886"/>`),
        ...ys.map(([y]) => `<path d="M0 ${round(y)}H${wide}" stroke="#8886"/>`),
        ...xs.flatMap(([x, words]) => String(words ?? '').split('\n').map((line, i) => text(x, tall + 14 + 12 * i, line, 'text-anchor="middle"'))),
        ...ys.map(([y, words]) => text(-6, y + 4, words ?? '', 'text-anchor="end"')),
    ];
}

/** A plot of uPlot with the look of each curve: { label, stroke, dash, lines, points, spanGaps }. */
export function svg(plot, title, across, looks) {
    const [left, wide, tall] = [plot.over.offsetLeft, plot.over.clientWidth, plot.over.clientHeight];
    const named = looks.filter(({ label }) => label);
    const foot = plot.height - tall - plot.over.offsetTop;
    const names = named.map(({ label, stroke, dash = [] }, i) => {
        const [x, y] = [left + (i % 2) * (wide / 2), HEAD + tall + foot + 12 + LINE * Math.floor(i / 2)];
        return `<path d="M${x} ${y - 4}h18" stroke="${stroke}" stroke-width="2.5" stroke-dasharray="${dash.join(' ')}"/>${text(x + 24, y, label)}`;
    });
    return svgDocument(plot.width, HEAD + tall + foot + 8 + LINE * Math.ceil(named.length / 2), [
        text(12, 16, title, 'font-size="13" font-weight="600"'),
        `<clipPath id="inside"><rect x="-4" y="-4" width="${wide + 8}" height="${tall + 8}"/></clipPath>`,
        `<g transform="translate(${left} ${HEAD})">`,
        ...axes(plot, wide, tall),
        text(wide / 2, tall + foot - 4, across, 'text-anchor="middle"'),
        '<g clip-path="url(#inside)">',
        ...looks.flatMap((look, i) => curve(plot, look, plot.data[i + 1])),
        '</g></g>',
        ...names,
    ]);
}

/** Two buttons; `of.svg()` is the picture, `of.rows()` the numbers. */
export function saveButtons(name, of) {
    const made = document.createElement('span');
    made.className = 'save';
    for (const [kind, action] of [
        ['SVG', () => save(`${fileName(name)}.svg`, 'image/svg+xml', of.svg())],
        ['CSV', () => save(`${fileName(name)}.csv`, 'text/csv', csv(of.rows()))],
    ]) {
        const button = document.createElement('button');
        button.textContent = kind;
        button.title = `save ${name} as ${kind}`;
        button.addEventListener('click', action);
        made.append(button);
    }
    return made;
}
