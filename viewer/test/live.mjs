// SPDX-License-Identifier: BSD-3-Clause
// live.mjs -- runs under way, watched in a browser. No test needs a run or a browser to be
// quick: a run lasts until a signal ends it, or is held while the page loads. Screenshots
// are left beside the pages of tests/view/browser.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, readFileSync, rmSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { clothShare, drawn, launch, PATIENCE } from './browser.mjs';

const root = process.env.WEFT_VIEW;
const weft = process.env.WEFT;
const SHEET = `${root}/hung.yaml`;

/** 20000 frames of 20000 steps each: many minutes on any machine. */
const ENDLESS = ['run.duration=200', 'run.fps=100', 'stepper.fixed_step=5.0e-7'];

const children = [];

/** Starts weft; resolves to its URL, and its exit code. */
function start(...args) {
    const child = spawn(weft, args, { stdio: ['ignore', 'pipe', 'inherit'] });
    children.push(child);
    const code = new Promise((done) => { child.on('close', (number) => done(number)); });
    const url = new Promise((done) => {
        let text = '';
        child.stdout.on('data', (bytes) => {
            text += bytes;
            done(/http:\S*/.exec(text)?.[0]);
        });
    });
    return { child, code, url };
}

/** A run, once it has frames, and its directory. */
async function run(sets, ...more) {
    const directory = `${root}/live`;
    rmSync(directory, { recursive: true, force: true });
    const made = start('run', SHEET, '--out', directory, '--quiet', ...sets.flatMap((set) => ['--set', set]), ...more);
    while (!existsSync(`${directory}/run.vtkhdf`)) {
        assert.equal(made.child.exitCode, null);
        await sleep(5);
    }
    return { directory, ...made };
}

/** The rows of a file of numbers, without its names. */
const rows = (file) => readFileSync(file, 'utf8').trim().split('\n').slice(1).map((line) => line.split(',').map(Number));

const isStopped = (child) => child.exitCode !== null || /^State:\s*[TZ]/m.test(readFileSync(`/proc/${child.pid}/status`, 'utf8'));

/** A run of 61 frames that is held (SIGSTOP) before its 30th. Where it got further, it is
 * begun again with twice as many steps. */
async function heldRun() {
    for (let step = 4e-6; ; step /= 2) {
        const made = await run(['run.fps=60', `stepper.fixed_step=${step}`], '--watch');
        made.child.kill('SIGSTOP');
        while (!isStopped(made.child)) {
            await sleep(1);
        }
        if (rows(`${made.directory}/series.csv`).length < 30) {
            return made;
        }
        made.child.kill('SIGKILL');
        await made.code;
    }
}

async function look(url, settings = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...settings });
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    const said = [];
    // 503: frames that cannot be read at this moment; the page asks again
    page.on('console', (message) => ['error', 'warning'].includes(message.type()) && !/GPU stall|status of 503/.test(message.text()) && said.push(message.text()));
    page.on('pageerror', (error) => said.push(error.message));
    page.on('request', (request) => request.url().startsWith(url) || said.push(request.url()));
    await page.goto(url);
    await page.waitForSelector('html[data-ready]');
    await page.waitForSelector('#summary .live'); // it gets frames
    return { page, said };
}

const count = (page) => page.evaluate(() => window.weft.page.times.length);
const grows = (page, had, by) => page.waitForFunction((n) => window.weft.page.times.length > n, had + by);
const over = (page) => page.waitForFunction(() => window.weft.page.runs[0].result !== null);
const isLast = (page) => page.evaluate(() => window.weft.state.frame === window.weft.page.times.length - 1);

/** The page has every row of the series, and frames of it up to the last, whose state is
 * in a CSV file. */
async function hasAll(page, directory, file) {
    const series = rows(`${directory}/series.csv`);
    const seen = await page.evaluate(() => ({
        times: window.weft.page.times, kinetic: window.weft.page.runs[0].columns.get('kinetic'),
        last: [...window.weft.page.runs[0].blocks.at(-1).read(1, new Float64Array(window.weft.page.count))],
    }));
    assert.deepEqual(seen.kinetic, series.map((row) => row[2]));
    assert.ok(seen.times.every((t, i) => series.some((row) => row[1] === t) && (i === 0 || t > seen.times[i - 1])));
    assert.equal(seen.times.at(-1), series.at(-1)[1]);
    const heights = rows(`${directory}/${file}`).map((row) => row[3]);
    assert.equal(heights.length, seen.last.length);
    seen.last.forEach((y, i) => assert.ok(Math.abs(y - heights[i]) < 1e-4));
}

let browser;
before(async () => { browser = await launch(); });
after(async () => {
    children.filter((child) => child.exitCode === null).forEach((child) => child.kill('SIGKILL'));
    await browser.close();
});

test('frames come while the run goes on, until it is stopped', async () => {
    const { directory, child, url, code } = await run(ENDLESS, '--watch');
    const { page, said } = await look(await url);
    await grows(page, await count(page), 5);
    assert.equal(await isLast(page), true);
    assert.equal(await page.locator('#summary .live').count(), 1);
    assert.ok(await clothShare(page) > 0.01);
    await page.screenshot({ path: `${root}/live.png` });
    child.kill('SIGTERM');
    await over(page);
    assert.match(await page.textContent('#notes'), /interrupted: SIGTERM/);
    assert.equal(await isLast(page), true);
    assert.equal(await code, 143);
    assert.deepEqual(said, []);
    const last = String(rows(`${directory}/series.csv`).length - 1);
    execFileSync(weft, ['export', directory, '--format', 'csv', '--frame', last]);
    await hasAll(page, directory, `frames/frame-${last.padStart(6, '0')}.csv`);
});

test('a page gets the end of a run, and goes on without its server', async () => {
    const { directory, child, url, code } = await heldRun();
    const { page, said } = await look(await url);
    assert.ok(await count(page) < 31);
    child.kill('SIGCONT');
    await over(page);
    await drawn(page);
    assert.equal(await page.locator('#summary .live').count(), 0);
    assert.match(await page.textContent('#summary'), /force evaluations/);
    assert.equal(await isLast(page), true);
    assert.equal(await code, 0);
    assert.deepEqual(said, []);
    await hasAll(page, directory, 'final.csv');
    await page.fill('#scrub', '3');
    assert.equal(await page.evaluate(() => window.weft.state.frame), 3);
});

test('a page that shows an earlier frame stays there', async () => {
    const { child, url, code } = await run(ENDLESS, '--watch');
    const { page } = await look(await url);
    await grows(page, 0, 4);
    await page.fill('#scrub', '2');
    await grows(page, await count(page), 3);
    assert.equal(await page.evaluate(() => window.weft.state.frame), 2);
    await page.click('#last');
    await grows(page, await count(page), 1);
    assert.equal(await isLast(page), true);
    child.kill('SIGTERM');
    await over(page);
    assert.equal(await isLast(page), true);
    assert.equal(await code, 143);
});

test('a run elsewhere is watched on a phone, and stopped', async () => {
    const other = await run(ENDLESS);
    const watching = start('view', '--watch', other.directory);
    const { page, said } = await look(await watching.url, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
    await grows(page, await count(page), 1);
    assert.deepEqual(await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]), [390, 390]);
    await page.screenshot({ path: `${root}/live-phone.png` });
    other.child.kill('SIGTERM');
    await over(page);
    assert.match(await page.textContent('#notes'), /interrupted: SIGTERM/);
    assert.deepEqual(said, []);
    assert.deepEqual([await other.code, await watching.code], [143, 0]);
});

test('a server that is stopped is missed, and found again', async () => {
    const other = await run(ENDLESS);
    const watching = start('view', '--watch', other.directory);
    const url = await watching.url;
    const { page } = await look(url);
    watching.child.kill('SIGKILL');
    await page.waitForFunction(() => /does not answer/.test(document.getElementById('summary').textContent));
    const had = await count(page);
    const again = start('view', '--watch', other.directory, '--port', new URL(url).port);
    await grows(page, had, 0);
    const times = await page.evaluate(() => window.weft.page.times);
    assert.ok(times.every((t, i) => i === 0 || t > times[i - 1]));
    other.child.kill('SIGTERM');
    assert.deepEqual([await other.code, await again.code], [143, 0]);
});
