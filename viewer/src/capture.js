// SPDX-License-Identifier: BSD-3-Clause
// capture.js -- the stage with its words as a picture (PNG), and as a film (WebM).
import { save } from './save.js';

const LAST = 1500; // ms that a film shows its last picture, and that pictures have to come to the recorder
const RATE = 12e6; // bits a second of a film

/** Each word of an element where the browser has put it. */
function* words(root) {
    const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        for (const { index, 0: word } of node.data.matchAll(/\S+/g)) {
            const range = document.createRange();
            range.setStart(node, index);
            range.setEnd(node, index + word.length);
            const [box] = range.getClientRects();
            if (box) {
                yield { word, box, style: getComputedStyle(node.parentElement) };
            }
        }
    }
}

/** Draws the stage as it is seen, and the time in its corner. */
export function compose(stage, context) {
    const { canvas } = stage;
    const around = canvas.parentElement;
    const frame = canvas.getBoundingClientRect();
    const ratio = canvas.width / frame.width;
    const style = getComputedStyle(around);
    stage.draw();
    context.setTransform(1, 0, 0, 1, 0, 0);
    const paper = context.createLinearGradient(0, 0, 0, canvas.height);
    ['--stage-top', '--stage-bottom'].forEach((name, i) => paper.addColorStop(i, style.getPropertyValue(name).trim()));
    context.fillStyle = paper;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(canvas, 0, 0);
    context.setTransform(ratio, 0, 0, ratio, -ratio * frame.left, -ratio * frame.top);
    for (const bar of around.querySelectorAll('#legend:not([hidden]) canvas')) {
        const { left, top, width, height } = bar.getBoundingClientRect();
        context.drawImage(bar, left, top, width, height);
    }
    context.textBaseline = 'middle';
    for (const { word, box, style: { font, color } } of words(around)) {
        Object.assign(context, { font, fillStyle: color });
        context.fillText(word, box.left, box.top + box.height / 2);
    }
    Object.assign(context, { font: `14px ${style.fontFamily}`, fillStyle: style.color, textAlign: 'right' });
    context.fillText(document.getElementById('clock').textContent, frame.right - 14, frame.top + 18);
    context.textAlign = 'left';
}

function paperOf(stage) {
    const { width, height } = stage.canvas;
    return Object.assign(document.createElement('canvas'), { width, height });
}

export async function savePicture(stage, name) {
    const paper = paperOf(stage);
    compose(stage, paper.getContext('2d'));
    save(name, 'image/png', await new Promise((done) => { paper.toBlob(done, 'image/png'); }));
}

/** A film of the stage, of the pictures that are taken until it ends. */
export class Film {
    constructor(stage, name) {
        const paper = paperOf(stage);
        const context = paper.getContext('2d', { willReadFrequently: true });
        const parts = [];
        const stream = paper.captureStream(0);
        const [track] = stream.getVideoTracks();
        this.recorder = new MediaRecorder(stream, { mimeType: 'video/webm', videoBitsPerSecond: RATE });
        this.recorder.ondataavailable = ({ data }) => parts.push(data);
        this.recorder.onstop = () => save(name, 'video/webm', ...parts);
        this.recorder.start();
        this.take = () => {
            compose(stage, context);
            track.requestFrame?.();
        };
        this.take();
    }

    end() {
        setTimeout(() => this.take(), LAST / 3);
        setTimeout(() => this.recorder.stop(), LAST);
    }
}
