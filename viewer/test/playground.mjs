// SPDX-License-Identifier: BSD-3-Clause
// playground.mjs -- the playground in a browser: WEFT_BUILD has playground.html and `hashes` of this
// machine; screenshots are left in WEFT_BUILD/wasm.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, statSync } from 'node:fs';
import { after, afterEach, before, test } from 'node:test';
import { drawn, launch, open, pixels } from './browser.mjs';

const build = process.env.WEFT_BUILD;
const file = `${build}/playground.html`;
const shot = (page, name) => drawn(page).then(() => page.screenshot({ path: `${build}/wasm/${name}.png` }));
const text = (page, id) => page.locator(`#${id}`).textContent();
const link = (state) => Buffer.from(JSON.stringify(state)).toString('base64url');
const until = (page, what, value) => page.waitForFunction(what, value, { polling: 50 });

/** The hashes of the frames of the first 2 s of a scene, as the program computes them here. */
const native = (scene, ...sets) => execFileSync(`${build}/hashes`, [`${build}/plugins`, '2', scene, ...sets], { encoding: 'utf8' }).split('\n');

/** Waits for a frame; [its number, its hash]. */
async function frame(page, least) {
    const shows = await until(page, (n) => {
        const { textContent } = document.getElementById('last');
        return Number(textContent.match(/\d+/)?.[0]) >= n && textContent;
    }, least);
    const [, number, hash] = (await shows.jsonValue()).match(/^frame (\d+): state (\w+)$/);
    return [Number(number), hash];
}

let browser;
const shown = [];
/** As open; what does not come within two minutes has failed. */
async function see(...how) {
    const seen = await open(browser, file, ...how);
    seen.page.setDefaultTimeout(120000);
    shown.push(seen.page);
    return seen;
}
before(async () => { browser = await launch(); });
afterEach(() => Promise.all(shown.splice(0).map((page) => page.context().close())));
after(() => browser.close());

test('it starts without an error or a request, and its frames are those of a native run', async (t) => {
    const { page, said, loading } = await see();
    t.diagnostic(`${(statSync(file).size / 1e6).toFixed(1)} MB, started in ${(loading / 1000).toFixed(2)} s, `
        + `${await page.evaluate(() => document.documentElement.dataset.ready)} ms of them in the page`);
    const [number, hash] = await frame(page, 3);
    assert.equal(hash, native('viewer/src/playground-scene.yaml')[number - 1]);
    assert.deepEqual(said.filter((line) => !line.startsWith('request: blob:')), []);
    await shot(page, 'playground');
});

test('a scene of the gallery by another method has the frames of a native run', async () => {
    const { page } = await see(link({ scene: 'flag', method: 'bogacki_shampine' }));
    const [number, hash] = await frame(page, 2);
    const method = 'stepper={plugin: arkode, method: bogacki_shampine, rtol: 1.0e-4, atol: 1.0e-4}';
    assert.equal(hash, native('scenes/flag.yaml', method)[number - 1]);
});

test('Euler at an h beyond its stable step blows up beside Verlet, which does not', async () => {
    const { page } = await see(link({ scene: 'playground', two: true }));
    assert.match(await text(page, 'limits'), /h is too long for euler\./);
    await until(page, () => /blew up/.test(document.getElementById('labels').textContent));
    const [verlet, euler] = await page.locator('#labels span').allTextContents();
    assert.match(euler, /^euler h = 490 µs.*blew up at t = 0\.\d+ s: particle \(\d+, \d+\) left first/);
    assert.doesNotMatch(verlet, /blew/);
    const dark = (await pixels(page, '#canvas')).filter(([r, g, b]) => r < 90 && g < 30 && b < 90 && r > 1.5 * g);
    assert.ok(dark.length > 2000, `${dark.length} pixels of strain beyond 100 %`);
    await shot(page, 'euler');
});

test('the button shows Euler against Verlet, and the pace is that since the start', async () => {
    const { page } = await see();
    await frame(page, 20);
    await page.click('#versus');
    await until(page, () => /blew up/.test(document.getElementById('labels').textContent));
    const [verlet, euler] = await page.locator('#labels span').allTextContents();
    assert.match(verlet, /^velocity_verlet h = 490 µs/);
    assert.match(euler, /^euler h = 490 µs.*h is 2\.4 times the stable step$/);
    await page.click('#restart');
    await page.waitForTimeout(2500);
    assert.match(await text(page, 'pace'), /^(1 picture|([02-9]|\d\d+) pictures)\/s, \d/);
});

test('stiffness beyond the limit shows what became of the cloth, and why', async () => {
    const { page } = await see(link({ scene: 'playground', k: 2, h: 5e-4 }));
    await until(page, () => /blew up/.test(document.getElementById('labels').textContent));
    assert.match(await text(page, 'labels'), /^velocity_verlet h = 490 µs, \d+ stepsblew up at t = 0\.\d+ s: particle \(\d+, \d+\) left first, h is 4\.9 times the stable step$/);
    const dark = (await pixels(page, '#canvas')).filter(([r, g, b]) => r < 90 && g < 30 && b < 90 && r > 1.5 * g);
    assert.ok(dark.length > 2000, `${dark.length} pixels of strain beyond 100 %`);
    await until(page, () => Number(document.getElementById('plots').dataset.highest) > 900);
    assert.ok(Number(await page.locator('#plots').getAttribute('data-highest')) < 2000);
    await shot(page, 'stiff');
});

test('a mistake in the text is reported at its line, and the scene that runs goes on', async () => {
    const { page } = await see();
    await page.click('#editing summary');
    await page.fill('#text', readFileSync('viewer/src/playground-scene.yaml', 'utf8').replace('density', 'densty'));
    await page.click('#run');
    await page.waitForSelector('#mistakes button');
    assert.match(await text(page, 'mistake'), /^8:3: unknown key 'densty'/);
    await page.fill('#text', readFileSync('scenes/hammock.yaml', 'utf8').replace('run:', 'run:\n  threads: 2'));
    await page.click('#run');
    await until(page, () => /threads is 2: this build of weft/.test(document.getElementById('mistake').textContent));
    const [before] = await frame(page, 1);
    await frame(page, before + 1);
});

test('a particle follows the pointer', async () => {
    const { page } = await see();
    await frame(page, 5);
    const { x, y, width, height } = await page.locator('#canvas').boundingBox();
    const [cx, cy] = [x + width / 2, y + height * 0.3];
    let taken = false;
    for (let k = 0; k < 24 && !taken; ++k) { // a place where there is cloth
        await page.mouse.move(cx, cy + 10 * k);
        await page.mouse.down();
        taken = await page.locator('#canvas.dragging').count() > 0;
        await (taken || page.mouse.up());
    }
    assert.ok(taken);
    await page.mouse.move(cx + 150, cy + 60, { steps: 4 });
    await until(page, () => Number(document.getElementById('canvas').dataset.strain) > 20);
    await page.mouse.up();
    assert.equal(await page.locator('#canvas.dragging').count(), 0);
    await shot(page, 'drag');
});

test('the link has the scene and its numbers', async () => {
    const { page } = await see(link({ scene: 'hammock', method: 'rk4', k: 0.5 }));
    const again = await see((await page.evaluate(() => location.hash)).slice(1));
    assert.equal(await again.page.locator('#scene').inputValue(), 'hammock');
    assert.equal(await again.page.locator('#method').inputValue(), 'rk4');
    assert.equal(await text(again.page, 'k-text'), await text(page, 'k-text'));
    const own = readFileSync('scenes/chain.yaml', 'utf8').replace(/^name: .*/m, 'name: my own');
    const mine = await see(link({ scene: '', text: own }));
    assert.match(await text(mine.page, 'about'), /^my own\s· 1 × 11 particles/);
    assert.match(await text((await see('e30x')).page, 'mistake'), /^The link holds no scene/);
});

test('a link whose text is wrong shows the mistake, and bears what is pressed', async () => {
    const { page, said } = await see(link({ scene: '', text: 'weft: 1\ncloth: {}\n' }));
    assert.match(await text(page, 'mistake'), /^1:1: the scene lacks/);
    for (const id of ['plain', 'two', 'fit', 'restart', 'step']) {
        await page.locator(`#${id}`).click();
    }
    await page.locator('#h').press('ArrowRight');
    await page.locator('#scene').selectOption('chain');
    await frame(page, 1);
    assert.deepEqual(said.filter((line) => !/blob:/.test(line)), []);
});

test('on a phone nothing reaches beyond the screen', async () => {
    const { page } = await see(link({ scene: 'playground', two: true }), { viewport: { width: 390, height: 844 } });
    await frame(page, 1);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 390);
    await page.screenshot({ path: `${build}/wasm/phone.png`, fullPage: true });
});

test('pictures a second of 25 x 25 particles are reported', async (t) => {
    const { page } = await see();
    await frame(page, 10);
    const { took, pictures } = await page.evaluate(async () => {
        const began = performance.now();
        let count = 0;
        while (performance.now() - began < 2000) {
            await new Promise(requestAnimationFrame);
            ++count;
        }
        return { pictures: (count / (performance.now() - began)) * 1000, took: Number(document.getElementById('pace').dataset.took) };
    });
    t.diagnostic(`${pictures.toFixed(0)} pictures a second, ${took.toFixed(1)} ms of stepping each`);
    assert.ok(pictures > 0);
});
