/* SPDX-License-Identifier: BSD-3-Clause */
/* forces.h -- the equations of motion on the threads of a simulation, each a band of
 * rows: the same bits as on one. */
#ifndef WEFT_SIM_FORCES_H
#define WEFT_SIM_FORCES_H

#include "sim/team.h"
#include "weft/cloth.h"

typedef struct weft__forces {
    const weft_cloth *cloth;
    weft__team *team; /* NULL: one thread */
    size_t bands;
    double *heat; /* [W] WEFT_SUMS of each row; NULL: no memory */
    weft_allocator memory;
} weft__forces;

/* On so many threads at most: a cloth that is too small for that has fewer. No
 * memory given: malloc's. */
weft__forces weft__forces_create(const weft_cloth *cloth, size_t threads,
                                 const weft_allocator *given);
void weft__forces_destroy(weft__forces *forces);

/* As weft_cloth_rhs; where heat is not NULL, also *heat [W], as below. */
int weft__forces_rhs(const weft__forces *forces, double t, const double *y,
                     double *dydt, double *heat);

/* As weft_cloth_dissipation. */
double weft__forces_heat(const weft__forces *forces, const double *y);

#endif
