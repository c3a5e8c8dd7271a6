// SPDX-License-Identifier: BSD-3-Clause
// diagram.mjs -- node diagram.mjs FOLDER PAGE...: the diagram of each page of weft compare
// alone, with the names of its coloured curves, as FOLDER/compare-NAME.png of NAME.html.
import { basename } from 'node:path';
import { drawn, launch, open } from './browser.mjs';

const ALONE = `#choices, #legend .other { display: none !important; }
    #diagram { border-radius: 0 !important; }`;

const [folder, ...files] = process.argv.slice(2);
const browser = await launch();
for (const file of files) {
    const { page } = await open(browser, file, '', {
        viewport: { width: 760, height: 720 }, bypassCSP: true,
    });
    await page.addStyleTag({ content: ALONE });
    await drawn(page);
    await page.locator('#diagram').screenshot({ path: `${folder}/compare-${basename(file, '.html')}.png` });
}
await browser.close();
