/* SPDX-License-Identifier: BSD-3-Clause */
/* one_sim.h -- the cloth and the simulation of a test; teardown destroys both. */
#pragma once

#include "support.h"

static weft_cloth *cloth;
static weft_sim *sim;

static inline void teardown(void)
{
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    sim = NULL;
    cloth = NULL;
}
