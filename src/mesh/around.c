/* SPDX-License-Identifier: BSD-3-Clause */
/* around.c -- which triangles a particle has. */
#include <string.h>

#include "mesh/triangles.h"

void weft__around_fill(weft__triangles *of, size_t particles)
{
    uint32_t *first = of->around_first;
    memset(first, 0, (particles + 1) * sizeof *first);
    for (size_t j = 0; j < 3 * of->count; ++j) {
        ++first[of->corner[j / 3][j % 3]];
    }
    for (size_t i = 0; i < particles; ++i) {
        first[i + 1] += first[i];
    }
    for (size_t j = 3 * of->count; j-- > 0;) { /* from the end of each particle's */
        of->around[--first[of->corner[j / 3][j % 3]]] = (uint32_t)(j / 3);
    }
}

/* Whether triangle t has no corner in [first, i). */
static bool met_first(const weft__triangles *of, size_t t, size_t first, size_t i)
{
    bool met = false;
    for (size_t k = 0; k < 3; ++k) {
        met = met || (of->corner[t][k] >= first && of->corner[t][k] < i);
    }
    return !met;
}

size_t weft__triangles_among(const weft__triangles *of, size_t first, size_t end,
                             uint32_t *list)
{
    size_t count = 0;
    for (size_t i = first; i < end; ++i) {
        for (size_t j = of->around_first[i]; j < of->around_first[i + 1]; ++j) {
            if (met_first(of, of->around[j], first, i)) {
                if (list != NULL) {
                    list[count] = of->around[j];
                }
                ++count;
            }
        }
    }
    return count;
}
