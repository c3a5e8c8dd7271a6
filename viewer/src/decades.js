// SPDX-License-Identifier: BSD-3-Clause
// decades.js -- the numbers along a logarithmic axis.

/** Powers of ten from lo to hi, about so many at most; where these are few 2 and 5 times
 * them too. */
export function decades(lo, hi, most) {
    const [first, last] = [lo, hi].map((v) => Math.floor(Math.log10(v) + 1e-9));
    const every = Math.ceil((last - first + 1) / most);
    const factors = 3 * Math.log10(hi / lo) > most ? [1] : [1, 2, 5];
    const list = [];
    for (let k = first; k <= last; ++k) {
        list.push(...factors.filter(() => k % every === 0).map((m) => Number(`${m}e${k}`)));
    }
    return list.filter((v) => v >= 0.999 * lo && v <= 1.001 * hi);
}

/** 1e-5, 1e12 */
export const powerText = (v) => v.toExponential(0).replace('+', '');
