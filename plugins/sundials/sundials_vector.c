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
 * needs one of its own, so arrays that no step needs are never touched.
 *
 * With a pass (weft_pass) sums and rates of a step are put off: each vector that would
 * receive one is `due`. When the norm of the error or the solution is asked for, the
 * attempt is made in one pass, and of its stages only the last is stored. The solver
 * does not notice: table, order of sums, tests and h are its own. What does not look
 * like an attempt is computed at once, and the stages one by one if a vector is read
 * that is due, or if the pass finds something that is not finite. */
#include "sundials_arithmetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    TERMS = WEFT__SUN_MOST_TERMS,
    LINE = 64,   /* bytes of a cache line */
    STAGES = 18, /* of an attempt that is put off */
};

/* Numbers that vectors may share. */
typedef struct array {
    double *data;
    void *block;        /* that data lies in */
    int users;          /* 0: it is free */
    uint64_t written;   /* the number of the last writing, different in all arrays */
    bool known, finite; /* finite: all are; valid if known */
    bool due;           /* its numbers are not there yet */
    double most[2];     /* as of weft_attempt; NaN: not known */
    struct array *next_free;
} array;

/* What a combination is made of: the writings that it reads, and its factors. */
typedef struct recipe {
    size_t terms;
    uint64_t written[TERMS];
    double factors[TERMS];
} recipe;

/* An attempt that is put off: as weft_attempt, of which so much is known. */
typedef struct attempt {
    int stages; /* with rates; 0: there is none */
    bool more;  /* z belongs to one more stage */
    bool made;  /* only the last z and rates are there */
    array *y, *z, *error, *k[STAGES];
    double a[STAGES * (STAGES - 1) / 2], e[STAGES], t[STAGES];
} attempt;

/* Weights that are due: `to` is made of y. */
typedef struct scales {
    array *y, *to;
    double rtol, atol[2];
} scales;

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
    size_t judged;         /* components that have a say in the norm */
    weft_agree agree;      /* on the norm; max NULL: with nobody */
    const weft_rms *rms;   /* NULL: the sum below */
    const weft_pass *pass; /* NULL: nothing is put off */
    weft__sun_stages by;
    attempt attempt;
    scales scales;
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

static void drop_attempt(family *all);
static void settle(family *all, array *a);
static const double *data_of(family *all, array *a);

/* Before it is written to, all of it unless `keep`. Where an array is shared there is a
 * free one, unless an attempt holds arrays that no vector has. */
static array *make_writable(content *v, bool keep)
{
    family *all = v->family;
    if (v->array->users > 1 && all->free == NULL && all->attempt.made) {
        drop_attempt(all);
    }
    if (v->array->users > 1 && all->free == NULL) {
        settle(all, NULL);
    }
    const array *shared = v->array;
    if (shared->users > 1) {
        array *a = all->free;
        all->free = a->next_free;
        if (keep) {
            memcpy(a->data, shared->data, all->n * sizeof *a->data);
        }
        share(v, a);
    }
    v->array->known = v->array->due = false;
    v->array->most[0] = NAN;
    v->array->written = ++all->writings;
    return v->array;
}

static void set_finite(array *a, bool finite)
{
    a->known = true;
    a->finite = finite;
}

/* ---- what is put off ------------------------------------------------------------- */

static void hold(array **place, array *a)
{
    if (a != NULL) {
        ++a->users;
    }
    *place = a;
}

static void let_go(family *all, array **place)
{
    release(all, *place);
    *place = NULL;
}

static void drop_attempt(family *all)
{
    attempt *of = &all->attempt;
    let_go(all, &of->y);
    let_go(all, &of->z);
    let_go(all, &of->error);
    for (int i = 0; i < of->stages; ++i) {
        let_go(all, &of->k[i]);
    }
    of->stages = 0;
    of->more = of->made = false;
}

/* The sum of the rates of `count` stages, with_state: and then of y. */
static void add_stages(const family *all, const double *factors, int count,
                       bool with_state, array *to)
{
    const attempt *of = &all->attempt;
    const double *x[STAGES + 1];
    double c[STAGES + 1];
    int terms = 0;
    for (int i = 0; i < count; ++i) {
        if (factors[i] != 0.0) {
            x[terms] = of->k[i]->data;
            c[terms++] = factors[i];
        }
    }
    if (with_state) {
        x[terms] = of->y->data;
        c[terms++] = 1.0;
    }
    set_finite(to, weft__sun_combine(all->pool, all->n, terms, x, c, to->data));
    to->due = false;
}

static void make_stages(family *all)
{
    attempt *of = &all->attempt;
    for (int i = 1; i < of->stages + of->more; ++i) {
        add_stages(all, of->a + i * (i - 1) / 2, i, true, of->z);
        if (i < of->stages) {
            all->by.rates(all->by.ctx, of->t[i], of->z->data, of->z->finite, of->made,
                          of->k[i]->data);
            of->k[i]->due = of->k[i]->known = false;
        }
    }
    if (of->error != NULL) {
        add_stages(all, of->e, of->stages, false, of->error);
    }
    drop_attempt(all);
}

/* In one pass; or stage by stage, then it returns false. */
static bool make_attempt(family *all, double *norm)
{
    attempt *of = &all->attempt;
    array *last = of->more ? NULL : of->k[of->stages - 1];
    weft_attempt now = { .struct_size = sizeof now,
                         .stages = of->stages + of->more,
                         .a = of->a,
                         .e = of->error != NULL ? of->e : NULL,
                         .t = of->t,
                         .y = of->y->data,
                         .k = of->k[0]->data,
                         .y_end = of->z->data,
                         .k_end = last != NULL ? last->data : NULL,
                         .rtol = all->scales.rtol,
                         .atol = { all->scales.atol[0], all->scales.atol[1] } };
    const int failed = all->pass->run(all->pass->self, &now);
    if (failed > 0) {
        make_stages(all);
        return false;
    }
    all->by.made(all->by.ctx, now.calls, failed < 0);
    of->made = true;
    of->z->due = false;
    of->z->most[0] = now.most[0], of->z->most[1] = now.most[1];
    set_finite(of->z, failed == 0);
    if (last != NULL) {
        last->due = false;
    }
    if (of->error != NULL) {
        set_finite(of->error, failed == 0);
    }
    *norm = failed < 0 ? (double)NAN : now.norm;
    return true;
}

/* Computes what is due: a, or with NULL all. */
static void settle(family *all, array *a)
{
    scales *by = &all->scales;
    if (by->to != NULL && by->to->due && (a == NULL || a == by->to)) {
        weft__sun_weights_of(all->pool, all->judged, by->y->data, by->rtol, by->atol,
                             by->to->data);
        by->to->due = false;
    }
    if (a == NULL || a->due) {
        double norm;
        attempt *of = &all->attempt;
        if (of->stages > 0 && !of->made && of->stages + of->more > 1) {
            (void)make_attempt(all, &norm);
        }
        if (of->stages > 0 && (a == NULL || a->due)) {
            make_stages(all);
        }
    }
    if (a == NULL) {
        drop_attempt(all);
        let_go(all, &by->y);
        let_go(all, &by->to);
    } else if (a->due) { /* nobody knows it any more */
        weft__sun_set(all->pool, all->n, (double)NAN, a->data);
        a->due = false;
    }
}

static const double *data_of(family *all, array *a)
{
    if (a->due) {
        settle(all, a);
    }
    return a->data;
}

static int stage_of(const attempt *of, const array *a)
{
    int i = of->stages - 1;
    while (i >= 0 && of->k[i] != a) {
        --i;
    }
    return i;
}

/* Writes the factors of a sum of rates in the order of their stages; false: it is none.
 */
static bool factors_of(const attempt *of, array *const x[], const recipe *sum,
                       size_t terms, double *factors)
{
    int before = -1;
    memset(factors, 0, (size_t)of->stages * sizeof *factors);
    for (size_t k = 0; k < terms; ++k) {
        const int i = stage_of(of, x[k]);
        if (i <= before) {
            return false;
        }
        factors[i] = sum->factors[k];
        before = i;
    }
    return true;
}

/* The first sum of an attempt: a rate and the state. */
static bool begin_attempt(family *all, array *const x[], const recipe *sum)
{
    attempt *of = &all->attempt;
    const bool continues = of->stages > 0 && !of->made && x[0] == of->k[0];
    if (sum->terms != 2 || sum->factors[1] != 1.0 || continues || x[0]->due
        || x[1]->due) {
        return of->stages > 0 && !of->made;
    }
    drop_attempt(all);
    hold(&of->k[0], x[0]);
    hold(&of->y, x[1]);
    of->stages = 1;
    return true;
}

/* Whether a sum is that of a stage, the solution or the error, and is put off. */
static bool put_off(content *v, array *const x[], const recipe *sum)
{
    family *all = v->family;
    attempt *of = &all->attempt;
    if (all->pass == NULL || !begin_attempt(all, x, sum)) {
        return false;
    }
    const int i = of->stages;
    const bool stage
        = x[sum->terms - 1] == of->y && sum->factors[sum->terms - 1] == 1.0;
    if (stage ? of->more || i == all->pass->stages || i == STAGES
              : i == 1 || of->error != NULL) {
        return false;
    }
    if (!factors_of(of, x, sum, sum->terms - stage,
                    stage ? of->a + i * (i - 1) / 2 : of->e)) {
        return false;
    }
    if (stage) {
        let_go(all, &of->z);
    }
    array *to = make_writable(v, false);
    if (of->stages != i) { /* no array was free */
        return false;
    }
    to->due = true;
    hold(stage ? &of->z : &of->error, to);
    of->more = of->more || stage;
    return true;
}

bool weft__sun_put_off(double t, N_Vector y, N_Vector ydot)
{
    family *all = of(y)->family;
    attempt *of_all = &all->attempt;
    const int i = of_all->stages;
    if (!of_all->more || of(y)->array != of_all->z || of_all->made
        || of_all->error != NULL) {
        return false;
    }
    array *to = make_writable(of(ydot), false);
    if (of_all->stages != i) {
        return false;
    }
    to->due = true;
    hold(&of_all->k[i], to);
    of_all->t[i] = t;
    ++of_all->stages;
    of_all->more = false;
    return true;
}

void weft__sun_pass(N_Vector v, const weft_pass *pass, weft__sun_stages by)
{
    of(v)->family->pass = pass;
    of(v)->family->by = by;
}

/* ---- access ---------------------------------------------------------------------- */

double *weft__sun_fill(N_Vector v)
{
    return make_writable(of(v), false)->data;
}

bool weft__sun_finite(N_Vector v)
{
    family *all = of(v)->family;
    array *a = of(v)->array;
    if (a->due && !a->known) {
        settle(all, a);
    }
    if (!a->known) {
        set_finite(a, weft__sun_all_finite(all->pool, all->n, a->data));
    }
    return a->finite;
}

void weft__sun_read(N_Vector v, double *to)
{
    family *all = of(v)->family;
    array *a = of(v)->array;
    const double *from = data_of(all, a), one = 1.0;
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

static void combine(content *z, array *const x[], const recipe *wanted)
{
    family *all = z->family;
    const double *from[TERMS];
    for (size_t k = 0; k < wanted->terms; ++k) {
        from[k] = data_of(all, x[k]);
    }
    array *a = make_writable(z, false);
    set_finite(a, weft__sun_combine(all->pool, all->n, (int)wanted->terms, from,
                                    wanted->factors, a->data));
}

/* Terms with the factor 0 are left out, NaN or not: a table with stages of no weight
 * gives the same bits as without them. z may be one of x. */
static int linear_combination(int count, sunrealtype *c, N_Vector *x, N_Vector z)
{
    family *all = of(z)->family;
    recipe *wanted = &all->recipes[1 - all->last];
    array *from[TERMS] = { NULL };
    wanted->terms = 0;
    for (int k = 0; k < count; ++k) {
        if (c[k] == 0.0) {
            continue;
        }
        if (wanted->terms == TERMS) {
            return -1;
        }
        from[wanted->terms] = of(x[k])->array;
        wanted->written[wanted->terms] = of(x[k])->array->written;
        wanted->factors[wanted->terms++] = c[k];
    }
    if (wanted->terms == 0) {
        set_all(0.0, z);
    } else if (wanted->terms == 1 && wanted->factors[0] == 1.0) {
        share(of(z), from[0]);
    } else if (is_made(all, wanted)) {
        share(of(z), all->made);
    } else {
        if (!put_off(of(z), from, wanted)) {
            combine(of(z), from, wanted);
        }
        all->made = of(z)->array;
        all->made_was = all->made->written;
        all->last = 1 - all->last;
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

/* These are rare in a step, and do not occur in one that is put off: the library
 * computes them in an array of z alone. */
#define IN_OWN_ARRAY(name, of_serial, parameters, ...)                                 \
    static void name parameters                                                        \
    {                                                                                  \
        settle(of(z)->family, NULL);                                                   \
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
    family *all = of(y)->family;
    scales *by = &all->scales;
    const double *from = data_of(all, of(y)->array);
    if (all->pass == NULL) {
        weft__sun_weights_of(all->pool, all->judged, from, rtol, atol,
                             weft__sun_fill(weights));
        return;
    }
    let_go(all, &by->y);
    let_go(all, &by->to);
    array *to = make_writable(of(weights), false);
    to->due = true;
    *by = (scales){ .rtol = rtol, .atol = { atol[0], atol[1] } };
    hold(&by->y, of(y)->array);
    hold(&by->to, to);
}

/* The solvers compare the norm of a state by its own weights with 1 / roundoff, and
 * use it for nothing else. */
#define LARGE 0x1p50

/* At least that norm; NaN: not known. */
static double bound_of(const scales *by)
{
    const double *most = by->y->most;
    const double x = most[0] / (by->rtol * most[0] + by->atol[0]);
    const double v = most[1] / (by->rtol * most[1] + by->atol[1]);
    return x > v ? x : isnan(x) ? x : v;
}

/* Components that are not judged have no say, but NaN in them shows. */
static sunrealtype norm(N_Vector x, N_Vector weights)
{
    family *all = of(x)->family;
    const attempt *on = &all->attempt;
    const scales *by = &all->scales;
    const bool due = of(weights)->array->due && of(weights)->array == by->to;
    if (on->stages > 0 && !on->made && on->error == of(x)->array) {
        double at_once;
        if (!due || on->y != by->y) {
            make_stages(all);
        } else if (make_attempt(all, &at_once)) {
            return at_once;
        }
    }
    const double bound = due && of(x)->array == by->y ? bound_of(by) : (double)NAN;
    if (bound < LARGE) {
        return bound;
    }
    const double *e = data_of(all, of(x)->array);
    if (due) {
        return weft__sun_scaled_norm(all->pool, all->n, e, by->y->data, by->rtol,
                                     by->atol);
    }
    double unjudged = 0.0;
    for (size_t i = all->judged; i < all->n; ++i) {
        unjudged += e[i] * 0.0;
    }
    const double *w = data_of(all, of(weights)->array);
    const double mine = (all->norm == WEFT_NORM_RMS && all->rms != NULL
                             ? all->rms->of(all->rms->self, e, w)
                             : weft__sun_norm(all->pool, all->judged, all->norm, e, w))
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

void weft__sun_agree(N_Vector v, weft_agree agree, const weft_rms *rms)
{
    of(v)->family->agree = agree;
    of(v)->family->rms = rms;
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
    drop_attempt(all);
    let_go(all, &all->scales.y);
    let_go(all, &all->scales.to);
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
