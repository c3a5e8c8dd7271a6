// SPDX-License-Identifier: BSD-3-Clause
// check.mjs BUILD -- the states of weft in WebAssembly are those of this machine, to the last bit:
// the program `hashes` of both builds on each shipped scene by several methods; and what this
// build cannot do is refused with a reason.
import { execFileSync } from 'node:child_process';
import { readdirSync, readFileSync } from 'node:fs';
import { wasi } from '../../viewer/src/wasi.js';

const [, , build] = process.argv;
const files = new Map(readdirSync('scenes').map((name) => [`scenes/${name}`, readFileSync(`scenes/${name}`)]));
const module = new WebAssembly.Module(readFileSync(`${build}/wasm/hashes.wasm`));

/** What hashes prints there; the text of stderr if it fails. */
function run(...args) {
    const text = ['', '', ''];
    const host = wasi({ args: ['hashes', ...args], files, write: (to, part) => { text[to] += part; } });
    const instance = new WebAssembly.Instance(module, host.imports);
    host.attach(instance);
    try {
        instance.exports._start();
    } catch (error) {
        if (error.code === undefined) {
            throw error;
        }
        return text[2];
    }
    return text[1];
}

let passed = 0;
let failed = 0;
function expect(right, text) {
    console.log(`${right ? 'ok' : 'FAILED'}: ${text}`);
    passed += right;
    failed += !right;
}

const [short, tight] = ['rtol: 1.0e-3, atol: 1.0e-3', 'rtol: 1.0e-5, atol: 1.0e-5'];
const EVERYWHERE = ['verlet velocity_verlet fixed_step: 2.0e-5', `arkode dormand_prince ${short}`,
    'stiff backward_euler fixed_step: 1.0e-3'];
const ON_FLAGS = ['verlet euler fixed_step: 2.0e-5', 'verlet symplectic_euler fixed_step: 2.0e-5',
    'verlet midpoint fixed_step: 2.0e-5', `arkode bogacki_shampine ${tight}`, `arkode fehlberg87 ${tight}`,
    `arkode verner65 ${tight}`, 'arkode rk4 fixed_step: 2.0e-5', `arkode esdirk324 ${short}`, `stiff ros2 ${short}`];
const CUT = /^ *cut:/m; // the mesher is part of the program

/** The scene by a method, here and there. */
function compare(scene, method) {
    const [plugin, name, ...numbers] = method.split(' ');
    const args = ['0.02', scene, 'run.fps=100', `stepper={plugin: ${plugin}, method: ${name}, ${numbers.join(' ')}}`];
    const here = execFileSync(`${build}/hashes`, [`${build}/plugins`, ...args], { encoding: 'utf8' });
    const there = run('', ...args);
    expect(here === there && /^[0-9a-f]{16}\n/.test(here), `${scene} ${name}: ${there.split('\n')[1]}`);
}

for (const [scene, text] of files) {
    if (scene.endsWith('.yaml') && !CUT.test(text)) {
        EVERYWHERE.forEach((method) => compare(scene, method));
    }
}
for (const scene of ['scenes/flag.yaml', 'scenes/curtain.yaml', 'scenes/table.yaml']) {
    ON_FLAGS.forEach((method) => compare(scene, method));
}
compare('scenes/tarpaulin.yaml', `stiff rkc2 ${tight}`);

function refuses(said, ...args) {
    const text = run(...args);
    expect(text === said, text.trim());
}
const has = 'this build of weft, for WebAssembly, has';
const only = 'this build of weft has the plugins arkode, stiff, verlet, and no others';
files.set('plugins/weft-own.so', new Uint8Array(8));
refuses(`threads is 2: ${has} one thread\n`, '', '1', 'scenes/hammock.yaml', 'run.threads=2');
refuses(`plugin 'gsl' not found: no weft-gsl.so in any folder: ${only}; arkode/fehlberg45 does the same\n`,
    '', '1', 'scenes/flag.yaml');
refuses(`plugin refused: plugins/weft-own.so: ${only}\n`,
    'plugins', '1', 'scenes/flag.yaml', 'stepper={plugin: own, method: own}');
files.delete('scenes/walk-07.obj');
const keyed = run('', '0.1', 'scenes/chain.yaml', 'contact={shapes: [{shape: mesh, file: walk-%02d.obj, fps: 4}]}', `stepper={plugin: stiff, method: ros2, ${short}}`);
expect(/key frame 07 of 'walk-%02d.obj' is missing, but 08 is there/.test(keyed), keyed.trim());
console.log(`${passed} passed, ${failed} failed`);
process.exitCode = failed > 0 ? 1 : 0;
