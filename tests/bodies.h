/* SPDX-License-Identifier: BSD-3-Clause */
/* bodies.h -- shapes of triangles, for tests: icospheres, plates. */
#pragma once

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "weft/cloth.h"

enum { BODY_MOST = 12000 }; /* vertices, and half the triangles */

typedef struct body_mesh {
    double places[3 * BODY_MOST];
    uint32_t corners[6 * BODY_MOST];
    weft_body body;
} body_mesh;

static inline body_mesh *body_new(void)
{
    body_mesh *to = calloc(1, sizeof *to);
    to->body.keys = 1;
    to->body.positions = to->places, to->body.corners = to->corners;
    return to;
}

static inline weft_shape body_shape(const body_mesh *of)
{
    weft_shape shape = weft_shape_default(WEFT_MESH);
    shape.body = &of->body;
    return shape;
}

/* A flat rectangle from -x to x and -z to z of cells x cells, in y = 0. */
static inline body_mesh *plate(size_t cells, double x, double z)
{
    body_mesh *to = body_new();
    const size_t n = cells + 1;
    for (size_t i = 0; i < n * n; ++i) {
        to->places[3 * i] = x * (2.0 * (double)(i % n) / (double)cells - 1.0);
        to->places[3 * i + 2] = z * (2.0 * (double)(i / n) / (double)cells - 1.0);
    }
    for (size_t i = 0; i < cells * cells; ++i) {
        const uint32_t a = (uint32_t)(i / cells * n + i % cells), b = a + (uint32_t)n;
        const uint32_t two[6] = { a, a + 1, b, a + 1, b + 1, b };
        memcpy(to->corners + 6 * i, two, sizeof two);
    }
    to->body.vertices = n * n, to->body.triangles = 2 * cells * cells;
    return to;
}

/* The vertex between two; each side is met twice, the second time backwards. */
static inline uint32_t middle(body_mesh *of, uint32_t a, uint32_t b, double radius,
                              uint32_t (*seen)[3], size_t *count)
{
    for (size_t i = *count; i-- > 0;) {
        if (seen[i][0] == b && seen[i][1] == a) {
            const uint32_t found = seen[i][2];
            memcpy(seen[i], seen[--*count], sizeof seen[i]);
            return found;
        }
    }
    const uint32_t v = (uint32_t)of->body.vertices++;
    double *x = of->places + 3 * (size_t)v, square = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        x[k] = of->places[3 * (size_t)a + k] + of->places[3 * (size_t)b + k];
        square += x[k] * x[k];
    }
    for (size_t k = 0; k < 3; ++k) {
        x[k] *= radius / sqrt(square);
    }
    seen[*count][0] = a, seen[*count][1] = b, seen[(*count)++][2] = v;
    return v;
}

/* About 0, of 12, 42, 162, 642 or 2562 vertices for 0 to 4 divisions. */
static inline body_mesh *icosphere(size_t divisions, double radius)
{
    static const uint32_t faces[60]
        = { 0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
            4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
            6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1 };
    static const signed char corner[36] /* 2: g */
        = { -1, 2,  0,  1, 2, 0,  -1, -2, 0,  1, -2, 0, 0,  -1, 2,  0,  1, 2,
            0,  -1, -2, 0, 1, -2, 2,  0,  -1, 2, 0,  1, -2, 0,  -1, -2, 0, 1 };
    const double g = 0.5 * (1.0 + sqrt(5.0)), unit = radius / sqrt(1.0 + g * g);
    body_mesh *to = body_new();
    uint32_t(*seen)[3] = malloc(6 * BODY_MOST * sizeof *seen);
    for (size_t i = 0; i < 36; ++i) {
        const double sign = corner[i] < 0 ? -unit : unit;
        to->places[i] = abs(corner[i]) == 2 ? sign * g : abs(corner[i]) * sign;
    }
    memcpy(to->corners, faces, sizeof faces);
    to->body.vertices = 12, to->body.triangles = 20;
    for (size_t level = 0; level < divisions; ++level) {
        size_t count = 0;
        for (size_t t = to->body.triangles; t-- > 0;) {
            uint32_t c[3], m[3];
            memcpy(c, to->corners + 3 * t, sizeof c);
            for (size_t k = 0; k < 3; ++k) {
                m[k] = middle(to, c[k], c[(k + 1) % 3], radius, seen, &count);
            }
            const uint32_t four[12] = { c[0], m[0], m[2], m[0], c[1], m[1],
                                        m[2], m[1], c[2], m[0], m[1], m[2] };
            memcpy(to->corners + 12 * t, four, sizeof four);
        }
        to->body.triangles *= 4;
    }
    free(seen);
    return to;
}
