/* SPDX-License-Identifier: BSD-3-Clause */
/* limit_springs.h -- the springs under a strain limit, for src/sim. x[3 N] are
 * positions in planes; a spring is loose if an end of it is not pinned. */
#ifndef WEFT_CLOTH_LIMIT_SPRINGS_H
#define WEFT_CLOTH_LIMIT_SPRINGS_H

#include "weft/cloth.h"

typedef struct weft__limited {
    const weft_cloth *cloth;
    double stretch;   /* 1 + strain: the length allowed, in rest lengths */
    double tolerance; /* relative, of that */
    bool families[WEFT_FAMILIES];
} weft__limited;

/* One pass of Gauss-Seidel: springs longer than allowed become as long as allowed, one
 * after another. Particle by particle within a family, both its springs in turn; the
 * ends share by inverse mass. Where a length is 0 or no number nothing is done. */
void weft__limited_sweep(const weft__limited *limited, double *x);

/* Whether no loose spring exceeds the tolerance. NaN is too long. */
bool weft__limited_met(const weft__limited *limited, const double *x);

/* Springs that exceed the tolerance and have both ends pinned. */
size_t weft__limited_held(const weft__limited *limited, const double *x);

/* As weft_cloth_worst_spring, of the limited springs in state y[6 N] (measure.c). */
weft_spring weft__limited_worst(const weft__limited *limited, const double *y);

#endif
