// SPDX-License-Identifier: BSD-3-Clause
// playground.mjs WASM FILE -- the playground: src/playground.js, page.wasm of the folder WASM, and
// the scenes of weft that a browser runs as they are watched.
import { readFileSync } from 'node:fs';
import { bundle, here, write } from './pages.mjs';

const [, , wasm, to] = process.argv;
const SCENES = ['two-corners', 'flag', 'curtain', 'hammock', 'trampoline', 'ball', 'table', 'pole', 'rail', 'towel', 'ribbon', 'twist',
    'provot', 'provot-limited', 'tarpaulin', 'pennant', 'denim', 'cantilever', 'hung-stretch', 'hung-shear', 'chain', 'stiffness', 'skirt', 'tshirt'];
const FILES = ['skirt.obj', 'tshirt.obj'];
const OWN = 'playground';
const read = (path) => readFileSync(path, 'utf8');
const scene = (name) => read(here(`../scenes/${name}.yaml`));

const texts = { [OWN]: read(here('src/playground-scene.yaml')), ...Object.fromEntries(SCENES.map((name) => [name, scene(name)])) };
const files = Object.fromEntries(FILES.map((name) => [name, read(here(`../scenes/${name}`))]));
const notices = [
    ['libyaml 0.2.5 (MIT)', `${wasm}/sources/libyaml/License`],
    ['SUNDIALS 6.4.1 (BSD-3-Clause)', `${wasm}/sources/sundials/LICENSE`],
    ['wasi-libc', '/usr/share/doc/wasi-libc/copyright'],
].map(([name, path]) => `${name}\n\n${read(path).trim()}`);

await write(to, 'playground', 'playground', 'playground', 'weft playground', ['three', 'uplot'], {
    parts: {
        SCENES: JSON.stringify({ names: Object.keys(texts), texts, files }).replaceAll('<', '\\u003c'),
        WORKER: await bundle('src/playground-worker.js'),
        WASM: readFileSync(`${wasm}/page.wasm`).toString('base64'),
    },
    more: [" 'wasm-unsafe-eval'", '; worker-src blob:'],
    notices,
});
