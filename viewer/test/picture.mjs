// SPDX-License-Identifier: BSD-3-Clause
// picture.mjs -- node picture.mjs FOLDER ADDRESS PAGE...: the cloth of each page alone, as
// FOLDER/PAGE.png, all from where the camera of the last page stands.
import { basename } from 'node:path';
import { drawn, launch, open } from './browser.mjs';

const ALONE = `body > :not(main), #controls, #side { display: none !important; }
    main { display: block !important; padding: 0 !important; }
    #stage { position: fixed !important; inset: 0; height: auto !important; border-radius: 0 !important; }`;

const [folder, address, ...files] = process.argv.slice(2);
const browser = await launch();
let camera = null;
for (const file of files.reverse()) {
    const { page } = await open(browser, file, `${address}&quality=fine`, {
        viewport: { width: 420, height: 420 }, bypassCSP: true,
    });
    await page.addStyleTag({ content: ALONE });
    camera = await page.evaluate((given) => {
        const { camera: eye, controls } = weft.stage;
        weft.stage.resize();
        weft.stage.moved = true; // by nobody else
        if (given) {
            eye.position.fromArray(given.eye);
            controls.target.fromArray(given.target);
            controls.update();
        } else {
            weft.stage.fit();
        }
        return { eye: eye.position.toArray(), target: controls.target.toArray() };
    }, camera);
    await drawn(page);
    await page.screenshot({ path: `${folder}/${basename(file, '.html')}.png` });
}
await browser.close();
