/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_load.h -- a triangle at rest and in a state: for bounds and the matrix. */
#ifndef WEFT_FORCES_MEMBRANE_LOAD_H
#define WEFT_FORCES_MEMBRANE_LOAD_H

#include "forces/membrane/membrane.h"

/* What a triangle is at rest. */
typedef struct weft__rest {
    const weft_fabric *fabric;
    double area, grad[3][2]; /* [m^2], [1/m] */
} weft__rest;

weft__rest weft__rest_of(const weft__triangles *of, size_t t);

/* What a state makes of a triangle; S by its parts above and below 0, as 11, 22, 12. */
typedef struct weft__load {
    double square;            /* of the largest stretch */
    double taut[3], slack[3]; /* [N/m] */
    double d[3][3], q[3];     /* [m], [m^2] edges and their squares */
    double arc[3];            /* [m^2] |h|^2 of the arcs */
    double press;             /* [N/m] above the stress of any slack, without a state */
    weft__barrier barrier;
    double of[WEFT__CONSTANTS * WEFT__WIDTH];
} weft__load;

void weft__load_of(const weft__membrane *own, size_t t, const weft__rest *of,
                   const double *y, weft__load *out);

/* [N/m^3] g_a.S g_b of a part S of the stress */
static inline double weft__geometric(const weft__rest *of, const double s[3], size_t a,
                                     size_t b)
{
    const double *g = of->grad[a], *h = of->grad[b];
    return g[0] * s[0] * h[0] + g[1] * s[1] * h[1] + s[2] * (g[0] * h[1] + g[1] * h[0]);
}

#endif
