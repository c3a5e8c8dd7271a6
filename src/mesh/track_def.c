/* SPDX-License-Identifier: BSD-3-Clause */
/* track_def.c -- a track as it is defined: its faults, and the slopes at its rows. */
#include <string.h>

#include "base/finite.h"
#include "mesh/track.h"

const char *weft__track_fault(const weft_table *of, size_t *row)
{
    *row = 0;
    if (of->count > 0 && of->rows == NULL) {
        return "is NULL, but the number of rows is not 0";
    }
    for (; *row < of->count; ++*row) {
        const double *b = of->rows + WEFT__TRACK_WIDTH * *row;
        const double *a = *row > 0 ? b - WEFT__TRACK_WIDTH : b;
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

/* Of intervals that are h and H long, with the slopes d and D of their chords. */
static double monotone(double h, double H, double d, double D)
{
    const double w1 = 2.0 * H + h, w2 = H + 2.0 * h;
    return (d > 0.0 && D > 0.0) || (d < 0.0 && D < 0.0) ? (w1 + w2) / (w1 / d + w2 / D)
                                                        : 0.0;
}

/* The slope of the chord from row a to row b, of component k. */
static double chord(const double *a, const double *b, size_t k)
{
    return (b[k] - a[k]) / (b[0] - a[0]);
}

/* Those of the natural spline: at inner rows the second derivative is continuous, so
 * that H m_(i-1) + 2 (h + H) m_i + h m_(i+1) = 3 (H d + h D); at both ends it is 0: 2 m
 * + the slope beside = 3 times the chord's. The last number of a row is what
 * elimination leaves as the factor of m_(i+1). */
static void make_natural(double *rows, size_t count)
{
    enum { WIDTH = WEFT__CURVE_WIDTH, FACTOR = WIDTH - 1 };
    for (size_t i = 0; i < count; ++i) {
        double *b = rows + WIDTH * i;
        const bool first = i == 0, last = i + 1 == count;
        const double *a = first ? b : b - WIDTH, *c = last ? b : b + WIDTH;
        const double h = first ? 0.0 : last ? 1.0 : b[0] - a[0];
        const double H = last ? 0.0 : first ? 1.0 : c[0] - b[0];
        const double before = last ? 1.0 : H, after = first ? 1.0 : h;
        const double pivot = 1.0 / (2.0 * (h + H) - (first ? 0.0 : before * a[FACTOR]));
        b[FACTOR] = last ? 0.0 : after * pivot;
        for (size_t k = 1; k < WEFT__TRACK_WIDTH; ++k) {
            const double right = 3.0
                                 * (first  ? chord(b, c, k)
                                    : last ? chord(a, b, k)
                                           : H * chord(a, b, k) + h * chord(b, c, k));
            b[k + 3] = (right - (first ? 0.0 : before * a[k + 3])) * pivot;
        }
    }
    for (size_t i = count - 1; i-- > 0;) {
        double *b = rows + WIDTH * i;
        for (size_t k = 4; k < FACTOR; ++k) {
            b[k] -= b[FACTOR] * b[WIDTH + k];
        }
    }
}

static void make_monotone(double *rows, size_t count)
{
    for (size_t i = 1; i + 1 < count; ++i) {
        double *b = rows + WEFT__CURVE_WIDTH * i;
        const double *a = b - WEFT__CURVE_WIDTH, *c = b + WEFT__CURVE_WIDTH;
        for (size_t k = 1; k < WEFT__TRACK_WIDTH; ++k) {
            b[k + 3]
                = monotone(b[0] - a[0], c[0] - b[0], chord(a, b, k), chord(b, c, k));
        }
    }
}

weft__curve weft__curve_make(const weft_table *of, bool natural, double *rows)
{
    memset(rows, 0, WEFT__CURVE_WIDTH * of->count * sizeof *rows);
    for (size_t i = 0; i < of->count; ++i) {
        memcpy(rows + WEFT__CURVE_WIDTH * i, of->rows + WEFT__TRACK_WIDTH * i,
               WEFT__TRACK_WIDTH * sizeof *rows);
    }
    if (natural && of->count > 1) {
        make_natural(rows, of->count);
    } else {
        make_monotone(rows, of->count);
    }
    return (weft__curve){ of->count > 0 ? rows : NULL, of->count, natural };
}
