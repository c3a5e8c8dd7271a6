/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/track.h"

#include <string.h>

static const double *row_of(const weft__curve *of, size_t i)
{
    return of->rows + WEFT__CURVE_WIDTH * i;
}

/* How many rows are met at t. */
static size_t rows_until(const weft__curve *of, double t)
{
    size_t low = 0, high = of->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const bool before = weft__row_met(row_of(of, middle)[0], t);
        low = before ? middle + 1 : low;
        high = before ? high : middle;
    }
    return low;
}

void weft__curve_at(const weft__curve *of, double t, double piece, double value[3][3])
{
    const size_t until = rows_until(of, piece), i = until > 0 ? until - 1 : 0;
    const double *a = row_of(of, i), *b = a + WEFT__CURVE_WIDTH;
    memcpy(value[0], a + 1, sizeof value[0]);
    memset(value[1], 0, 2 * sizeof value[1]);
    for (size_t k = 1; until > 0 && until < of->count && k < WEFT__TRACK_WIDTH; ++k) {
        const double h = b[0] - a[0], s = (t - a[0]) / h, d = b[k] - a[k];
        const double c1 = h * a[k + 3], end = h * b[k + 3];
        const double c2 = 3.0 * d - 2.0 * c1 - end, c3 = c1 + end - 2.0 * d;
        value[0][k - 1] += s * (c1 + s * (c2 + s * c3));
        value[1][k - 1] = (c1 + s * (2.0 * c2 + s * (3.0 * c3))) / h;
        value[2][k - 1] = (2.0 * c2 + s * (6.0 * c3)) / (h * h);
    }
}

void weft__curve_bounds(const weft__curve *of, double t, weft__piece_bounds *to)
{
    const size_t i = rows_until(of, t);
    to->first = fmax(to->first, i > 0 ? row_of(of, i - 1)[0] : -DBL_MAX);
    to->last = fmin(to->last, i < of->count ? row_of(of, i)[0] : DBL_MAX);
}
