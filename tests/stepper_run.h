/* SPDX-License-Identifier: BSD-3-Clause */
/* stepper_run.h -- a run of one method on the model of the conformance kit, for
 * tests of steppers beyond the conformance checks. */
#pragma once

#include "study/conformance/oscillators.h"
#include "support.h"

#ifdef HAVE_GSL
#include <gsl/gsl_errno.h>
#endif

#define SAME(a, b) ck_assert_mem_eq((a), (b), sizeof *(a) * (DIM + quadratures))

/* How many quadratures a run has. */
static size_t quadratures;

static inline int rhs(double t, const double *y, double *dydt, void *ctx)
{
    return weft__model_rhs(t, y, dydt, ctx);
}

/* One run of one method on the model. */
typedef struct trial_run {
    const weft_stepper_type *type;
    model model;
    weft_structure structure;
    weft_ode ode;
    void *self;
    double t, y[DIM + APART];
    weft_error err;
} trial_run;

static inline void start(trial_run *r, const weft_stepper_type *type,
                         const weft_stepper_config *config)
{
    *r = (trial_run){ .type = type, .model = { .k = 1.0, .apart = quadratures } };
    r->ode = (weft_ode){ .dim = DIM + quadratures, .rhs = rhs, .ctx = &r->model };
    memcpy(r->y, weft__model_start, sizeof weft__model_start);
    r->structure = weft__model_structure(&r->model);
    weft_stepper_config whole = test_config(type, *config);
    whole.quadratures = quadratures;
    whole.structure = weft__needs_structure(type) ? &r->structure : NULL;
    const weft_status status = type->create(type, &r->ode, &whole, &r->self, &r->err);
    ck_assert_msg(status == WEFT_OK, "%s", r->err.message);
}

static inline weft_status step(trial_run *r, double t_end)
{
    return r->type->step(r->self, t_end, &r->t, r->y, &r->err);
}

static inline void go(trial_run *r, double t_end)
{
    while (r->t < t_end) {
        ck_assert_msg(step(r, t_end) == WEFT_OK, "%s", r->err.message);
    }
}

static inline void end(trial_run *r)
{
    r->type->destroy(r->self);
}

static inline weft_stepper_stats stats(const trial_run *r)
{
    weft_stepper_stats s = { .struct_size = sizeof s };
    r->type->stats(r->self, &s);
    return s;
}

#define adaptive  weft__adaptive
#define fixed     weft__fixed
#define can_adapt weft__adapts
#define usual     weft__usual
#define allowed   weft__allowed
#define distance  weft__model_distance
#define y_start   weft__model_start

static inline double error_at_end(const trial_run *r)
{
    static double t = 0.0, y[DIM]; /* asked for again and again */
    if (t != r->t) {
        t = r->t;
        memcpy(y, y_start, sizeof y);
        weft__model_solve(0.0, t, y);
    }
    return distance(r->y, y);
}

/* GSL's error handler belongs to the program: here it is one that counts, and a test
 * fails if it was called or if a plugin has put another in its place. */
static int gsl_errors;

#ifdef HAVE_GSL
static inline void count_error(const char *reason, const char *file, int line, int code)
{
    ++gsl_errors;
    (void)reason;
    (void)file;
    (void)line;
    (void)code;
}
#endif

static inline void watch_gsl(void)
{
    gsl_errors = 0;
#ifdef HAVE_GSL
    gsl_set_error_handler(count_error);
#endif
}

static inline void gsl_was_silent(void)
{
    ck_assert_int_eq(gsl_errors, 0);
#ifdef HAVE_GSL
    ck_assert(gsl_set_error_handler(count_error) == count_error);
#endif
}

/* A case that runs a test once for every method. */
static inline void add_for_every_method(Suite *suite, const char *name,
                                        const TTest *test)
{
    TCase *tcase = tcase_create(name);
    tcase_set_timeout(tcase, 120.0);
    tcase_add_checked_fixture(tcase, watch_gsl, gsl_was_silent);
    tcase_add_loop_test(tcase, test, 0, (int)test_method_count());
    suite_add_tcase(suite, tcase);
}
