/* SPDX-License-Identifier: BSD-3-Clause */
/* shadow.c -- where the outermost edge crosses a ray from the origin. */
#include "study/shadow.h"

#include <math.h>
#include <stdlib.h>

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

weft_status shadow_init(shadow *of, const weft_cloth *cloth, const double gravity[3],
                        weft_error *err)
{
    const double g = sqrt(dot(gravity, gravity));
    const size_t along = fabs(gravity[0]) > 0.9 * g ? 1 : 0;
    of->count
        = weft_cloth_triangles(cloth, NULL) > 0 ? weft_cloth_edges(cloth, NULL) : 0;
    if (!(g > 0.0) || of->count == 0) {
        return weft_error_set(err, WEFT_IO, "%s: it has no outline from above",
                              of->count == 0 ? "the cloth has no triangles"
                                             : "the cloth has no weight");
    }
    double up[3], *x = of->axis[0], *y = of->axis[1];
    for (size_t k = 0; k < 3; ++k) {
        up[k] = -gravity[k] / g;
    }
    for (size_t k = 0; k < 3; ++k) {
        x[k] = (k == along) - up[along] * up[k];
    }
    const double length = sqrt(dot(x, x));
    for (size_t k = 0; k < 3; ++k) {
        x[k] /= length;
    }
    for (size_t k = 0; k < 3; ++k) {
        y[k] = up[(k + 1) % 3] * x[(k + 2) % 3] - up[(k + 2) % 3] * x[(k + 1) % 3];
    }
    of->ends = malloc(2 * of->count * sizeof *of->ends);
    if (of->ends == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the outline");
    }
    (void)weft_cloth_edges(cloth, of->ends);
    return WEFT_OK;
}

bool shadow_at(const shadow *of, const double *xyz, const double direction[2],
               shadow_point *out)
{
    double along[3], across[3], best[2] = { 0.0 };
    out->of = NULL;
    for (size_t k = 0; k < 3; ++k) {
        along[k] = direction[0] * of->axis[0][k] + direction[1] * of->axis[1][k];
        across[k] = direction[0] * of->axis[1][k] - direction[1] * of->axis[0][k];
    }
    for (size_t i = 0; i < of->count; ++i) {
        const double *a = xyz + 3 * of->ends[2 * i], *b = xyz + 3 * of->ends[2 * i + 1];
        const double from = dot(across, a), to = dot(across, b);
        if ((from <= 0.0) != (to <= 0.0)) {
            const double share = from / (from - to), start = dot(along, a);
            const double radius = start + share * (dot(along, b) - start);
            if (radius > (out->of == NULL ? 0.0 : out->radius)) {
                *out = (shadow_point){ .radius = radius, .of = of->ends + 2 * i };
                best[0] = share, best[1] = (dot(along, b) - start) / (to - from);
            }
        }
    }
    for (size_t k = 0; out->of != NULL && k < 3; ++k) {
        const double by = along[k] - best[1] * across[k];
        out->derivative[0][k] = (1.0 - best[0]) * by;
        out->derivative[1][k] = best[0] * by;
    }
    return out->of != NULL;
}
