// SPDX-License-Identifier: BSD-3-Clause
// batch.mjs -- the pages of batches that tests/view/browser made, in a browser. Screenshots
// are left beside them.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { clothShare, drawn, launch, open, pixels, saved } from './browser.mjs';

const root = process.env.WEFT_VIEW;
const file = `${root}/batch/batch.html`;
const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

/** summary.csv as a list of objects; quotes stay around its reasons. */
const [names, ...rows] = readFileSync(`${root}/batch/summary.csv`, 'utf8').trim().split('\n').map((line) => line.split(/,(?=(?:[^"]*"[^"]*")*[^"]*$)/));
const summary = rows.map((row) => Object.fromEntries(names.map((name, i) => [name, row[i]])));
/** The numbers of a column of the series of a run, which has all of them. */
function series(run, name) {
    const [head, ...lines] = readFileSync(`${root}/batch/${run.directory}/series.csv`, 'utf8').trim().split('\n').map((line) => line.split(','));
    return lines.map((line) => Number(line[head.indexOf(name)]));
}
const column = (page, name) => page.evaluate((wanted) => {
    const heads = [...document.querySelectorAll('#runs th')].map((th) => th.textContent);
    return [...document.querySelectorAll('#runs tbody tr')].map((tr) => tr.cells[heads.indexOf(wanted)].textContent);
}, name);
const texts = (page, selector) => page.locator(selector).allTextContents();
const sortBy = (page, name) => page.locator('#runs th').getByText(name, { exact: true }).click();

const plotted = (page) => page.waitForFunction(() => weft.main.drawn.length > 0);

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

test('a page of a batch loads without an error, a warning or a request', async () => {
    const { page, said } = await open(browser, file);
    await drawn(page);
    assert.deepEqual(said, []);
    assert.equal(await page.title(), 'batch: 24 runs - weft');
    assert.match(await page.textContent('#summary'), /20 done.*4 failed/);
    assert.equal(await page.locator('#player').count(), 0);
    await page.screenshot({ path: `${root}/batch-light.png`, fullPage: true });
});

test('the table has every run, its parameters and results', async () => {
    const { page } = await open(browser, file);
    assert.deepEqual(await column(page, 'stiffness [N/m]'), summary.map((run) => run['cloth.springs.stretch.stiffness']));
    assert.deepEqual(await column(page, 'status'), summary.map((run) => run.status));
    assert.deepEqual(await column(page, 'steps'), summary.map((run) => run.steps));
    const hrefs = await page.locator('#runs a').evaluateAll((list) => list.map((a) => new URL(a.href).searchParams.get('run')));
    assert.deepEqual(hrefs, summary.map((run) => run.directory));
});

test('a heading sorts, upwards and then downwards; numbers are no words', async () => {
    const { page } = await open(browser, file);
    const damping = summary.map((run) => run['forces.damping']).sort((a, b) => a - b);
    await sortBy(page, 'damping [kg/s]');
    assert.deepEqual(await column(page, 'damping [kg/s]'), damping);
    await sortBy(page, 'damping [kg/s]');
    assert.deepEqual(await column(page, 'damping [kg/s]'), damping.reverse());
    assert.deepEqual(await page.locator('#runs [aria-sort=descending]').allTextContents(), ['damping [kg/s]']);
    await sortBy(page, 'status');
    assert.deepEqual((await column(page, 'status')).slice(19, 21), ['done', 'failed']);
    await page.reload(); // the address remembers
    assert.deepEqual(await page.locator('#runs [aria-sort=ascending]').allTextContents(), ['status']);
});

test('words find runs', async () => {
    const { page } = await open(browser, file);
    await page.fill('#search', 'stiffness=3000 FAILED');
    assert.equal((await column(page, 'run')).length, 4);
    assert.equal(await page.textContent('#found'), '4 of 24 runs');
    await page.fill('#search', 'no such run');
    assert.equal((await column(page, 'run')).length, 0);
});

test('the map has the mean of the series of each pair, stripes where runs failed', async () => {
    const { page } = await open(browser, file, 'of=largest&value=max_strain');
    assert.equal(await page.textContent('#heat h2'), 'largest strain, maximum [%]');
    const labels = await page.locator('#heat td button').evaluateAll((list) => list.map((one) => one.ariaLabel));
    assert.equal(labels.length, 24);
    assert.equal(labels.filter((text) => text === 'largest strain, maximum [%]: failed').length, 4);
    assert.equal(await page.locator('#heat .undone').count(), 4);
    const last = summary.find((run) => run['cloth.springs.stretch.stiffness'] === '20' && run['forces.damping'] === '1.0e-4');
    const wanted = 100 * Math.max(...series(last, 'max_strain'));
    const told = Number(labels[3 * 6].replace('largest strain, maximum [%]: ', '')); // lowest row, first column
    assert.ok(Math.abs(told - wanted) < 1e-3 * wanted, `${told} ${wanted}`);
    await page.selectOption('#of', 'smallest');
    assert.equal(await page.textContent('#heat h2'), 'largest strain, minimum [%]');
    await page.selectOption('#y', '');
    assert.equal(await page.isVisible('#heat'), false);
});

test('a small plot of each quantity that differs; its title chooses it', async () => {
    const { page } = await open(browser, file);
    const titles = await texts(page, '#small .plot > button');
    assert.ok(['kinetic energy, at the end [J]', 'elastic energy, at the end [J]', 'largest strain, at the end [%]', 'wall time [s]'].every((title) => titles.includes(title)), titles.join());
    assert.ok(!titles.includes('steps, at the end')); // they are alike in runs that are done
    assert.deepEqual(await texts(page, '#inks span'), ['1.0e-4', '8.0e-4', '5.0e-3', '2.0e-2']);
    await page.locator('#small button').filter({ hasText: /^elastic energy, at the end/ }).click();
    assert.deepEqual(await texts(page, '#main .plot > button'), ['elastic energy, at the end [J]']);
    assert.equal(await page.textContent('#heat h2'), 'elastic energy, at the end [J]');
    await page.selectOption('#x', 'damping');
    assert.equal(await page.inputValue('#y'), 'stiffness'); // they change places
    assert.deepEqual(await texts(page, '#inks span'), ['20', '60', '100', '300', '1000', '3000']);
    const before = await pixels(page, '#main .u-over');
    await page.selectOption('#x', 'stiffness');
    const after = await pixels(page, '#main .u-over');
    assert.ok(after.some((p, i) => p.some((c, k) => Math.abs(c - before[i][k]) > 24)));
});

test('a page opens with a result that differs, words of steppers are short', async () => {
    const steps = await open(browser, `${root}/euler-steps/batch.html`);
    await plotted(steps.page);
    const [value, title] = [await steps.page.inputValue('#value'), await steps.page.textContent('#main .plot > button')];
    assert.ok(!['wall_time', 'steps', 'rhs_calls'].includes(value) && /\[.+\]$/.test(title), `${value} ${title}`);
    assert.equal(await steps.page.evaluate(() => weft.main.drawn[0].axes[0].label), 'fixed_step [s]');
    const heights = await steps.page.evaluate(() => weft.main.drawn[0].data[1]);
    assert.ok(new Set(heights).size > 3, heights.join());
    const { page, said } = await open(browser, `${root}/steppers/batch.html`);
    assert.deepEqual(await column(page, 'stepper'), ['verlet velocity_verlet 2.0e-4', 'gsl rkf45 1.0e-4', 'verlet euler 1.0e-2']);
    await plotted(page);
    const ticks = await page.evaluate(() => weft.main.drawn[0].axes[0]._values);
    assert.deepEqual(ticks.map((text) => text.split('\n')), [['verlet', 'velocity_verlet', '2.0e-4'], ['gsl', 'rkf45', '1.0e-4'], ['verlet', 'euler', '1.0e-2']]);
    assert.equal(await page.textContent('#undone'), '1 run is not done: no points');
    await page.screenshot({ path: `${root}/steppers.png` });
    assert.deepEqual(said, []);
});

test('every plot and the map are saved as SVG and CSV', async () => {
    const { page, said } = await open(browser, file, 'of=largest&value=max_strain');
    for (const where of ['#main .plot', '#small .plot >> nth=0', '#heat']) {
        await page.locator(where).hover();
        const svg = (await saved(page, () => page.locator(where).getByText('SVG').click())).bytes.toString();
        const wrong = await page.evaluate((text) => new DOMParser().parseFromString(text, 'image/svg+xml').querySelector('parsererror')?.textContent, svg);
        assert.equal(wrong, undefined);
        assert.ok(svg.includes('stiffness [N/m]') && /<(circle|rect)/.test(svg), where);
    }
    const { name, bytes } = await saved(page, () => page.locator('#main .plot').getByText('CSV').click());
    assert.equal(name, 'largest-strain-maximum.csv');
    const [head, ...lines] = bytes.toString().trim().split('\n').map((line) => line.match(/("[^"]*"|[^,]+)/g));
    assert.deepEqual(head, ['run', 'stiffness [N/m]', 'damping [kg/s]', '"largest strain, maximum [%]"']);
    assert.equal(lines.length, 20);
    const told = lines.find(([run]) => run === 'hung_stiffness=20_damping=1.0e-4');
    const wanted = 100 * Math.max(...series(summary.find((run) => run.directory === told[0]), 'max_strain'));
    assert.ok(Math.abs(told[3] - wanted) < 1e-3 * wanted);
    assert.deepEqual(said, []);
});

test('on paper there are no controls', async () => {
    const { page } = await open(browser, file);
    await page.emulateMedia({ media: 'print' });
    for (const gone of ['#asked', '#filter', '#heat .save']) {
        assert.ok(await page.locator(gone).isHidden(), gone);
    }
    for (const kept of ['#heat table', '#main .plot', '#runs']) {
        assert.ok(await page.locator(kept).first().isVisible(), kept);
    }
    assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector('#heat td button')).printColorAdjust), 'exact');
});

test('values are drawn even or by powers of ten as it is asked', async () => {
    const { page } = await open(browser, file, 'value=max_strain');
    const height = async () => {
        await plotted(page);
        return page.evaluate(() => weft.main.drawn[0].data[1].find((v) => v !== null));
    };
    const wanted = await page.evaluate(() => weft.main.points(weft.state.value)[0].y);
    await page.selectOption('#log', '1');
    assert.ok(Math.abs(await height() - Math.log10(wanted)) < 1e-12);
    await page.selectOption('#log', '0');
    assert.equal(await height(), wanted);
});

test('a point tells its run and opens it', async () => {
    const { page, said } = await open(browser, file);
    const [x, y, name] = await page.evaluate(() => {
        const plot = weft.main.drawn[0];
        const run = weft.batch.runs[9];
        const box = plot.over.getBoundingClientRect();
        const { x: along, value } = weft.state;
        return [box.left + plot.valToPos(along.place(run), 'x'), box.top + plot.valToPos(value.of(run, 0), 'y'), run.name];
    });
    await page.mouse.move(x, y);
    assert.match(await page.textContent('#tip'), /^largest strain, at the end \[%\] \d+\.\d+run 10: stiffness 100, damping 8\.0e-4$/);
    await page.mouse.click(x, y);
    await page.waitForFunction(() => window.weft?.page?.runs);
    assert.equal(await page.evaluate(() => weft.page.runs[0].directory), name);
    assert.equal(said.filter((text) => !text.startsWith('request: file:')).length, 0);
});

test('a row opens the player of its run, and back the batch is as it was', async () => {
    const { page } = await open(browser, file);
    await sortBy(page, 'damping [kg/s]');
    await page.locator('#runs tbody tr').nth(1).locator('td').nth(3).click();
    await page.waitForFunction(() => window.weft?.page?.runs);
    const { directory, frames, drop } = await page.evaluate(() => ({
        directory: weft.page.runs[0].directory, frames: weft.page.times.length, drop: weft.page.runs[0].blocks.at(-1).range(1)[0],
    }));
    assert.equal(directory, 'hung_stiffness=60_damping=1.0e-4');
    assert.equal(frames, 31);
    const final = readFileSync(`${root}/batch/${directory}/final.csv`, 'utf8').trim().split('\n').slice(1);
    assert.ok(Math.abs(drop - Math.min(...final.map((line) => Number(line.split(',')[3])))) < 1e-6);
    await page.evaluate(() => {
        weft.seek(20);
        weft.setColour(0);
    });
    assert.ok(await clothShare(page) > 0.02);
    assert.match(await page.textContent('#way'), /^all runs of batch\u00a0· run 5: stiffness 60, damping 1\.0e-4$/);
    await page.screenshot({ path: `${root}/batch-player.png` });
    await page.goBack();
    await page.waitForSelector('#runs tbody tr');
    assert.deepEqual(await page.locator('#runs [aria-sort=ascending]').allTextContents(), ['damping [kg/s]']);
    await page.locator('#runs a').first().click();
    await page.click('#way a');
    await page.waitForSelector('#runs tbody tr');
});

test('of fifty runs, of a thousand by make nightly, every one can be seen, found and played', async (t) => {
    const [across, up] = process.env.WHOLE ? [25, 8] : [5, 2];
    const runs = 5 * across * up;
    const { page, said, loading } = await open(browser, `${root}/thousand/batch.html`);
    t.diagnostic(`${runs} runs: open after ${(loading / 1000).toFixed(2)} s`);
    assert.equal(await page.locator('#runs tbody tr').count(), runs);
    assert.equal(await page.locator('#heat td button').count(), across * up);
    assert.match(await page.locator('#heat td button').first().getAttribute('aria-label'), /mean of 5 runs$/);
    await page.locator('#heat td button').first().click();
    assert.equal(await page.textContent('#found'), `5 of ${runs} runs`);
    await page.click('#everything');
    assert.equal(await page.locator('#runs tbody tr').count(), runs);
    await page.screenshot({ path: `${root}/thousand.png` });
    assert.deepEqual(said, []);
    await page.locator('#runs a').last().click();
    await page.waitForFunction(() => window.weft?.page?.runs);
    assert.match(await page.textContent('#way'), new RegExp(`run ${runs}:`));
});

test('words from scenes are words, and runs without frames have no link', async () => {
    const { page, said } = await open(browser, `${root}/odd/batch.html`);
    assert.deepEqual(said, []);
    assert.deepEqual(await column(page, 'name'), ['</template><script>alert(1)</script>', 'a "b", c', 'plain']);
    assert.equal(await page.locator('#runs a').count(), 2);
    assert.match(await page.locator('#runs tbody tr').last().locator('span').getAttribute('title'), /has no frames in this page/);
    assert.equal(await page.inputValue('#x'), 'name');
    await page.locator('#runs a').first().click();
    await page.waitForFunction(() => window.weft?.page?.runs);
    assert.equal(await page.textContent('#name'), '</template><script>alert(1)</script>');
});

test('dark where that is preferred, and by the button', async () => {
    const { page, said } = await open(browser, file, '', { colorScheme: 'dark' });
    const light = (list) => list.reduce((sum, [r, g, b]) => sum + r + g + b, 0) / (765 * list.length);
    assert.ok(light(await pixels(page, '#main')) < 0.25);
    await page.screenshot({ path: `${root}/batch-dark.png` });
    await page.click('#batch-theme');
    assert.ok(light(await pixels(page, '#main')) > 0.8);
    assert.deepEqual(said, []);
});

test('a phone shows all of it, and no wider than it is', async () => {
    for (const name of ['batch', 'thousand']) {
        const { page, said } = await open(browser, `${root}/${name}/batch.html`, '', PHONE);
        assert.deepEqual(await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]), [390, 390]);
        const [heat, main, runs, small] = await Promise.all(['#heat', '#main', '#runs', '#small'].map((id) => page.locator(id).boundingBox()));
        assert.ok(heat.y < main.y && main.y < runs.y && runs.y < small.y && main.width > 300);
        await page.screenshot({ path: `${root}/${name}-phone.png` });
        await page.locator('#runs a').nth(2).tap();
        await page.waitForFunction(() => window.weft?.page?.runs);
        await drawn(page);
        await page.screenshot({ path: `${root}/${name}-phone-player.png` });
        assert.deepEqual(said.filter((text) => !text.startsWith('request: file:')), []);
    }
});
