/* SPDX-License-Identifier: BSD-3-Clause */
/* implicit.c -- methods that solve linear systems with the filtered Jacobian A.
 *
 * ros2 (J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer, A second-order Rosenbrock
 * method applied to photochemical dispersion problems, SIAM J. Sci. Comput. 20, 1999):
 *
 *     (I - gamma h A) k1 = f(t, y)
 *     (I - gamma h A) k2 = f(t + h, y + h k1) - 2 k1
 *     y + (3/2) h k1 + (1/2) h k2,        compared with y + h k1
 *
 * It has order 2 with any matrix A and, with gamma = 1 - 1 / sqrt(2), is L-stable with
 * the Jacobian.
 *
 * backward_euler takes one Newton step from y for the implicit Euler method, as D.
 * Baraff, A. Witkin, Large steps in cloth simulation, SIGGRAPH 1998. */
#include "stiff_plugin.h"

#include <math.h>

static int solve(stiff_stepper *self, double *k)
{
    return weft__linear_solve(self->linear, self->settings.krylov, k) ? 0 : 1;
}

/* f and the Jacobian in (t, y), unless they are there. */
static int start(stiff_stepper *self, double t, const double *y)
{
    int failed = self->carries ? 0 : weft__stiff_rhs(self, t, y, self->f);
    self->carries = failed == 0;
    if (failed == 0 && !self->fresh) {
        failed = weft__linear_at(self->linear, t, y);
        self->fresh = failed == 0;
    }
    return failed;
}

int weft__ros2_attempt(stiff_stepper *self, double t, double h, const double *y)
{
    const size_t dim = self->ode.dim;
    double *k1 = self->work[0], *k2 = self->work[1];
    int failed = start(self, t, y);
    if (failed != 0) {
        return failed;
    }
    weft__linear_prepare(self->linear, (1.0 - sqrt(0.5)) * h);
    memcpy(k1, self->f, dim * sizeof *k1);
    if (solve(self, k1) != 0) {
        return 1;
    }
    weft__stiff_combine(dim, 2, (const double *[]){ y, k1 }, (double[]){ 1.0, h },
                        self->end);
    failed = weft__stiff_rhs(self, t + h, self->end, self->error);
    weft__stiff_combine(dim, 2, (const double *[]){ self->error, k1 },
                        (double[]){ 1.0, -2.0 }, k2);
    if (failed != 0 || solve(self, k2) != 0) {
        return failed != 0 ? failed : 1;
    }
    weft__stiff_combine(dim, 3, (const double *[]){ y, k1, k2 },
                        (double[]){ 1.0, 1.5 * h, 0.5 * h }, self->end);
    weft__stiff_combine(dim, 2, (const double *[]){ k1, k2 },
                        (double[]){ 0.5 * h, 0.5 * h }, self->error);
    return 0;
}

int weft__backward_euler_attempt(stiff_stepper *self, double t, double h,
                                 const double *y)
{
    const size_t dim = self->ode.dim;
    self->carries = self->fresh = false;
    const int failed = start(self, t + h, y);
    if (failed != 0) {
        return failed;
    }
    weft__linear_prepare(self->linear, h);
    if (solve(self, self->f) != 0) {
        return 1;
    }
    weft__stiff_combine(dim, 2, (const double *[]){ y, self->f }, (double[]){ 1.0, h },
                        self->end);
    self->carries = false;
    return 0;
}
