/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/self/orientation.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* ---- expansions ------------------------------------------------------------------ */

/* 48 products of three numbers, each of four doubles. */
enum { MOST = 6 * 8 * 4 };

/* The sum of its parts, which do not overlap and grow; none is 0. */
typedef struct expansion {
    size_t count;
    double part[MOST];
} expansion;

/* a + b = returned + *rest, exactly (Knuth) */
static double two_sum(double a, double b, double *rest)
{
    const double sum = a + b, of_b = sum - a;
    *rest = (a - (sum - of_b)) + (b - of_b);
    return sum;
}

/* a = returned + *rest, of 26 bits each (Veltkamp) */
static double split(double a, double *rest)
{
    const double scaled = 0x1p27 * a + a, high = scaled - (scaled - a);
    *rest = a - high;
    return high;
}

/* a b = returned + *rest, exactly (Dekker) */
static double two_product(double a, double b, double *rest)
{
    const double product = a * b;
    double a0, b0;
    const double a1 = split(a, &a0), b1 = split(b, &b0);
    *rest = a0 * b0 - (((product - a1 * b1) - a0 * b1) - a1 * b0);
    return product;
}

/* Adds one double (Shewchuk's Grow-Expansion, without zeros). */
static void orientation_grow(expansion *sum, double value)
{
    size_t count = 0;
    for (size_t i = 0; i < sum->count; ++i) {
        double rest;
        value = two_sum(value, sum->part[i], &rest);
        sum->part[count] = rest;
        count += rest != 0.0;
    }
    sum->part[count] = value;
    sum->count = count + (value != 0.0);
}

/* Adds sign * x y z. */
static void grow_product(expansion *sum, double sign, double x, double y, double z)
{
    double low, rest;
    const double high = two_product(sign * x, y, &low);
    if (high != 0.0 && z != 0.0) {
        const double of_low = two_product(low, z, &rest);
        orientation_grow(sum, rest);
        orientation_grow(sum, of_low);
        const double of_high = two_product(high, z, &rest);
        orientation_grow(sum, rest);
        orientation_grow(sum, of_high);
    }
}

/* m[row][column] is the sum of a pair of doubles. */
static int exact_sign(double m[3][3][2])
{
    static const size_t permutation[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
                                              { 2, 1, 0 }, { 0, 2, 1 }, { 1, 0, 2 } };
    expansion sum = { .count = 0 };
    for (size_t i = 0; i < 6; ++i) {
        const double *x = m[0][permutation[i][0]], *y = m[1][permutation[i][1]];
        const double *z = m[2][permutation[i][2]];
        for (size_t k = 0; k < 8; ++k) {
            grow_product(&sum, i < 3 ? 1.0 : -1.0, x[k & 1], y[k >> 1 & 1], z[k >> 2]);
        }
    }
    return sum.count == 0 ? 0 : sum.part[sum.count - 1] > 0.0 ? 1 : -1;
}

int weft__orientation(const double a[3], const double b[3], const double c[3],
                      const double d[3])
{
    const double *rows[3] = { a, b, c };
    double m[3][3][2], determinant = 0.0, size = 0.0;
    for (size_t r = 0; r < 3; ++r) {
        for (size_t k = 0; k < 3; ++k) {
            m[r][k][1] = two_sum(rows[r][k], -d[k], &m[r][k][0]);
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        const size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        const double left = m[0][k1][1] * m[1][k2][1],
                     right = m[0][k2][1] * m[1][k1][1];
        determinant += m[2][k][1] * (left - right);
        size += fabs(m[2][k][1]) * (fabs(left) + fabs(right));
    }
    /* Shewchuk's o3derrboundA, and as much again for sums in another order; the last
     * term is for products that underflow. */
    const double bound = 16.0 * 0x1p-53 * size + 0x1p-1000;
    return determinant > bound    ? 1
           : determinant < -bound ? -1
           : size == 0.0          ? 0
                                  : exact_sign(m);
}

/* ---- in one plane, or on one line ------------------------------------------------ */

/* The sign of the area of a, b, c as seen along axis k. */
static int orientation_turn(size_t k, const double a[3], const double b[3],
                            const double c[3])
{
    double flat[4][3];
    const double *points[4] = { a, b, c, c };
    for (size_t i = 0; i < 4; ++i) {
        for (size_t j = 0; j < 3; ++j) {
            flat[i][j] = j == k ? (double)(i == 3) : points[i][j];
        }
    }
    return weft__orientation(flat[0], flat[1], flat[2], flat[3]);
}

/* Along an axis in which the first three that are not on a line are not on one either.
 * false: all are on a line. */
static bool find_view(const double *const *points, size_t count, size_t *axis)
{
    for (size_t i = 2; i < count; ++i) {
        for (size_t j = 1; j < i; ++j) {
            for (size_t k = 0; k < 3; ++k) {
                if (orientation_turn(k, points[0], points[j], points[i]) != 0) {
                    *axis = k;
                    return true;
                }
            }
        }
    }
    return false;
}

/* Whether c is between a and b, on whose line it is. */
static bool orientation_between(const double a[3], const double b[3], const double c[3])
{
    bool is = true;
    for (size_t k = 0; k < 3; ++k) {
        is = is && fmin(a[k], b[k]) <= c[k] && c[k] <= fmax(a[k], b[k]);
    }
    return is;
}

/* Closed segments in a plane that is seen along the axis. */
static bool cross_in(size_t axis, const double p[3], const double q[3],
                     const double a[3], const double b[3])
{
    const int p_side = orientation_turn(axis, a, b, p),
              q_side = orientation_turn(axis, a, b, q);
    const int a_side = orientation_turn(axis, p, q, a),
              b_side = orientation_turn(axis, p, q, b);
    return (p_side * q_side < 0 && a_side * b_side < 0)
           || (p_side == 0 && orientation_between(a, b, p))
           || (q_side == 0 && orientation_between(a, b, q))
           || (a_side == 0 && orientation_between(p, q, a))
           || (b_side == 0 && orientation_between(p, q, b));
}

static bool inside_in(size_t axis, const double p[3], const double a[3],
                      const double b[3], const double c[3])
{
    const int ab = orientation_turn(axis, a, b, p),
              bc = orientation_turn(axis, b, c, p),
              ca = orientation_turn(axis, c, a, p);
    return orientation_turn(axis, a, b, c) != 0
           && ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0));
}

weft__meeting weft__segment_segment(const double p[3], const double q[3],
                                    const double a[3], const double b[3])
{
    const double *const points[4] = { p, q, a, b };
    size_t axis;
    if (weft__orientation(p, q, a, b) != 0) {
        return WEFT__APART;
    }
    const bool meet = find_view(points, 4, &axis)
                          ? cross_in(axis, p, q, a, b)
                          : orientation_between(a, b, p) || orientation_between(a, b, q)
                                || orientation_between(p, q, a);
    return meet ? WEFT__TOUCH : WEFT__APART;
}

weft__meeting weft__segment_triangle(const double p[3], const double q[3],
                                     const double a[3], const double b[3],
                                     const double c[3])
{
    const double *const corners[3] = { a, b, c };
    const int p_side = weft__orientation(a, b, c, p);
    const int q_side = weft__orientation(a, b, c, q);
    size_t axis;
    if (p_side * q_side > 0) {
        return WEFT__APART;
    }
    if (p_side == 0 && q_side == 0) {
        const bool meet
            = weft__segment_segment(p, q, a, b) != WEFT__APART
              || weft__segment_segment(p, q, b, c) != WEFT__APART
              || weft__segment_segment(p, q, c, a) != WEFT__APART
              || (find_view(corners, 3, &axis) && inside_in(axis, p, a, b, c));
        return meet ? WEFT__TOUCH : WEFT__APART;
    }
    const int ab = weft__orientation(p, q, a, b), bc = weft__orientation(p, q, b, c);
    const int ca = weft__orientation(p, q, c, a);
    const int least = ab < bc ? (ab < ca ? ab : ca) : (bc < ca ? bc : ca);
    const int most = ab > bc ? (ab > ca ? ab : ca) : (bc > ca ? bc : ca);
    return least < 0 && most > 0                     ? WEFT__APART
           : least * most > 0 && p_side * q_side < 0 ? WEFT__PIERCE
                                                     : WEFT__TOUCH;
}
