/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_loops.c -- the plain loops of membrane.h; membrane_fast.c has the same bits.
 */

#include <string.h>

#include "forces/membrane/membrane_law.h"

void weft__membrane_sides(const weft__mesh *mesh, const uint32_t corner[3],
                          const double *y, weft__sides3 *out)
{
    const size_t n = mesh->particles;
    for (size_t i = 0; i < 3; ++i) {
        const double *from = y + corner[(i + 1) % 3], *to = y + corner[(i + 2) % 3];
        for (size_t k = 0; k < 3; ++k) {
            out->d[i][k] = to[k * n] - from[k * n];
            out->w[i][k] = to[(k + 3) * n] - from[(k + 3) * n];
        }
    }
}

bool weft__membrane_each(const weft__membrane *of, size_t b, size_t *next,
                         weft__triangle *out)
{
    const size_t end = of->blocks[b + 1].batch;
    for (size_t i = *next; of->blocks[b].batch + i / WEFT__WIDTH < end; ++i) {
        const size_t g = of->blocks[b].batch + i / WEFT__WIDTH, lane = i % WEFT__WIDTH;
        const uint32_t t = of->corners[g].triangle[lane];
        if (t != WEFT__NONE) {
            for (size_t k = 0; k < WEFT__CONSTANTS; ++k) {
                out->of[k] = of->batches[g].of[k][lane];
            }
            out->corner = of->mesh->triangles->corner[t];
            out->number = t;
            *next = i + 1;
            return true;
        }
    }
    return false;
}

bool weft__membrane_each_own(const weft__membrane *of, size_t b, size_t *next,
                             weft__triangle *out)
{
    while (weft__membrane_each(of, b, next, out)) {
        if (out->corner[0] >= weft__block(of->mesh, b)) {
            return true;
        }
    }
    return false;
}

void weft__membrane_squares(const weft__sides3 *at, double square[3])
{
    for (size_t i = 0; i < 3; ++i) {
        square[i] = weft__dot(at->d[i], at->d[i]);
    }
}

void weft__membrane_pulls(const weft__membrane *own, const weft__triangle *tri,
                          const weft__sides3 *at, double s[3])
{
    double square[3], q[3];
    weft__membrane_squares(at, square);
    for (size_t i = 0; i < 3; ++i) {
        q[i] = square[i] - CONSTANT(tri->of, WEFT__SQUARE + i);
        if (own->damped) {
            q[i] = q[i] + CONSTANT(tri->of, WEFT__LAG) * weft__dot(at->d[i], at->w[i]);
        }
    }
    law_pull(tri->of, square, q, s);
}

/* Adds the change of the barrier's s, s_i = -2 push rate_i, for that of q. */
void weft__membrane_barrier_change(const double *of, const double square[3],
                                   const double more[3], double s[3])
{
    weft__barrier at;
    if (weft__membrane_barrier(of, square, &at)) {
        const double all = more[0] + more[1] + more[2];
        const double bend = at.bend * weft__dot(at.rate, more);
        for (size_t i = 0; i < 3; ++i) {
            const double rate = 2.0 * (all - 2.0 * more[i]) / CONSTANT(of, WEFT__LEAST);
            s[i] += 2.0 * (bend * at.rate[i] - at.push * rate);
        }
    }
}

/* The change of s along `by`. */
static void pulls_change(const weft__triangle *tri, const weft__sides3 *at,
                         const weft__sides3 *by, double s[3])
{
    double square[3], more[3], q[3];
    weft__membrane_squares(at, square);
    for (size_t i = 0; i < 3; ++i) {
        more[i] = 2.0 * weft__dot(at->d[i], by->d[i]);
        q[i] = more[i]
               + CONSTANT(tri->of, WEFT__LAG)
                     * (weft__dot(by->d[i], at->w[i]) + weft__dot(at->d[i], by->w[i]));
    }
    law_stiff(tri->of, q, s);
    weft__membrane_barrier_change(tri->of, square, more, s);
}

/* [N] on each corner, or its change along at->along. */
static void corner_forces(const weft__membrane *own, const weft__triangle *tri,
                          const weft__state *at, double force[3][3])
{
    weft__sides3 now, by;
    double s[3], change[3] = { 0.0, 0.0, 0.0 }, pull[3][3];
    weft__membrane_sides(own->mesh, tri->corner, at->y, &now);
    weft__membrane_pulls(own, tri, &now, s);
    if (at->along != NULL) {
        weft__membrane_sides(own->mesh, tri->corner, at->along, &by);
        pulls_change(tri, &now, &by, change);
    }
    for (size_t i = 0; i < 3; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            pull[i][k] = at->along == NULL
                             ? s[i] * now.d[i][k]
                             : change[i] * now.d[i][k] + s[i] * by.d[i][k];
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        force[0][k] = pull[2][k] - pull[1][k];
        force[1][k] = pull[0][k] - pull[2][k];
        force[2][k] = pull[1][k] - pull[0][k];
    }
}

/* [N] on the own particles of block b. */
void weft__membrane_forces(const weft__membrane *own, const weft__state *at, size_t b,
                           double force[WEFT__MESH_BLOCK][3])
{
    const size_t first = weft__block(own->mesh, b), end = weft__block(own->mesh, b + 1);
    weft__triangle tri;
    memset(force, 0, (end - first) * sizeof *force);
    for (size_t next = 0; weft__membrane_each(own, b, &next, &tri);) {
        double more[3][3];
        corner_forces(own, &tri, at, more);
        for (size_t c = 0; c < 3; ++c) {
            const size_t i = tri.corner[c];
            for (size_t k = 0; i >= first && i < end && k < 3; ++k) {
                force[i - first][k] += more[c][k];
            }
        }
    }
}

int weft__membrane_loops(const void *own, const weft__state *at, weft__unit unit,
                         double *to, size_t first, size_t end)
{
    const weft__membrane *of = own;
    const weft__mesh *mesh = of->mesh;
    double force[WEFT__MESH_BLOCK][3], bad = 0.0;
    for (size_t b = first; b < end; ++b) {
        const size_t low = weft__block(mesh, b), high = weft__block(mesh, b + 1);
        weft__membrane_forces(of, at, b, force);
        for (size_t i = low; i < high; ++i) {
            bad += weft__force_add(mesh, unit, i, force[i - low], to);
        }
    }
    return bad == 0.0 ? 0 : 1;
}

/* ---- the constants of a triangle at rest, and its barrier --------------------------
 */

void weft__membrane_shape(const weft__triangles *of, size_t t, double shape[3][3])
{
    const double per = 1.0 / (16.0 * of->area[t] * of->area[t]);
    double e[3][2];
    for (size_t i = 0; i < 3; ++i) {
        const double *from = weft__rest_at(of, t, (i + 1) % 3);
        const double *to = weft__rest_at(of, t, (i + 2) % 3);
        e[i][0] = to[0] - from[0], e[i][1] = to[1] - from[1];
    }
    for (size_t i = 0; i < 3; ++i) {
        const double *a = e[(i + 1) % 3], *b = e[(i + 2) % 3];
        shape[i][0] = -2.0 * a[1] * b[1] * per;
        shape[i][1] = -2.0 * a[0] * b[0] * per;
        shape[i][2] = (a[1] * b[0] + a[0] * b[1]) * per;
    }
}

static double membrane_loops_rest_square(const weft__triangles *of, size_t t, size_t i)
{
    const double *from = weft__rest_at(of, t, (i + 1) % 3);
    const double *to = weft__rest_at(of, t, (i + 2) % 3);
    const double u = to[0] - from[0], v = to[1] - from[1];
    return u * u + v * v;
}

void weft__membrane_shaped(const weft__triangles *of, size_t t,
                           const double shape[3][3], double to[WEFT__CONSTANTS])
{
    static const size_t pairs[6][2]
        = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 }, { 1, 2 } };
    const weft_fabric *fabric = &of->fabrics[of->fabric[t]];
    const double area = of->area[t];
    double stress[3];
    for (size_t k = 0; k < 6; ++k) {
        const double *a = shape[pairs[k][0]];
        weft__membrane_stress(fabric, shape[pairs[k][1]], stress);
        to[WEFT__STIFF + k]
            = 2.0 * area
              * (a[0] * stress[0] + a[1] * stress[1] + 2.0 * a[2] * stress[2]);
    }
    for (size_t i = 0; i < 3; ++i) {
        to[WEFT__SQUARE + i] = membrane_loops_rest_square(of, t, i);
    }
    to[WEFT__LEAST] = 0.36 * 16.0 * area * area;
    to[WEFT__LAG] = 2.0 * fabric->damping[0];
    to[WEFT__GUARD] = area * of->more[of->fabric[t]].barrier / 8.0;
}

void weft__membrane_constants(const weft__triangles *of, size_t t,
                              double to[WEFT__CONSTANTS])
{
    double shape[3][3];
    weft__membrane_shape(of, t, shape);
    weft__membrane_shaped(of, t, (const double(*)[3])shape, to);
}

bool weft__membrane_barrier(const double *of, const double square[3],
                            weft__barrier *out)
{
    const double least = CONSTANT(of, WEFT__LEAST), area = law_area(square);
    const double r = fmax(area, 0.0) / least, z = 1.0 - r, per = 1.0 / r;
    const double guard = CONSTANT(of, WEFT__GUARD);
    *out = (weft__barrier){ .push = 0.0 };
    if (!(area < least)) {
        return false;
    }
    out->push = guard * (z * z * z) * (4.0 * r + z) * per * per;
    out->bend = guard * z * z * (12.0 * r * r + 8.0 * z * r + 2.0 * z * z)
                * (per * per * per);
    for (size_t i = 0; i < 3; ++i) {
        const double others = square[(i + 1) % 3] + square[(i + 2) % 3];
        out->rate[i] = 2.0 * (others - square[i]) / least;
    }
    return true;
}
