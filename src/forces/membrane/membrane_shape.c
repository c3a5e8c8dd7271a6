/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_shape.c -- the constants of a triangle at rest, and its barrier. */
#include "forces/membrane/membrane_law.h"

void weft__membrane_shape(const weft__triangles *of, size_t t, double shape[3][3])
{
    const double per = 1.0 / (16.0 * of->area[t] * of->area[t]);
    double e[3][2];
    for (size_t i = 0; i < 3; ++i) {
        const double *from = of->rest[of->place[t][(i + 1) % 3]];
        const double *to = of->rest[of->place[t][(i + 2) % 3]];
        e[i][0] = to[0] - from[0], e[i][1] = to[1] - from[1];
    }
    for (size_t i = 0; i < 3; ++i) {
        const double *a = e[(i + 1) % 3], *b = e[(i + 2) % 3];
        shape[i][0] = -2.0 * a[1] * b[1] * per;
        shape[i][1] = -2.0 * a[0] * b[0] * per;
        shape[i][2] = (a[1] * b[0] + a[0] * b[1]) * per;
    }
}

static double rest_square(const weft__triangles *of, size_t t, size_t i)
{
    const double *from = of->rest[of->place[t][(i + 1) % 3]];
    const double *to = of->rest[of->place[t][(i + 2) % 3]];
    const double u = to[0] - from[0], v = to[1] - from[1];
    return u * u + v * v;
}

void weft__membrane_constants(const weft__triangles *of, size_t t, double *to)
{
    static const size_t pairs[6][2]
        = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 }, { 1, 2 } };
    const weft_fabric *fabric = &of->fabrics[of->fabric[t]];
    const double area = of->area[t];
    double shape[3][3], stress[3];
    weft__membrane_shape(of, t, shape);
    for (size_t k = 0; k < 6; ++k) {
        const double *a = shape[pairs[k][0]];
        weft__membrane_stress(fabric, shape[pairs[k][1]], stress);
        to[k * WEFT__WIDTH]
            = 2.0 * area
              * (a[0] * stress[0] + a[1] * stress[1] + 2.0 * a[2] * stress[2]);
    }
    for (size_t i = 0; i < 3; ++i) {
        to[(WEFT__SQUARE + i) * WEFT__WIDTH] = rest_square(of, t, i);
    }
    to[WEFT__LEAST * WEFT__WIDTH] = 0.36 * 16.0 * area * area;
    to[WEFT__LAG * WEFT__WIDTH] = 2.0 * fabric->damping[0];
    to[WEFT__GUARD * WEFT__WIDTH]
        = area * (fabric->stretch[0] + fabric->stretch[1]) / 8.0;
}

bool weft__membrane_barrier(const double *of, const double square[3],
                            weft__barrier *out)
{
    const double least = CONSTANT(of, WEFT__LEAST), area = law_area(square);
    const double r = fmax(area, 0.0) / least, z = 1.0 - r, per = 1.0 / r;
    const double guard = CONSTANT(of, WEFT__GUARD);
    *out = (weft__barrier){ .push = 0.0 };
    if (!(area < least)) {
        return false;
    }
    out->push = guard * (z * z * z) * (4.0 * r + z) * per * per;
    out->bend = guard * z * z * (12.0 * r * r + 8.0 * z * r + 2.0 * z * z)
                * (per * per * per);
    for (size_t i = 0; i < 3; ++i) {
        const double others = square[(i + 1) % 3] + square[(i + 2) % 3];
        out->rate[i] = 2.0 * (others - square[i]) / least;
    }
    return true;
}
