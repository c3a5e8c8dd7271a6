/* SPDX-License-Identifier: BSD-3-Clause */
/* shadow.h -- the outline of a cloth as seen from above, along gravity: its largest
 * radius about the origin in each direction. */
#pragma once

#include "weft/weft.h"

typedef struct shadow {
    double axis[2][3]; /* level: x as it is seen from above, and a quarter turn left */
    uint32_t *ends;    /* of all edges */
    size_t count;
} shadow;

/* Axis 0 is the level part of the scene's x, of gravity along x that of y. Errors:
 * WEFT_IO without gravity or triangles, WEFT_NO_MEMORY. Free `ends`. */
weft_status shadow_init(shadow *of, const weft_cloth *cloth, const double gravity[3],
                        weft_error *err);

typedef struct shadow_point {
    double radius;           /* [m] */
    const uint32_t *of;      /* the ends of the edge that is there */
    double derivative[2][3]; /* of the radius by their positions */
} shadow_point;

/* In a direction, the cosine and sine of an angle from axis 0; xyz: positions [m].
 * False: there is no cloth. */
bool shadow_at(const shadow *of, const double *xyz, const double direction[2],
               shadow_point *out);
