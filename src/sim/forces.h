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
} weft__forces;

/* On so many threads at most: a cloth that is too small for that has fewer. memory
 * NULL: malloc's. */
weft__forces weft__forces_create(const weft_cloth *cloth, size_t threads,
                                 const weft_allocator *memory);
void weft__forces_destroy(weft__forces *forces);

/* As weft_cloth_rhs. */
int weft__forces_rhs(const weft__forces *forces, double t, const double *y,
                     double *dydt);

#endif
