/* SPDX-License-Identifier: BSD-3-Clause */
/* stepper_run.h -- a run of one method on a small model, for the tests of steppers.
 *
 * The model: two coupled oscillators, damped, driven and not linear, with
 * y = (x1, x2, v1, v2). It can be told to fail. The reference solution is made here, by
 * the classical Runge-Kutta method with 2^-13 s, and good to 1e-13. */
#ifndef STEPPER_RUN_H
#define STEPPER_RUN_H

#include "support.h"

#include <math.h>
#include <string.h>

#ifdef HAVE_GSL
#include <gsl/gsl_errno.h>
#endif

#define DIM        4
#define APART      3 /* quadratures at most */
#define SAME(a, b) ck_assert_mem_eq((a), (b), sizeof *(a) * (DIM + quadratures))

/* How many quadratures a run has: t, x1 less its start, and the integral of v1 v2. */
static size_t quadratures;

typedef enum fault { NO_FAULT, REFUSE, STOP, GIVE_NAN, GIVE_INF, FAULTS } fault;

typedef struct model {
    double k;    /* [1/s^2] stiffness of the first oscillator */
    double edge; /* [m] beyond it the state is refused; 0: nowhere */
    uint64_t calls;
    double first[1 + DIM + APART]; /* t and y of the call after calls = 0 */
    fault fault;                   /* what goes wrong */
    uint64_t at;                   /* from this call on, */
    bool once;                     /* or at it alone */
} model;

static const double y_start[DIM] = { 0.613, -0.387, 0.271, 0.829 };

static inline int rhs(double t, const double *y, double *dydt, void *ctx)
{
    model *m = ctx;
    if (m->calls++ == 0) {
        m->first[0] = t;
        memcpy(m->first + 1, y, (DIM + quadratures) * sizeof *y);
    }
    dydt[0] = y[2];
    dydt[1] = y[3];
    dydt[2] = -m->k * sin(2.385 * y[0]) + 0.713 * (y[1] - y[0]) - 0.131 * y[2];
    dydt[3]
        = -1.618 * y[1] * y[1] * y[1] + 0.713 * (y[0] - y[1]) + 0.257 * cos(1.37 * t);
    if (m->edge > 0.0 && !(fabs(y[0]) < m->edge)) {
        return 1;
    }
    const bool fails
        = m->fault != NO_FAULT && (m->once ? m->calls == m->at : m->calls >= m->at);
    const double rates[APART] = { 1.0, y[2], y[2] * y[3] };
    memcpy(dydt + DIM, rates, quadratures * sizeof *rates);
    if (fails && (m->fault == GIVE_NAN || m->fault == GIVE_INF)) {
        dydt[quadratures > 0 ? DIM + quadratures - 1 : 2]
            = m->fault == GIVE_NAN ? (double)NAN : (double)INFINITY;
    }
    return fails && m->fault == REFUSE ? 1 : fails && m->fault == STOP ? -1 : 0;
}

/* One run of one method on the model. */
typedef struct run {
    const weft_stepper_type *type;
    model model;
    weft_ode ode;
    void *self;
    double t, y[DIM + APART];
    weft_error err;
} run;

static inline void start(run *r, const weft_stepper_type *type,
                         const weft_stepper_config *config)
{
    *r = (run){ .type = type, .model = { .k = 1.0 } };
    r->ode = (weft_ode){ .dim = DIM + quadratures, .rhs = rhs, .ctx = &r->model };
    memcpy(r->y, y_start, sizeof y_start);
    weft_stepper_config whole = test_config(type, *config);
    whole.quadratures = quadratures;
    const weft_status status = type->create(type, &r->ode, &whole, &r->self, &r->err);
    ck_assert_msg(status == WEFT_OK, "%s", r->err.message);
}

static inline weft_status step(run *r, double t_end)
{
    return r->type->step(r->self, t_end, &r->t, r->y, &r->err);
}

static inline void go(run *r, double t_end)
{
    while (r->t < t_end) {
        ck_assert_msg(step(r, t_end) == WEFT_OK, "%s", r->err.message);
    }
}

static inline void end(run *r)
{
    r->type->destroy(r->self);
}

static inline weft_stepper_stats stats(const run *r)
{
    weft_stepper_stats s = { .struct_size = sizeof s };
    r->type->stats(r->self, &s);
    return s;
}

static inline weft_stepper_config adaptive(double tolerance)
{
    return (weft_stepper_config){
        .struct_size = sizeof(weft_stepper_config),
        .atol_position = tolerance,
        .atol_velocity = tolerance,
        .first_step = 1.3e-3,
        .min_step = 1e-10,
        .max_step = INFINITY,
    };
}

static inline weft_stepper_config fixed(double h)
{
    return (weft_stepper_config){ .struct_size = sizeof(weft_stepper_config),
                                  .fixed_step = h };
}

static inline bool can_adapt(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_FIXED_ONLY) == 0;
}

/* Adaptive where the method can, in mode 0; mode 1 is fixed steps. */
static inline weft_stepper_config usual(const weft_stepper_type *type, int mode)
{
    return mode == 0 && can_adapt(type) ? adaptive(1e-6) : fixed(1e-3);
}

static inline double distance(const double *a, const double *b)
{
    double top = 0.0;
    for (int i = 0; i < DIM; ++i) {
        top = fmax(top, isfinite(a[i]) ? fabs(a[i] - b[i]) : INFINITY);
    }
    return top;
}

static inline void runge_kutta(model *m, double t, double h, double *y)
{
    double k[4][DIM + APART], z[DIM];
    const double c[4] = { 0.0, 0.5, 0.5, 1.0 };
    memset(k, 0, sizeof k);
    for (int s = 0; s < 4; ++s) {
        for (int i = 0; i < DIM; ++i) {
            z[i] = y[i] + (s == 0 ? 0.0 : h * c[s] * k[s - 1][i]);
        }
        (void)rhs(t + h * c[s], z, k[s], m);
    }
    for (int i = 0; i < DIM; ++i) {
        y[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
}

/* The solution from (t, y) to the end, a multiple of 2^-13 s away. */
static inline void solve(double t, double t_end, double *y)
{
    model m = { .k = 1.0 };
    const double h = 0x1p-13;
    for (int i = 0; t + i * h < t_end; ++i) {
        runge_kutta(&m, t + i * h, h, y);
    }
}

static inline double error_at_end(const run *r)
{
    static double t = 0.0, y[DIM]; /* asked for again and again */
    if (t != r->t) {
        t = r->t;
        memcpy(y, y_start, sizeof y);
        solve(0.0, t, y);
    }
    return distance(r->y, y);
}

/* What `usual` must reach at 1 s. */
static inline double allowed(const weft_stepper_type *type)
{
    return type->order == 1 ? 5e-3 : 1e-4;
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

static inline void with_quadratures(void)
{
    quadratures = APART;
}

/* The same for every method that takes quadratures, with them. */
static inline void add_with_quadratures(Suite *suite, const char *name,
                                        const TTest *test)
{
    TCase *tcase = tcase_create(name);
    tcase_set_timeout(tcase, 120.0);
    tcase_add_checked_fixture(tcase, with_quadratures, NULL);
    int i = 0; /* test_method's, which asserts: not for use outside a test */
    for (size_t p = 0; test_plugin(p) != NULL; ++p) {
        const weft_stepper_type *const *types = test_plugin(p)->types;
        for (size_t m = 0; types[m] != NULL; ++m, ++i) {
            if ((types[m]->flags & WEFT_STEPPER_QUADRATURES) != 0) {
                tcase_add_loop_test(tcase, test, i, i + 1);
            }
        }
    }
    suite_add_tcase(suite, tcase);
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

#endif
