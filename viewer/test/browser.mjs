// SPDX-License-Identifier: BSD-3-Clause
// browser.mjs -- a page in the Chromium of the distribution, and what it looks like.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { PNG } from 'pngjs';

const FLAGS = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

/** [ms] until a browser that does not answer counts as hung. */
export const PATIENCE = 600000;

export const launch = (...flags) => chromium.launch({
    timeout: PATIENCE,
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: [...FLAGS, ...flags],
});

/** Opens FILE#hash; `said` collects errors, warnings, dialogs and requests but its own. */
export async function open(browser, file, hash = '', settings = {}) {
    const context = await browser.newContext({
        viewport: { width: 960, height: 600 }, reducedMotion: 'reduce', ...settings,
    });
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    const url = pathToFileURL(file).href;
    const said = [];
    page.on('console', (message) => {
        if (['error', 'warning'].includes(message.type()) && !/GPU stall/.test(message.text())) {
            said.push(`${message.type()}: ${message.text()}`);
        }
    });
    page.on('pageerror', (error) => said.push(`error: ${error.message}`));
    page.on('dialog', (dialog) => {
        said.push(`dialog: ${dialog.message()}`);
        dialog.dismiss();
    });
    page.on('request', (request) => {
        if (request.url().split('#')[0] !== url && !request.url().startsWith('data:')) {
            said.push(`request: ${request.url()}`);
        }
    });
    const began = performance.now();
    await page.goto(hash ? `${url}#${hash}` : url);
    await page.waitForSelector('html[data-ready]');
    return { page, said, loading: performance.now() - began };
}

/** Two pictures of the browser later, what was asked for has been drawn. */
export const drawn = (page) => page.evaluate(
    () => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); }),
);

/** [red, green, blue] of every pixel of a PNG. */
export function pixelsOf(png) {
    const { data } = PNG.sync.read(png);
    return Array.from({ length: data.length / 4 }, (_, i) => [data[4 * i], data[4 * i + 1], data[4 * i + 2]]);
}

/** The same of an element as it is seen. */
export async function pixels(page, selector) {
    await drawn(page);
    return pixelsOf(await page.locator(selector).screenshot());
}

/** The part of a picture in the colours of a plain cloth: warm, no grey. */
export const warmShare = (all) => all.filter(([r, g, b]) => r > 1.35 * b && r - b > 30 && r > g).length / all.length;

export const clothShare = async (page, selector = '#canvas') => warmShare(await pixels(page, selector));

/** [ms] A download of a page's own bytes has begun long before, unless Chromium lost it. */
const LOST = 60000;

/** What the page gives the reader as a file when `action` is done: its name and bytes. On a
 * machine with more to do than processors one of some thousand downloads never begins, and
 * no event says so: it is asked for once more. */
export async function saved(page, action, lost = LOST) {
    const ask = (timeout) => Promise.all([page.waitForEvent('download', { timeout }), action()]);
    const [download] = await ask(lost).catch(() => ask(PATIENCE));
    return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}
