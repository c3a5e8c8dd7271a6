/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_fast.c -- the bending of plate.h, block by block: positions of its own
 * particles and its halo are copied to the first cache, and four rows at a time are
 * summed in the lanes of a vector, of whatever width the level has. */
#include "forces/bending/plate.h"
#include "forces/lanes.h"

enum { ROOM = WEFT__PLATE_ROOM, ROWS = WEFT__PLATE_ROWS };

typedef double quad __attribute__((vector_size(8 * ROWS)));
typedef double quad_anywhere
    __attribute__((vector_size(8 * ROWS), aligned(8), may_alias));

/* A block of rows. */
typedef struct block {
    const weft__plate_matrix *of;
    size_t b, first, own, halo;
} block;

static block part_of(const weft__plate_matrix *of, size_t b)
{
    const size_t first = b * WEFT__MESH_BLOCK, left = of->particles - first;
    return (block){ .of = of,
                    .b = b,
                    .first = first,
                    .own = left < WEFT__MESH_BLOCK ? left : WEFT__MESH_BLOCK,
                    .halo = of->reach[b + 1] - of->reach[b] };
}

/* x + tau v less that of the first particle; x alone if tau is 0. */
INLINE void take(const block *p, const double *x, double tau, double (*to)[4])
{
    const size_t n = p->of->particles;
    const uint32_t *halo = p->of->halo + p->of->reach[p->b];
    for (size_t k = 0; k < 3; ++k) {
        const double *plane = x + k * n, *v = tau != 0.0 ? plane + 3 * n : plane;
        const double origin = plane[p->first] + tau * v[p->first];
        for (size_t j = 0; j < p->own; ++j) {
            to[j][k] = (plane[p->first + j] + tau * v[p->first + j]) - origin;
        }
        for (size_t j = 0; j < p->halo; ++j) {
            to[p->own + j][k] = (plane[halo[j]] + tau * v[halo[j]]) - origin;
        }
    }
}

INLINE void add_column(const double *entry, const double at[4], quad sum[3])
{
    const quad share = *(const quad_anywhere *)entry;
    sum[0] += share * at[0];
    sum[1] += share * at[1];
    sum[2] += share * at[2];
}

/* Adds a group of rows by the copies. */
INLINE void add_rows(const weft__plate_matrix *of, const double *entry, size_t group,
                     double (*near)[4], quad sum[3])
{
    const size_t end = of->first[group + 1];
    quad even[3] = { { 0.0 } }, odd[3] = { { 0.0 } };
    size_t j = of->first[group];
    for (; j + 2 <= end; j += 2) {
        add_column(entry + ROWS * j, near[of->column[j]], even);
        add_column(entry + ROWS * (j + 1), near[of->column[j + 1]], odd);
    }
    if (j < end) {
        add_column(entry + ROWS * j, near[of->column[j]], even);
    }
    for (size_t k = 0; k < 3; ++k) {
        sum[k] += even[k] + odd[k];
    }
}

int NAME(plate, LEVEL)(const void *own, const weft__state *at, weft__unit unit,
                       double *to, size_t first, size_t end)
{
    const weft__plate *plate = own;
    const weft__plate_matrix *of = &plate->matrix;
    _Alignas(64) double near[ROOM][4];
    double rates[ROOM][4];
    double bad = 0.0;
    for (size_t b = first; b < end; ++b) {
        const block p = part_of(of, b);
        take(&p, at->y, of->tau, near);
        if (of->damping != NULL) {
            take(&p, at->y + 3 * of->particles, 0.0, rates);
        }
        for (size_t i = p.first; i < p.first + p.own; i += ROWS) {
            quad sum[3] = { { 0.0 } };
            add_rows(of, of->entry, i / ROWS, near, sum);
            if (of->damping != NULL) {
                add_rows(of, of->damping, i / ROWS, rates, sum);
            }
            for (size_t r = 0; r < ROWS && i + r < p.first + p.own; ++r) {
                const double share
                    = unit == WEFT__FORCE ? 1.0 : plate->mesh->inverse_mass[i + r];
                for (size_t k = 0; k < 3; ++k) {
                    double *sums = to + k * of->particles + i + r;
                    *sums -= share * sum[k][r];
                    bad += *sums * 0.0;
                }
            }
        }
    }
    return bad == 0.0 ? 0 : 1;
}
