/* SPDX-License-Identifier: BSD-3-Clause */
/* vector.c -- SUNDIALS' serial vector with memory of our own, and with those operations
 * replaced that an explicit step consists of. To the others, which may read it, it is a
 * serial vector.
 *
 * A step of ERKStep's moves more than it computes. What it copies is shared here until
 * one of the two is written to; a combination that already stands where it is wanted,
 * as the solution of a method whose last stage is at the solution does, is not computed
 * again; error weights are not stored, but made from the state while the error is
 * judged; and where an error estimate is kept, which is seen when it is first judged,
 * it is judged from then on as it is computed.
 *
 * There are as many arrays as vectors. One that is free is taken by the next vector
 * that needs one of its own: those needed by no step are never touched. */
#include "arithmetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    TERMS = WEFT__ARK_MAX_STAGES + 1,
    REMEMBERED = 16, /* terms of a combination that may be asked for again */
    LINE = 64,       /* bytes of a cache line */
};

/* Numbers that vectors may share. */
typedef struct array {
    double *data;
    void *block;        /* that data lies in */
    int users;          /* 0: it is free */
    uint64_t version;   /* of the numbers, of all there have been */
    bool known, finite; /* whether all are, if it is known */
    double most;        /* their largest magnitude; NaN: not known */
    struct array *next_free;
} array;

/* What a vector and its clones have in common. */
typedef struct family {
    const weft_team *team;
    size_t n;
    int members;
    array *free;
    uint64_t versions;
    weft_norm norm;
    struct content *weights; /* the member that weighs; NULL: none */
} family;

/* The version `is` of some numbers is the sum of factor[k] times version[k]. */
typedef struct recipe {
    int count; /* 0: it is not known how they were made */
    uint64_t version[REMEMBERED], is;
    double factor[REMEMBERED];
} recipe;

/* The norm of the version `of` by the weights of the version `by`. */
typedef struct verdict {
    uint64_t of, by;
    double norm;
} verdict;

typedef struct content {
    struct _N_VectorContent_Serial serial; /* first: all that the library sees */
    family *family;
    array *array;
    recipe made;
    bool judged; /* once: judged from then on as it is computed */
    verdict verdict;
    bool weighs; /* it is weights, of the numbers that it shares: */
    double rtol, atol[2];
    size_t half;
} content;

static content *of(N_Vector v)
{
    return v->content;
}

/* ---- arrays ---------------------------------------------------------------------- */

static void let_go(family *all, array *a)
{
    if (a != NULL && --a->users == 0) {
        a->next_free = all->free;
        all->free = a;
    }
}

static void hold(content *v, array *a)
{
    ++a->users;
    let_go(v->family, v->array);
    v->array = a;
    v->serial.data = a->data;
    v->made.count = 0;
    v->weighs = false;
}

/* Before it is written to. Where one is shared there is a free one. */
static void own(content *v, bool keep)
{
    family *all = v->family;
    const array *before = v->array;
    if (before->users > 1) {
        array *a = all->free;
        all->free = a->next_free;
        if (keep) {
            memcpy(a->data, before->data, all->n * sizeof *a->data);
        }
        hold(v, a);
    }
    v->array->version = ++all->versions;
    v->array->known = false;
    v->array->most = NAN;
    v->made.count = 0;
    v->weighs = false;
}

double *weft__ark_fill(N_Vector v)
{
    own(of(v), false);
    return of(v)->array->data;
}

static void is_finite(content *v, bool finite)
{
    v->array->known = true;
    v->array->finite = finite;
}

bool weft__ark_finite(N_Vector v)
{
    content *self = of(v);
    if (!self->array->known) {
        is_finite(self, weft__ark_all_finite(self->family->team, self->family->n,
                                             self->array->data));
    }
    return self->array->finite;
}

/* ---- combinations ---------------------------------------------------------------- */

static void set_all(sunrealtype c, N_Vector z)
{
    const family *all = of(z)->family;
    weft__ark_set(all->team, all->n, c, weft__ark_fill(z));
    is_finite(of(z), isfinite(c));
}

static bool stands_there(const content *z, const recipe *wanted)
{
    const recipe *made = &z->made;
    const size_t count = (size_t)wanted->count;
    return count > 0 && made->count == wanted->count && made->is == z->array->version
           && memcmp(made->version, wanted->version, count * sizeof *made->version) == 0
           && memcmp(made->factor, wanted->factor, count * sizeof *made->factor) == 0;
}

static ark_weights weights_of(const content *w)
{
    return (ark_weights){ .norm = w->family->norm,
                          .plain = w->weighs ? NULL : w->array->data,
                          .y = w->array->data,
                          .half = w->half,
                          .rtol = w->rtol,
                          .atol = { w->atol[0], w->atol[1] } };
}

/* What is read is held by others, or written to in place. */
static void combine(content *z, int count, const double *const *x, const double *c)
{
    const family *all = z->family;
    bool finite;
    own(z, false);
    if (z->judged && all->weights != NULL) {
        const ark_weights weights = weights_of(all->weights);
        z->verdict.norm = weft__ark_judge(all->team, all->n, &weights, z->array->data,
                                          count, x, c, &finite);
        z->verdict.of = z->array->version;
        z->verdict.by = all->weights->array->version;
    } else {
        finite = weft__ark_combine(all->team, all->n, count, x, c, z->array->data);
    }
    is_finite(z, finite);
}

/* What has the factor 0 is left out, NaN or not: a table that is given stages without
 * weight has the same bits as without them. */
static int linear_combination(int count, sunrealtype *c, N_Vector *x, N_Vector z)
{
    const double *from[TERMS];
    double factor[TERMS];
    recipe wanted = { 0 };
    int kept = 0;
    array *last = NULL;
    for (int k = 0; k < count; ++k) {
        if (c[k] == 0.0) {
            continue;
        }
        if (kept == TERMS) {
            return -1;
        }
        last = of(x[k])->array;
        if (kept < REMEMBERED) {
            wanted.version[kept] = last->version;
            wanted.factor[kept] = c[k];
        }
        factor[kept] = c[k];
        from[kept++] = last->data;
    }
    wanted.count = kept <= REMEMBERED ? kept : 0;
    if (kept == 0) {
        set_all(0.0, z);
    } else if (kept == 1 && factor[0] == 1.0) {
        hold(of(z), last);
    } else if (!stands_there(of(z), &wanted)) {
        combine(of(z), kept, from, factor);
        wanted.is = of(z)->array->version;
        of(z)->made = wanted;
    }
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

/* ARKODE wants to be given these, but an explicit step does without. */
static void absolute(N_Vector x, N_Vector z)
{
    own(of(z), true);
    N_VAbs_Serial(x, z);
}

static void divide(N_Vector x, N_Vector y, N_Vector z)
{
    own(of(z), true);
    N_VDiv_Serial(x, y, z);
}

static void add_constant(N_Vector x, sunrealtype b, N_Vector z)
{
    own(of(z), true);
    N_VAddConst_Serial(x, b, z);
}

static void invert(N_Vector x, N_Vector z)
{
    own(of(z), true);
    N_VInv_Serial(x, z);
}

void weft__ark_read(N_Vector v, double *to)
{
    array *a = of(v)->array;
    const family *all = of(v)->family;
    a->most = weft__ark_copy(all->team, all->n, a->data, to);
    is_finite(of(v), !isnan(a->most));
}

void weft__ark_write(N_Vector v, const double *from)
{
    const family *all = of(v)->family;
    double *to = weft__ark_fill(v);
    of(v)->array->most = weft__ark_copy(all->team, all->n, from, to);
    is_finite(of(v), !isnan(of(v)->array->most));
}

/* ---- norms ----------------------------------------------------------------------- */

void weft__ark_weigh(N_Vector y, N_Vector weights, size_t half, double rtol,
                     const double atol[2])
{
    content *self = of(weights);
    hold(self, of(y)->array);
    self->weighs = true;
    self->half = half;
    self->rtol = rtol;
    self->atol[0] = atol[0];
    self->atol[1] = atol[1];
    self->family->weights = self;
}

/* What the norm of a state in its own weights cannot be above; infinite where its
 * largest number is not known. */
static double bound(const content *x, const content *w)
{
    const double most = x->array->most, atol = fmin(w->atol[0], w->atol[1]);
    const bool own_weights = w->weighs && x->array == w->array && !isnan(most);
    return own_weights ? most / (w->rtol * most + atol) : INFINITY;
}

/* Of a state ARKODE asks only whether its norm is 1 / roundoff. */
static sunrealtype norm(N_Vector x, N_Vector weights)
{
    content *self = of(x), *w = of(weights);
    const family *all = self->family;
    if (w == all->weights && self->verdict.of == self->array->version
        && self->verdict.by == w->array->version) {
        return self->verdict.norm;
    }
    const double least = bound(self, w);
    if (least < 0x1p50) {
        return least;
    }
    bool finite;
    const ark_weights by = weights_of(w);
    self->judged = w->weighs && self->array != w->array;
    return weft__ark_judge(all->team, all->n, &by, self->array->data, 0, NULL, NULL,
                           &finite);
}

/* With fixed steps: nothing is judged. */
static sunrealtype no_norm(N_Vector x, N_Vector weights)
{
    (void)x;
    (void)weights;
    return 0.0;
}

void weft__ark_judge_by(N_Vector v, weft_norm by)
{
    of(v)->family->norm = by;
    v->ops->nvwrmsnorm = norm;
}

/* ---- the vector itself ----------------------------------------------------------- */

static void free_one(family *all)
{
    array *a = all->free;
    all->free = a->next_free;
    free(a->block);
    free(a);
}

static void leave(content *self)
{
    family *all = self->family;
    all->weights = all->weights == self ? NULL : all->weights;
    let_go(all, self->array);
    free_one(all); /* as there is one for each */
    if (--all->members == 0) {
        free(all);
    }
}

static void destroy(N_Vector v)
{
    if (v != NULL && v->content != NULL) {
        leave(v->content);
        free(v->content);
    }
    N_VFreeEmpty(v);
}

/* Zeros that the system gives when they are first touched, by who works on them. */
static array *make_array(size_t n)
{
    array *a = calloc(1, sizeof *a);
    const size_t line = LINE / sizeof(double);
    if (a == NULL) {
        return NULL;
    }
    a->block = n > SIZE_MAX - line ? NULL : calloc(n + line, sizeof(double));
    if (a->block == NULL) {
        free(a);
        return NULL;
    }
    const uintptr_t past = (uintptr_t)a->block % LINE;
    a->data = (double *)((char *)a->block + (past == 0 ? 0 : LINE - past));
    a->most = NAN;
    return a;
}

static bool join(N_Vector v, family *all)
{
    content *self = calloc(1, sizeof *self);
    array *a = make_array(all->n);
    if (self == NULL || a == NULL) {
        free(self);
        free(a == NULL ? NULL : a->block);
        free(a);
        return false;
    }
    self->family = all;
    self->serial.length = (sunindextype)all->n;
    self->serial.own_data = SUNTRUE;
    a->version = ++all->versions;
    ++all->members;
    hold(self, a);
    v->content = self;
    return true;
}

static N_Vector clone(N_Vector like)
{
    N_Vector v = N_VNewEmpty(like->sunctx);
    if (v == NULL || N_VCopyOps(like, v) != 0 || !join(v, of(like)->family)) {
        destroy(v);
        return NULL;
    }
    return v;
}

static void set_operations(N_Vector v)
{
    v->ops->nvclone = clone;
    v->ops->nvdestroy = destroy;
    v->ops->nvscale = scale;
    v->ops->nvlinearsum = linear_sum;
    v->ops->nvlinearcombination = linear_combination;
    v->ops->nvconst = set_all;
    v->ops->nvabs = absolute;
    v->ops->nvdiv = divide;
    v->ops->nvinv = invert;
    v->ops->nvaddconst = add_constant;
    v->ops->nvwrmsnorm = no_norm;
    v->ops->nvprod = NULL; /* these would write to what is shared */
    v->ops->nvcompare = NULL;
    v->ops->nvinvtest = NULL;
    v->ops->nvconstrmask = NULL;
    v->ops->nvsetarraypointer = NULL;
    v->ops->nvcloneempty = NULL;
}

N_Vector weft__ark_vector(size_t n, const weft_team *team, SUNContext context)
{
    N_Vector serial = N_VNewEmpty_Serial((sunindextype)n, context);
    N_Vector v = serial == NULL ? NULL : N_VNewEmpty(context);
    family *all = calloc(1, sizeof *all);
    if (v == NULL || all == NULL || N_VCopyOps(serial, v) != 0) {
        N_VDestroy(serial);
        destroy(v);
        free(all);
        return NULL;
    }
    N_VDestroy(serial);
    *all = (family){ .team = team, .n = n };
    if (!join(v, all)) {
        destroy(v);
        free(all);
        return NULL;
    }
    set_operations(v);
    return v;
}
