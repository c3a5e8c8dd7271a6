// SPDX-License-Identifier: BSD-3-Clause
// entry.js -- the player of the page's run, of ?run=NAME of a batch, or the batch.
import { batch, chosen } from './source.js';

if (batch && !chosen) {
    import('./batch.js');
} else {
    import('./main.js');
}
