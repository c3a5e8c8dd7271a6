/* SPDX-License-Identifier: BSD-3-Clause */
#include "cloth/self.h"

#include <stdio.h>

const char *weft_primitive_text(const weft_primitive *primitive, size_t cols,
                                char *text, size_t size)
{
    const size_t *i = primitive->particle;
    size_t r[3] = { 0 }, c[3] = { 0 };
    for (size_t k = 0; k < primitive->count; ++k) {
        r[k] = i[k] / cols, c[k] = i[k] % cols;
    }
    if (primitive->count == 1) {
        (void)snprintf(text, size, "particle (%zu, %zu)", r[0], c[0]);
    } else if (primitive->count == 2) {
        (void)snprintf(text, size, "edge (%zu, %zu)-(%zu, %zu)", r[0], c[0], r[1],
                       c[1]);
    } else {
        const size_t top = r[0] < r[1] ? r[0] : r[1], left = c[0] < c[1] ? c[0] : c[1];
        (void)snprintf(text, size, "cell (%zu, %zu)", top < r[2] ? top : r[2],
                       left < c[2] ? left : c[2]);
    }
    return text;
}
