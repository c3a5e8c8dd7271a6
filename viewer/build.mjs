// SPDX-License-Identifier: BSD-3-Clause
// build.mjs -- dist/player.html and dist/compare.html from src/. `node build.mjs FOLDER` writes
// there.
import { fileURLToPath } from 'node:url';
import { here, write } from './pages.mjs';

const MARK = '<!--WEFT-DATA-->';

async function writePage(name, entry, shape, title, software) {
    const page = await write(`${process.argv[2] ?? fileURLToPath(here('dist'))}/${name}.html`, name, entry, shape, title, software);
    if (page.split(MARK).length !== 2) {
        throw new Error(`the page must have one ${MARK}`);
    }
}

await writePage('player', 'entry', 'page', 'weft', ['three', 'uplot']);
await writePage('compare', 'compare', 'compare', 'weft compare', []);
