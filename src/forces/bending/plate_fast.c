/* SPDX-License-Identifier: BSD-3-Clause */
/* plate_fast.c -- the bending of plate.h, block by block: positions of its own
 * particles and its halo are copied to the first cache, as records x, y, z, 0 beside
 * those of their sums; what is summed for the halo is thrown away. */
#include "forces/bending/plate.h"
#include "forces/lanes.h"

enum { ROOM = WEFT__PLATE_ROOM, RECORD = WEFT__PLATE_RECORD };
enum { ROW = 24, LINE = 8, AHEAD = 384 };

/* Records of a block's particles and of its halo: what the terms multiply, and sums. */
typedef struct nearby {
    _Alignas(64) double x[RECORD * ROOM], sum[RECORD * ROOM];
} nearby;

INLINE record *plate_fast_at(double *of, size_t place)
{
    return (record *)(void *)(of + place);
}

/* A block of rows. */
typedef struct block {
    const weft__plate_matrix *of;
    size_t b, first, own, halo;
} block;

static block plate_fast_block_of(const weft__plate_matrix *of, size_t b)
{
    const size_t first = b * WEFT__MESH_BLOCK, left = of->particles - first;
    return (block){ .of = of,
                    .b = b,
                    .first = first,
                    .own = left < WEFT__MESH_BLOCK ? left : WEFT__MESH_BLOCK,
                    .halo = of->halo_first[b + 1] - of->halo_first[b] };
}

/* What a term multiplies, of one particle. */
INLINE void plate_fast_take(const double *x, size_t n, double tau, nearby *to,
                            size_t place)
{
    record value = { x[0], x[n], x[2 * n], 0.0 };
    if (tau != 0.0) {
        value += (record){ tau * x[3 * n], tau * x[4 * n], tau * x[5 * n], 0.0 };
    }
    *plate_fast_at(to->x, place) = value;
    *plate_fast_at(to->sum, place) = ALL(0.0);
}

INLINE void take_all(const block *p, const double *x, double tau, nearby *to)
{
    const size_t n = p->of->particles;
    const uint32_t *halo = p->of->halo + p->of->halo_first[p->b];
    for (size_t j = 0; j < p->own; ++j) {
        plate_fast_take(x + p->first + j, n, tau, to, RECORD * j);
    }
    for (size_t j = 0; j < p->halo; ++j) {
        plate_fast_take(x + halo[j], n, tau, to, RECORD * (p->own + j));
    }
}

/* By address: clang 11 does not pass vectors without the registers for them. */
INLINE void add_pair(double entry, const record *x, size_t other, nearby *near,
                     record *sum)
{
    const record pull = ALL(entry) * (*x - *plate_fast_at(near->x, other));
    *plate_fast_at(near->sum, other) += pull;
    *sum += pull;
}

/* A row of a block: so many pairs of particle i. */
INLINE void plate_fast_add_row(const double *entry, const uint32_t *column,
                               size_t length, nearby *near, size_t i)
{
    const record x = *plate_fast_at(near->x, RECORD * i);
    record even = ALL(0.0), odd = even;
    for (size_t j = 0; j < ROW; j += LINE) { /* of average length */
        __builtin_prefetch(entry + j + AHEAD);
        __builtin_prefetch(column + j + AHEAD);
    }
    for (size_t j = 0; j < length; j += 2) {
        add_pair(entry[j], &x, column[j], near, &even);
        add_pair(entry[j + 1], &x, column[j + 1], near, &odd);
    }
    *plate_fast_at(near->sum, RECORD * i) -= even + odd;
}

/* The rows of a block, which lie one behind the other. */
INLINE void plate_fast_add_rows(const block *p, const double *entry, nearby *near)
{
    const size_t begin = weft__plate_row_of(p->of, p->first).first;
    const uint32_t *column = p->of->column + begin;
    size_t length = 0;
    entry += begin;
    for (size_t i = 0; i < p->own; ++i, entry += length, column += length) {
        if (i % WEFT__PLATE_ROWS == 0) {
            const weft__plate_row row = weft__plate_row_of(p->of, p->first + i);
            length = row.end - row.first;
        }
        plate_fast_add_row(entry, column, length, near, i);
    }
}

/* Takes share times the sums from three planes; 0 or NaN. */
INLINE double plate_fast_subtract(const block *p, const double *mass,
                                  const nearby *near, double *from)
{
    const size_t n = p->of->particles;
    double bad = 0.0;
    for (size_t i = 0; i < p->own; ++i) {
        const double share = mass != NULL ? mass[p->first + i] : 1.0;
        const double *sum = near->sum + RECORD * i;
        double *to = from + p->first + i;
        to[0] -= share * sum[0], to[n] -= share * sum[1], to[2 * n] -= share * sum[2];
        bad += ((to[0] + to[n]) + to[2 * n]) * 0.0;
    }
    return bad;
}

int NAME(plate, LEVEL)(const void *own, const weft__state *at, weft__unit unit,
                       double *to, size_t first, size_t end)
{
    const weft__plate *plate = own;
    const double *mass = unit != WEFT__FORCE ? plate->mesh->inverse_mass : NULL;
    nearby near;
    weft__plate_term terms[2];
    const size_t count = weft__plate_terms(&plate->matrix, at->y, terms);
    double bad = 0.0;
    for (size_t b = first * count; b < end * count; ++b) {
        const block p = plate_fast_block_of(&plate->matrix, b / count);
        const weft__plate_term *term = &terms[b % count];
        take_all(&p, term->x, term->tau, &near);
        plate_fast_add_rows(&p, term->matrix, &near);
        bad += plate_fast_subtract(&p, mass, &near, to);
    }
    return bad == 0.0 ? 0 : 1;
}
