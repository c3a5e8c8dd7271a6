/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_fast.c -- the bending of plate.h, block by block: positions of its own
 * particles and its halo are copied to the first cache, and four rows at a time are
 * summed in the lanes of a vector, of whatever width the level has. */
#include "forces/bending/plate.h"
#include "forces/lanes.h"

enum { ROOM = WEFT__PLATE_ROOM, ROWS = WEFT__PLATE_ROWS, AHEAD = 192 };

typedef double quad __attribute__((vector_size(8 * ROWS)));
typedef double quad_anywhere
    __attribute__((vector_size(8 * ROWS), aligned(8), may_alias));

/* A block of rows. */
typedef struct block {
    const weft__plate_matrix *of;
    size_t b, first, own, halo;
} block;

static block block_of(const weft__plate_matrix *of, size_t b)
{
    const size_t first = b * WEFT__MESH_BLOCK, left = of->particles - first;
    return (block){ .of = of,
                    .b = b,
                    .first = first,
                    .own = left < WEFT__MESH_BLOCK ? left : WEFT__MESH_BLOCK,
                    .halo = of->reach[b + 1] - of->reach[b] };
}

/* What a term multiplies, less that of the first particle. */
INLINE void take(const block *p, const weft__plate_term *term, double (*to)[4])
{
    const double *x = term->x, tau = term->tau;
    const size_t n = p->of->particles, v = tau != 0.0 ? 3 * n : 0;
    const uint32_t *halo = p->of->halo + p->of->reach[p->b];
    const double *first = x + p->first;
    double origin[3];
    for (size_t k = 0; k < 3; ++k) {
        origin[k] = first[k * n] + tau * first[k * n + v];
    }
    for (size_t j = 0; j < p->own; ++j) {
        for (size_t k = 0; k < 3; ++k) {
            to[j][k] = (first[k * n + j] + tau * first[k * n + j + v]) - origin[k];
        }
    }
    for (size_t j = 0; j < p->halo; ++j) {
        const double *at = x + halo[j];
        for (size_t k = 0; k < 3; ++k) {
            to[p->own + j][k] = (at[k * n] + tau * at[k * n + v]) - origin[k];
        }
    }
}

typedef struct quad3 {
    quad x, y, z;
} quad3;

INLINE void add_column(const double *entry, const double at[4], quad3 *sum)
{
    const quad share = *(const quad_anywhere *)entry;
    sum->x += share * at[0];
    sum->y += share * at[1];
    sum->z += share * at[2];
}

/* A group of rows by the copies. */
INLINE quad3 add_rows(const weft__plate_matrix *of, const double *entry, size_t group,
                      double (*near)[4])
{
    const size_t end = of->first[group + 1];
    quad3 even = { .x = { 0.0 } }, odd = even;
    size_t j = of->first[group];
    for (; j + 2 <= end; j += 2) {
        __builtin_prefetch(entry + ROWS * (j + AHEAD));
        add_column(entry + ROWS * j, near[of->column[j]], &even);
        add_column(entry + ROWS * (j + 1), near[of->column[j + 1]], &odd);
    }
    if (j < end) {
        add_column(entry + ROWS * j, near[of->column[j]], &even);
    }
    return (quad3){ even.x + odd.x, even.y + odd.y, even.z + odd.z };
}

/* Takes share times a sum from the numbers of some rows; adds those to *bad. */
INLINE void subtract(double *from, const quad *share, const quad *sum, size_t rows,
                     quad *bad)
{
    const quad change = *share * *sum;
    if (rows == ROWS) {
        *bad += *(quad_anywhere *)from -= change;
        return;
    }
    for (size_t r = 0; r < rows; ++r) {
        (*bad)[r] += from[r] -= change[r];
    }
}

int NAME(plate, LEVEL)(const void *own, const weft__state *at, weft__unit unit,
                       double *to, size_t first, size_t end)
{
    const weft__plate *plate = own;
    const weft__plate_matrix *of = &plate->matrix;
    const size_t n = of->particles;
    const double *mass = plate->mesh->inverse_mass;
    _Alignas(64) double near[ROOM][4];
    weft__plate_term terms[2];
    const size_t count = weft__plate_terms(of, at->y, terms);
    quad bad = { 0.0 };
    for (size_t b = first * count; b < end * count; ++b) {
        const block p = block_of(of, b / count);
        const weft__plate_term *term = &terms[b % count];
        take(&p, term, near);
        for (size_t i = p.first; i < p.first + p.own; i += ROWS) {
            const size_t left = p.first + p.own - i, rows = left < ROWS ? left : ROWS;
            const quad3 sum = add_rows(of, term->matrix, i / ROWS, near);
            quad share = { 1.0, 1.0, 1.0, 1.0 };
            if (unit != WEFT__FORCE) {
                share = *(const quad_anywhere *)(mass + i);
            }
            subtract(to + i, &share, &sum.x, rows, &bad);
            subtract(to + n + i, &share, &sum.y, rows, &bad);
            subtract(to + 2 * n + i, &share, &sum.z, rows, &bad);
        }
    }
    return ((bad[0] + bad[1]) + (bad[2] + bad[3])) * 0.0 == 0.0 ? 0 : 1;
}
