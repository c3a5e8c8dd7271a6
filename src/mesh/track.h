/* SPDX-License-Identifier: BSD-3-Clause */
/* track.h -- the law of a weft_track (docs/physics.md): between two rows a polynomial
 * of degree 5, with two continuous derivatives everywhere. Steps end at rows, so that
 * within each step it is smooth and methods keep their order. */
#pragma once

#include "weft/cloth.h"

enum { WEFT__TRACK_WIDTH = 4 }; /* numbers of a row */

/* The vector at time t [s], its derivative and the second one. */
void weft__track_at(const weft_track *of, double t, double value[3][3]);

/* The first time of a row within (t, t_end), or t_end. */
double weft__track_next(const weft_track *of, double t, double t_end);

/* What is wrong, with the number of the row; NULL: nothing. */
const char *weft__track_fault(const weft_track *of, size_t *row);
