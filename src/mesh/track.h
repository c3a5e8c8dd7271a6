/* SPDX-License-Identifier: BSD-3-Clause */
/* track.h -- the law of a weft_track, of paths of pins and of wind: between two rows a
 * polynomial of degree 5 that has at each row the velocity and the acceleration of the
 * parabola through this row and its neighbours, and none at the first and the last. So
 * it has two continuous derivatives everywhere, depends on four rows only, and is
 * constant before the first row and after the last. Steps end at rows
 * (weft__track_next): within each step it is smooth, and methods keep their order. */
#pragma once

#include "weft/cloth.h"

enum { WEFT__TRACK_WIDTH = 4 }; /* numbers of a row */

/* The vector at time t [s], its derivative and the second one. */
void weft__track_at(const weft_track *track, double t, double value[3][3]);

/* The first time of a row within (t, t_end), as far as doubles tell them apart; else
 * t_end. */
double weft__track_next(const weft_track *track, double t, double t_end);

/* What is wrong, with the number of the row; NULL: nothing. */
const char *weft__track_fault(const weft_track *track, size_t *row);
