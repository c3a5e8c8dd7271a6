/* SPDX-License-Identifier: BSD-3-Clause */
/* plane.h -- points in the plane, and the ends of edges between them. */
#pragma once

#include <stdint.h>

/* Twice the area of a triangle, > 0 if its corners lie counterclockwise. */
static inline double weft__plane_turn(const double a[2], const double b[2],
                                      const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Square of the distance. */
static inline double weft__squared(const double a[2], const double b[2])
{
    return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

/* Of an edge, the lower one first, and its number. */
typedef struct weft__ends {
    uint32_t low, high, number;
} weft__ends;

static inline weft__ends weft__ends_of(uint32_t a, uint32_t b, uint32_t number)
{
    return a < b ? (weft__ends){ a, b, number } : (weft__ends){ b, a, number };
}

/* For qsort, of uint32_t. */
static inline int weft__ascending(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* For qsort and bsearch; the number does not count. */
static inline int weft__compare_ends(const void *a, const void *b)
{
    const weft__ends *x = (const weft__ends *)a, *y = (const weft__ends *)b;
    return x->low != y->low ? (x->low > y->low) - (x->low < y->low)
                            : (x->high > y->high) - (x->high < y->high);
}
