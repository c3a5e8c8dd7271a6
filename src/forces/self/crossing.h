/* SPDX-License-Identifier: BSD-3-Clause */
/* crossing.h -- where a cloth passes through itself. */
#ifndef WEFT_FORCES_SELF_CROSSING_H
#define WEFT_FORCES_SELF_CROSSING_H

#include "forces/self/orientation.h"
#include "forces/self/self.h"

typedef struct weft__crossings {
    size_t count;            /* of weft_cloth_crossings */
    weft_primitive first[2]; /* an edge and a triangle; of a chain: two edges. Or two
                                neighbours at the same place */
    weft__meeting how;       /* of the first */
} weft__crossings;

/* Particle `loose` counts as free; SIZE_MAX: none does. */
weft__crossings weft__crossings_of(const weft__quadtree *tree, size_t loose);

/* If a cloth with contact.self passes through itself in a state: WEFT_INVALID, with
 * `where` before "edge (3, 4)-(3, 5) passes through cell (9, 2); 12 such pairs". */
weft_status weft__crossing_error(const weft__self *own, const double *y, size_t loose,
                                 const char *where, weft_error *err);

#endif
