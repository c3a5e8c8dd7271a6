/* SPDX-License-Identifier: BSD-3-Clause */
/* arithmetic.c -- loops over whole states. A sum has a fixed order: the same bits on
 * any set of instructions. */
#include "stiff_plugin.h"

#include <math.h>

#include "../linear/vectors.h"

enum { LANES = 64 }; /* partial results of a norm */

INLINE void add_up(size_t n, int count, const double *const *x, const double *c,
                   double *to)
{
    const double *a = x[0], *b = x[1], *d = x[count > 2 ? 2 : 0];
    const double *e = x[count > 3 ? 3 : 0], *f = x[count > 4 ? 4 : 0];
    const double ca = c[0], cb = c[1], cd = count > 2 ? c[2] : 0.0;
    const double ce = count > 3 ? c[3] : 0.0, cf = count > 4 ? c[4] : 0.0;
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        double sum = ca * a[i] + cb * b[i];
        sum = count > 2 ? sum + cd * d[i] : sum;
        sum = count > 3 ? sum + ce * e[i] : sum;
        sum = count > 4 ? sum + cf * f[i] : sum;
        to[i] = sum;
    }
}

WIDE static void combine(size_t n, int count, const double *const *x, const double *c,
                         double *to)
{
    switch (count) {
    case 2:
        add_up(n, 2, x, c, to);
        break;
    case 3:
        add_up(n, 3, x, c, to);
        break;
    case 4:
        add_up(n, 4, x, c, to);
        break;
    default:
        add_up(n, 5, x, c, to);
    }
}

void weft__stiff_combine(size_t n, int count, const double *const *x, const double *c,
                         double *to)
{
    combine(n, count, x, c, to);
}

/* 0, or NaN: a sum, unlike a branch, can be vectorised. */
WIDE static bool all_finite(size_t n, const double *y)
{
    double bad[LANES] = { 0.0 }, sum = 0.0;
    size_t at = 0;
    for (; at + LANES <= n; at += LANES) {
        for (size_t i = 0; i < LANES; ++i) {
            bad[i] += 0.0 * y[at + i];
        }
    }
    for (size_t i = 0; at + i < n; ++i) {
        bad[i] += 0.0 * y[at + i];
    }
    for (size_t i = 0; i < LANES; ++i) {
        sum += bad[i];
    }
    return sum == 0.0;
}

bool weft__stiff_finite(size_t n, const double *y)
{
    return all_finite(n, y);
}

/* Adds to lane[LANES] the squares, or takes the largest. */
INLINE void gather(bool max, size_t n, const double *e, const double *y, double rtol,
                   double atol, double *lane)
{
    for (size_t at = 0; at < n; at += LANES) {
        const size_t count = n - at < LANES ? n - at : LANES;
        for (size_t i = 0; i < count; ++i) {
            const double part = fabs(e[at + i]) / (rtol * fabs(y[at + i]) + atol);
            const double most = part > lane[i] ? part : lane[i];
            lane[i] = max ? most : lane[i] + part * part;
        }
    }
}

WIDE static void gather_half(bool max, size_t n, const double *e, const double *y,
                             double rtol, double atol, double *lane)
{
    if (max) {
        gather(true, n, e, y, rtol, atol, lane);
    } else {
        gather(false, n, e, y, rtol, atol, lane);
    }
}

static double rms_of_all(const stiff_stepper *self, const double *e, const double *y)
{
    double *w = self->work[0];
    for (size_t i = 0; i < self->ode.dim; ++i) {
        const double atol = self->atol[i < self->half ? 0 : 1];
        w[i] = 1.0 / (self->rtol * fabs(y[i]) + atol);
    }
    return self->rms->of(self->rms->self, e, w);
}

double weft__stiff_norm(const stiff_stepper *self, const double *e, const double *y)
{
    if (self->norm == WEFT_NORM_RMS && self->rms != NULL) {
        const double norm = rms_of_all(self, e, y); /* whatever this part is */
        return weft__stiff_finite(self->ode.dim, e) ? norm : (double)NAN;
    }
    const size_t half = self->half;
    const bool max = self->norm == WEFT_NORM_MAX;
    double lane[LANES] = { 0.0 }, all = 0.0;
    gather_half(max, half, e, y, self->rtol, self->atol[0], lane);
    gather_half(max, half, e + half, y + half, self->rtol, self->atol[1], lane);
    for (size_t i = 0; i < LANES; ++i) {
        all = !max ? all + lane[i] : lane[i] > all ? lane[i] : all;
    }
    if (!weft__stiff_finite(self->ode.dim, e)) {
        return (double)NAN;
    }
    return max ? all : sqrt(all / (double)(2 * half));
}
