/* SPDX-License-Identifier: BSD-3-Clause */
/* bounds.h -- what forces add to the bounds on stiffness and damping of one particle;
 * src/cloth/bounds.c makes the polygon. Matrices are xx, yy, zz, xy, xz, yz, by mass.
 */
#ifndef WEFT_FORCES_BOUNDS_H
#define WEFT_FORCES_BOUNDS_H

#include "forces/force.h"

/* Of contact (contact/contact_bounds.c), apart: it is sought for many particles at
 * once.
 */
typedef struct weft__grip {
    double press[6];    /* [1/s^2] sum of S n n^T */
    double damp[6];     /* [1/s] sum of D n n^T */
    double slide[6];    /* [1/s] upper bound of friction's damping, which is >= 0 */
    double stiff, drag; /* [1/s^2], [1/s] in any direction, of either sign */
    double turn;        /* [1/s^2] most negative stiffness, from the normal's turning */
} weft__grip;

/* Families of springs: stiffness k and damping c along the same directions; a w + b c
 * is at most (a k + b c)+ of them. */
enum { WEFT__MODES = 6 };

typedef struct weft__bound {
    double along[WEFT__MODES][6]; /* sum (1/m_i + 1/m_j) share u u^T of a family */
    double taut[6], slack[6];     /* sum (1/m_i + 1/m_j) (T/L)+- (I - u u^T) */
    double drag;                  /* [1/s] damping alike in all directions */
    double added;                 /* [1/s] no direction is damped more by it */
    double bending;               /* [1/s^2] row sum by mass */
} weft__bound;

#endif
