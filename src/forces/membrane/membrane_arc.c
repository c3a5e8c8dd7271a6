/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_arc.c -- the plain loops of membrane.h; membrane_arc_fast.c has the same
 * bits. */

#include <string.h>

#include "forces/membrane/membrane_law.h"

/* An edge: from positions and velocities, then from those of a direction. */
typedef struct bow {
    double h[4][3], d[4][3];
} bow;

/* S and E of an edge; then their changes. */
typedef struct pull {
    double all, ends;
} pull;

void weft__arc_row(const weft__membrane *own, const double *x, size_t edge, double h[3])
{
    const weft__edge_slopes *rows = &own->arc.rows;
    const size_t n = own->mesh->particles, first = rows->first[edge];
    double sums[2][3] = { { 0.0 } };
    for (size_t j = first; j < rows->first[edge + 1]; ++j) {
        const double *at = x + rows->particle[j], *from = x + rows->particle[first];
        for (size_t k = 0; k < 3; ++k) {
            sums[(j - first) % 2][k] += rows->share[j] * (at[k * n] - from[k * n]);
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        h[k] = sums[0][k] + sums[1][k];
    }
}

void weft__arc_square(const weft__membrane *own, const double *y, size_t edge,
                      double square[2])
{
    double h[3], rate[3];
    square[0] = square[1] = 0.0;
    if (own->arc.begin != NULL) {
        weft__arc_row(own, y, edge, h);
        weft__arc_row(own, y + 3 * own->mesh->particles, edge, rate);
        square[0] = weft__dot(h, h);
        square[1] = 2.0 * weft__dot(h, rate);
    }
}

static void bow_of(const weft__membrane *own, const weft__state *at, size_t edge,
                   bow *out)
{
    const weft__triangles *of = own->mesh->triangles;
    const size_t n = own->mesh->particles;
    const uint32_t *ends = of->edge_list[edge].place;
    memset(out, 0, sizeof *out);
    for (size_t k = 0; k < (at->along != NULL ? 4 : 2); ++k) {
        const double *x = (k < 2 ? at->y : at->along) + k % 2 * 3 * n;
        if (k % 2 == 0 || own->damped) {
            weft__arc_row(own, x, edge, out->h[k]);
            for (size_t m = 0; m < 3; ++m) {
                out->d[k][m] = x[m * n + of->particle[ends[1]]]
                               - x[m * n + of->particle[ends[0]]];
            }
        }
    }
}

static weft__bent bent_of(const bow *of)
{
    return (weft__bent){ weft__dot(of->d[0], of->d[0]), weft__dot(of->d[0], of->d[1]),
                         weft__dot(of->h[0], of->h[0]), weft__dot(of->h[0], of->h[1]) };
}

static weft__bent membrane_arc_change_of(const bow *of)
{
    return (weft__bent){ 2.0 * weft__dot(of->d[0], of->d[2]),
                         weft__dot(of->d[2], of->d[1]) + weft__dot(of->d[0], of->d[3]),
                         2.0 * weft__dot(of->h[0], of->h[2]),
                         weft__dot(of->h[2], of->h[1])
                             + weft__dot(of->h[0], of->h[3]) };
}

/* Adds what triangle t pulls edge e with, or the change of it. */
static void add_pull(const weft__membrane *own, const weft__state *at, size_t t,
                     size_t e, bool change, pull *sum)
{
    const uint32_t *edge = own->mesh->triangles->edge[t];
    double c[WEFT__CONSTANTS], z[3], q[3], all[3], ends[3];
    const size_t k = edge[0] == e ? 0 : edge[1] == e ? 1 : 2;
    weft__membrane_constants(own->mesh->triangles, t, c);
    const double lag = CONSTANT(c, WEFT__LAG);
    for (size_t i = 0; i < 3; ++i) {
        bow of;
        bow_of(own, at, edge[i], &of);
        const weft__bent b = change ? membrane_arc_change_of(&of) : bent_of(&of);
        const double rest
            = change ? 0.0 : CONSTANT(c, WEFT__SQUARE + i) + weft__arc_bow(own, t, i);
        z[i] = b.arc + lag * b.arc_rate;
        q[i] = ((b.chord - rest) + lag * b.chord_rate) + z[i];
    }
    law_stiff(c, q, all);
    law_stiff(c, z, ends);
    sum->all += all[k];
    sum->ends += ends[k];
}

void weft__arc_force(const weft__membrane *own, const weft__state *at, size_t i,
                     double force[3])
{
    double sums[2][3] = { { 0.0 } };
    for (size_t j = own->arc.begin[i]; j < own->arc.begin[i + 1]; ++j) {
        const weft__arc_part *part = &own->arc.part[j];
        const size_t e = part->item / 2;
        const uint32_t *t = own->mesh->triangles->edge_list[e].triangle;
        pull now = { 0.0, 0.0 }, change = { 0.0, 0.0 };
        bow of;
        bow_of(own, at, e, &of);
        for (size_t k = 0; k < 2 && t[k] != WEFT__NONE; ++k) {
            add_pull(own, at, t[k], e, false, &now);
            if (at->along != NULL) {
                add_pull(own, at, t[k], e, true, &change);
            }
        }
        const bool end = part->item % 2 == 1;
        const double s = end ? now.ends : now.all;
        const double ds = end ? change.ends : change.all;
        double(*x)[3] = end ? of.d : of.h;
        for (size_t k = 0; k < 3; ++k) {
            sums[(j - own->arc.begin[i]) % 2][k]
                -= part->share
                   * (at->along != NULL ? ds * x[0][k] + s * x[2][k] : s * x[0][k]);
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        force[k] = sums[0][k] + sums[1][k];
    }
}

double weft__arc_particles(const weft__membrane *own, const weft__state *at,
                           weft__unit unit, double *to, size_t first, size_t end)
{
    double force[3], bad = 0.0;
    for (size_t i = first; i < end; ++i) {
        weft__arc_force(own, at, i, force);
        bad += weft__force_add(own->mesh, unit, i, force, to);
    }
    return bad;
}

int weft__arc_loops(const void *own, const weft__state *at, weft__unit unit, double *to,
                    size_t first, size_t end)
{
    const weft__membrane *of = own;
    return weft__arc_particles(of, at, unit, to, weft__block(of->mesh, first),
                               weft__block(of->mesh, end))
                   == 0.0
               ? 0
               : 1;
}
