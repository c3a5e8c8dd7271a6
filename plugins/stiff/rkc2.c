/* SPDX-License-Identifier: BSD-3-Clause */
/* rkc2.c -- the Runge-Kutta-Chebyshev method of order 2 (B. P. Sommeijer, L. F.
 * Shampine, J. G. Verwer, RKC: an explicit solver for parabolic PDEs, J. Comput. Appl.
 * Math. 88, 1998): s stages reach 0.65 s^2 along the negative real axis.
 * They are as many as spectrum.h asks for. */
#include "stiff_plugin.h"

#include <math.h>

#define DAMPING (2.0 / 13.0)
#define BIAS    WEFT__ESTIMATE_BIAS

weft_status weft__rkc2_prepare(stiff_stepper *self, double t, const double *y,
                               double *most, weft_error *err)
{
    const weft_status status
        = weft__spectrum_prepare(&self->spectrum, self->method->type.name,
                                 self->structure, self->fixed_step, t, y, err);
    *most = self->spectrum.cap;
    return status;
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
    const int stages
        = (int)fmax(2.0, 1.0 + sqrt(1.0 + WEFT__REACH * h * self->spectrum.radius));
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
