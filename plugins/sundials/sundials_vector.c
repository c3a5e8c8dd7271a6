/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_vector.c -- SUNDIALS' serial vector with memory of our own and the
 * operations of a step replaced (arithmetic.c). Functions that read vectors see a
 * serial one.
 *
 * A step of ERKStep moves more than it computes. Two things are avoided:
 * - copies: vectors share an array until one of them is written to. This saves 8 to 13
 * % of a step of Dormand and Prince's;
 * - a second computation of the last combination, as the solution of a method whose
 * last stage is at the solution (FSAL). This saves 10 to 15 % of a step beyond its
 * forces.
 *
 * There are as many arrays as vectors. A free one is taken by the next vector that
 * needs one of its own, so arrays that no step needs are never touched. */
#include "sundials_arithmetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    TERMS = WEFT__SUN_MOST_TERMS,
    LINE = 64, /* bytes of a cache line */
};

/* Numbers that vectors may share. */
typedef struct array {
    double *data;
    void *block;        /* that data lies in */
    int users;          /* 0: it is free */
    uint64_t written;   /* the number of the last writing, different in all arrays */
    bool known, finite; /* finite: all are; valid if known */
    struct array *next_free;
} array;

/* What a combination is made of: the writings that it reads, and its factors. */
typedef struct recipe {
    size_t terms;
    uint64_t written[TERMS];
    double factors[TERMS];
} recipe;

/* Shared by a vector and its clones. */
typedef struct family {
    const weft_team *pool;
    size_t n;
    int members;
    array *free;
    uint64_t writings;
    recipe recipes[2]; /* of the last combination computed, and of the next */
    int last;
    array *made;       /* the last combination; NULL: there is none */
    uint64_t made_was; /* its writing */
    weft_norm norm;
    size_t judged;    /* components that have a say in the norm */
    weft_agree agree; /* on the norm; max NULL: with nobody */
} family;

typedef struct content {
    struct _N_VectorContent_Serial serial; /* first: all that the library sees */
    family *family;
    array *array;
} content;

static content *of(N_Vector v)
{
    return v->content;
}

/* ---- arrays ---------------------------------------------------------------------- */

static void release(family *all, array *a)
{
    if (a != NULL && --a->users == 0) {
        a->next_free = all->free;
        all->free = a;
    }
}

static void share(content *v, array *a)
{
    ++a->users;
    release(v->family, v->array);
    v->array = a;
    v->serial.data = a->data;
}

/* Before it is written to, all of it unless `keep`. Where an array is shared there is a
 * free one. */
static array *make_writable(content *v, bool keep)
{
    family *all = v->family;
    const array *shared = v->array;
    if (shared->users > 1) {
        array *a = all->free;
        all->free = a->next_free;
        if (keep) {
            memcpy(a->data, shared->data, all->n * sizeof *a->data);
        }
        share(v, a);
    }
    v->array->known = false;
    v->array->written = ++all->writings;
    return v->array;
}

static void set_finite(array *a, bool finite)
{
    a->known = true;
    a->finite = finite;
}

double *weft__sun_fill(N_Vector v)
{
    return make_writable(of(v), false)->data;
}

bool weft__sun_finite(N_Vector v)
{
    const family *all = of(v)->family;
    array *a = of(v)->array;
    if (!a->known) {
        set_finite(a, weft__sun_all_finite(all->pool, all->n, a->data));
    }
    return a->finite;
}

void weft__sun_read(N_Vector v, double *to)
{
    const family *all = of(v)->family;
    array *a = of(v)->array;
    const double *from = a->data, one = 1.0;
    set_finite(a, weft__sun_combine(all->pool, all->n, 1, &from, &one, to));
}

void weft__sun_write(N_Vector v, const double *from)
{
    const family *all = of(v)->family;
    array *a = make_writable(of(v), false);
    const double one = 1.0;
    set_finite(a, weft__sun_combine(all->pool, all->n, 1, &from, &one, a->data));
}

/* ---- operations ------------------------------------------------------------------ */

static void set_all(sunrealtype c, N_Vector z)
{
    const family *all = of(z)->family;
    array *a = make_writable(of(z), false);
    weft__sun_set(all->pool, all->n, c, a->data);
    set_finite(a, isfinite(c));
}

static bool is_made(const family *all, const recipe *wanted)
{
    const recipe *last = &all->recipes[all->last];
    return all->made != NULL && all->made->users > 0
           && all->made->written == all->made_was && wanted->terms == last->terms
           && memcmp(wanted->written, last->written, wanted->terms * 8) == 0
           && memcmp(wanted->factors, last->factors, wanted->terms * 8) == 0;
}

static void combine(content *z, const double *const from[], const recipe *wanted)
{
    family *all = z->family;
    array *a = all->made = make_writable(z, false);
    set_finite(a, weft__sun_combine(all->pool, all->n, (int)wanted->terms, from,
                                    wanted->factors, a->data));
    all->last = 1 - all->last;
    all->made_was = a->written;
}

/* Terms with the factor 0 are left out, NaN or not: a table with stages of no weight
 * gives the same bits as without them. z may be one of x. */
static int linear_combination(int count, sunrealtype *c, N_Vector *x, N_Vector z)
{
    family *all = of(z)->family;
    recipe *wanted = &all->recipes[1 - all->last];
    const double *from[TERMS];
    array *only = NULL;
    wanted->terms = 0;
    for (int k = 0; k < count; ++k) {
        if (c[k] == 0.0) {
            continue;
        }
        if (wanted->terms == TERMS) {
            return -1;
        }
        only = of(x[k])->array;
        from[wanted->terms] = only->data;
        wanted->written[wanted->terms] = only->written;
        wanted->factors[wanted->terms++] = c[k];
    }
    if (wanted->terms == 0) {
        set_all(0.0, z);
    } else if (wanted->terms == 1 && wanted->factors[0] == 1.0) {
        share(of(z), only);
    } else if (is_made(all, wanted)) {
        share(of(z), all->made);
    } else {
        combine(of(z), from, wanted);
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

/* These are rare in a step: the library computes them in an array of z alone. */
#define IN_OWN_ARRAY(name, of_serial, parameters, ...)                                 \
    static void name parameters                                                        \
    {                                                                                  \
        (void)make_writable(of(z), true);                                              \
        of_serial(__VA_ARGS__);                                                        \
    }
IN_OWN_ARRAY(absolute, N_VAbs_Serial, (N_Vector x, N_Vector z), x, z)
IN_OWN_ARRAY(multiply, N_VProd_Serial, (N_Vector x, N_Vector y, N_Vector z), x, y, z)
IN_OWN_ARRAY(divide, N_VDiv_Serial, (N_Vector x, N_Vector y, N_Vector z), x, y, z)
IN_OWN_ARRAY(add_constant, N_VAddConst_Serial, (N_Vector x, sunrealtype b, N_Vector z),
             x, b, z)
IN_OWN_ARRAY(invert, N_VInv_Serial, (N_Vector x, N_Vector z), x, z)

/* ---- norms ----------------------------------------------------------------------- */

void weft__sun_weigh(N_Vector y, N_Vector weights, double rtol, const double atol[2])
{
    const family *all = of(y)->family;
    weft__sun_weights_of(all->pool, all->judged, NV_DATA_S(y), rtol, atol,
                         weft__sun_fill(weights));
}

/* Components that are not judged have no say, but NaN in them shows. */
static sunrealtype norm(N_Vector x, N_Vector weights)
{
    const family *all = of(x)->family;
    const double *e = NV_DATA_S(x);
    double unjudged = 0.0;
    for (size_t i = all->judged; i < all->n; ++i) {
        unjudged += e[i] * 0.0;
    }
    const double mine
        = weft__sun_norm(all->pool, all->judged, all->norm, e, NV_DATA_S(weights))
          + unjudged;
    return all->agree.max == NULL ? mine : all->agree.max(all->agree.self, mine);
}

/* With fixed steps: nothing is judged. */
static sunrealtype no_norm(N_Vector x, N_Vector weights)
{
    (void)x;
    (void)weights;
    return 0.0;
}

void weft__sun_judge_by(N_Vector v, weft_norm by, size_t judged)
{
    of(v)->family->norm = by;
    of(v)->family->judged = judged;
    v->ops->nvwrmsnorm = norm;
}

void weft__sun_agree(N_Vector v, weft_agree agree)
{
    of(v)->family->agree = agree;
}

/* ---- the vector itself ----------------------------------------------------------- */

static void free_array(array *a)
{
    free(a == NULL ? NULL : a->block);
    free(a);
}

static void leave(content *self)
{
    family *all = self->family;
    release(all, self->array);
    array *a = all->free; /* as there is one for each */
    all->free = a->next_free;
    all->made = all->made == a ? NULL : all->made;
    free_array(a);
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

/* Zeros that the system gives when they are first touched, by the thread that works on
 * them. */
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
    return a;
}

static bool join(N_Vector v, family *all)
{
    content *self = calloc(1, sizeof *self);
    array *a = make_array(all->n);
    if (self == NULL || a == NULL) {
        free(self);
        free_array(a);
        return false;
    }
    self->family = all;
    self->serial.length = (sunindextype)all->n;
    self->serial.own_data = SUNTRUE;
    ++all->members;
    share(self, a);
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
    v->ops->nvprod = multiply;
    v->ops->nvdiv = divide;
    v->ops->nvinv = invert;
    v->ops->nvaddconst = add_constant;
    v->ops->nvwrmsnorm = no_norm;
    v->ops->nvcompare = NULL; /* these would write to shared arrays */
    v->ops->nvinvtest = NULL;
    v->ops->nvconstrmask = NULL;
    v->ops->nvsetarraypointer = NULL;
    v->ops->nvcloneempty = NULL;
}

N_Vector weft__sun_vector(size_t n, const weft_team *pool, SUNContext context)
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
    *all = (family){ .pool = pool, .n = n, .judged = n };
    if (!join(v, all)) {
        destroy(v);
        free(all);
        return NULL;
    }
    set_operations(v);
    return v;
}
