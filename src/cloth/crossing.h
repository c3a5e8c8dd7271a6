/* SPDX-License-Identifier: BSD-3-Clause */
/* crossing.h -- where a cloth passes through itself. */
#ifndef WEFT_CLOTH_CROSSING_H
#define WEFT_CLOTH_CROSSING_H

#include "cloth/orientation.h"
#include "cloth/self_tree.h"

typedef struct weft__crossings {
    size_t count;            /* of weft_cloth_crossings */
    weft_primitive first[2]; /* an edge and a triangle; of a chain: two edges. Or two
                                neighbours at the same place */
    weft__meeting how;       /* of the first */
} weft__crossings;

weft__crossings weft__crossings_of(const weft__tree *tree);

/* "edge (3, 4)-(3, 5) passes through cell (9, 2); 12 such pairs"; count > 0. */
const char *weft__crossings_text(const weft__crossings *found, size_t cols, char *text,
                                 size_t size);

#endif
