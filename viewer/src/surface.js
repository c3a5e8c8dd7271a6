// SPDX-License-Identifier: BSD-3-Clause
// surface.js -- what is drawn between the particles of a page: the cells of its grid, or its
// triangles. Lists of particle numbers:
//   faces      three a triangle, as drawn
//   triangles  three a triangle, as the model has them; an edge of a chain is [a, b, b]
//   threads    two an edge that is drawn as a line; seams: those where pieces are sewn
//   rest       of triangles their flat rest shape: { faces, uv, of }, uv [m] of each place and
//              the particle `of` each place
//   cloths     of several: { name, first }, each from its first particle to that of the next

/** Two triangles a cell, split along alternating diagonals. */
function cells(rows, cols) {
    const index = [];
    for (let r = 0; r + 1 < rows; ++r) {
        for (let c = 0; c + 1 < cols; ++c) {
            const a = r * cols + c;
            const b = a + 1;
            const d = a + cols;
            const e = d + 1;
            index.push(...((r + c) % 2 ? [a, d, b, b, d, e] : [a, d, e, a, e, b]));
        }
    }
    return index;
}

function lines(rows, cols) {
    const index = [];
    for (let r = 0; r < rows; ++r) {
        for (let c = 0; c < cols; ++c) {
            const a = r * cols + c;
            if (c + 1 < cols) index.push(a, a + 1);
            if (r + 1 < rows) index.push(a, a + cols);
        }
    }
    return index;
}

function modelled(rows, cols) {
    const list = [];
    for (let r = 0; r < rows; ++r) {
        for (let c = 0; c < cols; ++c) {
            const a = r * cols + c;
            const [right, down] = [c + 1 < cols, r + 1 < rows];
            if (right && down) {
                list.push(a, a + cols, a + 1, a + cols + 1, a + 1, a + cols);
            } else if ((right && rows === 1) || (down && cols === 1)) {
                list.push(a, a + 1, a + 1);
            }
        }
    }
    return list;
}

/** Unit normals of a grid of points by central differences, one-sided on the rim. */
function gridNormals(p, rows, cols, out) {
    for (let r = 0, k = 0; r < rows; ++r) {
        const up = r > 0 ? 3 * cols : 0;
        const down = r + 1 < rows ? 3 * cols : 0;
        for (let c = 0; c < cols; ++c, k += 3) {
            const left = k - (c > 0 ? 3 : 0);
            const right = k + (c + 1 < cols ? 3 : 0);
            const ux = p[right] - p[left];
            const uy = p[right + 1] - p[left + 1];
            const uz = p[right + 2] - p[left + 2];
            const vx = p[k - up] - p[k + down];
            const vy = p[k - up + 1] - p[k + down + 1];
            const vz = p[k - up + 2] - p[k + down + 2];
            const nx = uy * vz - uz * vy;
            const ny = uz * vx - ux * vz;
            const nz = ux * vy - uy * vx;
            const length = Math.hypot(nx, ny, nz) || 1;
            out[k] = nx / length;
            out[k + 1] = ny / length;
            out[k + 2] = nz / length;
        }
    }
}

/** Unit normals of points: the sum over their triangles, by area. */
export function triangleNormals(p, faces, out) {
    out.fill(0);
    for (let t = 0; t < faces.length; t += 3) {
        const [a, b, c] = [3 * faces[t], 3 * faces[t + 1], 3 * faces[t + 2]];
        const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
        const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
        for (const k of [a, b, c]) {
            out[k] += uy * vz - uz * vy;
            out[k + 1] += uz * vx - ux * vz;
            out[k + 2] += ux * vy - uy * vx;
        }
    }
    for (let k = 0; k < out.length; k += 3) {
        const length = Math.hypot(out[k], out[k + 1], out[k + 2]) || 1;
        out[k] /= length;
        out[k + 1] /= length;
        out[k + 2] /= length;
    }
}

function grid([rows, cols]) {
    return {
        count: rows * cols,
        chain: rows === 1 || cols === 1,
        fine: Math.max(rows, cols),
        faces: cells(rows, cols),
        triangles: modelled(rows, cols),
        threads: lines(rows, cols),
        seams: [],
        cloths: [],
        rest: null,
        normals: (p, out) => gridNormals(p, rows, cols, out),
    };
}

/** Edges of triangles, each once, and those whose two sides have other places. */
function edges(corners, places) {
    const found = new Map();
    const list = { threads: [], seams: [] };
    for (let j = 0; j < corners.length; ++j) {
        const next = j % 3 === 2 ? j - 2 : j + 1;
        const [p, q] = corners[j] < corners[next] ? [j, next] : [next, j];
        const key = corners[p] * 2 ** 26 + corners[q];
        const other = found.get(key);
        if (other === undefined) {
            found.set(key, [places[p], places[q]]);
            list.threads.push(corners[p], corners[q]);
        } else if (other[0] !== places[p] || other[1] !== places[q]) {
            list.seams.push(corners[p], corners[q]);
        }
    }
    return list;
}

function mesh({ vertices, corners, places, rest, cloths = [] }) {
    const of = new Uint32Array(rest.length / 2);
    places.forEach((place, j) => { of[place] = corners[j]; });
    return {
        count: vertices,
        chain: false,
        fine: Math.sqrt(vertices),
        faces: corners,
        triangles: corners,
        ...edges(corners, places),
        cloths,
        rest: rest.length > 0 ? { faces: places, uv: rest, of } : null,
        normals: (p, out) => triangleNormals(p, corners, out),
    };
}

/** Which of several cloths has a particle. */
export const clothOf = ({ cloths }, i) => cloths.findLastIndex(({ first }) => first <= i);

/** `words` decodes base64 of words of 32 bits. */
export const readSurface = (meta, words) => (meta.mesh
    ? mesh({
        vertices: meta.mesh.vertices,
        corners: new Uint32Array(words(meta.mesh.corners)),
        places: new Uint32Array(words(meta.mesh.places)),
        rest: new Float32Array(words(meta.mesh.rest)),
        cloths: meta.mesh.cloths,
    })
    : grid(meta.shown));
