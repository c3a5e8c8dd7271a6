/* SPDX-License-Identifier: BSD-3-Clause */
/* limit_springs.h -- the springs under a strain limit, for src/sim. x[3 N] are
 * positions in planes. */
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

/* Springs that exceed the tolerance, those with both ends pinned or the others; looks
 * at no further row where there are `most`. NaN is too long. */
size_t weft__limited_excess(const weft__limited *limited, bool held, size_t most,
                            const double *x);

#endif
