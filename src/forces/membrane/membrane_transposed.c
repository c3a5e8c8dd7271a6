/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_transposed.c -- the transposed product of the membrane of membrane.h. */
#include "forces/membrane/membrane_law.h"

/* Adds x and v along the slope of an edge, whose share a particle pulls with. */
static void membrane_transposed_add_row(const weft__membrane *own, size_t edge,
                                        const double by[6], double *out)
{
    const weft__edge_slopes *rows = &own->arc.rows;
    const size_t n = own->mesh->particles, first = rows->first[edge];
    for (size_t j = first; j < rows->first[edge + 1]; ++j) {
        for (size_t k = 0; k < 6; ++k) {
            const double more = rows->share[j] * by[k];
            out[k * n + rows->particle[j]] -= more;
            out[k * n + rows->particle[first]] += more;
        }
    }
}

/* sigma (2 d + lag w) + s dl, then sigma lag d. */
static void membrane_transposed_turn_back(const double d[3], const double w[3],
                                          const double dl[3], double sigma, double lag,
                                          double s, double by[6])
{
    for (size_t k = 0; k < 3; ++k) {
        by[k] = sigma * (2.0 * d[k] + lag * w[k]) + s * dl[k];
        by[3 + k] = sigma * lag * d[k];
    }
}

/* Adds what a triangle has to the transposed product. Its edges pull with s d, and the
 * slopes of `arc` likewise, where s = K q + barrier and q = d.d + lag d.w - rest; with
 * sigma = K d.dl, summed over both, these are what turn_back has. */
static void add_transposed(const weft__membrane *own, const weft__triangle *tri,
                           const weft__state *at, double *out)
{
    const size_t n = own->mesh->particles;
    const double *const fields[3] = { at->y, at->y + 3 * n, at->along };
    const double lag = own->damped ? CONSTANT(tri->of, WEFT__LAG) : 0.0;
    const uint32_t *edge = own->mesh->triangles->edge[tri->number];
    const bool arc = own->arc.begin != NULL;
    weft__sides3 now;
    double square[3], more[3], along[3], s[3], q[3], z[3], bent[3], all[3], sigma[3];
    double barrier[3] = { 0.0, 0.0, 0.0 }, dl[3][3], h[3][3][3] = { { { 0.0 } } },
           by[6];
    weft__membrane_sides(own->mesh, tri->corner, at->y, &now);
    weft__membrane_squares(&now, square);
    weft__membrane_pulls(own, tri, &now, s);
    for (size_t i = 0; i < 3; ++i) {
        const double *from = at->along + tri->corner[(i + 1) % 3];
        const double *to = at->along + tri->corner[(i + 2) % 3];
        for (size_t k = 0; k < 3; ++k) {
            dl[i][k] = to[k * n] - from[k * n];
            if (arc) {
                weft__arc_row(own, fields[k], edge[i], h[i][k]);
            }
        }
        more[i] = 2.0 * weft__dot(now.d[i], dl[i]);
        along[i] = 0.5 * more[i] + weft__dot(h[i][0], h[i][2]);
        z[i] = weft__dot(h[i][0], h[i][0]) + lag * weft__dot(h[i][0], h[i][1]);
        q[i] = square[i] - CONSTANT(tri->of, WEFT__SQUARE + i)
               + lag * weft__dot(now.d[i], now.w[i]) + z[i];
    }
    law_stiff(tri->of, q, all);
    law_stiff(tri->of, along, sigma);
    law_stiff(tri->of, z, bent);
    weft__membrane_barrier_change(tri->of, square, more, barrier);
    for (size_t i = 0; i < 3; ++i) {
        membrane_transposed_turn_back(now.d[i], now.w[i], dl[i], sigma[i], lag,
                                      s[i] + bent[i], by);
        for (size_t k = 0; k < 6; ++k) {
            by[k] += k < 3 ? barrier[i] * now.d[i][k] : 0.0;
            out[k * n + tri->corner[(i + 1) % 3]] += by[k];
            out[k * n + tri->corner[(i + 2) % 3]] -= by[k];
        }
        if (arc) {
            membrane_transposed_turn_back(h[i][0], h[i][1], h[i][2], sigma[i], lag,
                                          all[i], by);
            membrane_transposed_add_row(own, edge[i], by, out);
        }
    }
}

void weft__membrane_transposed(const void *own, const weft__state *at, double *out)
{
    const weft__membrane *of = own;
    weft__triangle tri;
    for (size_t b = 0; b < weft__blocks(of->mesh); ++b) {
        for (size_t next = 0; weft__membrane_each_own(of, b, &next, &tri);) {
            add_transposed(of, &tri, at, out);
        }
    }
}
