/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/track.h"

#include <float.h>
#include <string.h>

#include "base/finite.h"

static const double *row_of(const weft_track *of, size_t i)
{
    return of->rows + WEFT__TRACK_WIDTH * i;
}

/* How many rows there are at t or before. */
static size_t rows_until(const weft_track *of, double t)
{
    size_t low = 0, high = of->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const bool before = row_of(of, middle)[0] <= t;
        low = before ? middle + 1 : low;
        high = before ? high : middle;
    }
    return low;
}

/* Of column k at row i: h times its rate, h^2 times its second derivative. */
static void slopes(const weft_track *of, size_t i, size_t k, double h, double slope[2])
{
    slope[0] = slope[1] = 0.0;
    if (i > 0 && i + 1 < of->count) {
        const double *a = row_of(of, i - 1), *b = row_of(of, i), *c = row_of(of, i + 1);
        const double before = b[0] - a[0], after = c[0] - b[0];
        const double left = (b[k] - a[k]) / before, right = (c[k] - b[k]) / after;
        slope[0] = h * (after * left + before * right) / (before + after);
        slope[1] = h * h * 2.0 * (right - left) / (before + after);
    }
}

void weft__track_at(const weft_track *of, double t, double value[3][3])
{
    const size_t until = rows_until(of, t), i = until > 0 ? until - 1 : 0;
    const double *a = row_of(of, i), *b = a + WEFT__TRACK_WIDTH;
    memcpy(value[0], a + 1, sizeof value[0]);
    memset(value[1], 0, 2 * sizeof value[1]);
    for (size_t k = 1; until > 0 && until < of->count && k < WEFT__TRACK_WIDTH; ++k) {
        const double h = b[0] - a[0], s = (t - a[0]) / h;
        double from[2], to[2];
        slopes(of, i, k, h, from);
        slopes(of, i + 1, k, h, to);
        const double c1 = from[0], c2 = 0.5 * from[1];
        /* what is left of the end for s^3, s^4 and s^5 */
        const double p = b[k] - a[k] - c1 - c2, q = to[0] - c1 - from[1];
        const double r = to[1] - from[1];
        const double c3 = 10.0 * p - 4.0 * q + 0.5 * r, c4 = 7.0 * q - 15.0 * p - r;
        const double c5 = 6.0 * p - 3.0 * q + 0.5 * r;
        value[0][k - 1] += s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))));
        value[1][k - 1]
            = (c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5))))
              / h;
        value[2][k - 1]
            = (2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h);
    }
}

double weft__track_next(const weft_track *of, double t, double t_end)
{
    const double apart = 16.0 * DBL_EPSILON * fmax(fabs(t), fabs(t_end));
    const size_t i = rows_until(of, t + apart);
    return i < of->count && row_of(of, i)[0] < t_end - apart ? row_of(of, i)[0] : t_end;
}

const char *weft__track_fault(const weft_track *of, size_t *row)
{
    *row = 0;
    if (of->count > 0 && of->rows == NULL) {
        return "is NULL, but the number of rows is not 0";
    }
    for (; *row < of->count; ++*row) {
        const double *b = row_of(of, *row), *a = *row > 0 ? b - WEFT__TRACK_WIDTH : b;
        const double h = b[0] - a[0];
        bool far = !isfinite(h * h);
        for (size_t k = 1; h > 0.0 && k < WEFT__TRACK_WIDTH; ++k) {
            far = far || !isfinite((b[k] - a[k]) / h / h);
        }
        if (!weft__all_finite(b, WEFT__TRACK_WIDTH)) {
            return "has a number that is not finite";
        }
        if (far || (*row > 0 && !(h > 0.0))) {
            return far ? "is too far from the row before for a double"
                       : "must have a later time than the row before";
        }
    }
    return NULL;
}
