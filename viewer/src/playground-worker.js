// SPDX-License-Identifier: BSD-3-Clause
// playground-worker.js -- a simulation beside the page: every message that asks has one answer.
import { Simulation } from './playground-sim.js';

const NOBODY = -1;
let sim = null;
let held = NOBODY;

const asked = {
    load: ({ module, files }) => {
        sim = new Simulation(module, files);
        return {};
    },
    open: ({ text, sets }) => {
        const opened = sim.open(text, sets);
        held = NOBODY;
        return opened.scene ? { ...opened, ...sim.look() } : opened;
    },
    advance: ({ until, budget, grab = held, drag }) => {
        const began = performance.now();
        if (grab !== held) {
            sim.calls.grab(grab);
            held = grab;
        }
        if (drag) {
            sim.calls.drag(...drag);
        }
        const failure = sim.advance(until, budget);
        const { planes, numbers } = sim.look();
        return { failure, planes, numbers, took: performance.now() - began };
    },
};

onmessage = ({ data }) => {
    const { kind, id } = data;
    try {
        const answer = asked[kind](data);
        postMessage({ id, ...answer }, answer.planes ? [answer.planes.buffer] : []);
    } catch (error) {
        postMessage({ id, failure: `the simulation stopped: ${error.message}` });
    }
};
