/* SPDX-License-Identifier: BSD-3-Clause */
/* part.h -- which of several parts has an item; parts follow one another. */
#pragma once

#include <stddef.h>

/* Defines a function: the number of the part of item i, by the members `parts`, each
 * with its `first`, and `part_count` of a struct; 0 if that is 0. */
#define WEFT__PART_OF(function, type)                                                  \
    static inline size_t function(const type *of, size_t i)                            \
    {                                                                                  \
        size_t part = 0;                                                               \
        while (part + 1 < of->part_count && i >= of->parts[part + 1].first) {          \
            ++part;                                                                    \
        }                                                                              \
        return part;                                                                   \
    }
