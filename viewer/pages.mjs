// SPDX-License-Identifier: BSD-3-Clause
// pages.mjs -- pages of src/ in one file each, which fetch nothing when they are shown. The same
// sources and versions give the same bytes.
import { createHash } from 'node:crypto';
import { readFile, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

export const here = (path) => new URL(path, import.meta.url);

export const bundle = async (entry) => {
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

// What the page may do: run this script, apply this style, what `more` says, and nothing else.
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;

const markup = async (name) => (await readFile(here(`src/${name}.html`), 'utf8')).trimEnd();

/** The file `to` of src/SHAPE.html, with TITLE. software: packages of node_modules; parts: further texts
 * that the page names as @PART@; more: of the policy; notices: of other software. */
export async function write(to, name, entry, shape, title, software, { parts = {}, more = ['', ''], notices = [] } = {}) {
    const script = await bundle(`src/${entry}.js`);
    const style = await bundle(`src/${shape}.css`);
    const fill = {
        POLICY: `default-src 'none'; img-src data:; script-src ${hash(script)}${more[0]}; `
            + `style-src ${hash(style)}; connect-src 'none'; base-uri 'none'; form-action 'none'${more[1]}`,
        NOTICES: [
            `weft's ${name} (BSD-3-Clause)\n\n${(await readFile(here('../LICENSE'), 'utf8')).trim()}`,
            ...await Promise.all(software.map(licence)), ...notices,
        ].join('\n\n----\n\n'),
        STYLE: style,
        SCRIPT: script,
        TITLE: title,
        ...parts,
    };
    for (const [part, text] of Object.entries(fill)) {
        if (part !== 'POLICY' && /<\/script|<\/style|-->|<!--/i.test(text)) {
            throw new Error(`${part} would end its element`);
        }
    }
    const shared = { HEAD: await markup('head'), STAGE: await markup('stage') };
    const page = (await readFile(here(`src/${shape}.html`), 'utf8'))
        .replace(/@(HEAD|STAGE)@/g, (_, part) => shared[part])
        .replace(/@([A-Z]+)@/g, (_, part) => fill[part]);
    await writeFile(to, page);
    return page;
}
