/* SPDX-License-Identifier: BSD-3-Clause */
/* bending_fast.c -- the bending of bending.h, LANES columns at a time, in one pass
 * over the rows of each plane. With P = k_r D_r x + k_t D_c x and Q = k_c D_c x,
 *
 *     K x = (P(r+1) - P(r)) + (D_c Q(r) - (P(r) - P(r-1)))
 *
 * A row finds its P and D_c Q, and with them the force on the row before, whose P and
 * second sum wait in the first cache. Beyond the rim is the last row once more. */
#include "forces/bending/bending.h"
#include "forces/lanes.h"

#include <string.h>

/* TILE columns, a block on their left and four on their right. */
enum { TILE = 128, SPAN = LANES + TILE + 4 * LANES };

/* Column c is at c - first + LANES. */
typedef struct strip {
    _Alignas(64) double moment[3 * SPAN]; /* [N] P of the row before */
    double waiting[3 * SPAN];             /* [N] D_c Q of that row less its pull */
    double field[3][3 * SPAN];            /* [m] x + damping v, of rows r % 3 */
    double columns[SPAN]; /* [N/m] k_r of rows that are not on the rim */
    mask right2[2];       /* whether two columns follow, from `inner` on */
    vec bad; /* the sum of all v', which only numbers that are not finite spoil */
    const weft__bending *own;
    const double *y;
    double *to;
    bool aside;   /* in `field` instead of y */
    size_t inner; /* columns in blocks that two columns follow */
    size_t first, end;
} strip;

/* What a block reads and writes of a plane, by its first column. */
typedef struct line {
    const double *above, *here, *below; /* [m] */
    const double *along;                /* [N/m] k_r */
    vec across, twist;                  /* [N/m] k_c and k_t */
    double *moment, *waiting;
} line;

/* What a block leaves to the next one on its right. */
typedef struct carried {
    vec ahead, turn, moment, rise;
} carried;

/* The resistance [N] of the row before in the block at j; rim: see `right2`. */
INLINE vec bending_fast_block(line of, ptrdiff_t j, carried *left, const mask *rim)
{
    const vec here = left->ahead, ahead = load(of.here + j + LANES);
    const vec next = NEXT_1(here, ahead), slope = NEXT_2(here, ahead) - next;
    const vec turn = (rim != NULL ? only(slope, *rim) : slope) - (next - here);
    const vec bent = of.across * turn; /* Q of the column to the right */
    const vec moment = rim != NULL ? only(bent, *rim) : bent;
    const vec rise = moment - SHIFT_1(left->moment, moment);
    const vec down = (load(of.below + j) - here) - (here - load(of.above + j));
    const vec p = load(of.along + j) * down + of.twist * SHIFT_1(left->turn, turn);
    const vec pull = p - load(of.moment + j);
    const vec force = pull + load(of.waiting + j);
    store(of.waiting + j, (rise - SHIFT_1(left->rise, rise)) - pull);
    store(of.moment + j, p);
    *left = (carried){ ahead, turn, moment, rise };
    return force;
}

/* The last columns of a row. */
INLINE void bending_fast_row_end(strip *self, line of, carried *left,
                                 const double *mass, double *to)
{
    const size_t count = self->own->mesh->cols - self->inner;
    double change[2 * LANES];
    for (size_t e = 0; e * LANES < count; ++e) {
        const size_t j = self->inner - self->first + e * LANES;
        const vec force = bending_fast_block(of, (ptrdiff_t)j, left, &self->right2[e]);
        store(change + e * LANES, load(mass + j) * force);
    }
    for (size_t l = 0; to != NULL && l < count; ++l) {
        double *at = to + (self->inner - self->first) + l;
        *at -= change[l];
        self->bad[0] += *at;
    }
}

/* x + damping v of a row from two columns beyond the tile on. */
static void take_row(strip *self, size_t r)
{
    const size_t n = self->own->mesh->stride, cols = self->own->mesh->cols;
    const size_t low = self->first > 0 ? self->first - LANES : 0;
    const size_t high = self->end < self->inner ? self->end + 2 : cols;
    const double damping = self->own->damping;
    const size_t v = damping != 0.0 ? 3 * n : 0; /* from x; without, x + 0 x is x */
    for (size_t k = 0; k < 3; ++k) {
        const double *x = self->y + k * n + r * cols + low;
        double *to = self->field[r % 3] + k * SPAN + (LANES + low - self->first);
        size_t j = 0;
        for (; j + LANES <= high - low; j += LANES) {
            store(to + j, load(x + j) + damping * load(x + j + v));
        }
        for (; j < high - low; ++j) {
            to[j] = x[j] + damping * x[j + v];
        }
    }
}

/* Column self->first of plane k of row r. */
static const double *field(const strip *self, size_t r, size_t k)
{
    return self->aside ? self->field[r % 3] + k * SPAN + LANES
                       : self->y + k * self->own->mesh->stride
                             + r * self->own->mesh->cols + self->first;
}

static line bending_fast_line_of(strip *self, size_t r, size_t k)
{
    static const double none[SPAN];
    const weft__bending *of = self->own;
    const size_t rows = self->own->mesh->rows;
    return (line){ .above = field(self, weft__before(r), k),
                   .here = field(self, r, k),
                   .below = field(self, weft__after(r, rows), k),
                   .along = (weft__inner(r, rows) ? self->columns : none) + LANES,
                   .across = splat(of->across * weft__strip(r, rows)),
                   .twist = splat(of->twist),
                   .moment = self->moment + k * SPAN + LANES,
                   .waiting = self->waiting + k * SPAN + LANES };
}

/* Plane k of row r; adds the force on the row before to `to`, unless that is NULL. */
static void bending_fast_row(strip *self, size_t r, size_t k, const double *mass,
                             double *to)
{
    const line of = bending_fast_line_of(self, r, k);
    const ptrdiff_t count = (ptrdiff_t)(self->end - self->first);
    const ptrdiff_t begin = self->first > 0 ? -LANES : 0;
    carried left = { .ahead = load(of.here + begin) };
    vec bad = self->bad;
    if (self->first == 0 && self->own->mesh->cols > 1) {
        left.turn[LANES - 1] = of.here[1] - of.here[0];
    }
    for (ptrdiff_t j = begin; j < count; j += LANES) {
        const vec force = bending_fast_block(of, j, &left, NULL);
        if (to != NULL && j >= 0) {
            const vec sums = load(to + j) - load(mass + j) * force;
            store(to + j, sums);
            bad += sums;
        }
    }
    self->bad = bad;
    if (self->end == self->inner) {
        bending_fast_row_end(self, of, &left, mass, to);
    }
}

/* The columns of the tile in rows [first_row, end_row). */
static void bending_fast_tile(strip *self, size_t first_row, size_t end_row)
{
    const size_t n = self->own->mesh->stride, rows = self->own->mesh->rows;
    size_t taken = weft__before(weft__before(first_row)); /* rows, so far */
    for (size_t s = first_row; s <= end_row + 1; ++s) {   /* row s - 1 */
        const size_t r = weft__before(s) < rows ? weft__before(s) : rows - 1;
        const bool adds = s > first_row + 1;
        const size_t i = (adds ? s - 2 : 0) * self->own->mesh->cols + self->first;
        for (; self->aside && taken <= weft__after(r, rows); ++taken) {
            take_row(self, taken);
        }
        for (size_t k = 0; k < 3; ++k) {
            bending_fast_row(self, r, k, self->own->mesh->inverse_mass + i,
                             adds ? self->to + k * n + i : NULL);
        }
    }
}

static void bending_fast_start(strip *self, const weft__bending *own, const double *y,
                               double *to)
{
    const weft__mesh *mesh = own->mesh;
    memset(self, 0, sizeof *self);
    self->own = own, self->y = y, self->to = to;
    self->inner = inner_columns(mesh->cols);
    /* blocks at the end read up to 2 LANES numbers beyond the plane of z */
    self->aside = own->damping != 0.0 || 3 * mesh->particles <= 2 * LANES;
    for (size_t e = 0; e < 2; ++e) {
        self->right2[e] = have_column(self->inner + e * LANES, 2, mesh->cols);
    }
}

int NAME(bending, LEVEL)(const void *own, const weft__state *at, weft__unit unit,
                         double *to, size_t first, size_t end)
{
    const weft__bending *of = own;
    const size_t cols = of->mesh->cols;
    strip self;
    (void)unit;
    bending_fast_start(&self, of, at->y, to);
    for (size_t c = 0; c == 0 || c < self.inner; c += TILE) {
        self.first = c;
        self.end = self.inner - c < TILE ? self.inner : c + TILE;
        for (size_t j = 0; j < SPAN; ++j) {
            self.columns[j] = of->along * weft__strip(c + j - LANES, cols);
        }
        bending_fast_tile(&self, first, end);
    }
    return sum(self.bad) * 0.0 == 0.0 ? 0 : 1;
}
