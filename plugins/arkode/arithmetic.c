/* SPDX-License-Identifier: BSD-3-Clause */
/* arithmetic.c -- the loops of vector.c over plain arrays.
 *
 * Debian compiles SUNDIALS at -O0. Beyond the caches it is memory that binds, so a
 * combination reads all its vectors side by side, once; and where it is an error
 * estimate it is judged block by block, while it still is in the first cache.
 *
 * Every component is computed by the same operations in the same order whatever the
 * instruction set, and a sum is taken over slices that depend on the length alone and
 * are added up in order: the same bits everywhere, on any number of threads. */
#include "arithmetic.h"

#include <math.h>
#include <string.h>

enum {
    SIDE_BY_SIDE = 8,       /* vectors read at once */
    BLOCK = 512,            /* components of a part that stays in a cache */
    LINE = 8,               /* components of a cache line */
    LANES = 64,             /* partial results of a norm; BLOCK is a multiple */
    SLICES = 64,            /* a vector has at most so many, */
    SLICE_LEAST = 2048,     /* of so many components at least */
    PARALLEL_LEAST = 20000, /* components that are worth the waking of a thread */
};

/* Wider vectors where the machine has them, which is found out as the plugin is loaded:
 * before there is an address sanitizer. */
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__)                   \
    && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WIDE __attribute__((target_clones("default", "avx2")))
#else
#define WIDE
#endif

/* What is written may be one of the vectors read, but not a part of one. */
#if defined(__clang__)
#define ELEMENTWISE _Pragma("clang loop vectorize(assume_safety)")
#else
#define ELEMENTWISE _Pragma("GCC ivdep")
#endif

/* What came of a slice. */
typedef struct part {
    double value; /* of a norm, or the largest magnitude */
    bool bad;     /* something is not finite */
} part;

/* On arrays of n components. */
typedef struct operation {
    size_t n;
    int count; /* of vectors read */
    const double *const *x;
    const double *c;
    double *z;
    const ark_weights *weights; /* NULL: it is not judged */
} operation;

/* The components [first, last). */
typedef part slice_fn(const operation *op, size_t first, size_t last);

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* A slice for each part of a job. */
typedef struct job {
    slice_fn *slice;
    const operation *op;
    size_t size; /* of a slice */
    part *parts;
} job;

static void do_slice(void *ctx, size_t i)
{
    const job *whole = ctx;
    const size_t first = i * whole->size;
    whole->parts[i]
        = whole->slice(whole->op, first, least(first + whole->size, whole->op->n));
}

/* Returns the number of slices. */
static int run(const weft_team *team, slice_fn *slice, const operation *op,
               part parts[SLICES])
{
    const size_t even = (op->n / (SLICES * LINE) + 1) * LINE;
    job whole = { slice, op, even > SLICE_LEAST ? even : SLICE_LEAST, parts };
    const int count = (int)((op->n + whole.size - 1) / whole.size);
    if (team != NULL && op->n >= PARALLEL_LEAST) {
        team->run(team->self, do_slice, &whole, (size_t)count);
        return count;
    }
    for (int i = 0; i < count; ++i) {
        do_slice(&whole, (size_t)i);
    }
    return count;
}

static bool any_bad(const part *parts, int count)
{
    int i = 0;
    while (i < count && !parts[i].bad) {
        ++i;
    }
    return i < count;
}

/* The largest value, NaN if one is. */
static double largest(const part *parts, int count)
{
    double most = 0.0;
    for (int i = 0; i < count; ++i) {
        const double value = parts[i].value;
        most = value > most || isnan(value) ? value : most;
    }
    return most;
}

/* ---- combinations ---------------------------------------------------------------- */

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

/* Returns whether something of z is not finite. */
static inline __attribute__((always_inline)) bool
add_up(int count, const double *const *x, const double *c, double *z, size_t n)
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

/* z = sum of c[k] x[k], from left to right; at most SIDE_BY_SIDE of them. */
WIDE static bool combine(int count, const double *const *x, const double *c, double *z,
                         size_t n)
{
    switch (count) {
    case 1:
        return add_up(1, x, c, z, n);
    case 2:
        return add_up(2, x, c, z, n);
    case 3:
        return add_up(3, x, c, z, n);
    case 4:
        return add_up(4, x, c, z, n);
    case 5:
        return add_up(5, x, c, z, n);
    case 6:
        return add_up(6, x, c, z, n);
    case 7:
        return add_up(7, x, c, z, n);
    default:
        return add_up(8, x, c, z, n);
    }
}

/* More vectors than that: the sum so far is the first of the next lot. What is not
 * finite stays so. */
static bool combine_many(const operation *op, size_t at, size_t n)
{
    double sum[BLOCK];
    const double *x[SIDE_BY_SIDE] = { sum };
    double c[SIDE_BY_SIDE] = { 1.0 };
    bool bad = false;
    for (int done = 0, lot = 0; done < op->count; done += lot) {
        const int kept = done > 0;
        for (lot = 0; kept + lot < SIDE_BY_SIDE && done + lot < op->count; ++lot) {
            x[kept + lot] = op->x[done + lot] + at;
            c[kept + lot] = op->c[done + lot];
        }
        bad = combine(kept + lot, x, c, sum, n);
        x[0] = sum;
        c[0] = 1.0;
    }
    memcpy(op->z + at, sum, n * sizeof *sum);
    return bad;
}

/* As many as there are; n <= BLOCK if they are many. */
static bool combine_part(const operation *op, size_t at, size_t n)
{
    const double *x[SIDE_BY_SIDE];
    if (op->count > SIDE_BY_SIDE) {
        return combine_many(op, at, n);
    }
    for (int k = 0; k < op->count; ++k) {
        x[k] = op->x[k] + at;
    }
    return combine(op->count, x, op->c, op->z + at, n);
}

static part combination_slice(const operation *op, size_t first, size_t last)
{
    part out = { 0 };
    const size_t most = op->count > SIDE_BY_SIDE ? BLOCK : last - first;
    for (size_t at = first; at < last; at += most) {
        out.bad = combine_part(op, at, least(most, last - at)) || out.bad;
    }
    return out;
}

bool weft__ark_combine(const weft_team *team, size_t n, int count,
                       const double *const *x, const double *c, double *z)
{
    const operation op = { .n = n, .count = count, .x = x, .c = c, .z = z };
    part parts[SLICES];
    return !any_bad(parts, run(team, combination_slice, &op, parts));
}

/* ---- other loops ----------------------------------------------------------------- */

/* A comparison drops NaN, which is kept apart. */
WIDE static part copy_slice(const operation *op, size_t first, size_t last)
{
    double most[LINE] = { 0.0 };
    uint64_t bad = 0;
    for (size_t at = first; at < last; at += LINE) {
        const double *from = op->x[0] + at;
        double *to = op->z + at;
        const size_t m = least(LINE, last - at);
        for (size_t i = 0; i < m; ++i) {
            const double size = fabs(from[i]);
            most[i] = size > most[i] ? size : most[i];
            bad |= magnitude_bits(size) + SHOWS_NOT_FINITE;
            to[i] = from[i];
        }
    }
    for (size_t i = 1; i < LINE; ++i) {
        most[0] = most[i] > most[0] ? most[i] : most[0];
    }
    return (part){ bad >> 63 != 0 ? NAN : most[0], bad >> 63 != 0 };
}

double weft__ark_copy(const weft_team *team, size_t n, const double *x, double *z)
{
    const operation op = { .n = n, .x = &x, .z = z };
    part parts[SLICES];
    return largest(parts, run(team, copy_slice, &op, parts));
}

WIDE static part set_slice(const operation *op, size_t first, size_t last)
{
    double *z = op->z;
    const double c = op->c[0];
    for (size_t i = first; i < last; ++i) {
        z[i] = c;
    }
    return (part){ 0 };
}

void weft__ark_set(const weft_team *team, size_t n, double c, double *z)
{
    const operation op = { .n = n, .c = &c, .z = z };
    part parts[SLICES];
    (void)run(team, set_slice, &op, parts);
}

WIDE static part finite_slice(const operation *op, size_t first, size_t last)
{
    const double *x = op->x[0];
    uint64_t bad = 0;
    for (size_t i = first; i < last; ++i) {
        bad |= magnitude_bits(x[i]) + SHOWS_NOT_FINITE;
    }
    return (part){ .bad = bad >> 63 != 0 };
}

bool weft__ark_all_finite(const weft_team *team, size_t n, const double *x)
{
    const operation op = { .n = n, .x = &x };
    part parts[SLICES];
    return !any_bad(parts, run(team, finite_slice, &op, parts));
}

/* ---- norms ----------------------------------------------------------------------- */

WIDE static void weigh(const double *y, double *to, size_t n, double rtol, double atol)
{
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        to[i] = 1.0 / (rtol * fabs(y[i]) + atol);
    }
}

/* Weights [at, at + n), into `room` where they stand nowhere. */
static const double *weights_at(const ark_weights *w, size_t at, size_t n,
                                double room[BLOCK])
{
    if (w->plain != NULL) {
        return w->plain + at;
    }
    const size_t x = at >= w->half ? 0 : least(n, w->half - at);
    weigh(w->y + at, room, x, w->rtol, w->atol[0]);
    weigh(w->y + at + x, room + x, n - x, w->rtol, w->atol[1]);
    return room;
}

/* In the lanes the largest e w; returns whether one is NaN. */
WIDE static bool raise_lanes(const double *e, const double *w, size_t n, double *lane)
{
    uint64_t nan = 0;
    for (size_t at = 0; at < n; at += LANES) {
        const size_t m = least(LANES, n - at);
        for (size_t i = 0; i < m; ++i) {
            const double size = fabs(e[at + i] * w[at + i]);
            lane[i] = size > lane[i] ? size : lane[i];
            nan |= magnitude_bits(size) + SHOWS_NAN;
        }
    }
    return nan >> 63 != 0;
}

/* In the lanes the sums of (e w)^2. */
WIDE static void add_to_lanes(const double *e, const double *w, size_t n, double *lane)
{
    for (size_t at = 0; at < n; at += LANES) {
        const size_t m = least(LANES, n - at);
        for (size_t i = 0; i < m; ++i) {
            const double size = e[at + i] * w[at + i];
            lane[i] += size * size;
        }
    }
}

static double together(const double *lane, bool max)
{
    double sum = lane[0];
    for (size_t i = 1; i < LANES; ++i) {
        sum = !max ? sum + lane[i] : lane[i] > sum ? lane[i] : sum;
    }
    return sum;
}

/* Combined first if there are vectors to combine. */
static part judged_slice(const operation *op, size_t first, size_t last)
{
    const bool max = op->weights->norm == WEFT_NORM_MAX;
    double lane[LANES] = { 0.0 }, room[BLOCK];
    bool nan = false;
    part out = { 0 };
    for (size_t at = first; at < last; at += BLOCK) {
        const size_t n = least(BLOCK, last - at);
        const double *w = weights_at(op->weights, at, n, room);
        if (op->count > 0) {
            out.bad = combine_part(op, at, n) || out.bad;
        }
        if (max) {
            nan = raise_lanes(op->z + at, w, n, lane) || nan;
        } else {
            add_to_lanes(op->z + at, w, n, lane);
        }
    }
    out.value = nan ? NAN : together(lane, max);
    return out;
}

/* What has no weight has no say, nor in where slices end; NaN in it shows. */
double weft__ark_judge(const weft_team *team, size_t n, const ark_weights *weights,
                       double *e, int count, const double *const *x, const double *c,
                       bool *finite)
{
    const size_t judged = weights->plain != NULL ? n : 2 * weights->half;
    const operation op
        = { .n = judged, .count = count, .x = x, .c = c, .z = e, .weights = weights };
    part parts[SLICES];
    const int slices = run(team, judged_slice, &op, parts);
    double sum = 0.0, unjudged = 0.0;
    bool bad = any_bad(parts, slices);
    for (size_t at = judged; at < n; ++at) {
        bad = (count > 0 && combine_part(&op, at, 1)) || bad;
        unjudged += e[at] * 0.0;
    }
    *finite = !bad;
    if (weights->norm == WEFT_NORM_MAX) {
        return largest(parts, slices) + unjudged;
    }
    for (int i = 0; i < slices; ++i) {
        sum += parts[i].value;
    }
    return sqrt((sum + unjudged) / (double)judged);
}
