/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_bounds.h -- what contact adds to the stiffness and damping of a particle, for
 * bounds.c; derived in docs/physics.md. Matrices are xx, yy, zz, xy, xz, yz, by mass.
 */
#ifndef WEFT_CLOTH_CONTACT_BOUNDS_H
#define WEFT_CLOTH_CONTACT_BOUNDS_H

#include "cloth/shapes.h"

typedef struct weft__grip {
    double press[6];    /* [1/s^2] sum of S n n^T */
    double damp[6];     /* [1/s] sum of D n n^T */
    double slide[6];    /* [1/s] upper bound of friction's damping, which is >= 0 */
    double stiff, drag; /* [1/s^2], [1/s] in any direction, of either sign */
    double turn;        /* [1/s^2] most negative stiffness, from the normal's turning */
} weft__grip;

/* Of free particle i in a state. */
weft__grip weft__grip_of(const weft_cloth *cloth, size_t i, double t, const double *y);

/* Of any free particle that touches one shape at a time, with a kinetic energy relative
 * to it and a contact energy that together are at most m stopping_speed^2 / 2. */
weft__grip weft__grip_any(const weft_cloth *cloth);

/* Adds to *most, number by number, the largest of layers, `share` of the law, with
 * phi(s) up to `phi`. */
void weft__grip_most(const weft_cloth *cloth, const weft__pose *pose, double share,
                     double phi, weft__grip *most);

/* Adds an upper bound of a K + b C to matrix[6]. */
void weft__grip_add(const weft__grip *grip, double a, double b, double matrix[6]);

/* out[3 N] += (a K + b C) x, without mass and without what turning normals and the
 * coupling of friction to pressure add. */
void weft__grip_multiply(const weft_cloth *cloth, double t, const double *y, double a,
                         double b, const double *x, double *out);

#endif
