/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_law.h -- the law of membrane.h for one triangle or a vector of them
 * (forces/law.h). */
#pragma once

#include "forces/law.h"
#include "forces/membrane/membrane.h"

/* of: the constants of a triangle, or those of a batch from a lane on */
#ifdef LAW_OF_LANES
#define CONSTANT(of, k) AT((of) + (k)*WEFT__WIDTH)
#else
#define CONSTANT(of, k) (of)[k]
#endif

/* [N/m] K q */
LAW void law_stiff(const double *of, const num q[3], num s[3])
{
    const num k01 = CONSTANT(of, 3), k02 = CONSTANT(of, 4), k12 = CONSTANT(of, 5);
    s[0] = (CONSTANT(of, 0) * q[0] + k01 * q[1]) + k02 * q[2];
    s[1] = (k01 * q[0] + CONSTANT(of, 1) * q[1]) + k12 * q[2];
    s[2] = (k02 * q[0] + k12 * q[1]) + CONSTANT(of, 2) * q[2];
}

/* [m^4] 16 area^2 from the squares of the edges */
LAW num law_area(const num square[3])
{
    const num both = square[0] + square[1] - square[2];
    return 4.0 * square[0] * square[1] - both * both;
}

/* Adds the barrier's part to s: with r = 16 area^2 / least and phi = (1 - r)^4 / r,
 * s_i = 2 dU/dq_i = 2 guard phi' (-dr/dq_i), where dr/dq_0 = 2 (q_1 + q_2 - q_0) /
 * least.
 */
LAW void law_barrier(const double *of, const num square[3], num area, num s[3])
{
    const num least = CONSTANT(of, WEFT__LEAST);
    const num r = CHOOSE(area > 0.0, area, NUM(0.0)) / least, z = 1.0 - r;
    const num steep = (z * z * z) * (4.0 * r + z) / (r * r);
    const num push = CHOOSE(area < least,
                            -4.0 * CONSTANT(of, WEFT__GUARD) * steep / least, NUM(0.0));
    s[0] = s[0] + push * (square[1] + square[2] - square[0]);
    s[1] = s[1] + push * (square[2] + square[0] - square[1]);
    s[2] = s[2] + push * (square[0] + square[1] - square[2]);
}

/* [N/m] s of squares of edges and of their q + damping dq/dt */
LAW void law_pull(const double *of, const num square[3], const num q[3], num s[3])
{
    law_stiff(of, q, s);
    const num area = law_area(square);
    if (ANY(area < CONSTANT(of, WEFT__LEAST))) {
        law_barrier(of, square, area, s);
    }
}
