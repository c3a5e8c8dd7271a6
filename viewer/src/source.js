// SPDX-License-Identifier: BSD-3-Clause
// source.js -- where the data are: in the page, or of a batch in a template for each run.

/** Rows of cells, quoted as in RFC 4180. */
export function readCsv(text) {
    const rows = [[]];
    for (const [, quoted, plain, end] of text.matchAll(/(?:"((?:[^"]|"")*)"|([^,\n]*))(,|\n|$)/g)) {
        rows.at(-1).push(quoted?.replaceAll('""', '"') ?? plain);
        if (end === '\n') {
            rows.push([]);
        }
    }
    return rows;
}

function readBatch(root) {
    const element = root.getElementById('weft-batch');
    if (!element) {
        return null;
    }
    const data = JSON.parse(element.textContent);
    const [names, ...rows] = readCsv(data.summary ?? '');
    const at = Object.fromEntries(names.map((name, i) => [name, i]));
    const players = root.querySelectorAll('template');
    const runs = rows.filter((row) => row.length > at.directory).map((row, i) => ({
        number: i + 1,
        text: (name) => row[at[name]] ?? '',
        name: row[at.directory],
        done: row[at.status] === 'done',
        columns: data.runs[i]?.columns ?? {},
        page: data.runs[i]?.page ? `${encodeURIComponent(row[at.directory])}/run.html` : '',
        root: players[i]?.content.firstElementChild ? players[i].content : null,
    }));
    return { ...data, names, varied: names.slice(0, at.scene), runs };
}

export const batch = readBatch(document);
const asked = new URLSearchParams(location.search).get('run');
/** The run of the batch to play. */
export const chosen = batch?.runs.find((run) => run.root && run.name === asked);
export const root = chosen?.root ?? document;
