/* SPDX-License-Identifier: BSD-3-Clause */
/* triangles_work.c -- memory and faults of a mesh in the making, and the curve along
 * which its particles lie. */
#include "mesh/triangles_work.h"

#include <stdarg.h>
#include <stdio.h>

#include "base/memory.h"

void *weft__work_take(weft__work *at, size_t count, size_t size)
{
    void *block = at->no_memory ? NULL : weft__zeroed(at->memory, count, size);
    at->no_memory = at->no_memory || block == NULL;
    at->failed = at->failed || at->no_memory;
    return block;
}

void weft__mesh_fault(weft__work *at, weft__mesh_part part, size_t index,
                      const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    at->failed = true;
    at->to->found(at->to->ctx, part, index, text);
}

/* The distance of a point along Hilbert's curve (D. Hilbert, Math. Ann. 38, 459, 1891).
 */
static uint64_t hilbert(uint32_t x, uint32_t y)
{
    uint64_t d = 0;
    for (uint32_t s = UINT32_C(1) << 31; s > 0; s >>= 1) {
        const bool right = (x & s) != 0, up = (y & s) != 0;
        d = d << 2 | ((right ? 3U : 0U) ^ (up ? 1U : 0U));
        if (!up) {
            const uint32_t kept = right ? ~x : x;
            x = right ? ~y : y;
            y = kept;
        }
    }
    return d;
}

/* A part of 2^32, 0 for what is no number. */
static uint32_t triangles_along(double part)
{
    return part <= 1.0 ? (uint32_t)(part * (double)UINT32_MAX) : 0;
}

uint64_t weft__curve_key(const double x[2], const double low[2], double side)
{
    return hilbert(triangles_along((x[0] - low[0]) / side),
                   triangles_along((x[1] - low[1]) / side));
}
