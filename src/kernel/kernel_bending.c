/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel_bending.c -- the bending of bending.h, LANES columns at a time: row after row
 * of x + damping v, from three of these the moments of the middle one, and from three
 * rows of moments the force on the middle one. The rows stay in the first cache, TILE
 * columns wide, with two more on either side. */
#include "cloth/bending.h"
#include "cloth/levels.h"
#include "kernel/lanes.h"

#include <string.h>

/* ASIDE: on either side, so that blocks are aligned. */
enum { TILE = 128, ASIDE = 16, SPAN = TILE + 2 * ASIDE };

/* Column c is at c - first + ASIDE. */
typedef struct strip {
    double field[3][3 * SPAN];  /* [m] x + damping v, of rows r % 3 */
    double moment[3 * SPAN];    /* [N] P = k_r D_r + k_t D_c, of the last row */
    double pull[2][3 * SPAN];   /* [N] P of row r + 1 less that of row r, r % 2 */
    double across[2][3 * SPAN]; /* [N] D_c k_c D_c of rows r % 2 */
    double columns[SPAN];       /* the part of k_r by column */
    mask inner[SPAN / LANES];   /* where k_c is not 0 */
    vec bad;                    /* 0 or NaN */
    const weft_cloth *cloth;
    const double *y;
    double *dydt;
    size_t first, end; /* columns */
} strip;

/* x + damping v of `count` columns at x, of planes n apart. */
INLINE void take(const double *x, size_t n, double damping, size_t count, double *to)
{
    vec3 a = load3_some(x, n, count);
    if (damping != 0.0) {
        const vec3 v = load3_some(x + 3 * n, n, count);
        a = plus(a, scaled(splat(damping), v));
    }
    store3_some(to, SPAN, a, count);
}

static void take_row(strip *self, size_t r)
{
    const size_t cols = self->cloth->cols, n = self->cloth->particles;
    const size_t from = self->first, past = self->end + 2;
    const size_t low = from < 2 ? 0 : from - 2, high = past < cols ? past : cols;
    const double damping = self->cloth->rigidity.damping;
    const double *x = self->y + r * cols + low;
    double *const to = self->field[r % 3] + (ASIDE + low - from);
    const size_t count = high - low, few = count < LANES ? count : LANES;
    size_t j = 0;
    /* beyond the rim as on it */
    take(x + count - few, n, damping, few, to + count - few + 1);
    for (; j + LANES <= count; j += LANES) {
        take(x + j, n, damping, LANES, to + j);
    }
    if (j < count && j > 0) { /* back over some */
        take(x + count - LANES, n, damping, LANES, to + count - LANES);
    } else if (j < count) {
        take(x, n, damping, count, to);
    }
}

static size_t before(size_t at)
{
    return at > 0 ? at - 1 : at;
}

static size_t after(size_t at, size_t count)
{
    return at + 1 < count ? at + 1 : at;
}

/* What a block leaves to the next one on its right. */
typedef struct trail {
    vec3 slope, moment, rise;
} trail;

static void find_moments(strip *self, size_t r)
{
    const size_t rows = self->cloth->rows, end = self->end - self->first + ASIDE;
    const weft__rigidity *k = &self->cloth->rigidity;
    const double *here = self->field[r % 3], *above = self->field[before(r) % 3];
    const double *below = self->field[after(r, rows) % 3], *columns = self->columns;
    double *moment = self->moment, *pull = self->pull[(r + 1) % 2];
    double *across = self->across[r % 2];
    const vec k_r = splat(weft__inner(r, rows) ? k->along : 0.0);
    const vec k_c = splat(k->across * weft__strip(r, rows)), k_t = splat(k->twist);
    trail left = { 0 };
    for (size_t j = ASIDE - (self->first > 0 ? LANES : 0); j <= end; j += LANES) {
        const vec3 middle = load3(here + j, SPAN);
        const vec3 slope = minus(load3(here + j + 1, SPAN), middle);
        const vec3 right = minus(slope, shift_1(left.slope, slope));
        const vec3 down = minus(minus(load3(below + j, SPAN), middle),
                                minus(middle, load3(above + j, SPAN)));
        const vec3 p = plus(scaled(k_r * load(columns + j), down), scaled(k_t, right));
        const vec3 q = only3(scaled(k_c, right), self->inner[j / LANES]);
        const vec3 rise = minus(q, shift_1(left.moment, q));
        store3(pull + j, SPAN, minus(p, load3(moment + j, SPAN)));
        store3(moment + j, SPAN, p);
        store3(across + j - 1, SPAN, minus(rise, shift_1(left.rise, rise)));
        left = (trail){ slope, q, rise };
    }
}

/* v' of `count` columns, which was `old`; what pulls from above, below and aside.
 * Returns 0 or NaN. */
INLINE vec add(const double *above, const double *below, const double *across,
               const double *inverse_mass, vec3 old, size_t count, double *to, size_t n)
{
    const vec3 bent
        = plus(minus(load3(below, SPAN), load3(above, SPAN)), load3(across, SPAN));
    vec3 sums = minus(old, scaled(load(inverse_mass), bent));
    store3_some(to, n, sums, count);
    if (count < LANES) {
        sums = load3_some(to, n, count);
    }
    return (sums.x * 0.0) * (sums.y * 0.0) * (sums.z * 0.0);
}

/* A block at the end goes back over some columns, whose v' has changed by then. */
static void add_forces(strip *self, size_t r)
{
    static const double none[3 * SPAN];
    const size_t n = self->cloth->particles;
    const size_t i = r * self->cloth->cols + self->first;
    const size_t count = self->end - self->first, last = count - LANES;
    const double *above = (r > 0 ? self->pull[(r + 1) % 2] : none) + ASIDE;
    const double *below
        = (r + 1 < self->cloth->rows ? self->pull[r % 2] : none) + ASIDE;
    const double *across = self->across[r % 2] + ASIDE;
    const double *mass = self->cloth->inverse_mass + i;
    double *to = self->dydt + 3 * n + i;
    const vec3 old = count >= LANES ? load3(to + last, n) : load3_some(to, n, count);
    vec bad = self->bad;
    size_t j = 0;
    for (; j + LANES <= count; j += LANES) {
        bad *= add(above + j, below + j, across + j, mass + j, load3(to + j, n), LANES,
                   to + j, n);
    }
    if (j < count && j > 0) {
        bad *= add(above + last, below + last, across + last, mass + last, old, LANES,
                   to + last, n);
    } else if (j < count) {
        bad *= add(above, below, across, mass, old, count, to, n);
    }
    self->bad = bad;
}

/* Columns [first, end) of rows [first_row, end_row). */
static void add_tile(strip *self, size_t first, size_t end, size_t first_row,
                     size_t end_row)
{
    const size_t rows = self->cloth->rows, cols = self->cloth->cols;
    size_t found = before(first_row), taken = before(found); /* rows, so far */
    self->first = first, self->end = end;
    for (size_t j = 0; j < SPAN; ++j) {
        const size_t c = first + j < ASIDE ? 0 : first + j - ASIDE;
        self->columns[j] = weft__strip(c, cols);
        self->inner[j / LANES][j % LANES] = weft__inner(c, cols) ? -1 : 0;
    }
    for (size_t r = first_row; r < end_row; ++r) {
        for (; found <= after(r, rows); ++found) {
            for (; taken <= after(found, rows); ++taken) {
                take_row(self, taken);
            }
            find_moments(self, found);
        }
        add_forces(self, r);
    }
}

int NAME(bending, LEVEL)(const weft__subject *of, double *dydt, size_t first_row,
                         size_t end_row)
{
    const size_t cols = of->cloth->cols;
    strip self;
    if (!of->cloth->rigidity.present) {
        return 0;
    }
    memset(&self, 0, sizeof self);
    self.cloth = of->cloth, self.y = of->y, self.dydt = dydt;
    for (size_t c = 0; c < cols; c += TILE) {
        add_tile(&self, c, cols - c < TILE ? cols : c + TILE, first_row, end_row);
    }
    return sum(self.bad) == 0.0 ? 0 : 1;
}
