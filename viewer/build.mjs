// SPDX-License-Identifier: BSD-3-Clause
// build.mjs -- dist/player.html and dist/compare.html from src/: pages that fetch nothing
// when they are shown. The same sources and versions give the same bytes.
// `node build.mjs FOLDER` writes there.
import { createHash } from 'node:crypto';
import { readFile, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = (path) => new URL(path, import.meta.url);
const MARK = '<!--WEFT-DATA-->';

const bundle = async (entry) => {
    const result = await build({
        entryPoints: [fileURLToPath(here(entry))],
        bundle: true,
        minify: true,
        format: 'iife',
        target: 'es2022',
        legalComments: 'none', // the full licences are put into the page below
        write: false,
    });
    return result.outputFiles[0].text.trim();
};

const licence = async (name) => {
    const { version, license } = JSON.parse(
        await readFile(here(`node_modules/${name}/package.json`), 'utf8'),
    );
    const text = await readFile(here(`node_modules/${name}/LICENSE`), 'utf8');
    return `${name} ${version} (${license})\n\n${text.trim()}`;
};

// What the page may do: run this script, apply this style, and nothing else.
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;

async function write(name, entry, shape, software) {
    const script = await bundle(`src/${entry}.js`);
    const style = await bundle(`src/${shape}.css`);
    const notices = [
        `weft's ${name} (BSD-3-Clause)\n\n${(await readFile(here('../LICENSE'), 'utf8')).trim()}`,
        ...await Promise.all(software.map(licence)),
    ].join('\n\n----\n\n');
    const fill = {
        POLICY: `default-src 'none'; img-src data:; script-src ${hash(script)}; `
            + `style-src ${hash(style)}; connect-src 'none'; base-uri 'none'; form-action 'none'`,
        NOTICES: notices,
        STYLE: style,
        SCRIPT: script,
    };
    for (const text of [script, style, notices]) {
        if (/<\/script|<\/style|-->|<!--/i.test(text)) {
            throw new Error('a part of the page would end its element');
        }
    }
    const page = (await readFile(here(`src/${shape}.html`), 'utf8')).replace(
        /@([A-Z]+)@/g,
        (_, part) => fill[part],
    );
    if (page.split(MARK).length !== 2) {
        throw new Error(`the page must have one ${MARK}`);
    }
    await writeFile(`${process.argv[2] ?? fileURLToPath(here('dist'))}/${name}.html`, page);
}

await write('player', 'entry', 'page', ['three', 'uplot']);
await write('compare', 'compare', 'compare', []);
