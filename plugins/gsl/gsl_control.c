/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gsl_control.c -- when a step is accurate enough, and how long the next one may be.
 *
 * With the error estimate e_i of a step and
 *
 *     D_i = atol_i + rtol |y_i|,   atol_i of positions or of velocities,
 *
 * GSL's scaled control uses r = max_i |e_i| / D_i: it rejects a step of r > 1.1 and
 * lengthens the next one where r < 0.5. For WEFT_NORM_RMS
 *
 *     r = sqrt(1/n sum_i (e_i / D_i)^2)
 *
 * Either r is computed here, in one pass with the test for numbers that are not finite,
 * which GSL does not look for; so both norms decide by the same rule. Either is of the
 * positions and velocities alone, so that quadratures have no say. The rule is that of
 * the scaled kind, as the standard kind may lengthen h by exactly 5, where msbdf
 * divides by zero (GSL bug 52336). It is written out here, as GSL's takes libm's pow,
 * whose bits differ between machines. */
#include "gsl_plugin.h"

#include <float.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "../linear/vectors.h"

enum { LANES = 8 };

/* Added to the bits of |x| it carries into the sign just where x is not finite. */
static inline uint64_t shows_not_finite(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (bits & INT64_MAX) + UINT64_C(0x0010000000000000);
}

/* Raises lane[0 .. count) to |e_i| / D_i. */
INLINE void raise_lanes(const double *y, const double *e, double rtol, double atol,
                        size_t count, double *lane, uint64_t *bad)
{
    for (size_t i = 0; i < count; ++i) {
        const double r = fabs(e[i]) / (atol + rtol * fabs(y[i]));
        lane[i] = r > lane[i] ? r : lane[i];
        bad[i] |= shows_not_finite(y[i]) | shows_not_finite(e[i]);
    }
}

WIDE static bool raise_ratio(const double *y, const double *e, size_t n, double rtol,
                             double atol, double *most)
{
    double lane[LANES] = { 0.0 };
    uint64_t bad[LANES] = { 0 }, any = 0;
    size_t at = 0;
    for (; at + LANES <= n; at += LANES) {
        raise_lanes(y + at, e + at, rtol, atol, LANES, lane, bad);
    }
    raise_lanes(y + at, e + at, rtol, atol, n - at, lane, bad);
    for (size_t i = 0; i < LANES; ++i) {
        *most = lane[i] > *most ? lane[i] : *most;
        any |= bad[i];
    }
    return any >> 63 == 0;
}

static bool rms_ratio(const gsl_stepper *self, const double *y, double *r)
{
    const size_t half = self->half;
    double sum = 0.0;
    uint64_t bad = 0;
    for (size_t i = 0; i < 2 * half; ++i) {
        const double ratio = self->yerr[i] / weft__gsl_tolerance(self, i, y[i]);
        sum += ratio * ratio;
        bad |= shows_not_finite(y[i]) | shows_not_finite(self->yerr[i]);
    }
    *r = sqrt(sum / (2.0 * (double)half));
    return bad >> 63 == 0;
}

bool weft__gsl_ratio(const gsl_stepper *self, const double *y, double *r)
{
    const size_t half = self->half, rest = self->ode.dim - 2 * half;
    bool finite;
    *r = 0.0;
    if (self->norm == WEFT_NORM_RMS) {
        finite = rms_ratio(self, y, r);
    } else {
        finite = raise_ratio(y, self->yerr, half, self->rtol, self->atol[0], r);
        finite = raise_ratio(y + half, self->yerr + half, half, self->rtol,
                             self->atol[1], r)
                 && finite;
    }
    return finite && weft__gsl_finite(y + 2 * half, rest)
           && weft__gsl_finite(self->yerr + 2 * half, rest);
}

double weft__gsl_tolerance(const gsl_stepper *self, size_t i, double y)
{
    return self->atol[i < self->half ? 0 : 1] + self->rtol * fabs(y);
}

/* Implicit and multistep methods solve their equations to this accuracy. */
static int errlevel(void *state, const double y, const double dydt, const double h,
                    const size_t i, double *level)
{
    (void)dydt;
    (void)h;
    *level = weft__gsl_tolerance(state, i, y);
    return GSL_SUCCESS;
}

static const gsl_odeiv2_control_type control_type = {
    .name = "weft",
    .errlevel = errlevel,
};

void weft__gsl_control_init(gsl_stepper *self, weft_norm norm, double rtol,
                            double atol_position, double atol_velocity)
{
    self->norm = norm;
    self->rtol = rtol;
    self->atol[0] = atol_position;
    self->atol[1] = atol_velocity;
    self->control = (gsl_odeiv2_control){ .type = &control_type, .state = self };
}

/* The rule has no knobs; these are GSL's constants (cscal.c). */
#define SAFETY        0.9
#define REJECT_ABOVE  1.1
#define GROW_BELOW    0.5
#define MAX_GROWTH    4.9
#define MIN_REDUCTION 0.2

bool weft__gsl_rejects(unsigned int order, double r, double *h)
{
    if (r > REJECT_ABOVE) {
        *h *= fmax(SAFETY / weft_pow(r, 1.0 / order), MIN_REDUCTION);
        return true;
    }
    if (r < GROW_BELOW) {
        const double wanted = SAFETY / weft_pow(fmax(r, DBL_MIN), 1.0 / (order + 1.0));
        *h *= fmax(fmin(wanted, MAX_GROWTH), 1.0);
    }
    return false;
}

#define TEXT(number)  #number
#define VALUE(number) TEXT(number)

void weft__gsl_options(const void *instance, weft_option_fn *tell, void *ctx)
{
    const gsl_stepper *self = instance;
    if (self->fixed_step == 0.0) {
        tell(ctx, "controller", "gsl_scaled");
        tell(ctx, "safety", VALUE(SAFETY));
        tell(ctx, "reject_above", VALUE(REJECT_ABOVE));
        tell(ctx, "grow_below", VALUE(GROW_BELOW));
        tell(ctx, "max_growth", VALUE(MAX_GROWTH));
        tell(ctx, "min_reduction", VALUE(MIN_REDUCTION));
    }
}
