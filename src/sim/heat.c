/* SPDX-License-Identifier: BSD-3-Clause */
/* heat.c -- what the dampers have taken, where no ledger is kept. */
#include "sim/simulation.h"

void weft__sim_add_heat(weft_sim *sim, double h, double heating)
{
    sim->dissipated += 0.5 * h * (sim->heating + heating);
    sim->heating = heating;
    sim->unheated = 0.0;
}

void weft__sim_settle(weft_sim *sim)
{
    if (sim->unheated > 0.0) {
        weft__sim_add_heat(sim, sim->unheated, weft__forces_heat(&sim->forces, sim->y));
    }
}

/* The heating in y, before the corrections, is for the next step to tell where y is
 * sure to be what it first looks at. */
void weft__sim_account_heat(weft_sim *sim, double h)
{
    sim->unheated = sim->ledger.on ? 0.0 : h;
    if ((sim->method->flags & WEFT_STEPPER_FIRST_AT_Y) == 0 || sim->limit != NULL
        || sim->correct != NULL) {
        weft__sim_settle(sim);
    }
}

double weft_sim_dissipated(const weft_sim *sim)
{
    const double *done = sim->y + weft_cloth_dim(sim->cloth);
    if (sim->ledger.on) {
        return done[WEFT_POWER_SPRINGS] + done[WEFT_POWER_DRAG];
    }
    if (sim->unheated == 0.0) {
        return sim->dissipated;
    }
    const double heating = weft_cloth_dissipation(sim->cloth, sim->y);
    return sim->dissipated + 0.5 * sim->unheated * (sim->heating + heating);
}
