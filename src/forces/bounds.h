/* SPDX-License-Identifier: BSD-3-Clause */
/* bounds.h -- what forces add to the bounds on stiffness and damping of one particle;
 * src/cloth/bounds.c makes the polygon. Matrices are xx, yy, zz, xy, xz, yz, per unit
 * mass.
 */
#pragma once

#include <string.h>

#include "forces/force.h"

/* Relative error allowed for closed forms. */
#define WEFT__ROUNDOFF 1e-12

enum { WEFT__RATIOS = 7, WEFT__SIDES = 3 + 3 * WEFT__RATIOS };

/* The directions (a, b) in which a K + b C is bounded: of K, of C from both sides, and
 * three for each ratio [s] of damping to stiffness that a force has. */
typedef struct weft__sides {
    size_t count;
    double direction[WEFT__SIDES][2];
} weft__sides;

/* For weft__force.ratios. One that is there already adds nothing; without those that
 * find no room the polygon is less sharp. */
static inline void weft__sides_add(weft__sides *to, double ratio)
{
    bool fresh = ratio > 0.0 && isfinite(ratio) && to->count < WEFT__SIDES;
    for (size_t s = 3; s < to->count; s += 3) {
        fresh = fresh && to->direction[s][0] != ratio;
    }
    if (fresh) {
        const double directions[3][2]
            = { { ratio, 1.0 }, { ratio, -1.0 }, { -ratio, 1.0 } };
        memcpy(to->direction[to->count], directions, sizeof directions);
        to->count += 3;
    }
}

/* For weft__force.bound: adds to the sum of one side a bound alike in all directions.
 * Of a symmetric matrix with 3 x 3 blocks, norms n_ij of them [N/m], that is
 * (a + b c / k)+ (sum over j of n_ij) / m_i. */
static inline void weft__bound_add(double sum[6], double bound)
{
    for (size_t k = 0; k < 3; ++k) {
        sum[k] += bound;
    }
}

/* Of a force that seeks what touches for many particles at once, such as contact. */
typedef struct weft__range_stiffness {
    double normal_stiffness[6]; /* [1/s^2] sum of S n n^T */
    double normal_damping[6];   /* [1/s] sum of D n n^T */
    double friction_damping[6]; /* [1/s] upper bound of friction's damping, which is >=
                                   0 */
    double any_stiffness,
        any_damping;           /* [1/s^2], [1/s] in any direction, of either sign */
    double negative_stiffness; /* [1/s^2] most negative stiffness, from the normal's
                                  turning */
} weft__range_stiffness;

/* Adds S n n^T, D n n^T and T (I - n n^T). */
static inline void weft__range_stiffness_add(weft__range_stiffness *to,
                                             const double n[3], double stiffness,
                                             double damping, double friction_rate)
{
    const double nn[6] = { n[0] * n[0], n[1] * n[1], n[2] * n[2],
                           n[0] * n[1], n[0] * n[2], n[1] * n[2] };
    for (size_t k = 0; k < 6; ++k) {
        to->normal_stiffness[k] += stiffness * nn[k];
        to->normal_damping[k] += damping * nn[k];
        to->friction_damping[k] += friction_rate * ((k < 3 ? 1.0 : 0.0) - nn[k]);
    }
}
