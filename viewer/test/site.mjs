// SPDX-License-Identifier: BSD-3-Clause
// site.mjs -- node site.mjs SITE [FOLDER [PAGE...]]: the pages of the site as files, narrow and wide, light and dark:
// nothing is fetched, nothing is wider than the screen, and the search finds words. With FOLDER, pictures of them.
import { pathToFileURL } from 'node:url';
import { launch } from './browser.mjs';

const [site, folder, ...named] = process.argv.slice(2);
const PAGES = ['index', 'docs/start/gallery', 'scenes/ball', 'docs/reference/integrators', 'reference/sim', 'reference/python'];
const browser = await launch();
const faults = [];

async function visit(address, settings) {
    const page = await (await browser.newContext(settings)).newPage();
    page.on('pageerror', (error) => faults.push(`${address}: ${error.message}`));
    page.on('request', (request) => {
        if (!/^(file|data|blob):/.test(request.url())) {
            faults.push(`${address} fetches ${request.url()}`);
        }
    });
    await page.goto(pathToFileURL(site).href + '/' + address);
    return page;
}

for (const [width, height] of [[1280, 800], [390, 844]]) {
    for (const colorScheme of ['light', 'dark']) {
        for (const name of named.length ? named : PAGES) {
            const page = await visit(`${name}.html`, { viewport: { width, height }, colorScheme });
            const wide = await page.evaluate(() => document.documentElement.scrollWidth);
            if (wide > width) {
                faults.push(`${name}.html is ${wide} pixels wide on a screen of ${width}`);
            }
            if (folder) {
                await page.waitForTimeout(500);
                await page.screenshot({ path: `${folder}/${name.replaceAll('/', '-')}-${width}-${colorScheme}.png` });
            }
            await page.context().close();
        }
    }
}

for (const words of ['strain limit', 'weft_sim_advance', 'Dormand']) {
    const page = await visit(`search.html?q=${encodeURIComponent(words)}`, {});
    try {
        await page.waitForSelector('#search-results li a', { timeout: 20000 });
    } catch {
        faults.push(`the search finds nothing for '${words}'`);
    }
    if (folder && words === 'strain limit') {
        await page.waitForTimeout(500);
        await page.screenshot({ path: `${folder}/search.png` });
    }
}
await browser.close();
faults.forEach((fault) => console.log(fault));
console.log(faults.length ? `${faults.length} faults` : 'ok: search, sizes and colours in chromium');
process.exit(faults.length ? 1 : 0);
