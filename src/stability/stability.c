/* SPDX-License-Identifier: BSD-3-Clause */
/* stability.c -- the largest stable step of a method on modes x'' + c x' + w x = 0.
 *
 * A Runge-Kutta method turns y' = A y into y1 = R(h A) y0, R a polynomial. Its
 * coefficients are the result of one step with h = 1 from the last unit vector under
 * y_i' = y_(i+1). The roots mu of mu^2 + c mu + w = 0 must then have |R(h mu)| <= 1:
 * where w and c fill a polygon, the maximum principle asks for no more than its sides
 * and the real axis up to the largest root.
 *
 * Other methods (Verlet's) are run on the modes themselves, all at once, and judged by
 * whether one has grown. With one evaluation a step the characteristic polynomial of a
 * step is linear in K and C, and the polygon serves as for Runge-Kutta; with more it
 * does where K and C commute.
 *
 * A method that knows the modes of the cloth (weft_structure) refuses fixed steps that
 * are not stable: it is asked.
 *
 * A method with |R(iy)| > 1 for small y has no stable step on undamped modes. These may
 * be allowed to grow; damping takes the allowance back (allowance below). */
#include "weft/stability.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/sized.h"
#include "plugin/methods.h"
#include "plugin/plugin_check.h"
#include "weft/elementary.h"

#define ROUNDOFF 1e-12 /* of growth a step */
#define SHORT    1e-4  /* of h: error of a verdict after STEPS steps */
#define FAR      1e6   /* [s] t_end, so far away that no step of 1 s is cut */

/* Of one step, log(2): without it a step as long as many runs might grow without end,
 * and modes next to rigid ones would be searched for as long. */
#define MOST_GROWTH 0.69314718055994531

enum { SHIFT_DIM = WEFT_STABILITY_DEGREE + 1 };

/* A method that takes steps of 1 s. */
typedef struct probe {
    const weft_stepper_type *type;
    void *self;
    double t;
} probe;

static weft_status probe_begin(probe *run, const weft_stability *of,
                               const weft_ode *ode, weft_error *err)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = 1.0;
    config.butcher = of->butcher;
    *run = (probe){ .type = of->type };
    return of->type->create(of->type, ode, &config, &run->self, err);
}

static weft_status probe_step(probe *run, double *y)
{
    return run->type->step(run->self, FAR, &run->t, y, NULL);
}

static uint64_t probe_calls(const probe *run)
{
    weft_stepper_stats stats = { .struct_size = sizeof stats };
    run->type->stats(run->self, &stats);
    return stats.rhs_calls;
}

static int shift(double t, const double *y, double *dydt, void *ctx)
{
    (void)t;
    (void)ctx;
    memcpy(dydt, y + 1, (SHIFT_DIM - 1) * sizeof *y);
    dydt[SHIFT_DIM - 1] = 0.0;
    return 0;
}

/* Independent modes: x[count], then v[count]. */
typedef struct step_batch {
    size_t count;
    const double *w, *c; /* [1/s^2], [1/s] */
} step_batch;

static int oscillate(double t, const double *y, double *dydt, void *ctx)
{
    const step_batch *of = ctx;
    (void)t;
    for (size_t i = 0; i < of->count; ++i) {
        dydt[i] = y[of->count + i];
        dydt[of->count + i] = -of->w[i] * y[i] - of->c[i] * y[of->count + i];
    }
    return 0;
}

/* r and calls from steps of the shift; further ones would begin from more than 0. */
static weft_status read_polynomial(weft_stability *out, weft_error *err)
{
    double y[SHIFT_DIM] = { 0 };
    const weft_ode ode = { SHIFT_DIM, shift, NULL };
    probe run;
    TRY(probe_begin(&run, out, &ode, err));
    y[SHIFT_DIM - 1] = 1.0;
    weft_status status = probe_step(&run, y);
    out->degree = 0;
    for (int k = 0; k < SHIFT_DIM; ++k) {
        out->r[k] = y[SHIFT_DIM - 1 - k];
        out->degree = out->r[k] != 0.0 ? k : out->degree;
    }
    /* The first step may cost more than later ones. */
    const uint64_t before = probe_calls(&run);
    for (int k = 0; k < 4 && status == WEFT_OK; ++k) {
        status = probe_step(&run, y);
    }
    out->calls = (double)(probe_calls(&run) - before) / 4.0;
    out->type->destroy(run.self);
    return status == WEFT_OK
               ? status
               : weft_error_set(err, status, "%s: no step of a linear problem",
                                out->type->name);
}

/* (x, v) becomes R(A) (x, v), A = (0 1; -w -c). */
static void stability_apply(const weft_stability *of, double w, double c, double y[2])
{
    double sum[2] = { 0.0, 0.0 };
    for (int k = of->degree; k >= 0; --k) {
        const double x = sum[1], v = -w * sum[0] - c * sum[1];
        sum[0] = x + of->r[k] * y[0];
        sum[1] = v + of->r[k] * y[1];
    }
    memcpy(y, sum, sizeof sum);
}

/* Whether three steps of some modes agree with R. */
static weft_status polynomial_holds(const weft_stability *of, bool *holds,
                                    weft_error *err)
{
    static const double w[3] = { 0.25, 2.0, 0.7 }, c[3] = { 0.0, 1.0, 0.3 };
    step_batch ctx = { 3, w, c };
    const weft_ode ode = { 6, oscillate, &ctx };
    double y[6] = { 1.0, 0.3, -0.4, 0.2, -0.8, 0.6 };
    double wanted[3][2] = { { 1.0, 0.2 }, { 0.3, -0.8 }, { -0.4, 0.6 } };
    probe run;
    TRY(probe_begin(&run, of, &ode, err));
    *holds = true;
    for (int step = 0; step < 3 && *holds; ++step) {
        *holds = probe_step(&run, y) == WEFT_OK;
        for (size_t i = 0; i < 3; ++i) {
            stability_apply(of, w[i], c[i], wanted[i]);
            *holds = *holds && fabs(y[i] - wanted[i][0]) < 1e-10
                     && fabs(y[3 + i] - wanted[i][1]) < 1e-10;
        }
    }
    of->type->destroy(run.self);
    return WEFT_OK;
}

weft_status weft_stability_create(const weft_stepper_type *type,
                                  const weft_butcher *butcher, weft_stability *out,
                                  weft_error *err)
{
    TRY(weft__given(type, out, "weft_stability_create", err));
    TRY(weft__method_check(type, 0, err));
    *out = (weft_stability){ .type = type, .butcher = butcher };
    if ((type->flags & (WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_MULTISTEP)) != 0) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "%s: only explicit methods of one step have a largest "
                              "stable step",
                              type->name);
    }
    if ((type->flags & WEFT_STEPPER_STRUCTURE) != 0) {
        out->degree = -1;
        return WEFT_OK;
    }
    bool holds = false;
    TRY(read_polynomial(out, err));
    TRY(polynomial_holds(out, &holds, err));
    out->degree = holds ? out->degree : -1;
    return WEFT_OK;
}

/* ---- Runge-Kutta: along rays from 0 ---------------------------------------------- */

/* Not libm's cabs: a step that follows from it has the same bits everywhere. */
static double magnitude(double complex z)
{
    return sqrt(creal(z) * creal(z) + cimag(z) * cimag(z));
}

static bool contracts(const weft_stability *of, double complex mu, double growth,
                      double h)
{
    double complex sum = 0.0;
    for (int k = of->degree; k >= 0; --k) {
        sum = sum * (h * mu) + of->r[k];
    }
    const double e = 2.7182818284590452, most = fmin(growth * h, MOST_GROWTH);
    return magnitude(sum) <= (1.0 + ROUNDOFF) * weft_pow(e, most);
}

/* The first h below limit at which the ray h mu leaves the region of stability. */
static double ray_limit(const weft_stability *of, double complex mu, double growth,
                        double limit)
{
    const double stride = 0x1p-5 / magnitude(mu);
    double low = 0.0, high = fmin(stride, limit);
    while (contracts(of, mu, growth, high)) {
        if (!(high < limit)) {
            return limit;
        }
        low = high;
        high = fmin(high + stride, limit);
    }
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        *(contracts(of, mu, growth, middle) ? &low : &high) = middle;
    }
    return low;
}

/* The root of mu^2 + c mu + w that is farthest left, of a pair the upper one. */
static double complex stability_root(double w, double c)
{
    const double under = 0.25 * c * c - w;
    return under >= 0.0 ? -0.5 * c - sqrt(under) : -0.5 * c + I * sqrt(-under);
}

/* Rate [1/s] at which a mode may grow: what its own damping, -Re mu, leaves of
 * `growth`, so that lightly damped modes limit h no more than undamped ones do. None on
 * the real axis. All modes on the ray of mu but nearer to 0 are allowed as much or
 * more. */
static double allowance(double complex mu, double growth)
{
    return cimag(mu) != 0.0 ? fmax(0.0, growth + creal(mu)) : 0.0;
}

enum { POINTS = 16 }; /* per side, denser where the modes are slow */

/* Radius beyond which only R = const is stable: it encloses all zeros of R. */
static double farthest(const weft_stability *of, double complex mu)
{
    double most = 0.0;
    for (int k = 1; k < of->degree; ++k) {
        most = fmax(most, fabs(of->r[k] / of->r[of->degree]));
    }
    most = fmax(most, (fabs(of->r[0]) + 2.0) / fabs(of->r[of->degree]));
    return (1.0 + most) / magnitude(mu);
}

static double polygon_limit(const weft_stability *of, const weft_stiffness *polygon,
                            double growth)
{
    double limit = INFINITY;
    for (size_t i = 0; i < polygon->count && of->degree > 0; ++i) {
        const double *p = polygon->corners[i];
        const double *q = polygon->corners[(i + 1) % polygon->count];
        const double *slow = p[0] < q[0] ? p : q, *fast = p[0] < q[0] ? q : p;
        for (int k = POINTS; k >= 0; --k) {
            const double part = (double)k * k / (POINTS * POINTS);
            const double complex mu
                = stability_root(slow[0] + part * (fast[0] - slow[0]),
                                 slow[1] + part * (fast[1] - slow[1]));
            if (mu != 0.0) {
                limit = ray_limit(of, mu, allowance(mu, growth),
                                  fmin(limit, farthest(of, mu)));
            }
        }
    }
    return limit;
}

/* ---- other methods: by running them ---------------------------------------------- */

enum { STEPS = 4096, PARTS = 4 }; /* the modes are also run at 1/4, 2/4, 3/4 of h */

/* The largest w x^2 + v^2 of each mode over some steps; false if a step failed. */
static bool largest(probe *run, const step_batch *of, int steps, double *y,
                    double *most)
{
    memset(most, 0, of->count * sizeof *most);
    for (int i = 0; i < steps; ++i) {
        if (probe_step(run, y) != WEFT_OK) {
            return false;
        }
        for (size_t k = 0; k < of->count; ++k) {
            const double x = y[k], v = y[of->count + k];
            const double energy = of->w[k] * x * x + v * v;
            most[k] = energy > most[k] ? energy : most[k];
        }
    }
    return true;
}

/* Between the second and the last quarter of many steps no mode has grown by more than
 * a tenth: the apparent growth of a bounded one in finite quarters. */
static bool none_grows(probe *run, const step_batch *of, double *y, double *work)
{
    double *early = work, *late = work + of->count;
    bool stable = largest(run, of, STEPS / 4, y, early)
                  && largest(run, of, STEPS / 4, y, early)
                  && largest(run, of, STEPS / 4, y, late)
                  && largest(run, of, STEPS / 4, y, late);
    for (size_t k = 0; stable && k < of->count; ++k) {
        stable = isfinite(late[k]) && late[k] <= 1.1 * early[k];
    }
    return stable;
}

/* The modes of h, w h^2 and c h, at its parts. */
static size_t scale_modes(const weft_stiffness *polygon, double h, double *w, double *c)
{
    size_t count = 0;
    for (size_t i = 0; i < 2 * polygon->count; ++i) { /* corners and middles of sides */
        const double *p = polygon->corners[i / 2];
        const double *q = polygon->corners[(i + 1) / 2 % polygon->count];
        for (int part = 1; part <= PARTS; ++part) {
            const double s = h * part / (double)PARTS;
            w[count] = 0.5 * (p[0] + q[0]) * s * s;
            c[count++] = 0.5 * (p[1] + q[1]) * s;
        }
    }
    return count;
}

static weft_status run_is_stable(const weft_stability *of,
                                 const weft_stiffness *polygon, double h, double *work,
                                 bool *stable, weft_error *err)
{
    const size_t most = 2 * PARTS * WEFT_STIFFNESS_CORNERS;
    double *w = work, *c = w + most, *y = c + most;
    step_batch ctx = { scale_modes(polygon, h, w, c), w, c };
    const weft_ode ode = { 2 * ctx.count, oscillate, &ctx };
    for (size_t k = 0; k < ctx.count; ++k) {
        y[k] = 1.0;
        y[ctx.count + k] = 0.7;
    }
    probe run;
    TRY(probe_begin(&run, of, &ode, err));
    *stable = none_grows(&run, &ctx, y, y + 2 * most);
    of->type->destroy(run.self);
    return WEFT_OK;
}

/* Whether steps of h are stable; `work`: as of find_runs. */
typedef weft_status verdict_fn(const weft_stability *of, const weft_stiffness *polygon,
                               double h, double *work, bool *stable, weft_error *err);

/* The largest stable h, by trials, and `kept` of it, after an error so far; INFINITY:
 * none was unstable. Ends earlier with a stable one that is `enough`. */
static weft_status bisect(const weft_stability *of, const weft_stiffness *polygon,
                          verdict_fn *verdict, double *work, int trials, double kept,
                          double enough, double *h, weft_error *err)
{
    const double fast = sqrt(polygon->omega2) + polygon->damping;
    double low = 0.0, high = 0.1 / fast; /* doubled until it is unstable */
    bool found = false;
    for (int i = 0; i < trials && kept * low < enough; ++i) {
        bool stable = false;
        const double trial = found ? 0.5 * (low + high) : high;
        *h = kept * low;
        TRY(verdict(of, polygon, trial, work, &stable, err));
        if (stable) {
            low = trial;
            high = found ? high : 2.0 * high;
        } else {
            high = trial;
            found = true;
        }
    }
    *h = found ? kept * low : INFINITY;
    return WEFT_OK;
}

static weft_status bisect_runs(const weft_stability *of, const weft_stiffness *polygon,
                               double enough, double *h, weft_error *err)
{
    double *work = malloc((size_t)12 * PARTS * WEFT_STIFFNESS_CORNERS * sizeof *work);
    if (work == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a stable step");
    }
    const weft_status status
        = bisect(of, polygon, run_is_stable, work, 24, 1.0 - SHORT, enough, h, err);
    free(work);
    return status;
}

/* ---- methods that know the modes: by asking them --------------------------------- */

/* Whether a particle at rest can take fixed steps of h on a cloth with these modes, and
 * the RHS calls of one. Not WEFT_OK: the method refuses the cloth. */
static weft_status ask(const weft_stability *of, const weft_stiffness *polygon,
                       double h, bool *stable, double *calls, weft_error *err)
{
    enum { ASKED = 4 };
    const weft_structure structure = weft__one_structure(polygon);
    double y[6] = { 0 };
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = h;
    config.structure = &structure;
    probe run = { .type = of->type };
    TRY(of->type->create(of->type, &weft__one_ode, &config, &run.self, err));
    *stable = probe_step(&run, y) == WEFT_OK; /* may cost more than later ones */
    const uint64_t before = probe_calls(&run);
    for (int k = 0; k < ASKED && *stable; ++k) {
        *stable = probe_step(&run, y) == WEFT_OK;
    }
    *calls = (double)(probe_calls(&run) - before) / (double)ASKED;
    of->type->destroy(run.self);
    return WEFT_OK;
}

static weft_status answer_is_stable(const weft_stability *of,
                                    const weft_stiffness *polygon, double h,
                                    double *work, bool *stable, weft_error *err)
{
    double calls;
    (void)work;
    return ask(of, polygon, h, stable, &calls, err);
}

static bool asks(const weft_stability *of)
{
    return (of->type->flags & WEFT_STEPPER_STRUCTURE) != 0;
}

weft_status weft_stability_calls(const weft_stability *stability,
                                 const weft_stiffness *modes, double h, double *calls,
                                 weft_error *err)
{
    bool stable = false;
    *calls = stability->calls;
    return asks(stability) && isfinite(h)
               ? ask(stability, modes, h, &stable, calls, err)
               : WEFT_OK;
}

static weft_status find_step(const weft_stability *of, const weft_stiffness *polygon,
                             double growth, double enough, double *h, weft_error *err)
{
    if (!isfinite(polygon->omega2) || !isfinite(polygon->damping)) {
        *h = 0.0;
        return WEFT_OK;
    }
    if (of->degree >= 0) {
        *h = polygon_limit(of, polygon, growth);
        return WEFT_OK;
    }
    *h = INFINITY;
    if (!(polygon->omega2 > 0.0) && !(polygon->damping > 0.0)) {
        return WEFT_OK;
    }
    return asks(of)
               ? bisect(of, polygon, answer_is_stable, NULL, 60, 1.0, INFINITY, h, err)
               : bisect_runs(of, polygon, enough, h, err);
}

weft_status weft_stability_step(const weft_stability *stability,
                                const weft_stiffness *modes, double growth, double *h,
                                weft_error *err)
{
    return find_step(stability, modes, growth, INFINITY, h, err);
}

weft_status weft_stability_reaches(const weft_stability *stability,
                                   const weft_stiffness *modes, double growth, double h,
                                   bool *reaches, weft_error *err)
{
    double found;
    *reaches = false;
    TRY(find_step(stability, modes, growth, h, &found, err));
    *reaches = found >= h;
    return WEFT_OK;
}
