/* SPDX-License-Identifier: BSD-3-Clause */
/* dense.h -- small dense matrices, row by row. */
#pragma once

#include <math.h>
#include <stddef.h>
#include <string.h>

/* c (m x n) += s a (m x k) b (k x n) */
static inline void weft__dense_add(size_t m, size_t k, size_t n, double s,
                                   const double *a, const double *b, double *c)
{
    for (size_t i = 0; i < m; ++i) {
        for (size_t l = 0; l < k; ++l) {
            const double f = s * a[i * k + l];
            for (size_t j = 0; j < n; ++j) {
                c[i * n + j] += f * b[l * n + j];
            }
        }
    }
}

/* c (m x n) += a^T b, of a (k x m) and b (k x n) */
static inline void weft__dense_add_turned(size_t k, size_t m, size_t n, const double *a,
                                          const double *b, double *c)
{
    for (size_t l = 0; l < k; ++l) {
        for (size_t i = 0; i < m; ++i) {
            const double f = a[l * m + i];
            for (size_t j = 0; j < n; ++j) {
                c[i * n + j] += f * b[l * n + j];
            }
        }
    }
}

/* The lower factor L of a = L L^T, in place, with 0 above it. A row without a pivot has
 * an infinite one, so that its unknown is 0. */
static inline void weft__dense_factorise(size_t n, double *a)
{
    for (size_t i = 0; i < n; ++i) {
        const double whole = a[i * n + i];
        for (size_t j = 0; j <= i; ++j) {
            double sum = a[i * n + j];
            for (size_t k = 0; k < j; ++k) {
                sum -= a[i * n + k] * a[j * n + k];
            }
            a[i * n + j] = j < i                 ? sum / a[j * n + j]
                           : sum > 1e-10 * whole ? sqrt(sum)
                                                 : (double)INFINITY;
        }
        for (size_t j = i + 1; j < n; ++j) {
            a[i * n + j] = 0.0;
        }
    }
}

/* x = L^-1 b, then x = (L L^T)^-1 b; x may be b. */
static inline void weft__dense_solve_lower(size_t n, const double *l, const double *b,
                                           double *x)
{
    for (size_t i = 0; i < n; ++i) {
        double sum = b[i];
        for (size_t k = 0; k < i; ++k) {
            sum -= l[i * n + k] * x[k];
        }
        x[i] = sum / l[i * n + i];
    }
}

static inline void weft__dense_solve(size_t n, const double *l, const double *b,
                                     double *x)
{
    weft__dense_solve_lower(n, l, b, x);
    for (size_t i = n; i-- > 0;) {
        double sum = x[i];
        for (size_t k = i + 1; k < n; ++k) {
            sum -= l[k * n + i] * x[k];
        }
        x[i] = sum / l[i * n + i];
    }
}
