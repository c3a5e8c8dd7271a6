/* SPDX-License-Identifier: BSD-3-Clause */
/* measured_order.c -- measures the order of a method on equations that show it clearly.
 *
 * There is one equation for each rooted tree up to a weight, one more than the order
 * claimed: v' of a tree is the product of the branches of its root, each the v or the x
 * of a smaller tree; x' = v, and all begin at 0. A leaf at a root is t itself. So
 *
 *     v(t) = t^w / gamma, x(t) = t^(w+1) / ((w+1) gamma)       with w the weight,
 *
 * and a Runge-Kutta method of order p is exact for the trees of weight p or less
 * (Butcher, Numerical Methods for ODEs, 3rd ed., theorem 315A). The step error of
 * weight p + 1 is c h^(p+1) with c independent of t, h and y, as no weight is left for
 * more: the errors of the steps add up to c h^p, and the ratio of the errors with h and
 * h/2 is 2^p without terms of higher order, at any h. On other problems, tables of high
 * order show their order only for a short range of h between those terms and roundoff,
 * or not at all. */
#include <math.h>
#include <stdlib.h>

#include "study/conformance/trial.h"

enum {
    WEIGHTS = WEFT__ORDER_MOST + 2, /* from 0, which no tree has */
    TREES_MOST = 6964,              /* of smaller weights */
    STEPS_MOST = 1024
};

/* Relative errors near 1e-11 are not those of the method: implicit ones iterate to
 * that accuracy, and some tables weight their stages by hundreds.
 * This margin above it changes the order by 0.05 at most. */
#define ROUNDOFF 3e-10

typedef struct branch {
    size_t tree;
    bool x; /* the tree's x, of one weight more; or its v */
} branch;

typedef struct forest {
    size_t count;
    size_t half; /* count, and what makes it three numbers for each of some particles */
    int weight[TREES_MOST];
    double gamma[TREES_MOST];
    size_t rest[TREES_MOST]; /* the tree without its last branch */
    branch last[TREES_MOST];
} forest;

static bool in_order(const forest *f, size_t rest, branch last)
{
    const branch before = f->last[rest];
    return rest == 0 || last.tree < before.tree
           || (last.tree == before.tree && last.x <= before.x);
}

static void add_tree(forest *f, int weight, size_t rest, branch last)
{
    const size_t k = f->count++;
    const double of_x = last.x ? f->weight[last.tree] + 1 : 1;
    f->weight[k] = weight;
    f->rest[k] = rest;
    f->last[k] = last;
    f->gamma[k]
        = weight * (f->gamma[rest] / f->weight[rest]) * of_x * f->gamma[last.tree];
}

/* In order of weight; the branches of a root fall in order, so that no tree comes
 * twice. */
static void grow(forest *f, int most)
{
    f->count = 1;
    f->weight[0] = 1;
    f->gamma[0] = 1.0;
    for (int weight = 2; weight <= most; ++weight) {
        const size_t smaller = f->count;
        for (size_t rest = 0; rest < smaller; ++rest) {
            for (size_t i = 0; i < 2 * smaller; ++i) {
                const branch last = { i / 2, i % 2 != 0 };
                if (f->weight[rest] + f->weight[last.tree] + last.x == weight
                    && in_order(f, rest, last)) {
                    add_tree(f, weight, rest, last);
                }
            }
        }
    }
}

/* y = (x of every tree, v of every tree), each filled up with zeros */
static int rate(double t, const double *y, double *dydt, void *ctx)
{
    const forest *f = ctx;
    const double *x = y, *v = y + f->half;
    double *dv = dydt + f->half;
    memset(dv, 0, f->half * sizeof *dv);
    dv[0] = 1.0;
    for (size_t k = 1; k < f->count; ++k) {
        const branch last = f->last[k];
        const double factor = last.x ? x[last.tree] : last.tree == 0 ? t : v[last.tree];
        dv[k] = dv[f->rest[k]] * factor;
    }
    memcpy(dydt, v, f->half * sizeof *v);
    return 0;
}

/* The largest errors of each weight at t = 1 s; an x has the weight of its v plus 1,
 * and counts if there are v of that weight. */
static void find_errors(const forest *f, const double *y, double error[WEIGHTS])
{
    const int most = f->weight[f->count - 1];
    memset(error, 0, WEIGHTS * sizeof *error);
    for (size_t k = 0; k < f->count; ++k) {
        const int w = f->weight[k];
        const double of_v = fabs(y[f->half + k] * f->gamma[k] - 1.0);
        error[w] = fmax(error[w], of_v);
        if (w < most) {
            const double of_x = fabs(y[k] * f->gamma[k] * (w + 1) - 1.0);
            error[w + 1] = fmax(error[w + 1], of_x);
        }
    }
}

/* A structure that knows nothing: K and C are 0. */
static int no_springs(double t, const double *y, double *planes, double *blocks,
                      void *ctx)
{
    (void)t, (void)y, (void)planes, (void)blocks, (void)ctx;
    return 0;
}

/* Masses of 1 and drags of 0, in 2 n numbers. */
static weft_structure structure_of(size_t n, double *numbers)
{
    for (size_t i = 0; i < 2 * n; ++i) {
        numbers[i] = i < n ? 1.0 : 0.0;
    }
    return (weft_structure){ .struct_size = sizeof(weft_structure),
                             .particles = n,
                             .mass = numbers,
                             .drag = numbers + n,
                             .linearise = no_springs,
                             .modes = weft__no_modes };
}

static weft_status errors_with(const weft_stepper_type *type, forest *f, int steps,
                               double error[WEIGHTS], weft_error *err)
{
    const weft_ode ode = { .dim = 2 * f->half, .rhs = rate, .ctx = f };
    void *self = NULL;
    double t = 0.0, *y = calloc(2 * ode.dim, sizeof *y);
    if (y == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory");
    }
    const weft_structure structure = structure_of(f->half / 3, y + ode.dim);
    weft_stepper_config config = weft__with_table(type, weft__fixed(1.0 / steps));
    config.structure = weft__needs_structure(type) ? &structure : NULL;
    weft_status status = type->create(type, &ode, &config, &self, err);
    while (status == WEFT_OK && t < 1.0) {
        status = type->step(self, 1.0, &t, y, err);
    }
    if (status == WEFT_OK) {
        find_errors(f, y, error);
    }
    type->destroy(self);
    free(y);
    return status;
}

/* For each weight, takes the finest steps whose error stands out from roundoff; the
 * order is the least over all weights. */
static weft_status halve(const weft_stepper_type *type, forest *f, double *order,
                         weft_error *err)
{
    double error[WEIGHTS], finer[WEIGHTS], orders[WEIGHTS];
    bool seen = true;
    weft_status status = errors_with(type, f, 1, error, err);
    for (size_t w = 0; w < WEIGHTS; ++w) {
        orders[w] = (double)INFINITY;
    }
    for (int steps = 2; status == WEFT_OK && seen && steps <= STEPS_MOST; steps *= 2) {
        status = errors_with(type, f, steps, finer, err);
        seen = false;
        for (size_t w = 0; status == WEFT_OK && w < WEIGHTS; ++w) {
            if (!(finer[w] <= ROUNDOFF)) {
                orders[w] = log2(error[w] / finer[w]);
                seen = true;
            }
            error[w] = finer[w];
        }
    }
    *order = (double)INFINITY;
    for (size_t w = 0; w < WEIGHTS; ++w) {
        *order = fmin(*order, orders[w]);
    }
    return status;
}

int weft__order_claimed(const weft_stepper_type *type)
{
    const bool custom = (type->flags & WEFT_STEPPER_BUTCHER) != 0;
    return custom ? merson()->order : weft__takes_fixed(type) ? type->order : 0;
}

weft_status weft__order(const weft_stepper_type *type, int claimed, double *order,
                        weft_error *err)
{
    if (claimed < 1 || claimed > WEFT__ORDER_MOST) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "order %d is not measured",
                              claimed);
    }
    forest *f = calloc(1, sizeof *f);
    if (f == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory");
    }
    grow(f, claimed + 1);
    f->half = (f->count + 2) / 3 * 3;
    const weft_status status = halve(type, f, order, err);
    free(f);
    return status;
}

/* ---- the checks ------------------------------------------------------------------ */

const char *weft__order_not_measured(const weft_stepper_type *type)
{
    const int claimed = weft__order_claimed(type);
    return !weft__takes_fixed(type)     ? "the method takes no fixed steps"
           : claimed < 1                ? "the order varies"
           : claimed > WEFT__ORDER_MOST ? "an order that high is not measured"
                                        : NULL;
}

void weft__the_order_is_the_one_claimed(trial *self)
{
    const int claimed = weft__order_claimed(self->type);
    weft_error err = { 0 };
    double measured = 0.0;
    const weft_status status = weft__order(self->type, claimed, &measured, &err);
    EXPECT(status == WEFT_OK, "a step failed: %s", err.message);
    EXPECT(fabs(measured - claimed) <= WEFT__ORDER_BOUND,
           "order %d is claimed, %s%.3g is measured; within %g would do", claimed,
           isinf(measured) ? "a higher one, " : "", measured, WEFT__ORDER_BOUND);
}

typedef struct result {
    double error;
    uint64_t steps;
} result;

static result at_4_s(trial *self, weft_norm norm, double tolerance)
{
    weft_stepper_config config = weft__adaptive(tolerance);
    config.norm = norm;
    trial_run *r = weft__begin(self, 0, config);
    weft__go(self, r, 4.0);
    return (result){ weft__error_at_end(r), weft__stats(r).steps };
}

/* The error at the end is not the error of a step: a factor remains between them. It is
 * about the number of steps, which is large for low orders, where the estimate is of
 * the solution that is continued: of multistep methods, and by one of a higher order.
 */
void weft__the_error_follows_the_tolerance(trial *self)
{
    const int order = self->type->order;
    const double low = order == 1 ? 1e-5 : order == 2 ? 1e-7 : 1e-9;
    const bool its_own = (self->type->flags & WEFT_STEPPER_MULTISTEP) != 0
                         || self->type->error_order > order;
    const double most = order == 1 || (order == 2 && its_own) ? 2000.0 : 150.0;
    for (int norm = WEFT_NORM_MAX; norm <= WEFT_NORM_RMS; ++norm) {
        const double fine_most = (norm == WEFT_NORM_MAX ? 1.0 : 2.0) * most * low;
        const result rough = at_4_s(self, (weft_norm)norm, 1e-3);
        const result fine = at_4_s(self, (weft_norm)norm, low);
        EXPECT(rough.error <= most * 1e-3 && fine.error <= fine_most,
               "off by %.3g at a tolerance of 1e-3 and by %.3g at %g, at most "
               "%.3g and %.3g would do",
               rough.error, fine.error, low, most * 1e-3, fine_most);
        EXPECT(fine.error <= 0.11 * rough.error && fine.steps > rough.steps,
               "a tolerance of %g instead of 1e-3 makes the error %.3g of %.3g, "
               "in %" PRIu64 " steps instead of %" PRIu64,
               low, fine.error, rough.error, fine.steps, rough.steps);
    }
}
