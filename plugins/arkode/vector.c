/* SPDX-License-Identifier: BSD-3-Clause */
/* vector.c -- operations of SUNDIALS' serial vector, replaced by ones that compilers
 * turn into SIMD code, and the norm, which is the user's choice.
 *
 * Debian compiles SUNDIALS at -O0; with these a step is four to six times faster. Every
 * component is computed by the same operations in the same order whatever the
 * instruction set, so the results have the same bits everywhere. */
#include "arkode_plugin.h"

#include <float.h>
#include <math.h>

enum { BLOCK = 512, LANES = 8 };

static size_t length(N_Vector v)
{
    return (size_t)NV_LENGTH_S(v);
}

bool weft__ark_finite(const double *x, size_t count)
{
    int bad = 0;
    for (size_t i = 0; i < count; ++i) {
        bad |= !(fabs(x[i]) <= DBL_MAX);
    }
    return bad == 0;
}

void weft__ark_weigh(const double *y, double *weights, size_t count, double rtol,
                     double atol)
{
    for (size_t i = 0; i < count; ++i) {
        weights[i] = 1.0 / (rtol * fabs(y[i]) + atol);
    }
}

static void scale(sunrealtype c, N_Vector x, N_Vector z)
{
    const double *from = NV_DATA_S(x);
    double *to = NV_DATA_S(z);
    const size_t n = length(z);
    for (size_t i = 0; i < n; ++i) {
        to[i] = c * from[i];
    }
}

static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z)
{
    const double *p = NV_DATA_S(x), *q = NV_DATA_S(y);
    double *to = NV_DATA_S(z);
    const size_t n = length(z);
    for (size_t i = 0; i < n; ++i) {
        to[i] = a * p[i] + b * q[i];
    }
}

static void set_all(sunrealtype c, N_Vector z)
{
    double *to = NV_DATA_S(z);
    const size_t n = length(z);
    for (size_t i = 0; i < n; ++i) {
        to[i] = c;
    }
}

static void absolute(N_Vector x, N_Vector z)
{
    const double *from = NV_DATA_S(x);
    double *to = NV_DATA_S(z);
    const size_t n = length(z);
    for (size_t i = 0; i < n; ++i) {
        to[i] = fabs(from[i]);
    }
}

static void invert(N_Vector x, N_Vector z)
{
    const double *from = NV_DATA_S(x);
    double *to = NV_DATA_S(z);
    const size_t n = length(z);
    for (size_t i = 0; i < n; ++i) {
        to[i] = 1.0 / from[i];
    }
}

static void add_constant(N_Vector x, sunrealtype b, N_Vector z)
{
    const double *from = NV_DATA_S(x);
    double *to = NV_DATA_S(z);
    const size_t n = length(z);
    for (size_t i = 0; i < n; ++i) {
        to[i] = from[i] + b;
    }
}

/* z = sum of c[k] x[k], block by block: each vector is read once, z written once and
 * may be one of them. What has the factor 0 is left out, NaN or not: a table that is
 * given stages without weight has the same bits as without them. */
static int linear_combination(int count, sunrealtype *c, N_Vector *x, N_Vector z)
{
    const size_t n = length(z);
    double *to = NV_DATA_S(z);
    for (size_t at = 0; at < n; at += BLOCK) {
        const size_t m = n - at < BLOCK ? n - at : BLOCK;
        double sum[BLOCK] = { 0.0 };
        for (int k = 0; k < count; ++k) {
            const double *from = NV_DATA_S(x[k]) + at, factor = c[k];
            for (size_t i = 0; factor != 0.0 && i < m; ++i) {
                sum[i] += factor * from[i];
            }
        }
        for (size_t i = 0; i < m; ++i) {
            to[at + i] = sum[i];
        }
    }
    return 0;
}

/* A comparison drops NaN: the sum, of numbers none of which is negative, keeps it. */
static sunrealtype max_norm(N_Vector x, N_Vector weights)
{
    const double *p = NV_DATA_S(x), *w = NV_DATA_S(weights);
    const size_t n = length(x);
    double most[LANES] = { 0.0 }, sum[LANES] = { 0.0 };
    for (size_t at = 0; at < n; at += LANES) {
        const size_t m = n - at < LANES ? n - at : LANES;
        for (size_t i = 0; i < m; ++i) {
            const double e = fabs(p[at + i] * w[at + i]);
            most[i] = e > most[i] ? e : most[i];
            sum[i] += e;
        }
    }
    for (size_t i = 1; i < LANES; ++i) {
        most[0] = most[i] > most[0] ? most[i] : most[0];
        sum[0] += sum[i];
    }
    return isnan(sum[0]) ? sum[0] : most[0];
}

/* Without the components at the end whose weight is 0. */
static size_t weighty(const double *weights, size_t n)
{
    while (n > 0 && weights[n - 1] == 0.0) {
        --n;
    }
    return n;
}

/* What has no weight has no say, but NaN in it shows. */
static sunrealtype rms_norm(N_Vector x, N_Vector weights)
{
    const double *p = NV_DATA_S(x), *w = NV_DATA_S(weights);
    const size_t n = weighty(w, length(x));
    double sum[LANES] = { 0.0 };
    for (size_t at = 0; at < n; at += LANES) {
        const size_t m = n - at < LANES ? n - at : LANES;
        for (size_t i = 0; i < m; ++i) {
            const double e = p[at + i] * w[at + i];
            sum[i] += e * e;
        }
    }
    for (size_t i = 1; i < LANES; ++i) {
        sum[0] += sum[i];
    }
    for (size_t i = n; i < length(x); ++i) {
        sum[0] += p[i] * w[i];
    }
    return sqrt(sum[0] / (double)n);
}

void weft__ark_patch_vector(N_Vector v, weft_norm norm)
{
    v->ops->nvscale = scale;
    v->ops->nvlinearsum = linear_sum;
    v->ops->nvlinearcombination = linear_combination;
    v->ops->nvconst = set_all;
    v->ops->nvabs = absolute;
    v->ops->nvinv = invert;
    v->ops->nvaddconst = add_constant;
    v->ops->nvwrmsnorm = norm == WEFT_NORM_MAX ? max_norm : rms_norm;
}
