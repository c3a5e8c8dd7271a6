/* SPDX-License-Identifier: BSD-3-Clause */
/* mail.h -- what the bands of triangles tell each other in an evaluation: v' of
 * particles. */
#pragma once

#include "weft/sim.h"

typedef struct weft__mail {
    weft_parcel *parcels; /* by rank; NULL: a grid, or a whole cloth */
    size_t count, before; /* parcels; those of bands before this one */
    uint32_t *sent; /* own particles that are ghosts elsewhere, parcel by parcel */
    double *room;   /* what is sent, then what is received */
    size_t missing; /* particles for which the first ghost stands */
    bool *edge;     /* own blocks with particles that are sent */
} weft__mail;
