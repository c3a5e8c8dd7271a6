// SPDX-License-Identifier: BSD-3-Clause
// picture.mjs -- node picture.mjs FOLDER ADDRESS PAGE...: the cloth of each page alone, as
// FOLDER/PAGE.png, all under one camera that just holds what they show. Two runs of a page
// stand side by side.
import { basename } from 'node:path';
import { drawn, launch, open } from './browser.mjs';

const SIDE = 420; // pixels of the picture of a run
const ALONE = `body > :not(main), #controls, #side, #labels { display: none !important; }
    main { display: block !important; padding: 0 !important; }
    #stage { position: fixed !important; inset: 0; height: auto !important; border-radius: 0 !important; }`;

const [folder, address, ...files] = process.argv.slice(2);
const browser = await launch();

async function show(file) {
    const { page } = await open(browser, file, `${address}&quality=fine`, {
        viewport: { width: SIDE, height: SIDE }, bypassCSP: true,
    });
    await page.addStyleTag({ content: ALONE });
    const boxes = await page.evaluate(() => weft.page.runs.map(
        (run) => [0, 1, 2].map((axis) => run.blocks[weft.state.frame].range(axis)),
    ));
    await page.setViewportSize({ width: SIDE * boxes.length, height: SIDE });
    return { file, page, boxes };
}

const shown = [];
for (const file of files) {
    shown.push(await show(file));
}
const boxes = shown.flatMap((one) => one.boxes);
for (const { file, page } of shown) {
    await drawn(page);
    await page.evaluate((all) => {
        const { stage } = weft;
        const [any] = stage.corners;
        stage.corners = all.flatMap(([x, y, z]) => [0, 1, 2, 3, 4, 5, 6, 7].map(
            (i) => any.clone().set(x[i & 1], y[(i >> 1) & 1], z[i >> 2]),
        ));
        stage.fit();
    }, boxes);
    await drawn(page);
    await page.screenshot({ path: `${folder}/${basename(file, '.html')}.png` });
}
await browser.close();
