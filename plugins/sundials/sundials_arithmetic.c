/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_arithmetic.c -- the loops of vector.c over plain arrays. Debian compiles
 * those of SUNDIALS at -O0.
 *
 * Every component is computed by the same operations in the same order on any set of
 * instructions, and a sum is taken over slices that depend on the length alone and are
 * added up in order: the same bits everywhere, on any number of threads. */
#include "sundials_arithmetic.h"

#include <math.h>
#include <string.h>

#include "../linear/vectors.h"

enum {
    SIDE_BY_SIDE = 8,       /* vectors read at once */
    BLOCK = 1024,           /* components of a partial sum, which stays in a cache */
    LINE = 8,               /* components of a cache line */
    LANES = 64,             /* partial results of a norm */
    SLICES = 64,            /* a vector has at most so many, */
    SLICE_LEAST = 2048,     /* of so many components at least */
    PARALLEL_LEAST = 20000, /* components that are worth waking a thread for */
};

/* A loop over n components, slice by slice. */
typedef struct loop loop;
typedef double slice_fn(const loop *self, size_t first, size_t end);

struct loop {
    slice_fn *slice;
    size_t n;
    int count; /* of vectors read */
    const double *const *x;
    const double *c;
    double *z;
    size_t size; /* of a slice */
    double results[SLICES];
};

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

static void do_slice(void *ctx, size_t i)
{
    loop *self = ctx;
    const size_t first = i * self->size;
    self->results[i] = self->slice(self, first, least(first + self->size, self->n));
}

/* Returns the number of slices. */
static size_t run(loop *self, const weft_team *pool)
{
    const size_t even = (self->n / (SLICES * LINE) + 1) * LINE;
    self->size = even > SLICE_LEAST ? even : SLICE_LEAST;
    const size_t count = (self->n + self->size - 1) / self->size;
    if (pool != NULL && self->n >= PARALLEL_LEAST) {
        pool->run(pool->self, do_slice, self, count);
        return count;
    }
    for (size_t i = 0; i < count; ++i) {
        do_slice(self, i);
    }
    return count;
}

/* NaN if one is. */
static double largest(const double *values, size_t count)
{
    double most = 0.0;
    for (size_t i = 0; i < count; ++i) {
        most = values[i] > most || isnan(values[i]) ? values[i] : most;
    }
    return most;
}

/* Added to the bits of |x| these carry into the sign just for an x that is not finite,
 * whose exponent has all bits set, or that is NaN, which has bits behind them. */
#define SHOWS_NOT_FINITE UINT64_C(0x0010000000000000)
#define SHOWS_NAN        UINT64_C(0x000fffffffffffff)

static inline uint64_t magnitude_bits(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits & INT64_MAX;
}

/* ---- combinations ---------------------------------------------------------------- */

/* Returns whether something of z is not finite. */
INLINE bool add_up(int count, const double *const *x, const double *c, double *z,
                   size_t n)
{
    const double *from[SIDE_BY_SIDE];
    double factor[SIDE_BY_SIDE];
    for (int k = 0; k < count; ++k) {
        from[k] = x[k];
        factor[k] = c[k];
    }
    uint64_t bad = 0;
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        double sum = factor[0] * from[0][i];
        for (int k = 1; k < count; ++k) {
            sum += factor[k] * from[k][i];
        }
        z[i] = sum;
        bad |= magnitude_bits(sum) + SHOWS_NOT_FINITE;
    }
    return bad >> 63 != 0;
}

/* At most SIDE_BY_SIDE vectors. */
WIDE static bool add(int count, const double *const *x, const double *c, double *z,
                     size_t n)
{
    switch (count) {
#define CASE(m)                                                                        \
    case m:                                                                            \
        return add_up(m, x, c, z, n);
        CASE(1)
        CASE(2)
        CASE(3)
        CASE(4)
        CASE(5)
        CASE(6)
        CASE(7)
#undef CASE
    default:
        return add_up(SIDE_BY_SIDE, x, c, z, n);
    }
}

/* Of more vectors the sum so far is the first of the next lot. What is not finite stays
 * so. Returns NaN if something of z is not finite. */
static double combine_slice(const loop *self, size_t first, size_t end)
{
    double sum[BLOCK];
    bool bad = false;
    for (size_t at = first; at < end; at += BLOCK) {
        const size_t n = least(BLOCK, end - at);
        const double *x[SIDE_BY_SIDE] = { sum };
        double c[SIDE_BY_SIDE] = { 1.0 };
        for (int done = 0, lot = 0; done < self->count; lot = 1) {
            for (; lot < SIDE_BY_SIDE && done < self->count; ++lot, ++done) {
                x[lot] = self->x[done] + at;
                c[lot] = self->c[done];
            }
            bad = add(lot, x, c, done < self->count ? sum : self->z + at, n) || bad;
            x[0] = sum;
            c[0] = 1.0;
        }
    }
    return bad ? (double)NAN : 0.0;
}

bool weft__sun_combine(const weft_team *pool, size_t n, int count,
                       const double *const *x, const double *c, double *z)
{
    loop all
        = { .slice = combine_slice, .n = n, .count = count, .x = x, .c = c, .z = z };
    return !isnan(largest(all.results, run(&all, pool)));
}

WIDE static double set_slice(const loop *self, size_t first, size_t end)
{
    for (size_t i = first; i < end; ++i) {
        self->z[i] = self->c[0];
    }
    return 0.0;
}

void weft__sun_set(const weft_team *pool, size_t n, double c, double *z)
{
    loop all = { .slice = set_slice, .n = n, .c = &c, .z = z };
    (void)run(&all, pool);
}

WIDE static double finite_slice(const loop *self, size_t first, size_t end)
{
    const double *x = self->x[0];
    uint64_t bad = 0;
    for (size_t i = first; i < end; ++i) {
        bad |= magnitude_bits(x[i]) + SHOWS_NOT_FINITE;
    }
    return bad >> 63 != 0 ? (double)NAN : 0.0;
}

bool weft__sun_all_finite(const weft_team *pool, size_t n, const double *x)
{
    loop all = { .slice = finite_slice, .n = n, .x = &x };
    return !isnan(largest(all.results, run(&all, pool)));
}

/* ---- norms ----------------------------------------------------------------------- */

WIDE static void weigh(const double *y, double *w, size_t n, double rtol, double atol)
{
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        w[i] = 1.0 / (rtol * fabs(y[i]) + atol);
    }
}

/* c: rtol and both of atol. */
static double weights_slice(const loop *self, size_t first, size_t end)
{
    const size_t half = self->n / 2, mid = half < first ? first : least(half, end);
    const double *y = self->x[0], *c = self->c;
    weigh(y + first, self->z + first, mid - first, c[0], c[1]);
    weigh(y + mid, self->z + mid, end - mid, c[0], c[2]);
    return 0.0;
}

void weft__sun_weights_of(const weft_team *pool, size_t n, const double *y, double rtol,
                          const double atol[2], double *w)
{
    const double c[] = { rtol, atol[0], atol[1] };
    loop all = { .slice = weights_slice, .n = n, .x = &y, .c = c, .z = w };
    (void)run(&all, pool);
}

/* The largest |e w|. */
WIDE static double max_slice(const loop *self, size_t first, size_t end)
{
    const double *e = self->x[0], *w = self->x[1];
    double lane[LANES] = { 0.0 };
    uint64_t nan = 0;
    for (size_t at = first; at < end; at += LANES) {
        const size_t m = least(LANES, end - at);
        for (size_t i = 0; i < m; ++i) {
            const double size = fabs(e[at + i] * w[at + i]);
            lane[i] = size > lane[i] ? size : lane[i];
            nan |= magnitude_bits(size) + SHOWS_NAN;
        }
    }
    return nan >> 63 != 0 ? (double)NAN : largest(lane, LANES);
}

/* By weights that are computed here: c is rtol and both of atol. */
WIDE static double scaled_slice(const loop *self, size_t first, size_t end)
{
    const double *e = self->x[0], *y = self->x[1], *c = self->c;
    double lane[LANES] = { 0.0 };
    uint64_t nan = 0;
    for (size_t at = first; at < end; at += LANES) {
        const size_t m = least(LANES, end - at);
        for (size_t i = 0; i < m; ++i) {
            const double atol = at + i < self->n / 2 ? c[1] : c[2];
            const double weight = 1.0 / (c[0] * fabs(y[at + i]) + atol);
            const double size = fabs(e[at + i] * weight);
            lane[i] = size > lane[i] ? size : lane[i];
            nan |= magnitude_bits(size) + SHOWS_NAN;
        }
    }
    return nan >> 63 != 0 ? (double)NAN : largest(lane, LANES);
}

double weft__sun_scaled_norm(const weft_team *pool, size_t n, const double *e,
                             const double *y, double rtol, const double atol[2])
{
    const double *both[] = { e, y }, c[] = { rtol, atol[0], atol[1] };
    loop all = { .slice = scaled_slice, .n = n, .x = both, .c = c };
    return largest(all.results, run(&all, pool));
}

static double sum_of(const double *values, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        sum += values[i];
    }
    return sum;
}

/* The sum of (e w)^2. */
WIDE static double squares_slice(const loop *self, size_t first, size_t end)
{
    const double *e = self->x[0], *w = self->x[1];
    double lane[LANES] = { 0.0 };
    for (size_t at = first; at < end; at += LANES) {
        const size_t m = least(LANES, end - at);
        for (size_t i = 0; i < m; ++i) {
            const double size = e[at + i] * w[at + i];
            lane[i] += size * size;
        }
    }
    return sum_of(lane, LANES);
}

double weft__sun_norm(const weft_team *pool, size_t n, weft_norm norm, const double *e,
                      const double *w)
{
    const double *both[] = { e, w };
    const bool max = norm == WEFT_NORM_MAX;
    loop all = { .slice = max ? max_slice : squares_slice, .n = n, .x = both };
    const size_t slices = run(&all, pool);
    return max ? largest(all.results, slices)
               : sqrt(sum_of(all.results, slices) / (double)n);
}
