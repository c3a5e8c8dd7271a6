/* SPDX-License-Identifier: BSD-3-Clause */
/* track.h -- the law of a weft_table (docs/theory/model.md): between two rows each
 * component is a polynomial of degree 3, with one continuous derivative everywhere; at
 * rest before the first row and after the last.
 *
 * The second derivative jumps at a row. So a step ends there, and all that a method
 * evaluates for a step, also at its ends and outside of it, takes the polynomial of the
 * interval in which the step lies, its piece. A piece is named by any time in it. */
#pragma once

#include <float.h>
#include <math.h>

#include "weft/cloth.h"

enum {
    WEFT__TRACK_WIDTH = 4, /* numbers of a row: t, vector */
    WEFT__CURVE_WIDTH = 8  /* and its slope; the last is room for weft__curve_make */
};

/* A track with the slopes at its rows. */
typedef struct weft__curve {
    const double *rows;
    size_t count;
    bool jumps; /* its slope, at the first and the last row: a natural spline */
} weft__curve;

/* Whether a row or a key at `row` [s] is at t or before, which roundoff does not
 * decide. */
static inline bool weft__row_met(double row, double t)
{
    return row - t <= 16.0 * DBL_EPSILON * fmax(fabs(row), fabs(t));
}

/* The vector at t [s], its derivative and the second one, by the polynomial of the
 * interval that `piece` [s] lies in or begins. */
void weft__curve_at(const weft__curve *of, double t, double piece, double value[3][3]);

/* [s] The last row that is met, and the first that is not, of some curves and bodies;
 * -DBL_MAX, DBL_MAX: there is none. */
typedef struct weft__piece_bounds {
    double first, last;
} weft__piece_bounds;

/* Keeps those at t that are nearer to t than the bounds are. */
void weft__curve_bounds(const weft__curve *of, double t, weft__piece_bounds *to);

/* ---- track_def.c ----------------------------------------------------------------- */

/* What is wrong with a track, with the number of the row; NULL: nothing. */
const char *weft__track_fault(const weft_table *of, size_t *row);

/* Writes the rows of a track without faults, with slopes, to rows[WEFT__CURVE_WIDTH
 * count]: those of F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984),
 * by which no component leaves the range of its two rows; or of the natural spline. */
weft__curve weft__curve_make(const weft_table *of, bool natural, double *rows);
