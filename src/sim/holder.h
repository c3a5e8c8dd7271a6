/* SPDX-License-Identifier: BSD-3-Clause */
/* holder.h -- what holds a step. */
#pragma once

#include "sim/simulation.h"

/* In words; and if `near.found`, what is nearest. */
typedef struct weft__holder {
    char text[sizeof((weft_failure *)0)->held];
    weft__penetration near; /* particle and shape as of a definition */
    size_t other_shape;     /* the nearest but one */
    double other_gap;       /* [m] of that; 0: it is not near */
} weft__holder;

/* pace.c: from the measures of the present state. Collective. */
void weft__sim_find_holder(const weft_sim *sim, const weft_measures *now,
                           weft__holder *out);
