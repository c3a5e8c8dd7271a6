// SPDX-License-Identifier: BSD-3-Clause
// picture.mjs -- node picture.mjs FOLDER ADDRESS PAGE...: the cloth of each page alone, as
// FOLDER/PAGE.png, all under one camera that just holds what they show. Two runs of a page
// stand side by side. ADDRESS is that of the player, such as frame=20; frames=0-60 draws a film, FOLDER/PAGE-000.png to
// PAGE-060.png, and frame=60% the frame there.
import { basename } from 'node:path';
import { drawn, launch, open } from './browser.mjs';

const SIDE = 420; // pixels of the picture of a run
const FILM_SIDE = 300;
const ALONE = `body > :not(main), #controls, #side, #labels { display: none !important; }
    main { display: block !important; padding: 0 !important; }
    #stage { position: fixed !important; inset: 0; height: auto !important; border-radius: 0 !important; }`;

const [folder, address, ...files] = process.argv.slice(2);
const film = /frames=(\d+)-(\d+)/.exec(address);
const share = /frame=(\d+)%/.exec(address);
const side = film ? FILM_SIDE : SIDE;
const browser = await launch();

/** The frames to draw of a run of so many. */
function numbers(count) {
    const [first, last] = film ? film.slice(1).map(Number)
        : [Math.round((share?.[1] ?? 0) / 100 * (count - 1))];
    return film ? Array.from({ length: last - first + 1 }, (_, k) => first + k) : share ? [first] : [];
}

async function show(file) {
    const { page } = await open(browser, file, `${address.replace('%', '')}&quality=fine&colour=plain&follow=0`, {
        viewport: { width: side, height: side }, bypassCSP: true,
    });
    await page.addStyleTag({ content: ALONE });
    const frames = numbers(await page.evaluate(() => weft.page.runs[0].blocks.length));
    const boxes = await page.evaluate((list) => {
        list.slice(0, 1).forEach((frame) => weft.seek(frame));
        const of = list.length ? list : [weft.state.frame];
        return weft.page.runs.map((run) => [0, 1, 2].map((axis) => {
            const ends = of.map((frame) => run.blocks[frame].range(axis));
            return [Math.min(...ends.map((end) => end[0])), Math.max(...ends.map((end) => end[1]))];
        }));
    }, frames);
    await page.setViewportSize({ width: side * boxes.length, height: side });
    const direction = await page.evaluate(() => weft.stage.direction.toArray());
    return { file, page, boxes, frames, direction };
}

const shown = [];
for (const file of files) {
    shown.push(await show(file));
}
const boxes = shown.flatMap((one) => one.boxes);
for (const { file, page, frames } of shown) {
    const name = `${folder}/${basename(file, '.html')}`;
    await drawn(page);
    await page.evaluate(([all, direction]) => {
        const { stage } = weft;
        stage.direction.set(...direction);
        const [any] = stage.corners;
        stage.corners = all.flatMap(([x, y, z]) => [0, 1, 2, 3, 4, 5, 6, 7].map(
            (i) => any.clone().set(x[i & 1], y[(i >> 1) & 1], z[i >> 2]),
        ));
        stage.fit(false);
    }, [boxes, shown[0].direction]);
    for (const frame of film ? frames : [undefined]) {
        await page.evaluate((one) => one !== undefined && weft.seek(one), frame);
        await drawn(page);
        await page.screenshot({ path: `${name}${film ? `-${String(frame).padStart(3, '0')}` : ''}.png` });
    }
}
await browser.close();
