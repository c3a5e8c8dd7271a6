/* SPDX-License-Identifier: BSD-3-Clause */
#include "filter.h"

#include <math.h>

#include "vectors.h"

WIDE static void filter_springs(double *planes, size_t count)
{
    double *rest = planes + 3 * count, *q = planes + 4 * count;
    ELEMENTWISE
    for (size_t i = 0; i < count; ++i) {
        const double k = rest[i] + q[i];
        const double least = q[i] > 0.0 ? q[i] : 0.0;
        q[i] = least < k ? least : k;
        rest[i] = k - q[i];
    }
}

void weft__filter_springs(double *planes, size_t count)
{
    filter_springs(planes, count);
}

/* One rotation of Jacobi's method, which makes a[p][q] 0 (Golub, Van Loan, Matrix
 * Computations, 4th ed., algorithm 8.5.1); v collects the eigenvectors in columns. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
    if (a[p][q] == 0.0) {
        return;
    }
    const double tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    const double root = sqrt(1.0 + tau * tau);
    const double t = tau >= 0.0 ? 1.0 / (tau + root) : -1.0 / (root - tau);
    const double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    for (int k = 0; k < 3; ++k) {
        const double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for (int k = 0; k < 3; ++k) {
        const double pk = a[p][k], qk = a[q][k], vp = v[k][p], vq = v[k][q];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        v[k][p] = c * vp - s * vq;
        v[k][q] = s * vp + c * vq;
    }
    a[p][q] = a[q][p] = 0.0;
}

enum { SWEEPS = 6 }; /* the convergence is quadratic */

/* Drops negative eigenvalues. */
static void drop_negative(double a[3][3])
{
    double v[3][3] = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } };
    double d[3][3];
    memcpy(d, a, sizeof d);
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        rotate(d, v, 0, 1);
        rotate(d, v, 0, 2);
        rotate(d, v, 1, 2);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            a[i][j] = 0.0;
            for (int k = 0; k < 3; ++k) {
                a[i][j] += d[k][k] > 0.0 ? d[k][k] * v[i][k] * v[j][k] : 0.0;
            }
        }
    }
}

/* Whether no eigenvalue is negative, because no principal minor is. Roundoff makes
 * those of a block without full rank negative by some 1e-16 of the product of its
 * diagonal; ten times that is allowed, so that no eigenvalue is below -2e-8 of the
 * largest entry of the diagonal. NaN: no. */
static bool is_not_negative(double a[3][3])
{
    const double least = -1e-15;
    const double x = a[0][0], y = a[1][1], z = a[2][2];
    const double xy = x * y - a[0][1] * a[0][1];
    const double xz = x * z - a[0][2] * a[0][2];
    const double yz = y * z - a[1][2] * a[1][2];
    const double all = x * yz - a[0][1] * (a[0][1] * z - a[1][2] * a[0][2])
                       + a[0][2] * (a[0][1] * a[1][2] - y * a[0][2]);
    return x >= 0.0 && y >= 0.0 && z >= 0.0 && xy >= least * (x * y)
           && xz >= least * (x * z) && yz >= least * (y * z)
           && all >= least * (x * y * z);
}

void weft__filter_blocks(double *blocks, size_t n)
{
    for (size_t i = 0; i < n; ++i) {
        double *k = blocks + i, a[3][3], any = 0.0;
        for (size_t j = 0; j < 9; ++j) {
            const double entry = 0.5 * (k[j * n] + k[(j % 3 * 3 + j / 3) * n]);
            a[j / 3][j % 3] = entry;
            any += fabs(entry);
        }
        if (any > 0.0 && !is_not_negative(a)) {
            drop_negative(a);
        }
        k[0] = a[0][0];
        k[n] = a[0][1];
        k[2 * n] = a[0][2];
        k[3 * n] = a[1][1];
        k[4 * n] = a[1][2];
        k[5 * n] = a[2][2];
    }
}
