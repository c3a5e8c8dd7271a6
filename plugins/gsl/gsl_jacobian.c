/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gsl_jacobian.c -- df/dy and df/dt by forward differences of the RHS: dim + 2 calls.
 *
 *     J_ij = (f_i(t, y + d e_j) - f_i(t, y)) / d
 *
 * Truncation errs by d J', roundoff by eps |f| / d: least near d = sqrt(eps) s, where s
 * is the scale on which f bends. As s serves the largest coordinate of all positions
 * for a position, and the largest velocity for a velocity, so that a component which
 * happens to be 0 is moved as far as its neighbours are.
 *
 * A singular I - g J, g being some part of h, makes gsl_linalg_LU_solve call the error
 * handler, that is, abort. det(I - g J) as a polynomial in the nonzero J_ij is not zero
 * everywhere (it is 1 at J = 0), so it is zero only by coincidence, and round numbers
 * do coincide: x' = v, v' = 16 x with g = 1/4. Each J_ij is therefore multiplied by a
 * number within 2^-31 of 1, always the same for i and j. The difference quotient errs
 * by more, and a coincidence of the model must now hit one number in four millions.
 * Beside g J_ij beyond 1 / eps the 1 is lost, and pivots may be rounded to 0: such a
 * step has no solution. */
#include "gsl_plugin.h"

#include <float.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

/* Below this [m], [m/s] a state counts as resting at 0. */
#define SMALLEST_SCALE 0.01

static double largest(const double *y, size_t count)
{
    double top = SMALLEST_SCALE;
    for (size_t i = 0; i < count; ++i) {
        top = fmax(top, fabs(y[i]));
    }
    return top;
}

/* Uniform in [1 - 2^-31, 1 + 2^-31): the upper half of D. E. Knuth's congruential
 * generator for MMIX, as a signed fraction. */
static double near_one(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    const double fraction = (double)(*seed >> 32) * 0x1p-31 - 1.0;
    return 1.0 + 0x1p-31 * fraction;
}

/* Column j of a matrix of dim columns: (f_moved - f) / d. Returns the sum of |J_ij|. */
static double put_column(const gsl_stepper *self, double *dfdy, size_t j, double d)
{
    const size_t dim = self->ode.dim;
    uint64_t seed = j;
    double sum = 0.0;
    for (size_t i = 0; i < dim; ++i) {
        const double quotient = (self->f_moved[i] - self->f[i]) / d;
        dfdy[i * dim + j] = quotient * near_one(&seed);
        sum += fabs(quotient);
    }
    return sum;
}

/* The moment is moved forward, but never past the end of the frame, where the model
 * need not be defined. */
static int time_derivative(gsl_stepper *self, double t, const double y[], double dfdt[])
{
    double moved = t + sqrt(DBL_EPSILON) * fmax(fabs(t), self->h_try);
    if (moved > self->t_end) {
        moved = t - sqrt(DBL_EPSILON) * fmax(fabs(t), self->h_try);
    }
    const int failed = weft__gsl_rhs(moved, y, self->f_moved, self);
    for (size_t i = 0; i < self->ode.dim; ++i) {
        dfdt[i] = (self->f_moved[i] - self->f[i]) / (moved - t);
    }
    return failed;
}

int weft__gsl_jacobian(double t, const double y[], double *dfdy, double dfdt[],
                       void *instance)
{
    gsl_stepper *self = instance;
    const size_t dim = self->ode.dim, half = dim / 2;
    const double scale[2] = { largest(y, half), largest(y + half, half) };
    int failed = weft__gsl_rhs(t, y, self->f, self);
    memcpy(self->y_moved, y, dim * sizeof *y);
    for (size_t j = 0; j < dim && failed == 0; ++j) {
        self->y_moved[j] = y[j] + sqrt(DBL_EPSILON) * scale[j < half ? 0 : 1];
        failed = weft__gsl_rhs(t, self->y_moved, self->f_moved, self);
        /* the move as it was rounded, not as it was meant */
        const double sum
            = failed != 0 ? 0.0 : put_column(self, dfdy, j, self->y_moved[j] - y[j]);
        if (!(self->h_try * sum <= 1.0 / DBL_EPSILON)) {
            self->trouble = isfinite(sum) ? UNSOLVED : NOT_FINITE;
            failed = GSL_ERANGE;
        }
        self->y_moved[j] = y[j];
    }
    return failed != 0 ? failed : time_derivative(self, t, y, dfdt);
}
