// SPDX-License-Identifier: BSD-3-Clause
// live.mjs -- runs under way, watched in a browser. Screenshots are left beside the pages of
// tests/view/browser.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { clothShare, drawn, launch } from './browser.mjs';

const root = process.env.WEFT_VIEW;
const weft = process.env.WEFT;
const SHEET = `${root}/hung.yaml`;

/** Starts weft; resolves to its URL, its end, and its output. */
function start(...args) {
    const child = spawn(weft, args);
    const made = { child, text: '' };
    made.code = new Promise((done) => { child.on('close', (code) => done(code)); });
    made.url = new Promise((done) => {
        child.stdout.on('data', (bytes) => {
            made.text += bytes;
            done(/http:\S*/.exec(made.text)?.[0]);
        });
    });
    return made;
}

/** A run of some seconds, and its directory. */
function run(name, step, ...more) {
    const directory = `${root}/${name}`;
    rmSync(directory, { recursive: true, force: true });
    return { directory, ...start('run', SHEET, '--out', directory, '--quiet', '--set', `stepper.fixed_step=${step}`, ...more) };
}

async function look(url, settings = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...settings });
    const page = await context.newPage();
    const said = [];
    page.on('console', (message) => ['error', 'warning'].includes(message.type()) && !/GPU stall/.test(message.text()) && said.push(message.text()));
    page.on('pageerror', (error) => said.push(error.message));
    page.on('request', (request) => request.url().startsWith(url) || said.push(request.url()));
    await page.goto(url);
    await page.waitForSelector('html[data-ready]');
    return { page, said };
}

const count = (page) => page.evaluate(() => window.weft.page.times.length);
const over = (page) => page.waitForFunction(() => window.weft.page.runs[0].result !== null);

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

test('frames come while the run goes on, and its end', async () => {
    const { directory, url, code } = run('live', '4.0e-6', '--watch', '--set', 'run.fps=60');
    const { page, said } = await look(await url);
    const early = await count(page);
    assert.ok(early < 61, `${early}`);
    await page.waitForSelector('#summary .live');
    await page.waitForFunction((had) => window.weft.page.times.length > had + 5, early);
    assert.equal(await page.evaluate(() => window.weft.state.frame + 1 >= window.weft.page.times.length - 1), true); // the newest is shown
    assert.ok(await clothShare(page) > 0.01);
    await page.screenshot({ path: `${root}/live.png` });
    await over(page);
    await drawn(page);
    assert.deepEqual(said, []);
    assert.equal(await page.locator('#summary .live').count(), 0);
    assert.match(await page.textContent('#summary'), /force evaluations/);
    assert.equal(await code, 0);
    // all that came is what the run has written
    const rows = readFileSync(`${directory}/series.csv`, 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
    const seen = await page.evaluate(() => ({
        times: window.weft.page.times, kinetic: window.weft.page.runs[0].columns.get('kinetic'),
        last: [...window.weft.page.runs[0].blocks.at(-1).read(1, new Float64Array(window.weft.page.count))],
    }));
    assert.deepEqual(seen.kinetic, rows.map((row) => Number(row[2])));
    assert.ok(seen.times.every((t, i) => rows.some((row) => Number(row[1]) === t) && (i === 0 || t > seen.times[i - 1])));
    assert.equal(seen.times.at(-1), 1);
    const final = readFileSync(`${directory}/final.csv`, 'utf8').trim().split('\n').slice(1).map((line) => Number(line.split(',')[3]));
    seen.last.forEach((y, i) => assert.ok(Math.abs(y - final[i]) < 1e-4));
    // the page goes on without its server
    await page.fill('#scrub', '3');
    assert.equal(await page.evaluate(() => window.weft.state.frame), 3);
});

test('a page that shows an earlier frame stays there', async () => {
    const { url, code } = run('live', '4.0e-6', '--watch');
    const { page } = await look(await url);
    await page.waitForFunction(() => window.weft.page.times.length > 4);
    await page.fill('#scrub', '2');
    const had = await count(page);
    await page.waitForFunction((n) => window.weft.page.times.length > n + 3, had);
    assert.equal(await page.evaluate(() => window.weft.state.frame), 2);
    await page.click('#last');
    await over(page);
    assert.equal(await page.evaluate(() => window.weft.state.frame === window.weft.page.times.length - 1), true);
    assert.equal(await code, 0);
});

test('a run elsewhere is watched on a phone, and stopped', async () => {
    const other = run('live', '1.0e-6');
    let watching = null;
    for (let i = 0; i < 100 && !watching?.text; ++i) { // until it has begun
        watching = start('view', '--watch', other.directory);
        await Promise.race([watching.url, watching.code]);
    }
    const { page, said } = await look(await watching.url, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
    const had = await count(page);
    await page.waitForFunction((n) => window.weft.page.times.length > n + 1, had);
    assert.deepEqual(await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]), [390, 390]);
    await page.screenshot({ path: `${root}/live-phone.png` });
    other.child.kill('SIGTERM');
    await over(page);
    assert.match(await page.textContent('#summary'), /interrupted: SIGTERM/);
    assert.deepEqual(said, []);
    assert.deepEqual([await other.code, await watching.code], [143, 0]);
});

test('a server that is stopped is missed, and found again', async () => {
    const other = run('live', '5.0e-7');
    let watching = null;
    for (let i = 0; i < 100 && !watching?.text; ++i) {
        watching = start('view', '--watch', other.directory);
        await Promise.race([watching.url, watching.code]);
    }
    const url = await watching.url;
    const { page } = await look(url);
    await page.waitForSelector('#summary .live');
    watching.child.kill('SIGKILL');
    await page.waitForFunction(() => /does not answer/.test(document.getElementById('summary').textContent));
    const had = await count(page);
    const again = start('view', '--watch', other.directory, '--port', new URL(url).port);
    await page.waitForFunction((n) => window.weft.page.times.length > n, had);
    const times = await page.evaluate(() => window.weft.page.times);
    assert.ok(times.every((t, i) => i === 0 || t > times[i - 1]));
    other.child.kill('SIGTERM');
    assert.deepEqual([await other.code, await again.code], [143, 0]);
});
