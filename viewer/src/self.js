// SPDX-License-Identifier: BSD-3-Clause
// self.js -- how far the particles of a cloth are from its other parts.

/** The square of the distance of p to a triangle, which may be a line (C. Ericson, Real-Time
 * Collision Detection, 2005, 5.1.5); points are [x, y, z]. */
function square(p, a, b, c) {
    const minus = (u, v) => [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
    const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    const [ab, ac, ap, bp, cp] = [minus(b, a), minus(c, a), minus(p, a), minus(p, b), minus(p, c)];
    const [d1, d2, d3, d4, d5, d6] = [dot(ab, ap), dot(ac, ap), dot(ab, bp), dot(ac, bp), dot(ab, cp), dot(ac, cp)];
    const at = (v, w) => {
        const r = [0, 1, 2].map((k) => ap[k] - v * ab[k] - w * ac[k]);
        return dot(r, r);
    };
    if (d1 <= 0 && d2 <= 0) return at(0, 0);
    if (d3 >= 0 && d4 <= d3) return at(1, 0);
    const vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return at(d1 / (d1 - d3), 0);
    if (d6 >= 0 && d5 <= d6) return at(0, 1);
    const vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return at(0, d2 / (d2 - d6));
    const va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) {
        const w = (d4 - d3) / (d4 - d3 + (d5 - d6));
        return at(1 - w, w);
    }
    return at(vb / (va + vb + vc), vc / (va + vb + vc));
}

const key = (i, j, k) => (i * 73856093) ^ (j * 19349663) ^ (k * 83492791);

/** Lowers each out[i] to the distance of particle i from the nearest triangle that it is no
 * corner of, if that is below `reach` [m]. */
export function selfGaps(triangles, [x, y, z], reach, out) {
    const list = Array.from({ length: triangles.length / 3 }, (_, t) => [...triangles.slice(3 * t, 3 * t + 3)]);
    const point = (i) => [x[i], y[i], z[i]];
    const mean = list.reduce((sum, [a, b]) => sum + Math.hypot(x[a] - x[b], y[a] - y[b], z[a] - z[b]), 0) / list.length;
    const size = Math.max(reach, mean);
    const place = (v) => Math.floor(v / size);
    const bins = new Map(); // particles by cubes of space
    for (let i = 0; i < out.length; ++i) {
        const at = key(...point(i).map(place));
        bins.set(at, [...(bins.get(at) ?? []), i]);
    }
    for (const corners of list) {
        const points = corners.map(point);
        const [low, high] = [Math.min, Math.max].map((least, s) => [0, 1, 2].map(
            (k) => place(least(...points.map((p) => p[k])) + (s ? reach : -reach)),
        ));
        for (let i = low[0]; i <= high[0]; ++i) {
            for (let j = low[1]; j <= high[1]; ++j) {
                for (let k = low[2]; k <= high[2]; ++k) {
                    for (const q of bins.get(key(i, j, k)) ?? []) {
                        if (!corners.includes(q)) {
                            const d = Math.sqrt(square(point(q), ...points));
                            out[q] = d < reach ? Math.min(out[q], d) : out[q];
                        }
                    }
                }
            }
        }
    }
    return out;
}
