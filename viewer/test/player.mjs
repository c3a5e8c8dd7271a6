// SPDX-License-Identifier: BSD-3-Clause
// player.mjs -- the pages that tests/view/browser made, in a browser. The directory with
// the runs is the argument; screenshots are left in it.
import assert from 'node:assert/strict';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { clothShare, drawn, launch, open, PATIENCE, pixels, pixelsOf, saved, warmShare } from './browser.mjs';

const root = process.env.WEFT_VIEW;
const at = (name) => `${root}/${name}`;
const frame = (page) => page.evaluate(() => weft.state.frame);
const shot = (page, name) => drawn(page).then(() => page.screenshot({ path: at(name) }));

/** final.csv as x, y, z of each particle. */
const final = (run) => readFileSync(at(`${run}/final.csv`), 'utf8').trim().split('\n').slice(1)
    .map((line) => line.split(',').slice(2, 5).map(Number));

const plane = (page, block, index) => page.evaluate(
    ([name, k]) => {
        const { page: data } = weft;
        const list = name === 'apart' ? data.apart : data.runs[name].blocks;
        const last = list[list.length - 1];
        return { values: [...last.read(k, new Float64Array(data.count))], range: last.range(k) };
    },
    [block, index],
);

let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

test('a page loads without an error, a warning or a request', async () => {
    const { page, said } = await open(browser, at('a/run.html'));
    await drawn(page);
    assert.deepEqual(said, []);
    assert.equal(await page.title(), 'hung by two corners - weft');
    assert.match(await page.textContent('#summary'), /17 × 17 particles.*verlet velocity_verlet/);
});

test('nothing but its own script may run, and nothing can be fetched', async () => {
    const { page } = await open(browser, at('a/run.html'));
    const reached = await page.evaluate(async () => {
        const script = document.createElement('script');
        script.textContent = 'window.injected = true';
        document.body.append(script);
        const fetched = await fetch('https://example.invalid/').then(() => true, () => false);
        return { injected: window.injected ?? false, fetched };
    });
    assert.deepEqual(reached, { injected: false, fetched: false });
    const text = readFileSync(at('a/run.html'), 'utf8');
    assert.match(text, /default-src 'none'/);
    assert.doesNotMatch(text, /<(script|link|img)[^>]+(src|href)=["']?(https?:)?\/\//);
    assert.match(text, /three \S+ \(MIT\)[\s\S]*Permission is hereby granted/);
    assert.match(text, /uplot \S+ \(MIT\)[\s\S]*Permission is hereby granted/);
});

test('the cloth is drawn, falls, and is gone when it is hidden', async () => {
    const { page } = await open(browser, at('a/run.html'), 'threads=0&colour=plain');
    const first = await pixels(page, '#canvas');
    await page.evaluate(() => weft.seek(40));
    assert.ok(await clothShare(page) > 0.04);
    const later = await pixels(page, '#canvas');
    const moved = later.filter((p, i) => p.some((c, k) => Math.abs(c - first[i][k]) > 24)).length;
    assert.ok(moved > 0.04 * later.length);
    await page.evaluate(() => {
        weft.stage.views[0].cloth.group.visible = false;
        weft.stage.request();
    });
    assert.equal(await clothShare(page), 0);
});

test('positions and strains are those of the run', async () => {
    const { page } = await open(browser, at('a/run.html'));
    const wanted = final('a');
    for (let k = 0; k < 3; ++k) {
        const { values, range } = await plane(page, 0, k);
        const step = (range[1] - range[0]) / 65535;
        values.forEach((v, i) => assert.ok(Math.abs(v - wanted[i][k]) <= step + 1e-6));
    }
    const { values } = await plane(page, 0, 3);
    const most = await page.evaluate(() => weft.page.runs[0].columns.get('max_strain').at(-1));
    assert.ok(Math.abs(Math.max(...values) - most) < 1e-5);
});

test('play moves on, pause stops, the end stops', async () => {
    const { page } = await open(browser, at('a/run.html'));
    assert.equal(await frame(page), 0);
    await page.selectOption('#rate', { index: 0 }); // its end is far, however slow the browser
    await page.click('#play');
    await page.waitForFunction(() => weft.state.frame > 0 && (document.getElementById('play').click(), true));
    await page.selectOption('#rate', '4×');
    const stopped = await frame(page);
    await page.waitForTimeout(200);
    assert.equal(await frame(page), stopped);
    await page.evaluate(() => weft.seek(58));
    await page.click('#play');
    await page.waitForFunction(() => !weft.state.playing);
    assert.equal(await frame(page), 60);
    await page.selectOption('#rate', { index: 0 });
    await page.click('#play'); // once more from the start
    await page.waitForFunction(() => weft.state.playing && weft.state.frame < 50);
});

test('a page plays by itself, unless less motion is asked for', async () => {
    const lively = await open(browser, at('a/run.html'), '', { reducedMotion: 'no-preference' });
    await lively.page.waitForFunction(() => weft.state.frame > 0);
    const calm = await open(browser, at('a/run.html'));
    await calm.page.waitForTimeout(200);
    assert.equal(await frame(calm.page), 0);
});

test('the slider, a plot and the address go to a frame', async () => {
    const { page } = await open(browser, at('a/run.html'), 'frame=7');
    assert.equal(await frame(page), 7);
    await page.fill('#scrub', '45');
    assert.equal(await frame(page), 45);
    assert.equal(await page.textContent('#clock'), '1.500 s');
    const over = page.locator('.u-over').first();
    const box = await over.boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + 40);
    assert.ok(Math.abs(await frame(page) - 30) <= 1);
    const line = await over.locator('.now').boundingBox();
    assert.ok(Math.abs(line.x - box.x - box.width / 2) < 4);
});

test('every key does what the list of keys says', async () => {
    const { page } = await open(browser, at('a/run.html'), 'colour=plain');
    const press = async (key) => {
        await page.keyboard.press(key);
        return frame(page);
    };
    assert.equal(await press('ArrowRight'), 1);
    assert.equal(await press('Shift+ArrowRight'), 11);
    assert.equal(await press('ArrowLeft'), 10);
    assert.equal(await press('End'), 60);
    assert.equal(await press('Home'), 0);
    await press('Space');
    assert.equal(await page.evaluate(() => weft.state.playing), true);
    await press('Space');
    assert.equal(await page.evaluate(() => weft.state.playing), false);
    await press('+');
    assert.equal(await page.inputValue('#rate'), '2×');
    await press('-');
    await press('-');
    assert.equal(await page.inputValue('#rate'), '0.5×');
    await press('c');
    assert.equal(await page.inputValue('#colour'), 'strain');
    const threads = await page.isChecked('#threads');
    await press('t');
    assert.equal(await page.isChecked('#threads'), !threads);
    assert.equal(await page.isChecked('#follow'), false);
    await press('f');
    assert.equal(await page.isChecked('#follow'), true);
    await press('d');
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
    await press('?');
    assert.ok(await page.isVisible('#keys'));
    await press('Escape');
    assert.ok(await page.isHidden('#keys'));
    await press('Tab');
    const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
    assert.equal(outline, 'solid');
});

test('the mouse turns the view, R fits it to all frames again', async () => {
    const { page } = await open(browser, at('a/run.html'));
    const camera = () => page.evaluate(() => weft.stage.camera.position.toArray());
    const fitted = await camera();
    await page.mouse.move(400, 400);
    await page.mouse.down();
    await page.mouse.move(500, 420, { steps: 4 });
    await page.mouse.up();
    const turned = await camera();
    assert.ok(Math.abs(turned[0] - fitted[0]) > 0.1);
    await page.keyboard.press('Shift+R');
    (await camera()).forEach((x, k) => assert.ok(Math.abs(x - fitted[k]) < 1e-6));
});

test('the camera starts 25 degrees above the cloth, and sees it from a side', async () => {
    for (const name of ['a', 'edge', 'shapes', 'panels']) {
        const { page } = await open(browser, at(`${name}/run.html`), 'colour=plain&threads=0');
        const rise = await page.evaluate(() => {
            const { camera, controls } = weft.stage;
            const way = camera.position.clone().sub(controls.target).normalize();
            return (Math.asin(way.y) * 180) / Math.PI;
        });
        assert.ok(Math.abs(rise - 25) < 1e-6, `${name} ${rise}`);
        assert.ok(await clothShare(page) > 0.02, name);
    }
});

test('a cloth that moves far is followed, and r fits the frame that is shown', async () => {
    const { page } = await open(browser, at('falls/run.html'), 'colour=plain&threads=0');
    assert.ok(await page.isChecked('#follow'));
    const first = await clothShare(page);
    await page.keyboard.press('End');
    const last = await clothShare(page);
    assert.ok(first > 0.05 && Math.abs(last - first) < 0.02, `${first} ${last}`);
    await page.keyboard.press('f');
    await page.keyboard.press('Home');
    assert.equal(await clothShare(page), 0); // the camera stays below
    await page.keyboard.press('r');
    assert.ok(await clothShare(page) > 0.05);
    await page.keyboard.press('Shift+R');
    const small = await clothShare(page);
    assert.ok(small > 0 && small < 0.02, String(small));
    const near = await open(browser, at('a/run.html'));
    assert.equal(await near.page.isChecked('#follow'), false);
});

test('strain is shown first where it is above 1 %', async () => {
    for (const [name, colour] of [['a', 'strain'], ['edge', 'plain'], ['spring', 'strain']]) {
        const { page } = await open(browser, at(`${name}/run.html`), 'frame=0');
        const most = await page.evaluate(() => weft.page.runs[0].columns.get('max_strain').reduce((a, b) => Math.max(a, b)));
        assert.equal(most > 0.01, colour === 'strain', name);
        assert.equal(await page.inputValue('#colour'), colour, name);
    }
});

test('the picture is saved as a PNG with its words', async () => {
    const { page, said } = await open(browser, at('a/run.html'), 'frame=40&colour=plain&threads=0');
    const { name, bytes } = await saved(page, () => page.click('#png'));
    assert.equal(name, 'a-frame-40.png');
    writeFileSync(at('saved.png'), bytes);
    const size = [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
    assert.deepEqual(size, await page.evaluate(() => [weft.stage.canvas.width, weft.stage.canvas.height]));
    const [share, onPage] = [warmShare(await pixelsOf(bytes)), await clothShare(page)];
    assert.ok(share > 0.02 && Math.abs(share - onPage) < 0.01, `${share} ${onPage}`);
    assert.deepEqual(said, []);
});

test('a film is a WebM of the run', async () => {
    const { page, said } = await open(browser, at('limited/run.html'));
    await page.selectOption('#rate', '0.25×');
    const { name, bytes } = await saved(page, () => page.click('#webm'), PATIENCE);
    assert.equal(name, 'limited.webm');
    writeFileSync(at('saved.webm'), bytes);
    assert.deepEqual([...bytes.subarray(0, 4)], [0x1a, 0x45, 0xdf, 0xa3]); // EBML
    const reader = await page.context().newPage();
    const seen = await reader.evaluate(async (text) => {
        const video = Object.assign(document.createElement('video'), { muted: true });
        const ended = new Promise((done) => { video.onended = done; });
        video.src = `data:video/webm;base64,${text}`;
        await video.play();
        await ended;
        return [video.videoWidth, video.videoHeight, video.getVideoPlaybackQuality().totalVideoFrames];
    }, bytes.toString('base64'));
    const size = await page.evaluate(() => [weft.stage.canvas.width, weft.stage.canvas.height]);
    assert.ok(size.every((length, k) => Math.abs(seen[k] - length) < 2) && seen[2] > 1, seen.join());
    assert.equal(await page.getAttribute('#webm', 'aria-pressed'), 'false');
    assert.deepEqual(said, []);
});

test('every plot has an axis of time, and is saved as SVG and CSV', async () => {
    const { page, said } = await open(browser, at('a/compare.html'));
    const plots = page.locator('#plots .uplot');
    const titles = await page.locator('.u-title').allTextContents();
    assert.ok(titles.slice(0, -1).every((title) => /\[.+\]$/.test(title)), titles.join());
    assert.deepEqual(await page.evaluate(() => [...new Set(weft.plots.drawn.map((plot) => plot.axes[0].label))]), ['time t [s]']);
    const tables = [];
    for (let i = 0; i < titles.length; ++i) {
        const [svg, csv] = [await saved(page, () => plots.nth(i).getByText('SVG').click()), await saved(page, () => plots.nth(i).getByText('CSV').click())];
        tables.push(csv);
        const picture = svg.bytes.toString();
        assert.ok(picture.includes('<polyline') && picture.includes('time t [s]') && picture.includes(titles[i].replace(/&/g, '&#38;')), titles[i]);
        const wrong = await page.evaluate((text) => new DOMParser().parseFromString(text, 'image/svg+xml').querySelector('parsererror')?.textContent, picture);
        assert.equal(wrong, undefined);
        const [head, ...lines] = csv.bytes.toString().trim().split('\n').map((line) => line.split(','));
        const { data, labels } = await page.evaluate((k) => ({
            data: weft.plots.drawn[k].data[0], labels: weft.plots.drawn[k].series.slice(1).map(({ label }) => label),
        }), i);
        assert.deepEqual(head.slice(1), labels.map((label) => `${label} ${/\[.*\]$/.exec(titles[i]) ?? ''}`.trim()));
        assert.deepEqual(lines.map(([t]) => Number(t)), data);
        writeFileSync(at(`plot-${i}.svg`), picture);
    }
    const kinetic = tables[1].bytes.toString().trim().split('\n').slice(1).map((line) => Number(line.split(',')[1]));
    assert.deepEqual(kinetic, await page.evaluate(() => weft.page.runs[0].columns.get('kinetic')));
    assert.deepEqual(said, []);
});

test('on paper there are no controls', async () => {
    const { page } = await open(browser, at('a/run.html'), 'frame=40');
    assert.ok(await page.isVisible('#controls'));
    await page.emulateMedia({ media: 'print' });
    for (const gone of ['#controls', '.save', '#files details']) {
        assert.ok(await page.locator(gone).first().isHidden(), gone);
    }
    for (const kept of ['#canvas', '#legend', '.uplot']) {
        assert.ok(await page.locator(kept).first().isVisible(), kept);
    }
    await page.setViewportSize({ width: 718, height: 1000 }); // A4
    await drawn(page);
    await page.waitForFunction(() => document.documentElement.scrollWidth <= 718);
    const boxes = await page.locator('.uplot').evaluateAll((list) => list.map((one) => one.getBoundingClientRect().toJSON()));
    assert.equal(boxes[0].top, boxes[1].top);
    assert.ok(boxes.every(({ right }) => right <= 718) && boxes[0].right <= boxes[1].left, JSON.stringify(boxes));
    await page.screenshot({ path: at('print.png'), fullPage: true });
    writeFileSync(at('print.pdf'), await page.pdf({ format: 'A4' }));
});

test('colours have a bar with numbers and a unit', async () => {
    const { page } = await open(browser, at('a/run.html'), 'frame=40&colour=plain');
    assert.ok(await page.isHidden('#legend'));
    for (const [name, unit] of [['strain', '%'], ['speed', 'm/s']]) {
        await page.selectOption('#colour', name);
        assert.equal(await page.textContent('#legend-title'), `${name} [${unit}]`);
        const ticks = await page.locator('#legend-ticks span').allTextContents();
        assert.equal(ticks.length, 5);
        assert.ok(ticks.every((text, i) => i === 0 || Number(text) > Number(ticks[i - 1])));
    }
});

test('facts are parted by dots behind them, so that no line begins with one', async () => {
    const { page } = await open(browser, at('a/run.html'), '', { viewport: { width: 390, height: 844 } });
    const [before, behind] = await page.evaluate(() => ['::before', '::after'].map((part) => (
        [...document.querySelectorAll('#summary .fact')].map((fact) => getComputedStyle(fact, part).content))));
    assert.ok(before.length > 3 && before.every((text) => text === 'none'));
    assert.deepEqual(behind, [...behind.slice(1).map(() => '"\u00b7"'), 'none']);
});

test('plots show the columns there are', async () => {
    const { page } = await open(browser, at('a/run.html'));
    const titles = await page.locator('.u-title').allTextContents();
    assert.deepEqual(titles, ['energy [J]', 'largest strain [%]', 'step size [s]',
        'evaluations per frame']);
    const legend = await page.locator('.uplot').first().textContent();
    for (const name of ['kinetic', 'elastic', 'gravitational', 'total']) {
        assert.match(legend, new RegExp(name));
    }
    assert.doesNotMatch(legend, /dissipated|contact/);
    const touching = await open(browser, at('shapes/run.html'));
    assert.match(await touching.page.locator('.uplot').first().textContent(), /contact/);
    const ledger = await open(browser, at('spring/run.html'));
    assert.match(await ledger.page.locator('.uplot').first().textContent(), /dissipated/);
    const without = readFileSync(at('a/run.html'), 'utf8').replace(/,step_size,/, ',other,');
    writeFileSync(at('columns.html'), without);
    const other = await open(browser, at('columns.html'));
    assert.equal((await other.page.locator('.u-title').allTextContents()).length, 3);
    assert.deepEqual(other.said, []);
});

test('a limit has its curve, and without one there is none', async () => {
    const strains = async (file) => {
        const { page } = await open(browser, at(file));
        return page.locator('.uplot').nth(1).textContent();
    };
    assert.match(await strains('limited/run.html'), /limited/);
    assert.doesNotMatch(await strains('a/run.html'), /limited/);
});

test('frames that were left out keep their numbers', async () => {
    const { page } = await open(browser, at('limited/run.html'), 'frame=2');
    assert.equal(await page.getAttribute('#clock', 'title'), 'frame 8 of 15');
    assert.equal(await page.textContent('#clock'), '0.267 s');
});

test('two runs are shown side by side with what parts them', async () => {
    const { page, said } = await open(browser, at('a/compare.html'), 'frame=40&quality=fine');
    assert.deepEqual(said, []);
    assert.equal(await page.inputValue('#colour'), 'difference');
    assert.equal(await page.textContent('#legend-title'), 'difference [m]');
    assert.equal(await page.locator('#labels span').count(), 2);
    assert.equal(await page.locator('.u-title').first().textContent(), 'largest difference [m]');
    const [a, b] = [final('a'), final('b')];
    const { values, range } = await plane(page, 'apart', 0);
    const step = range[1] / 65535;
    values.forEach((v, i) => {
        const apart = Math.hypot(...a[i].map((x, k) => x - b[i][k]));
        assert.ok(Math.abs(v - apart) <= step + 1e-6);
    });
    assert.ok(range[1] > 1e-6);
    await shot(page, 'compare.png');
    await page.selectOption('#colour', 'plain');
    const wide = await pixels(page, '#canvas');
    const width = await page.evaluate(() => document.getElementById('canvas').clientWidth);
    const warm = (left) => wide.filter(([r, , b2], i) => (i % width < width / 2) === left && r > 1.35 * b2 && r - b2 > 30).length;
    assert.ok(warm(true) > 1000 && warm(false) > 1000);
});

test('a mesh has its triangles, its seam and its flat rest shape', async () => {
    const { page, said } = await open(browser, at('panels/run.html'), 'frame=5&threads=0&colour=plain');
    assert.match(await page.textContent('#summary'), /6 vertices, 4 triangles/);
    const { faces, threads, seams, places } = await page.evaluate(() => {
        const { surface } = weft.page;
        const list = (of) => [...of];
        return { faces: list(surface.faces), threads: list(surface.threads), seams: list(surface.seams), places: list(surface.rest.of) };
    });
    assert.deepEqual([faces.length, threads.length, places.length], [12, 18, 8]);
    assert.deepEqual(seams, [1, 4]);
    const [x, y, z] = await Promise.all([0, 1, 2].map((k) => plane(page, 0, k)));
    readFileSync(at('panels/final.csv'), 'utf8').trim().split('\n').slice(1).forEach((line, i) => {
        const [vertex, ...end] = line.split(',').map(Number);
        assert.equal(vertex, i);
        [x, y, z].forEach(({ values, range }, k) => assert.ok(Math.abs(values[i] - end[k]) <= (range[1] - range[0]) / 65535 + 1e-6));
    });
    const share = async () => {
        await drawn(page);
        return clothShare(page);
    };
    const alone = await share();
    await page.keyboard.press('p');
    assert.ok(await page.isChecked('#rest'));
    assert.equal(await page.evaluate(() => weft.stage.views.length), 2);
    assert.ok(alone > 0.02 && await share() > 0.02);
    await shot(page, 'panels.png');
    await page.uncheck('#rest');
    assert.equal(await share(), alone);
    assert.deepEqual(said, []);
    const grid = await open(browser, at('a/run.html'));
    assert.ok(await grid.page.isHidden('#rest-shape'));
});

test('runs of different frame times are shown at the times both have', async () => {
    const { page } = await open(browser, at('times.html'));
    const times = await page.evaluate(() => weft.page.times);
    assert.deepEqual(times.map((t) => Math.round(t * 1e6)), [0, 166667, 333333, 500000]);
    assert.match(await page.textContent('#notes'), /4 times that both runs have/);
    const labels = await page.locator('#labels span').allTextContents();
    assert.deepEqual(labels.map((text) => text.trim()), ['A fps24', 'B fps30']);
});

test('a hostile scene name is only text', async () => {
    const { page, said } = await open(browser, at('hostile/run.html'));
    assert.deepEqual(said, []);
    const name = '</script><script>alert(1)</script><!-- "\\\u00e9&amp;';
    assert.equal(await page.textContent('#name'), name);
    assert.equal(await page.evaluate(() => document.scripts.length),
        await page.evaluate(() => weft.page.times.length + 2));
    await page.locator('details').first().click();
    assert.match(await page.locator('details pre').first().textContent(), /<script>alert\(1\)/);
});

test('a page beyond its budget is thinned and says so', async () => {
    const { page } = await open(browser, at('long/run.html'));
    assert.ok(statSync(at('long/run.html')).size < 66e6);
    const times = await page.evaluate(() => weft.page.times);
    assert.equal(times.length, 301);
    assert.match(await page.textContent('#notes'), /thinned to 301 of 601 frames/);
    const wide = await open(browser, at('wide/run.html'));
    assert.match(await wide.page.textContent('#notes'), /every 2\. of 300 × 40 particles/);
    assert.deepEqual(await wide.page.evaluate(() => weft.page.shown), [151, 21]);
});

test('a chain is a line of beads', async () => {
    const { page, said } = await open(browser, at('chain/run.html'), 'frame=20&quality=fine&colour=plain');
    assert.deepEqual(said, []);
    assert.ok(await clothShare(page) > 1e-4);
    await shot(page, 'chain.png');
    const plain = await pixels(page, '#canvas');
    await page.selectOption('#colour', 'speed');
    await page.evaluate(() => { document.getElementById('legend').hidden = true; });
    const speed = await pixels(page, '#canvas');
    assert.ok(speed.filter((p, i) => p.some((c, k) => Math.abs(c - plain[i][k]) > 24)).length > 100);
});

test('the line of a chain is light on dark and dark on light', async () => {
    for (const [colorScheme, sign] of [['light', -1], ['dark', 1]]) {
        const { page } = await open(browser, at('chain/run.html'), 'frame=20&quality=fine', { colorScheme });
        const seen = await pixels(page, '#canvas');
        await page.evaluate(() => {
            weft.stage.views[0].cloth.lines.visible = false;
            weft.stage.request();
        });
        const bare = await pixels(page, '#canvas');
        const changes = seen.map((p, i) => p[0] - bare[i][0]).filter((d) => Math.abs(d) > 40);
        assert.ok(changes.length > 100 && changes.filter((d) => sign * d > 0).length > 0.9 * changes.length, colorScheme);
    }
});

test('an interrupted run says so', async () => {
    const text = readFileSync(at('a/run.html'), 'utf8')
        .replace('status: done\\u000areason: \\"\\"', 'status: failed\\u000areason: \\"h < 1e-12\\"');
    writeFileSync(at('failed.html'), text);
    const { page } = await open(browser, at('failed.html'));
    assert.equal(await page.textContent('.bad'), 'failed: h < 1e-12');
    assert.ok(await page.isHidden('#more')); // it has room
});

/** Diagonals of the boxes of the frames of the first run, over that of frame 0. */
const growth = (page) => page.evaluate(() => {
    const { blocks } = weft.page.runs[0];
    const size = (block) => Math.hypot(...[0, 1, 2].map((k) => block.range(k)[1] - block.range(k)[0]));
    return blocks.map((block) => size(block) / size(blocks[0]));
});
/** Whether what the stage draws of the cloth is in the picture in part. */
const isInView = (page) => page.evaluate(() => {
    const { camera, views, centre } = weft.stage;
    const { array } = views[0].cloth.geometry.attributes.position;
    camera.updateMatrixWorld();
    for (let i = 0; i < array.length; i += 3) {
        const [x, y, z] = centre.clone().set(...array.subarray(i, i + 3)).project(camera).toArray();
        if (Math.abs(x) <= 1 && Math.abs(y) <= 1 && Math.abs(z) <= 1) {
            return true;
        }
    }
    return false;
});

test('the stage follows the onset of a blow-up and is never empty', async () => {
    const { page, said } = await open(browser, at('blown/run.html'), 'frame=0&threads=0');
    const sizes = await growth(page);
    const { calm, held, size, first } = await page.evaluate(() => ({ ...weft.page.runs[0], size: weft.stage.size, first: weft.page.runs[0].blocks[0] }));
    assert.ok(first && sizes.slice(0, calm).at(-1) <= 2 && sizes[calm] > 2 && sizes.at(-1) > 10, sizes.join());
    assert.ok(sizes.slice(0, held + 1).every((ratio) => ratio <= 10));
    assert.ok(size < 10);
    for (const at_ of [0, calm - 1, calm, held, held + 1, sizes.length - 1]) {
        await page.evaluate((k) => weft.seek(k), at_);
        assert.ok(await isInView(page), `frame ${at_}`);
        assert.equal(/left the picture/.test(await page.textContent('#labels')), at_ >= calm);
        assert.equal(/shown as at/.test(await page.textContent('#labels')), at_ > held);
        assert.equal(await page.evaluate(() => weft.stage.views[0].cloth.surface.material.transparent), at_ > held);
    }
    await shot(page, 'blown.png');
    const drawnNow = () => page.evaluate(() => [...weft.stage.views[0].cloth.geometry.attributes.position.array.slice(0, 300)]);
    const last = await drawnNow();
    await page.evaluate((k) => weft.seek(k), held);
    assert.deepEqual(await drawnNow(), last);
    assert.deepEqual(said, []);
});

test('a blow-up has strain on a log scale to 100 %, and a line that says when and what left', async () => {
    const { page } = await open(browser, at('blown/run.html'), 'frame=0');
    assert.equal(await page.inputValue('#colour'), 'strain');
    assert.deepEqual(await page.locator('#legend-ticks span').allTextContents(), ['0.1', '1', '10', '100']);
    const { labels } = await plotted(page, 'largest strain [%]');
    assert.deepEqual(labels, ['0.1', '1', '10', '100']);
    const [time, left] = await page.evaluate(() => {
        const { page: data, plots } = weft;
        return [data.times[data.runs[0].calm], plots.drawn.map((plot) => plot.data[0].at(-1))];
    });
    assert.ok(left.every((t) => t <= time), left.join());
    assert.match(await page.textContent('#notes'), new RegExp(`^blows up at ${time.toFixed(3)} s: particle \\(\\d+, \\d+\\) leaves the picture.*failed: not finite`));
    const tall = async () => (await page.locator('#said').boundingBox()).height;
    const line = await tall();
    assert.ok(line < 30);
    await page.click('#more');
    assert.ok(await tall() > 1.5 * line);
    assert.match(await page.textContent('#said'), /at most twice as large as at the start/);
    await page.click('#more');
    assert.equal(await tall(), line);
});

test('the run that leaves a pair is named, and the other is still seen', async () => {
    const { page, said } = await open(browser, at('onset.html'), 'frame=40');
    const captions = await page.locator('#labels .caption').allTextContents();
    assert.equal(captions[0], '');
    assert.match(captions[1], /^particle \(\d+, \d+\) left the picture at 0\.\d+ s/);
    assert.match(await page.textContent('#notes'), /^B blows up at/);
    assert.ok(await page.evaluate(() => weft.stage.size) < 10);
    assert.ok(await isInView(page));
    await shot(page, 'onset.png');
    assert.deepEqual(said, []);
});

test('a blow-up is played slowly, and to its end', async () => {
    const { page } = await open(browser, at('blown/run.html'));
    const held = await page.evaluate(() => weft.page.runs[0].held);
    const rate = Number.parseFloat(await page.inputValue('#rate'));
    assert.ok(rate < 1);
    await page.evaluate((k) => weft.seek(k - 1), held);
    await page.selectOption('#rate', '4×');
    await page.click('#play');
    await page.waitForFunction(() => !weft.state.playing);
    assert.equal(await frame(page), held + 1);
});

/** What a plot of this title shows: the labels of its vertical axis, and of each curve
 * the heights [px] of its values. */
const plotted = (page, title) => page.evaluate((wanted) => {
    const u = weft.plots.drawn.find((one) => one.root.querySelector('.u-title').textContent === wanted);
    return {
        labels: u.axes[1]._values,
        heights: u.data.slice(1).map((list) => list.map((v) => (v === null ? null : u.valToPos(v, 'y')))),
        tall: u.over.clientHeight,
    };
}, title);

test('a run that blows up at once shows its start, and all that is finite if it is asked to', async () => {
    const { page, said } = await open(browser, at('early/run.html'), 'colour=plain&quality=fine');
    assert.equal(await page.isChecked('#all'), false);
    await page.keyboard.press('End');
    assert.ok(await clothShare(page) > 0.01);
    assert.match(await page.textContent('#notes'), /^blows up at 0\.033 s: .*Record more frames of the onset with --set run\.fps=2000/);
    await page.keyboard.press('a');
    assert.equal(await page.isChecked('#all'), true);
    assert.match(await page.textContent('#notes'), /^blows up at 0\.033 s: .*every frame has a scale/);
    assert.equal((await page.locator('#labels .caption').allTextContents()).join(''), '');
    await drawn(page);
    for (const title of ['energy [J]', 'largest strain [%]']) {
        const { labels, heights, tall } = await plotted(page, title);
        assert.ok(labels.length > 2 && labels.includes('0') && labels.some((text) => /^1e\d\d/.test(text)), labels.join());
        const last = heights.at(-1);
        assert.ok(last.every((y, i) => y >= 0 && y <= tall && (i === 0 || y < last[i - 1])), last.join());
    }
    assert.ok((await plotted(page, 'step size [s]')).labels.length > 0);
    const floors = [];
    for (const i of [1, 3, 5]) {
        await page.evaluate((k) => weft.seek(k), i);
        floors.push(Number(/floor: (\S+) m/.exec(await page.textContent('#scale'))[1]));
        const cloth = await page.evaluate(() => [...weft.stage.views[0].cloth.geometry.attributes.position.array].every((x, k) => Math.abs(x - weft.stage.centre.toArray()[k % 3]) <= weft.stage.size));
        assert.ok(cloth, `frame ${i}`);
    }
    assert.ok(floors[0] > 1e3 && floors[1] > 1e3 * floors[0] && floors[2] >= floors[1], floors.join());
    await page.selectOption('#colour', 'strain');
    assert.match(await page.textContent('#legend-ticks'), /^1.*1e\d\d$/);
    await shot(page, 'early.png');
    await page.keyboard.press('a');
    assert.equal(await page.isChecked('#all'), false);
    assert.equal(await page.textContent('#scale'), 'floor: 0.2 m a square');
    assert.deepEqual(said, []);
    const calm = await open(browser, at('a/run.html'));
    assert.ok(await calm.page.isHidden('#fit-all'));
});

test('the drift of an oscillator is seen in its own plot', async () => {
    const title = 'energy error (residual) [J]';
    const range = (list) => Math.max(...list) - Math.min(...list);
    const alone = await open(browser, at('spring/run.html'));
    const { labels, heights, tall } = await plotted(alone.page, title);
    assert.ok(range(heights[0]) > 0.7 * tall && labels.some((text) => /e-6/.test(text)), labels.join());
    const two = await open(browser, at('drift.html'));
    await shot(two.page, 'drift.png');
    const both = await plotted(two.page, title);
    assert.ok(both.heights.every((list) => range(list) > 0.1 * tall), both.heights.map(range).join());
    const none = await open(browser, at('a/run.html'));
    assert.doesNotMatch(await none.page.textContent('#plots'), /residual/);
});

test('the second run is dashed in the legends, too', async () => {
    const { page } = await open(browser, at('a/compare.html'));
    const styles = await page.locator('.uplot').nth(1).locator('.u-series').evaluateAll((list) => list
        .map((row) => [row.textContent.slice(0, 1), getComputedStyle(row.querySelector('.u-marker')).borderTopStyle]));
    const shown = styles.filter(([name]) => 'AB'.includes(name));
    assert.equal(shown.length, 6);
    assert.ok(shown.every(([name, style]) => style === (name === 'A' ? 'solid' : 'dashed')), shown.join());
});

test('shapes are drawn where they are in a frame', async () => {
    const { page, said } = await open(browser, at('shapes/run.html'), 'frame=0&threads=0');
    assert.deepEqual(said, []);
    const seen = async (k, frame) => {
        await page.evaluate(([i, f]) => {
            weft.seek(f);
            weft.stage.views[0].cloth.group.visible = false;
            weft.stage.views[0].shapes.group.children.forEach((shape, j) => { shape.visible = i === j; });
            weft.stage.request();
        }, [k, frame]);
        return pixels(page, '#canvas');
    };
    const bare = await seen(-1, 0);
    const share = async (k, frame) => (await seen(k, frame)).map(
        (p, i) => p.some((c, j) => Math.abs(c - bare[i][j]) > 8),
    );
    for (const k of [0, 1, 2, 3]) {
        assert.ok((await share(k, 0)).filter(Boolean).length > 200, `shape ${k}`);
    }
    const [first, last] = [await share(1, 0), await share(1, 15)];
    assert.ok(first.filter((x, i) => x !== last[i]).length > 100);
    await page.evaluate(() => {
        weft.stage.views[0].cloth.group.visible = true;
        weft.stage.views[0].shapes.group.children.forEach((shape) => { shape.visible = true; });
    });
    await page.selectOption('#colour', 'gap');
    for (const theme of ['light', 'dark']) {
        await shot(page, `shapes-${theme}.png`);
        await page.keyboard.press('d');
    }
});

test('a sensitivity colours the cloth by its length', async () => {
    const { page, said } = await open(browser, at('sensed/run.html'), 'colour=s_forces.gravity.1&threads=0');
    assert.deepEqual(said, []);
    assert.deepEqual(await page.evaluate(() => weft.page.fields.slice(2)), ['s_cloth.springs.stretch.stiffness', 's_forces.gravity.1']);
    assert.equal(await page.textContent('#legend-title'), 's_forces.gravity.1 [m]');
    const wanted = readFileSync(at('sensed/sensitivity.csv'), 'utf8').trim().split('\n')
        .filter((line) => line.startsWith('forces.gravity.1,')).map((line) => Math.hypot(...line.split(',').slice(3, 6).map(Number)));
    const { values, range } = await plane(page, 0, 6);
    assert.equal(values.length, wanted.length);
    values.forEach((v, i) => assert.ok(Math.abs(v - wanted[i]) <= (range[1] - range[0]) / 65535 + 1e-6, `${i}: ${v} ${wanted[i]}`));
});

test('several cloths have a colour and a name each, which the pointer finds', async () => {
    const { page, said } = await open(browser, at('cloths/run.html'), 'frame=0&threads=0');
    assert.match(await page.textContent('#summary'), /12 vertices, 8 triangles in 2 cloths/);
    assert.equal(await page.textContent('#legend-ticks'), '\u25a0 left\u25a0 right');
    assert.equal(await page.inputValue('#colour'), 'plain');
    const over = async (vertices) => {
        const place = await page.evaluate((list) => {
            const { views: [{ cloth }], camera, canvas } = weft.stage;
            const { position } = cloth.geometry.attributes;
            const middle = weft.stage.centre.clone().set(0, 0, 0);
            list.forEach((i) => middle.add(middle.clone().fromBufferAttribute(position, i).divideScalar(list.length)));
            const { x, y } = middle.project(camera);
            const { left, top, width, height } = canvas.getBoundingClientRect();
            return [left + ((1 + x) / 2) * width, top + ((1 - y) / 2) * height];
        }, vertices);
        await page.mouse.move(...place);
        await drawn(page);
        return { place, name: await page.isVisible('#tip') ? page.textContent('#tip') : null };
    };
    const [left, right] = [await over([0, 1, 4]), await over([6, 7, 10])];
    assert.deepEqual([await left.name, await right.name], ['left', 'right']);
    await page.mouse.move(left.place[0], 5);
    assert.ok(await page.isHidden('#tip'));
    const inks = await page.evaluate(() => [0, 6].map((i) => [...weft.stage.views[0].cloth.geometry.attributes.color.array.subarray(3 * i, 3 * i + 3)]));
    assert.notDeepEqual(...inks);
    await page.selectOption('#colour', 'strain');
    assert.match(await page.textContent('#legend-title'), /strain/);
    assert.deepEqual(said, []);
});

test('meshes of shapes lie on their surfaces, and gaps are those of the run', async () => {
    const { page } = await open(browser, at('shapes/run.html'), 'frame=15');
    const far = await page.evaluate(() => weft.stage.views[0].shapes.list.map((shape, k) => {
        const mesh = weft.stage.views[0].shapes.group.children[k];
        const { position } = mesh.geometry.attributes;
        const turned = mesh.geometry.clone().applyQuaternion(mesh.quaternion).translate(...mesh.position.toArray()).attributes.position;
        const block = { read: (plane, out) => out.map((_, i) => turned.array[3 * i + plane]) };
        const found = weft.gaps(weft.page, { obstacles: [shape], blocks: { 15: block } }, 15, new Float32Array(position.count));
        return Math.max(...found.map(Math.abs));
    }));
    assert.ok(far.every((gap) => gap < 1e-6), far.join());
    const [shown, told] = await page.evaluate(() => {
        const { page: data } = weft;
        const [run] = data.runs;
        return [Math.min(...weft.gaps(data, run, 15, new Float32Array(data.count))), run.columns.get('min_gap').at(-1)];
    });
    assert.ok(Math.abs(shown - told) < 1e-4, `${shown} ${told}`);
    await page.selectOption('#colour', 'gap');
    assert.equal(await page.textContent('#legend-title'), 'gap [mm]');
    assert.deepEqual(await page.locator('#legend-ticks span').allTextContents(), ['10', '7.5', '5', '2.5', '0']);
    assert.ok((await page.locator('.u-title').allTextContents()).includes('smallest gap [m]'));
});

test('the gap of cloth to itself is that of the run', async () => {
    const { page } = await open(browser, at('towel/run.html'), 'frame=30&colour=gap');
    const [near, told, first] = await page.evaluate(() => {
        const { page: data } = weft;
        const [run] = data.runs;
        const least = (frame) => Math.min(...weft.gaps(data, { ...run, obstacles: [] }, frame, new Float32Array(data.count)));
        return [least(30), run.columns.get('self_gap').at(-1), least(0)];
    });
    assert.ok(near >= told - 1e-5 && near < 1.5 * told, `${near} ${told}`); // edges may be nearer
    assert.equal(first, Infinity);
    assert.equal(await page.textContent('#legend-title'), 'gap [mm]');
    assert.ok((await page.locator('.u-title').allTextContents()).includes('smallest gap [m]'));
    await shot(page, 'towel.png');
});

test('light, dark and a phone', async () => {
    const light = await open(browser, at('a/run.html'), 'frame=40&quality=fine');
    await shot(light.page, 'light.png');
    const dark = await open(browser, at('a/run.html'), 'frame=40&colour=strain&quality=fine', { colorScheme: 'dark' });
    await shot(dark.page, 'dark.png');
    const paper = ({ page }) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    assert.notEqual(await paper(light), await paper(dark));
    const phone = await open(browser, at('a/run.html'), 'frame=40&quality=fine', {
        viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2,
    });
    await shot(phone.page, 'phone.png');
    assert.ok(await phone.page.evaluate(() => document.documentElement.scrollWidth) <= 390);
    for (const control of ['#play', '#scrub', '#colour', '#rate', '#help']) {
        const box = await phone.page.locator(control).boundingBox();
        assert.ok(box.x >= 0 && box.x + box.width <= 390 && box.y + box.height <= 844, control);
    }
    await phone.page.tap('#play');
    await phone.page.waitForFunction(() => weft.state.frame > 41);
});

test('without WebGL the plots are still there', async () => {
    const poor = await launch('--disable-3d-apis');
    const { page } = await open(poor, at('a/run.html'));
    assert.ok(await page.isVisible('#no-webgl'));
    assert.equal(await page.locator('.u-title').count(), 4);
    await page.fill('#scrub', '30');
    assert.equal(await page.textContent('#clock'), '1.000 s');
    await poor.close();
});

test('the time a page of 100 x 100 particles and 120 frames takes is told', { skip: !process.env.WHOLE }, async (t) => {
    await open(browser, at('big/run.html')); // the browser's own start is not the page's
    const { page, loading } = await open(browser, at('big/run.html'));
    const cost = await page.evaluate(() => {
        const gl = weft.stage.renderer.getContext();
        const began = performance.now();
        for (let i = 0; i < 60; ++i) {
            weft.seek(i);
            weft.stage.draw();
            gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        }
        return (performance.now() - began) / 60;
    });
    t.diagnostic(`loaded in ${(loading / 1000).toFixed(2)} s, `
        + `${(statSync(at('big/run.html')).size / 1e6).toFixed(1)} MB, ${cost.toFixed(1)} ms a frame`);
    assert.equal(await page.evaluate(() => weft.page.times.length), 121);
});
