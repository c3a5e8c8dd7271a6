/* SPDX-License-Identifier: BSD-3-Clause */
/* kernel_bending.c -- the bending of bending.h, LANES columns at a time: row after row
 * of x + damping v, from three of these the moments of the middle one, and from three
 * rows of moments the force on the middle one. The rows stay in the first cache, TILE
 * columns wide, with two more on either side. */
#include "cloth/bending.h"
#include "cloth/levels.h"
#include "kernel/lanes.h"

#include <string.h>

enum { TILE = 128, ASIDE = 2, SPAN = TILE + 2 * ASIDE + LANES };

/* Column c is at c - first + ASIDE. */
typedef struct strip {
    double field[3][3 * SPAN];         /* [m] x + damping v, of rows r % 3 */
    double moment[3][3 * SPAN];        /* [N] k_r D_r + k_t D_c */
    double across[2][3 * SPAN];        /* [N] k_c D_c, of rows r % 2 */
    double columns[SPAN], inner[SPAN]; /* the parts of k_r and k_c by column */
    vec bad;                           /* 0 or NaN */
    const weft_cloth *cloth;
    const double *y;
    double *dydt;
    size_t first, end; /* columns */
} strip;

INLINE vec3 second(vec3 low, vec3 here, vec3 high)
{
    return minus(minus(high, here), minus(here, low));
}

/* Beyond the rim as on it, in the three planes of a row. */
static void repeat_ends(const strip *self, double *row)
{
    const size_t past = self->end - self->first + ASIDE;
    for (size_t k = 0; k < 3 * SPAN; k += SPAN) {
        if (self->first == 0) {
            row[k + ASIDE - 1] = row[k + ASIDE];
        }
        if (self->end == self->cloth->cols) {
            row[k + past] = row[k + past - 1];
        }
    }
}

/* `count` columns from particle i on. */
INLINE void take(const strip *self, size_t i, size_t count, double *to)
{
    const size_t n = self->cloth->particles;
    const double damping = self->cloth->rigidity.damping;
    vec3 x = load3_some(self->y + i, n, count);
    if (damping != 0.0) {
        const vec3 v = load3_some(self->y + 3 * n + i, n, count);
        x = plus(x, scaled(splat(damping), v));
    }
    store3_some(to, SPAN, x, count);
}

static void take_row(strip *self, size_t r)
{
    const size_t cols = self->cloth->cols, from = self->first, past = self->end + ASIDE;
    const size_t low = from < ASIDE ? 0 : from - ASIDE,
                 high = past < cols ? past : cols;
    const size_t count = high - low < LANES ? high - low : LANES;
    for (size_t c = low; c < high; c += LANES) { /* the last goes back over some */
        const size_t at = c + count > high ? high - count : c;
        take(self, r * cols + at, count, self->field[r % 3] + (ASIDE + at - from));
    }
    repeat_ends(self, self->field[r % 3]);
}

static size_t before(size_t at)
{
    return at > 0 ? at - 1 : at;
}

static size_t after(size_t at, size_t count)
{
    return at + 1 < count ? at + 1 : at;
}

static void find_moments(strip *self, size_t r)
{
    const size_t rows = self->cloth->rows, end = self->end - self->first + ASIDE;
    const weft__rigidity *k = &self->cloth->rigidity;
    const double *here = self->field[r % 3], *above = self->field[before(r) % 3];
    const double *below = self->field[after(r, rows) % 3];
    const vec along = splat(weft__inner(r, rows) ? k->along : 0.0);
    const vec across = splat(k->across * weft__strip(r, rows)), twist = splat(k->twist);
    for (size_t j = ASIDE - 1; j <= end; j += LANES) {
        const vec3 middle = load3(here + j, SPAN);
        const vec3 down
            = second(load3(above + j, SPAN), middle, load3(below + j, SPAN));
        const vec3 right
            = second(load3(here + j - 1, SPAN), middle, load3(here + j + 1, SPAN));
        store3(
            self->moment[r % 3] + j, SPAN,
            plus(scaled(along * load(self->columns + j), down), scaled(twist, right)));
        store3(self->across[r % 2] + j, SPAN,
               scaled(across * load(self->inner + j), right));
    }
    repeat_ends(self, self->across[r % 2]);
}

static void add_forces(strip *self, size_t r)
{
    const size_t n = self->cloth->particles, rows = self->cloth->rows;
    const double *here = self->moment[r % 3], *above = self->moment[before(r) % 3];
    const double *below = self->moment[after(r, rows) % 3], *flat = self->across[r % 2];
    for (size_t c = self->first; c < self->end; c += LANES) {
        const size_t j = c - self->first + ASIDE, i = r * self->cloth->cols + c;
        const size_t count = self->end - c < LANES ? self->end - c : LANES;
        const vec3 down = second(load3(above + j, SPAN), load3(here + j, SPAN),
                                 load3(below + j, SPAN));
        const vec3 right = second(load3(flat + j - 1, SPAN), load3(flat + j, SPAN),
                                  load3(flat + j + 1, SPAN));
        const vec3 bent
            = scaled(load(self->cloth->inverse_mass + i), plus(down, right));
        double *to = self->dydt + 3 * n + i;
        vec3 sums = minus(load3_some(to, n, count), bent);
        store3_some(to, n, sums, count);
        if (count < LANES) {
            sums = load3_some(to, n, count);
        }
        self->bad += ((sums.x + sums.y) + sums.z) * 0.0;
    }
}

/* Columns [first, end) of rows [first_row, end_row). */
static void add_tile(strip *self, size_t first, size_t end, size_t first_row,
                     size_t end_row)
{
    const size_t rows = self->cloth->rows, cols = self->cloth->cols;
    size_t moments = before(first_row), taken = before(moments); /* rows, so far */
    self->first = first, self->end = end;
    for (size_t j = 0; j < SPAN; ++j) {
        const size_t c = first + j < ASIDE ? 0 : first + j - ASIDE;
        self->columns[j] = weft__strip(c, cols);
        self->inner[j] = weft__inner(c, cols) ? 1.0 : 0.0;
    }
    for (size_t r = first_row; r < end_row; ++r) {
        for (; moments <= after(r, rows); ++moments) {
            for (; taken <= after(moments, rows); ++taken) {
                take_row(self, taken);
            }
            find_moments(self, moments);
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
