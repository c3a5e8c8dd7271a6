/* SPDX-License-Identifier: BSD-3-Clause */
/* vector.c -- SUNDIALS' serial vector with memory of our own, and with those operations
 * replaced that an explicit step consists of. To the others it is a serial vector.
 *
 * Debian compiles SUNDIALS at -O0. Beyond the caches it is memory that binds, so a
 * combination reads all its vectors side by side, once.
 *
 * Every component is computed by the same operations in the same order whatever the
 * instruction set, and a sum is taken over slices that depend on the length alone and
 * are added up in order: the same bits everywhere, on any number of threads. */
#include "arkode_plugin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SIDE_BY_SIDE = 8, /* vectors read at once */
    TERMS = WEFT__ARK_MAX_STAGES + 1,
    BLOCK = 512,            /* components of a sum that stays in a cache */
    LINE = 8,               /* components of a cache line */
    LANES = 64,             /* partial results of a norm */
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

typedef struct content {
    struct _N_VectorContent_Serial serial; /* first: all that the library sees */
    ark_team *team;
    bool finite; /* what the last combination written here is */
} content;

/* On vectors of n components. */
typedef struct operation {
    size_t n;
    ark_team *team;
    int count; /* of vectors read */
    const double *const *x;
    const double *c;
    double *z;
} operation;

/* The components [first, last); returns what a reduction makes of them. */
typedef double slice_fn(const operation *op, size_t first, size_t last);

static size_t length(N_Vector v)
{
    return (size_t)NV_LENGTH_S(v);
}

static ark_team *team_of(N_Vector v)
{
    return ((const content *)v->content)->team;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* A slice for each part of a job. */
typedef struct job {
    slice_fn *slice;
    const operation *op;
    size_t size; /* of a slice */
    double *part;
} job;

static void do_slice(void *ctx, int i)
{
    const job *whole = ctx;
    const size_t first = (size_t)i * whole->size;
    whole->part[i]
        = whole->slice(whole->op, first, least(first + whole->size, whole->op->n));
}

/* Returns the number of slices; part[i] is what came of the i-th. */
static int run(slice_fn *slice, const operation *op, double part[SLICES])
{
    const size_t even = (op->n / (SLICES * LINE) + 1) * LINE;
    job whole = { slice, op, even > SLICE_LEAST ? even : SLICE_LEAST, part };
    const int count = (int)((op->n + whole.size - 1) / whole.size);
    if (op->team != NULL && op->n >= PARALLEL_LEAST) {
        weft__ark_team_run(op->team, do_slice, &whole, count);
        return count;
    }
    for (int i = 0; i < count; ++i) {
        do_slice(&whole, i);
    }
    return count;
}

/* ---- combinations ---------------------------------------------------------------- */

/* That are not finite are the doubles with all bits of the exponent set: one more
 * carries into the sign, and more than nothing behind it, for NaN, does so sooner. */
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

static double combination_slice(const operation *op, size_t first, size_t last)
{
    const double *x[SIDE_BY_SIDE];
    for (int k = 0; k < op->count && k < SIDE_BY_SIDE; ++k) {
        x[k] = op->x[k] + first;
    }
    if (op->count <= SIDE_BY_SIDE) {
        return combine(op->count, x, op->c, op->z + first, last - first);
    }
    bool bad = false;
    for (size_t at = first; at < last; at += BLOCK) {
        bad = combine_many(op, at, least(BLOCK, last - at)) || bad;
    }
    return bad;
}

WIDE static double set_slice(const operation *op, size_t first, size_t last)
{
    double *z = op->z;
    const double c = op->c[0];
    for (size_t i = first; i < last; ++i) {
        z[i] = c;
    }
    return 0.0;
}

static void set_all(sunrealtype c, N_Vector z)
{
    double part[SLICES];
    const operation op
        = { .n = length(z), .team = team_of(z), .c = &c, .z = NV_DATA_S(z) };
    (void)run(set_slice, &op, part);
    ((content *)z->content)->finite = isfinite(c);
}

static bool all_zero(const double *part, int count)
{
    int i = 0;
    while (i < count && part[i] == 0.0) {
        ++i;
    }
    return i == count;
}

/* What has the factor 0 is left out, NaN or not: a table that is given stages without
 * weight has the same bits as without them. */
static int linear_combination(int count, sunrealtype *c, N_Vector *x, N_Vector z)
{
    double part[SLICES], factor[TERMS];
    const double *from[TERMS];
    int kept = 0;
    for (int k = 0; k < count; ++k) {
        if (c[k] != 0.0) {
            if (kept == TERMS) {
                return -1;
            }
            factor[kept] = c[k];
            from[kept++] = NV_DATA_S(x[k]);
        }
    }
    const operation op = { .n = length(z),
                           .team = team_of(z),
                           .count = kept,
                           .x = from,
                           .c = factor,
                           .z = NV_DATA_S(z) };
    if (kept == 0) {
        set_all(0.0, z);
        return 0;
    }
    ((content *)z->content)->finite = all_zero(part, run(combination_slice, &op, part));
    return 0;
}

static void scale(sunrealtype c, N_Vector x, N_Vector z)
{
    (void)linear_combination(1, &c, &x, z);
}

static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z)
{
    sunrealtype c[] = { a, b };
    N_Vector both[] = { x, y };
    (void)linear_combination(2, c, both, z);
}

void weft__ark_read(N_Vector v, double *to)
{
    const double *from = NV_DATA_S(v), one = 1.0;
    double part[SLICES];
    const operation op = {
        .n = length(v), .team = team_of(v), .count = 1, .x = &from, .c = &one, .z = to
    };
    (void)run(combination_slice, &op, part);
}

void weft__ark_write(N_Vector v, const double *from)
{
    const double one = 1.0;
    double part[SLICES];
    const operation op = { .n = length(v),
                           .team = team_of(v),
                           .count = 1,
                           .x = &from,
                           .c = &one,
                           .z = NV_DATA_S(v) };
    (void)run(combination_slice, &op, part);
}

/* ---- tests and norms ------------------------------------------------------------- */

/* A comparison drops NaN, which is kept apart. */
WIDE static double max_slice(const operation *op, size_t first, size_t last)
{
    double most[LANES] = { 0.0 };
    uint64_t nan = 0;
    for (size_t at = first; at < last; at += LANES) {
        const double *p = op->x[0] + at, *w = op->x[1] + at;
        const size_t m = least(LANES, last - at);
        for (size_t i = 0; i < m; ++i) {
            const double e = fabs(p[i] * w[i]);
            most[i] = e > most[i] ? e : most[i];
            nan |= magnitude_bits(e) + SHOWS_NAN;
        }
    }
    for (size_t i = 1; i < LANES; ++i) {
        most[0] = most[i] > most[0] ? most[i] : most[0];
    }
    return nan >> 63 != 0 ? NAN : most[0];
}

WIDE static double square_slice(const operation *op, size_t first, size_t last)
{
    double sum[LANES] = { 0.0 };
    for (size_t at = first; at < last; at += LANES) {
        const double *p = op->x[0] + at, *w = op->x[1] + at;
        const size_t m = least(LANES, last - at);
        for (size_t i = 0; i < m; ++i) {
            const double e = p[i] * w[i];
            sum[i] += e * e;
        }
    }
    for (size_t i = 1; i < LANES; ++i) {
        sum[0] += sum[i];
    }
    return sum[0];
}

static operation on_two(N_Vector x, N_Vector y, const double *both[2])
{
    both[0] = NV_DATA_S(x);
    both[1] = NV_DATA_S(y);
    return (operation){ .n = length(x), .team = team_of(x), .x = both };
}

static sunrealtype max_norm(N_Vector x, N_Vector weights)
{
    const double *both[2];
    const operation op = on_two(x, weights, both);
    double part[SLICES], most = 0.0;
    const int count = run(max_slice, &op, part);
    for (int i = 0; i < count; ++i) {
        most = part[i] > most || isnan(part[i]) ? part[i] : most;
    }
    return most;
}

static sunrealtype rms_norm(N_Vector x, N_Vector weights)
{
    const double *both[2];
    const operation op = on_two(x, weights, both);
    double part[SLICES], sum = 0.0;
    const int count = run(square_slice, &op, part);
    for (int i = 0; i < count; ++i) {
        sum += part[i];
    }
    return sqrt(sum / (double)op.n);
}

/* With fixed steps: nothing is judged. */
static sunrealtype no_norm(N_Vector x, N_Vector weights)
{
    (void)x;
    (void)weights;
    return 0.0;
}

WIDE static double finite_slice(const operation *op, size_t first, size_t last)
{
    const double *x = op->x[0];
    uint64_t bad = 0;
    for (size_t i = first; i < last; ++i) {
        bad |= magnitude_bits(x[i]) + SHOWS_NOT_FINITE;
    }
    return bad >> 63 != 0;
}

bool weft__ark_finite(N_Vector v)
{
    const double *x = NV_DATA_S(v);
    const operation op = { .n = length(v), .team = team_of(v), .x = &x };
    double part[SLICES];
    return all_zero(part, run(finite_slice, &op, part));
}

bool weft__ark_made_finite(N_Vector v)
{
    return ((const content *)v->content)->finite;
}

WIDE static double weigh_slice(const operation *op, size_t first, size_t last)
{
    const double *y = op->x[0], rtol = op->c[0], atol = op->c[1];
    double *weights = op->z;
    ELEMENTWISE
    for (size_t i = first; i < last; ++i) {
        weights[i] = 1.0 / (rtol * fabs(y[i]) + atol);
    }
    return 0.0;
}

void weft__ark_weigh(N_Vector y, N_Vector weights, size_t first, size_t count,
                     double rtol, double atol)
{
    const double *from = NV_DATA_S(y) + first, c[] = { rtol, atol };
    double part[SLICES];
    const operation op = { .n = count,
                           .team = team_of(y),
                           .x = &from,
                           .c = c,
                           .z = NV_DATA_S(weights) + first };
    (void)run(weigh_slice, &op, part);
}

/* ---- the vector itself ----------------------------------------------------------- */

static void destroy(N_Vector v)
{
    if (v != NULL && v->content != NULL) {
        free(NV_DATA_S(v));
        free(v->content);
    }
    N_VFreeEmpty(v);
}

/* Each thread is the first to touch what it works on later, and so has it near. */
static bool give_content(N_Vector v, size_t n, ark_team *team)
{
    const size_t line = LINE * sizeof(double);
    content *own = calloc(1, sizeof *own);
    if (own == NULL) {
        return false;
    }
    v->content = own;
    own->team = team;
    own->serial.length = (sunindextype)n;
    own->serial.own_data = SUNTRUE;
    own->serial.data = n > (SIZE_MAX - line) / sizeof(double)
                           ? NULL
                           : aligned_alloc(line, (n / LINE + 1) * line);
    if (own->serial.data == NULL) {
        return false;
    }
    set_all(0.0, v);
    return true;
}

static N_Vector clone(N_Vector like)
{
    N_Vector v = N_VNewEmpty(like->sunctx);
    if (v == NULL || N_VCopyOps(like, v) != 0
        || !give_content(v, length(like), team_of(like))) {
        destroy(v);
        return NULL;
    }
    return v;
}

N_Vector weft__ark_vector(size_t n, ark_team *team, SUNContext context)
{
    N_Vector serial = N_VNewEmpty_Serial(0, context);
    N_Vector v = serial == NULL ? NULL : N_VNewEmpty(context);
    if (v == NULL || N_VCopyOps(serial, v) != 0 || !give_content(v, n, team)) {
        N_VDestroy(serial);
        destroy(v);
        return NULL;
    }
    N_VDestroy(serial);
    v->ops->nvclone = clone;
    v->ops->nvdestroy = destroy;
    v->ops->nvscale = scale;
    v->ops->nvlinearsum = linear_sum;
    v->ops->nvlinearcombination = linear_combination;
    v->ops->nvconst = set_all;
    v->ops->nvwrmsnorm = no_norm;
    return v;
}

void weft__ark_judge_by(N_Vector v, weft_norm norm)
{
    v->ops->nvwrmsnorm = norm == WEFT_NORM_MAX ? max_norm : rms_norm;
}
