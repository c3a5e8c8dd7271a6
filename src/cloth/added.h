/* SPDX-License-Identifier: BSD-3-Clause */
/* added.h -- the forces that are added to springs, gravity and drag.
 *
 * Each has a line in WEFT_ADDED, a plain file src/cloth/NAME.c with the functions
 * below, and a kernel weft__NAME_LEVEL in src/kernel/kernel_NAME.c. All do nothing for
 * a cloth without that force. */
#ifndef WEFT_CLOTH_ADDED_H
#define WEFT_CLOTH_ADDED_H

#include "cloth/rows.h"

/* X(name, level), in the order of summation, which is part of the result. */
#define WEFT_ADDED(X, level) X(bending, level) X(wind, level) X(contact, level)

typedef enum weft__unit {
    WEFT__FORCE,       /* [N] */
    WEFT__ACCELERATION /* [m/s^2] as free; 0 of pinned particles */
} weft__unit;

typedef struct weft__added {
    /* adds that of particle i to to[3], n apart */
    void (*add)(const weft__subject *of, size_t i, weft__unit unit, double *to);
    /* adds its powers [W] in row r: on free particles; of bending, heat and pins */
    weft__row_fn *power;
    /* adds the derivative of its acceleration along of->along */
    weft__rows_fn *change;
    /* [kg/s] no direction of particle i is damped more, whatever the state; 0 of
     * contact, whose damping depends on the state (contact_bounds.h), and of bending,
     * whose damping goes with its stiffness (bounds.c) */
    double (*damping)(const weft_cloth *cloth, size_t i);
} weft__added;

#define WEFT_ADDED_PLACE(name, level) WEFT__ADDED_##name,
enum { WEFT_ADDED(WEFT_ADDED_PLACE, ) WEFT__ADDED /* their number */ };

#define WEFT_ADDED_DECLARE(name, level) extern const weft__added weft__##name;
WEFT_ADDED(WEFT_ADDED_DECLARE, )
extern const weft__added *const weft__added_forces[WEFT__ADDED]; /* rhs.c */

#endif
