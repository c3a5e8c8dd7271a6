/* SPDX-License-Identifier: BSD-3-Clause */
/* shapes.h -- rigid shapes: where they are, and the distance to them.
 *
 * The gap d is > 0 outside and 1-Lipschitz: |grad d| <= 1. With r = x - at it is
 *
 *     plane      r.normal
 *     sphere     |r| - radius
 *     capsule    (rho^4 + q^4)^(1/4) - radius,  rho from the axis, q beyond an end
 *     box        (q_x^4 + q_y^4 + q_z^4)^(1/4) - rounding,  q beyond half - rounding
 *
 * The 4-norm joins sides to ends and edges with three continuous derivatives, so that
 * methods keep their order there. */
#ifndef WEFT_FORCES_CONTACT_SHAPES_H
#define WEFT_FORCES_CONTACT_SHAPES_H

#include "forces/force.h"

/* A rigid shape: what is defined and what follows from it (shapes.h). */
typedef struct weft__shape {
    weft_shape def;
    weft__motion motion;
    double axis[3];  /* unit: a plane's normal, from end to end of a capsule */
    double spin[3];  /* [rad/s] of a plane and a capsule exactly along the axis */
    double length;   /* [m] of a capsule's axis */
    double radius;   /* [m] also of the edges of a box; a plane has 0 */
    double friction; /* >= 0 */
} weft__shape;

/* A shape at a time. */
typedef struct weft__pose {
    weft_shape_kind kind;
    double at[3], velocity[3]; /* [m], [m/s] */
    double spin[3];            /* [rad/s] */
    double axis[3], length;    /* as in weft__shape */
    double inner[3];           /* [m] box: half - rounding */
    double radius;             /* [m] box: rounding */
    double friction;
} weft__pose;

/* The friction of a shape: its own, or else that of the contact. */
static inline double weft__friction_of(const weft_shape *def, double friction)
{
    return def->friction < 0.0 ? friction : def->friction;
}

/* A shape without faults. `friction`: that of the contact. */
weft__shape weft__shape_of(const weft_shape *def, double friction);

weft__pose weft__pose_of(const weft__shape *shape, double t);

/* [1/m] times dx: the change of the gradient, which is that at x, by a move dx. */
void weft__shape_turn(const weft__pose *pose, const double x[3],
                      const double gradient[3], const double dx[3], double turn[3]);

/* [m] */
double weft__gap_at(const weft__pose *pose, const double x[3]);

#endif
