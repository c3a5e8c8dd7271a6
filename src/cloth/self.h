/* SPDX-License-Identifier: BSD-3-Clause */
/* self.h -- the primitives of a cloth for contact with itself, and pairs of them.
 *
 * Node (r, c) owns its particle, the edges to the right and down, the diagonal
 * (r, c + 1)-(r + 1, c) and the two triangles that it makes of the cell, as far as the
 * grid has them: each primitive has one owner, and each pair of primitives one pair of
 * nodes. The formulas are in docs/physics.md. */
#ifndef WEFT_CLOTH_SELF_H
#define WEFT_CLOTH_SELF_H

#include "cloth/model.h"

/* Both return their number, 0 to 3 and 0 or 2. */
static inline size_t weft__node_edges(const weft_cloth *cloth, size_t i,
                                      uint32_t edges[3][2])
{
    const size_t cols = cloth->cols, right = i % cols + 1 < cols;
    const size_t down = i + cols < cloth->particles;
    const uint32_t here = (uint32_t)i, below = (uint32_t)(i + cols);
    size_t count = 0;
    if (right) {
        edges[count][0] = here, edges[count][1] = here + 1;
        ++count;
    }
    if (down) {
        edges[count][0] = here, edges[count][1] = below;
        ++count;
    }
    if (right && down) {
        edges[count][0] = here + 1, edges[count][1] = below;
        ++count;
    }
    return count;
}

static inline size_t weft__node_triangles(const weft_cloth *cloth, size_t i,
                                          uint32_t triangles[2][3])
{
    const size_t cols = cloth->cols;
    if (i % cols + 1 >= cols || i + cols >= cloth->particles) {
        return 0;
    }
    const uint32_t here = (uint32_t)i, below = (uint32_t)(i + cols);
    triangles[0][0] = here, triangles[0][1] = below, triangles[0][2] = here + 1;
    triangles[1][0] = below + 1, triangles[1][1] = here + 1, triangles[1][2] = below;
    return 2;
}

#endif
