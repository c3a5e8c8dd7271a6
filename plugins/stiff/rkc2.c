/* SPDX-License-Identifier: BSD-3-Clause */
/* rkc2.c -- the Runge-Kutta-Chebyshev method of order 2 (B. P. Sommeijer, L. F.
 * Shampine, J. G. Verwer, RKC: an explicit solver for parabolic PDEs, J. Comput. Appl.
 * Math. 88, 1998): s stages reach 0.65 s^2 along the negative real axis.
 *
 * With damping tau times the stiffness, the eigenvalues mu that are not real lie on the
 * circle |mu + 1 / tau| = 1 / tau, which is stable for h <= 2.3 tau, whatever the
 * stages. Modes with h |mu| < 0.5 are slow enough for the error test. What follows is a
 * bound of h for each corner of the polygon that holds all modes; below a damping ratio
 * of 0.5 that is no longer than the step of an explicit method, and the method is
 * refused. */
#include "stiff_plugin.h"

#include <math.h>

enum { STAGES_MOST = 500, STEPS_KNOWN = 256 };

#define DAMPING    (2.0 / 13.0)
#define MARGIN     1.05 /* of the largest eigenvalue, while the state changes */
#define CIRCLE     1.9  /* of 2.3 tau, for the same reason */
#define SLOW       0.5  /* h omega of modes that need no damping */
#define LEAST_ZETA 0.5
#define BIAS                                                                           \
    5.0            /* of the authors' estimate: it is that of the solution itself,     \
                      so that the errors of all steps add up */
#define REACH 1.54 /* s^2 > 1 + REACH h radius, the authors' */

typedef double corner[2]; /* (omega^2 [1/s^2], damping rate [1/s]) */

/* Of the two roots of mu^2 + c mu + w = 0, the larger |mu|. */
static double magnitude(double w, double c)
{
    return c * c > 4.0 * w ? 0.5 * (c + sqrt(c * c - 4.0 * w)) : sqrt(w);
}

bool weft__rkc2_refuses(const weft_structure *structure)
{
    corner corners[WEFT_MODES_CORNERS];
    const size_t count
        = structure->modes(0.0, NULL, corners, WEFT_MODES_CORNERS, structure->ctx);
    double w = 0.0, c = 0.0;
    for (size_t i = 0; i < count; ++i) {
        w = fmax(w, corners[i][0]);
        c = fmax(c, corners[i][1]);
    }
    return w > 0.0 && 0.5 * c < LEAST_ZETA * sqrt(w);
}

static void learn(stiff_modes *self, corner *corners, size_t count)
{
    *self = (stiff_modes){ .known = true, .cap = (double)INFINITY };
    for (size_t i = 0; i < count; ++i) {
        const double w = corners[i][0], c = corners[i][1];
        self->radius = fmax(self->radius, MARGIN * magnitude(w, c));
        if (w > 0.0) {
            self->cap = fmin(self->cap, fmax(CIRCLE * c / w, SLOW / sqrt(w)));
        }
    }
    const double most = (double)STAGES_MOST - 1.0;
    self->cap = fmin(self->cap, (most * most - 1.0) / (REACH * self->radius));
}

weft_status weft__rkc2_prepare(stiff_stepper *self, double t, const double *y,
                               double *most, weft_error *err)
{
    const char *name = self->method->type.name;
    if (!self->modes.known || self->modes.age >= STEPS_KNOWN) {
        corner corners[WEFT_MODES_CORNERS];
        const size_t count = self->structure->modes(t, y, corners, WEFT_MODES_CORNERS,
                                                    self->structure->ctx);
        learn(&self->modes, corners, count);
        if (!isfinite(self->modes.radius)) {
            self->modes.known = false;
            return weft_error_set(err, WEFT_NOT_FINITE, "%s: the state is not finite",
                                  name);
        }
    }
    *most = self->modes.cap;
    if (self->fixed_step > self->modes.cap) {
        return weft_error_set(
            err, WEFT_UNSUPPORTED,
            "%s: a fixed_step of %.3g s is not stable: at most %.3g s", name,
            self->fixed_step, self->modes.cap);
    }
    return WEFT_OK;
}

/* T_j(w), T_j'(w), T_j''(w) of Chebyshev's polynomials, and b_j. */
typedef struct chebyshev {
    double value, slope, bend, b;
} chebyshev;

static chebyshev next_of(double w, const chebyshev *last, const chebyshev *before)
{
    chebyshev next
        = { .value = 2.0 * w * last->value - before->value,
            .slope = 2.0 * last->value + 2.0 * w * last->slope - before->slope,
            .bend = 4.0 * last->slope + 2.0 * w * last->bend - before->bend };
    next.b = next.bend / (next.slope * next.slope);
    return next;
}

/* T_j for j = 0, 1; b_0 = b_1 = b_2. */
static void first_two(double w, chebyshev two[2])
{
    two[0] = (chebyshev){ .value = 1.0 };
    two[1] = (chebyshev){ .value = w, .slope = 1.0 };
    two[0].b = two[1].b = next_of(w, &two[1], &two[0]).b;
}

/* T'(w) / T''(w) of the stages-th. */
static double last_ratio(double w, int stages)
{
    chebyshev two[2];
    first_two(w, two);
    for (int j = 2; j <= stages; ++j) {
        const chebyshev next = next_of(w, &two[1], &two[0]);
        two[0] = two[1];
        two[1] = next;
    }
    return two[1].slope / two[1].bend;
}

/* All stages; the last one goes to self->end. What the RHS returned. */
static int run_stages(stiff_stepper *self, double t, double h, const double *y,
                      int stages)
{
    const size_t dim = self->ode.dim;
    const double w0 = 1.0 + DAMPING / ((double)stages * stages);
    const double w1 = last_ratio(w0, stages);
    double *before = self->work[0], *last = self->work[1], *f = self->error;
    chebyshev two[2];
    first_two(w0, two);
    double at = w1 * two[1].b; /* c_j, of the stage last */
    memcpy(before, y, dim * sizeof *y);
    weft__stiff_combine(dim, 2, (const double *[]){ y, self->f },
                        (double[]){ 1.0, at * h }, last);
    for (int j = 2; j <= stages; ++j) {
        const int failed = weft__stiff_rhs(self, t + at * h, last, f);
        if (failed != 0) {
            return failed;
        }
        const chebyshev next = next_of(w0, &two[1], &two[0]);
        const double mu = 2.0 * next.b * w0 / two[1].b, nu = -next.b / two[0].b;
        const double mu_f = 2.0 * next.b * w1 / two[1].b;
        const double gamma_f = -(1.0 - two[1].b * two[1].value) * mu_f;
        double *to = j == stages ? self->end : before; /* element by element */
        weft__stiff_combine(dim, 5, (const double *[]){ y, last, before, f, self->f },
                            (double[]){ 1.0 - mu - nu, mu, nu, mu_f * h, gamma_f * h },
                            to);
        before = last;
        last = to;
        two[0] = two[1];
        two[1] = next;
        at = w1 * next.bend / next.slope;
    }
    return 0;
}

int weft__rkc2_attempt(stiff_stepper *self, double t, double h, const double *y)
{
    const size_t dim = self->ode.dim;
    double *f_end = self->f_end;
    const int stages = (int)fmax(2.0, 1.0 + sqrt(1.0 + REACH * h * self->modes.radius));
    int failed = self->carries ? 0 : weft__stiff_rhs(self, t, y, self->f);
    self->carries = failed == 0;
    failed = failed != 0 ? failed : run_stages(self, t, h, y, stages);
    if (failed != 0 || self->fixed_step > 0.0) {
        return failed;
    }
    failed = weft__stiff_rhs(self, t + h, self->end, f_end);
    self->ends = failed == 0;
    weft__stiff_combine(
        dim, 4, (const double *[]){ y, self->end, self->f, f_end },
        (double[]){ 0.8 * BIAS, -0.8 * BIAS, 0.4 * BIAS * h, 0.4 * BIAS * h },
        self->error);
    return failed;
}
