/* SPDX-License-Identifier: BSD-3-Clause */
/* law.h -- what a law is written in that holds for one particle, pair or triangle and,
 * with the same bits, for a vector of them. A file that includes a law for vectors
 * defines LAW_OF_LANES before.
 *
 *     num              a double, or a vector of them
 *     truth            what comparisons give
 *     NUM(a)           a double as a num
 *     AT(p)            the num at p
 *     ROOT(a)          the square root
 *     OVER(a, b)       a / b
 *     LESS(a, b)       a < b
 *     ANY(t)           whether a comparison holds for any
 *     CHOOSE(t, a, b)  a where t, else b
 *     MOST(a, b)       a where a > b, else b
 *     LAW              the storage class of the functions
 */
#pragma once

#ifdef LAW_OF_LANES
#include "forces/lanes.h"

typedef vec num;
typedef mask truth;
#define NUM(a)          splat(a)
#define AT(p)           load(p)
#define ROOT(a)         root(a)
#define OVER(a, b)      ((a) / (b))
#define LESS(a, b)      ((a) < (b))
#define ANY(t)          any(t)
#define CHOOSE(t, a, b) choose(t, a, b)
#define MOST(a, b)      most(a, b)
#define LAW             INLINE
#elif defined LAW_OF_DUALS
#include <complex.h>
#include <math.h>

typedef double _Complex num;
typedef int truth;
#define NUM(a)          (a)
#define ROOT(a)         dual_root(a)
#define OVER(a, b)      dual_over(a, b)
#define LESS(a, b)      (creal(a) < creal(b))
#define CHOOSE(t, a, b) ((t) ? (a) : (b))
#define LAW             static inline

static inline num dual_of(double value, double derivative)
{
    return value + derivative * _Complex_I;
}

static inline num dual_root(num a) /* of 0: its derivative is left out */
{
    const double root = sqrt(creal(a));
    return dual_of(root, root > 0.0 ? 0.5 * cimag(a) / root : 0.0);
}

static inline num dual_over(num a, num b)
{
    const double per = 1.0 / creal(b), ratio = creal(a) * per;
    return dual_of(ratio, (cimag(a) - ratio * cimag(b)) * per);
}
#else
#include <math.h>

typedef double num;
typedef int truth;
#define NUM(a)          (a)
#define AT(p)           (*(p))
#define ROOT(a)         sqrt(a)
#define OVER(a, b)      ((a) / (b))
#define LESS(a, b)      ((a) < (b))
#define ANY(t)          (t)
#define CHOOSE(t, a, b) ((t) ? (a) : (b))
#define MOST(a, b)      ((a) > (b) ? (a) : (b))
#define LAW             static inline
#endif
