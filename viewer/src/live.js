// SPDX-License-Identifier: BSD-3-Clause
// live.js -- frames that a run under way goes on to write, from weft run --watch.
import { addFrame, addRows, readReport } from './data.js';

/** Whether the page came from the server of a run that is not over. */
export const isLive = (page) => Boolean(page.runs[0].live) && location.protocol === 'http:';

/** Asks for the frames after those of the page; `news` is called after each, `changed`
 * when the connection is there, is lost, or the run is over: 'live', 'lost' or 'over'. */
export function follow(page, { news, changed }) {
    const [run] = page.runs;
    const source = new EventSource(`frames?frame=${run.live.frame}&series=${run.live.series}`);
    source.onopen = () => changed('live');
    source.onerror = () => changed('lost'); // and tries again by itself
    source.onmessage = (event) => {
        const message = JSON.parse(event.data);
        addRows(run, message.series);
        if (message.time > page.times.at(-1)) {
            addFrame(page, message);
        }
        news();
    };
    source.addEventListener('end', (event) => {
        const { series, result } = JSON.parse(event.data);
        source.close();
        addRows(run, series);
        Object.assign(run, { result, outcome: readReport(result) });
        changed('over');
    });
}
