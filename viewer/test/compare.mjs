// SPDX-License-Identifier: BSD-3-Clause
// compare.mjs -- the diagram that tests/view/browser made, in a browser. Screenshots are
// left beside it.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { drawn, launch, open, pixels, saved } from './browser.mjs';

const root = process.env.WEFT_VIEW;
const file = `${root}/compare/compare.html`;

/** compare.csv as a list of objects; the reason, which comes last, is left out. */
function runs() {
    const [head, ...lines] = readFileSync(`${root}/compare/compare.csv`, 'utf8').trim().split('\n');
    const names = head.split(',').slice(0, -1);
    return lines.map((line) => Object.fromEntries(names.map((name, i) => [name, line.split(',')[i]])));
}

/** Where a point of a method is in the window. */
const place = (page, name, index) => page.evaluate(([wanted, i]) => {
    const method = weft.page.methods.find((m) => `${m.plugin} ${m.name}` === wanted);
    const point = method.points[i];
    const box = document.getElementById('plot').getBoundingClientRect();
    return [box.left + weft.plot.x(weft.costOf(point)), box.top + weft.plot.y(point.error)];
}, [name, index]);

const button = (page, name) => page.locator('#legend button').filter({ hasText: new RegExp(`^${name}$`) });

/** Part of the plot in one of the inks of the coloured curves. */
async function inkShare(page) {
    const inks = await page.evaluate(() => weft.page.methods.filter((m) => !m.other).map((m) => {
        const probe = document.createElement('i');
        probe.style.color = `var(${m.colour})`;
        document.body.append(probe);
        const rgb = getComputedStyle(probe).color.match(/\d+/g).map(Number);
        probe.remove();
        return rgb;
    }));
    const all = await pixels(page, '#plot');
    return all.filter((p) => inks.some((ink) => ink.every((c, k) => Math.abs(c - p[k]) < 8))).length / all.length;
}

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

test('the diagram loads without an error, a warning or a request', async () => {
    const { page, said } = await open(browser, file);
    await drawn(page);
    assert.deepEqual(said, []);
    assert.match(await page.title(), /^<\/script><script>alert\(1\)<\/script>: which integrator\? - weft$/);
    assert.match(await page.textContent('#summary'), /7 × 7 particles/);
    assert.match(await page.textContent('#horizon'), /predictable to t = .* displaced by 1e-10 m/);
    assert.match(await page.textContent('#stiffness'), /The stiffest mode: omega .* damping ratio/);
    assert.match(await page.textContent('#choices'), /show all methods/);
    assert.match(await page.textContent('#as-is'), /as the scene is \(gsl rkf45\): error .* in .*s, .* evaluations/);
    await page.screenshot({ path: `${root}/compare-light.png` });
});

test('nothing but its own script may run, and its software is named', async () => {
    const { page } = await open(browser, file);
    assert.equal(await page.evaluate(() => {
        const script = document.createElement('script');
        script.textContent = 'window.injected = true';
        document.body.append(script);
        return window.injected ?? false;
    }), false);
    const text = readFileSync(file, 'utf8');
    assert.match(text, /default-src 'none'/);
    assert.match(text, /weft's compare \(BSD-3-Clause\)/);
    assert.doesNotMatch(text, /(three|uplot) \S+ \(MIT\)|u-wrap/); // nor any part of them
});

test('every run of the table is a point', async () => {
    const { page } = await open(browser, file);
    const wanted = runs().filter((run) => run.outcome === 'done');
    const points = await page.evaluate(() => weft.page.methods.flatMap((m) => m.points.map((p) => [m.plugin, m.name, p.setting, p.error, p.calls])));
    assert.deepEqual(points, wanted.map((run) => [run.plugin, run.method, ...['setting', 'error', 'rhs_calls'].map((key) => Number(run[key]))]));
    assert.ok(points.length > 100);
});

test('curves are drawn, and gone when their methods are hidden', async () => {
    const { page } = await open(browser, file);
    const before = await inkShare(page);
    assert.ok(before > 0.002, `${before}`);
    for (const name of await page.evaluate(() => weft.shown().filter((m) => !m.other).map((m) => `${m.plugin} ${m.name}`))) {
        await button(page, name).click();
        assert.equal(await button(page, name).getAttribute('aria-pressed'), 'false');
    }
    await page.click('#all');
    await page.mouse.move(0, 0);
    assert.equal(await page.evaluate(() => weft.shown().length), 0);
    assert.ok(await inkShare(page) < 0.1 * before);
    await button(page, 'gsl rkf45').click();
    assert.equal(await page.evaluate(() => weft.shown().length), 1);
});

test('a point tells its method, tolerance, error and cost', async () => {
    const { page } = await open(browser, file);
    assert.equal(await page.isVisible('#tip'), false);
    const run = runs().filter((r) => r.method === 'rk8pd' && r.outcome === 'done');
    await page.mouse.move(...await place(page, 'gsl rk8pd', run.length - 2));
    const tip = await page.innerText('#tip');
    const { setting, error, rhs_calls: calls } = run[run.length - 2];
    assert.match(tip, /^gsl rk8pd, order 8/);
    assert.ok(tip.includes(`tolerance ${Number(setting).toExponential(0)}`), tip);
    assert.ok(tip.includes(`error ${Number(error).toExponential(1)} m`), tip);
    assert.ok(tip.replaceAll('\u202f', '').includes(`${calls} evaluations`), tip);
    await page.mouse.move(0, 0);
    assert.equal(await page.isVisible('#tip'), false);
});

test('the axis turns to evaluations and back', async () => {
    const { page } = await open(browser, file);
    const at = await place(page, 'gsl rk8pd', 0);
    const before = await pixels(page, '#plot');
    await page.click('#by-calls');
    assert.equal(await page.getAttribute('#by-calls', 'aria-pressed'), 'true');
    assert.match(await page.textContent('#plot'), /dashed: a part of the work/);
    assert.equal(await page.locator('.curve.partly').count(), await page.evaluate(() => weft.shown().filter((m) => m.implicit).length));
    await page.mouse.move(...await place(page, 'gsl rk8pd', 0));
    assert.match(await page.innerText('#tip'), /gsl rk8pd/);
    await page.mouse.move(0, 0);
    const after = await pixels(page, '#plot');
    assert.ok(after.some((p, i) => p.some((c, k) => Math.abs(c - before[i][k]) > 24)));
    await page.click('#by-time');
    assert.equal(await page.locator('.curve.partly').count(), 0);
    assert.deepEqual(await place(page, 'gsl rk8pd', 0), at);
});

test('the diagram is saved as an SVG that needs nothing else', async () => {
    const { page, said } = await open(browser, file);
    const { name, bytes } = await saved(page, () => page.click('#save'));
    assert.equal(name, 'compare.svg');
    writeFileSync(`${root}/compare.svg`, bytes);
    const text = bytes.toString();
    assert.doesNotMatch(text, /var\(|class=|style|script>|href/);
    const { points, inks } = await page.evaluate(() => ({
        points: weft.shown().flatMap((m) => m.points.filter((p) => p.error > 0 && p.error <= 1)).length,
        inks: [...document.querySelectorAll('.curve:not(.other)')].map((g) => getComputedStyle(g).stroke),
    }));
    assert.ok(points > 50 && inks.length > 2);
    assert.equal(text.match(/<circle/g).length, points);
    const alone = await page.context().newPage();
    await alone.goto(`file://${root}/compare.svg`);
    assert.ok(inks.every((ink) => text.includes(`stroke="${ink}"`)));
    assert.equal(await alone.textContent('text'), '</script><script>alert(1)</script>');
    const all = await pixels(alone, 'svg');
    const coloured = all.filter((p) => inks.some((ink) => ink.match(/\d+/g).every((c, k) => Math.abs(c - p[k]) < 8)));
    assert.ok(coloured.length > 0.002 * all.length, `${coloured.length}`);
    await alone.screenshot({ path: `${root}/compare-svg.png` });
    assert.deepEqual(said, []);
});

test('dark where that is preferred, and by the button', async () => {
    const { page, said } = await open(browser, file, '', { colorScheme: 'dark' });
    const light = (list) => list.reduce((sum, [r, g, b]) => sum + r + g + b, 0) / (765 * list.length);
    assert.ok(light(await pixels(page, '#plot')) < 0.25);
    assert.ok(await inkShare(page) > 0.002);
    await page.screenshot({ path: `${root}/compare-dark.png` });
    await page.click('#theme');
    assert.ok(light(await pixels(page, '#plot')) > 0.8);
    assert.deepEqual(said, []);
});

test('a phone shows all of it, one below the other', async () => {
    const { page, said } = await open(browser, file, '', {
        viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true,
    });
    assert.deepEqual(await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]), [390, 390]);
    const [plot, side] = await Promise.all(['#plot', '#side'].map((id) => page.locator(id).boundingBox()));
    assert.ok(side.y > plot.y + plot.height && plot.width > 300);
    await page.touchscreen.tap(...await place(page, 'gsl rk8pd', 2));
    assert.match(await page.innerText('#tip'), /gsl rk8pd|arkode/);
    await page.screenshot({ path: `${root}/compare-phone.png`, fullPage: true });
    assert.deepEqual(said, []);
});
