/* SPDX-License-Identifier: BSD-3-Clause */
/* wrong_libm.c -- a libm to be preloaded, wrong by up to one part in 1e9: the bits of a
 * run must not depend on it (test_libm.c). The error follows from the argument, as that
 * of a true libm does, and is large enough for a single call to show. */
#define _GNU_SOURCE
#include <complex.h>
#include <dlfcn.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#pragma GCC visibility push(default)

static double spoil(double right, double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits *= 0x9E3779B97F4A7C15u; /* 2^64 over the golden ratio: Knuth's hash */
    return right * (1.0 + 1e-9 * ((double)(bits >> 11) * 0x1p-52 - 1.0));
}

static void *right_one(const char *name)
{
    void *found = dlsym(RTLD_NEXT, name);
    if (found == NULL) {
        abort();
    }
    return found;
}

/* Conversions of pointers as POSIX has them at dlsym. */
#define FIND(f) *(void **)&right = right_one(#f)

#define ONE(f)                                                                         \
    double f(double x)                                                                 \
    {                                                                                  \
        double (*right)(double);                                                       \
        FIND(f);                                                                       \
        return spoil(right(x), x);                                                     \
    }

#define TWO(f)                                                                         \
    double f(double x, double y)                                                       \
    {                                                                                  \
        double (*right)(double, double);                                               \
        FIND(f);                                                                       \
        return spoil(right(x, y), x);                                                  \
    }

#define CIRCULAR(X)   X(sin) X(cos) X(tan) X(asin) X(acos) X(atan)
#define HYPERBOLIC(X) X(sinh) X(cosh) X(tanh)
#define POWERS(X)     X(exp) X(exp2) X(exp10) X(expm1) X(cbrt)
#define LOGARITHMS(X) X(log) X(log2) X(log10) X(log1p)
#define BINARY(X)     X(pow) X(atan2) X(hypot)

CIRCULAR(ONE)
HYPERBOLIC(ONE)
POWERS(ONE)
LOGARITHMS(ONE)
BINARY(TWO)

void sincos(double x, double *sine, double *cosine)
{
    void (*right)(double, double *, double *);
    FIND(sincos);
    right(x, sine, cosine);
    *sine = spoil(*sine, x);
    *cosine = spoil(*cosine, x);
}

double cabs(double complex z)
{
    double (*right)(double complex);
    FIND(cabs);
    return spoil(right(z), creal(z));
}
