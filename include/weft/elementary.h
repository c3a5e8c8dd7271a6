/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/elementary.h -- a power, and sine and cosine of a phase, with the same bits on
 * every machine: for step sizes and prescribed motions, in weft and in its plugins.
 *
 * libm's rounding of these functions is not standardised: libraries differ in the last
 * bit, and glibc differs between processors with and without fused multiply-add. The
 * functions below use + - * / of IEEE 754 binary64, and frexp, ldexp, rint and fabs,
 * which are exact in every libm. They need rounding to nearest and no contraction: use
 * gcc's -ffp-contract=off.
 *
 * Numbers of more than 53 bits are pairs hi + lo, |lo| <= ulp(hi) / 2: sums and
 * products after T. J. Dekker, Numer. Math. 18 (1971), D. E. Knuth, The Art of Computer
 * Programming 2, 4.2.2, and M. Joldes, J.-M. Muller, V. Popescu, ACM TOMS 44 (2017),
 * algorithms 5 and 10. Leading terms of the series are pairs, the others doubles. */
#ifndef WEFT_ELEMENTARY_H
#define WEFT_ELEMENTARY_H

#include <float.h>
#include <math.h>

#if FLT_EVAL_METHOD < 0 || FLT_EVAL_METHOD > 1 || defined(__FAST_MATH__)
#error "weft/elementary.h needs IEEE 754 arithmetic: no x87 registers, no -ffast-math"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* hi + lo. This type and its functions serve the two functions at the end. */
typedef struct weft_pair {
    double hi, lo;
} weft_pair;

/** Adds two doubles exactly.
 * @param a finite
 * @param b finite
 * @return a + b */
static inline weft_pair weft_pair_sum(double a, double b)
{
    const double s = a + b, t = s - a;
    const weft_pair sum = { s, (a - (s - t)) + (b - t) };
    return sum;
}

/** Multiplies two doubles exactly.
 * @param a |a| < 2^996
 * @param b |b| < 2^996, and 2^-969 < |a b| < 2^996
 * @return a b */
static inline weft_pair weft_pair_product(double a, double b)
{
    const double split = 134217729.0 /* 2^27 + 1 */, p = a * b;
    const double ah = split * a - (split * a - a), al = a - ah;
    const double bh = split * b - (split * b - b), bl = b - bh;
    const weft_pair product = { p, ((ah * bh - p) + ah * bl + al * bh) + al * bl };
    return product;
}

/** Adds two pairs.
 * @param a finite
 * @param b finite
 * @return a + b, with an error below 2^-104 (|a| + |b|) */
static inline weft_pair weft_pair_add(weft_pair a, weft_pair b)
{
    const weft_pair s = weft_pair_sum(a.hi, b.hi);
    return weft_pair_sum(s.hi, s.lo + (a.lo + b.lo));
}

/** Multiplies two pairs.
 * @param a finite
 * @param b finite
 * @return a b, with an error below 2^-103 |a b| */
static inline weft_pair weft_pair_mul(weft_pair a, weft_pair b)
{
    const weft_pair p = weft_pair_product(a.hi, b.hi);
    return weft_pair_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

/** Returns ln 2 as a pair.
 * @return ln 2 */
static inline weft_pair weft_pair_ln2(void)
{
    const weft_pair ln2 = { 0.69314718055994529, 2.3190468138462996e-17 };
    return ln2;
}

/** Computes a logarithm: x = 2^e m, m within a factor sqrt(2) of 1, and
 *
 *     ln m = 2 s (1 + z/3 + z^2/5 + ...),  s = (m - 1) / (m + 1),  z = s^2 < 0.0295
 *
 * @param x 0 < x < infinity
 * @return ln x */
static inline weft_pair weft_pair_log(double x)
{
    const weft_pair odd[3] = { { 1.0, 0.0 },
                               { 0.33333333333333331, 1.850371707708594e-17 },
                               { 0.20000000000000001, -1.1102230246251566e-17 } };
    int e;
    double m = frexp(x, &e), tail = 0.0;
    if (m < 0.70710678118654752) {
        m *= 2.0;
        --e;
    }
    const weft_pair below = weft_pair_sum(m, 1.0);
    const double q = (m - 1.0) / below.hi; /* m - 1 is exact, and so is the remainder */
    const weft_pair back = weft_pair_product(q, below.hi);
    const double rest = (m - 1.0 - back.hi) - back.lo - q * below.lo;
    const weft_pair s = weft_pair_sum(q, rest / below.hi);
    const weft_pair z = weft_pair_mul(s, s), twice = { 2.0 * s.hi, 2.0 * s.lo };
    for (int k = 27; k > 5; k -= 2) {
        tail = tail * z.hi + 1.0 / k;
    }
    weft_pair sum = { tail, 0.0 };
    for (int i = 2; i >= 0; --i) {
        sum = weft_pair_add(weft_pair_mul(sum, z), odd[i]);
    }
    const weft_pair exponent = { (double)e, 0.0 };
    return weft_pair_add(weft_pair_mul(exponent, weft_pair_ln2()),
                         weft_pair_mul(sum, twice));
}

/** Computes an exponential: 2^k (e^u)^64 with u = (t - k ln 2) / 64, |u| < 0.0055, and
 *
 *     e^u = 1 + u (1 + u/2 (1 + u/3 (1 + ...)))
 *
 * @param t |t| < 750
 * @return e^t */
static inline double weft_pair_exp(weft_pair t)
{
    const weft_pair one = { 1.0, 0.0 }, ln2 = weft_pair_ln2();
    const double k = rint(t.hi / ln2.hi);
    const weft_pair less = { -k, 0.0 };
    const weft_pair r = weft_pair_add(t, weft_pair_mul(less, ln2));
    const weft_pair u = { r.hi / 64.0, r.lo / 64.0 }, half = { 0.5 * u.hi, 0.5 * u.lo };
    double tail = 0.0;
    for (int n = 9; n > 2; --n) {
        tail = (1.0 + tail) * (u.hi / n);
    }
    weft_pair sum = weft_pair_mul(weft_pair_sum(1.0, tail), half);
    sum = weft_pair_add(one, weft_pair_mul(weft_pair_add(one, sum), u));
    for (int i = 0; i < 6; ++i) {
        sum = weft_pair_mul(sum, sum);
    }
    return ldexp(sum.hi, (int)k);
}

/** Computes a power. Zeros, infinities and NaN give the results of pow. At 1e6 points
 * the result was the double nearest to x^y each time; below DBL_MIN the last bit may be
 * wrong.
 * @param x >= 0; x < 0 gives NaN for every y but 0
 * @param y any number
 * @return x^y, with the same bits on every machine */
static inline double weft_pow(double x, double y)
{
    if (x == 1.0 || y == 0.0) {
        return 1.0;
    }
    if (!(x >= 0.0 && y == y)) {
        return NAN;
    }
    const double limit = (x > 1.0) == (y > 0.0) ? INFINITY : 0.0;
    if (x == 0.0 || isinf(x) || isinf(y)) {
        return limit;
    }
    const weft_pair log = weft_pair_log(x), exponent = { y, 0.0 };
    if (fabs(log.hi * y) > 746.0) {
        return limit;
    }
    return weft_pair_exp(weft_pair_mul(log, exponent));
}

/** Computes sin(2 pi f t) and cos(2 pi f t). The phase f t, its distance from the
 * nearest integer and that from the nearest quarter are exact, so that the accuracy
 * does not decay with t: Taylor's series see an angle of at most pi / 4. Errors at 1e6
 * points: at most 0.77 ulp; absolute ones of 1e-290 at most where |f t| < 1e-290.
 * @param f [Hz]; |f|, |t| and |f t| < 2^990, else the results are NaN
 * @param t [s]
 * @param[out] sine may not be NULL
 * @param[out] cosine may not be NULL */
static inline void weft_sincos_turns(double f, double t, double *sine, double *cosine)
{
    const weft_pair two_pi = { 6.2831853071795862, 2.4492935982947064e-16 };
    const weft_pair p = weft_pair_product(f, t);
    const weft_pair x = weft_pair_sum(p.hi - rint(p.hi), p.lo - rint(p.lo));
    const double q = rint(4.0 * x.hi);
    const weft_pair a = weft_pair_mul(weft_pair_sum(x.hi - 0.25 * q, x.lo), two_pi);
    const weft_pair z = weft_pair_mul(a, a), less = weft_pair_sum(1.0, -0.5 * z.hi);
    double s = 0.0, c = 0.0;
    for (int k = 18; k > 2;
         k -= 2) { /* -z/20 (1 - z/42 (...)), -z/12 (1 - z/30 (...)) */
        s = (1.0 + s) * (-z.hi / (k * (k + 1)));
        c = (1.0 + c) * (-z.hi / (k * (k - 1)));
    }
    s = a.hi + (a.lo - a.hi * (z.hi / 6.0 * (1.0 + s)));
    c = less.hi + (less.lo - 0.5 * z.lo - 0.5 * z.hi * c);
    const double turned[5] = { s, c, -s, -c, s };
    const int quarter = q == q ? (int)q & 3 : 0;
    *sine = turned[quarter];
    *cosine = turned[quarter + 1];
}

#ifdef __cplusplus
}
#endif

#endif
