/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_pins.c -- pins that change while a simulation runs. */
#include <math.h>

#include "cloth/repin.h"
#include "sim/simulation.h"

static weft_status check(const weft_sim *sim, const char *function, size_t i,
                         const double numbers[3], weft_error *err)
{
    if (weft__sim_outside(sim, function, err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    if (i >= weft_cloth_particles(sim->cloth)) {
        return weft_error_set(err, WEFT_INVALID, "no particle %zu: there are %zu", i,
                              weft_cloth_particles(sim->cloth));
    }
    for (size_t k = 0; numbers != NULL && k < 3; ++k) {
        if (!isfinite(numbers[k])) {
            return weft_error_set(err, WEFT_INVALID, "particle %zu: %g is not finite",
                                  i, numbers[k]);
        }
    }
    return WEFT_OK;
}

void weft__sim_use_pins(weft_sim *sim, weft_cloth *own)
{
    if (sim->own != NULL) { /* others may look at it */
        weft__cloth_trade(sim->own, own);
        weft__cloth_return(own);
        return;
    }
    sim->own = own;
    sim->cloth = sim->forces.cloth = own;
    weft__limit_use(sim->limit, own);
}

/* The first change. */
static weft_status own_pins(weft_sim *sim, weft_error *err)
{
    if (sim->own == NULL) {
        weft_cloth *own = weft__cloth_borrow(sim->given, &sim->memory);
        if (own == NULL) {
            return weft_error_set(err, WEFT_NO_MEMORY, "no memory for pins");
        }
        weft__sim_use_pins(sim, own);
    }
    return WEFT_OK;
}

weft_status weft_sim_pin(weft_sim *sim, size_t i, const double velocity[3],
                         weft_error *err)
{
    static const double still[3] = { 0.0, 0.0, 0.0 };
    const double *v = velocity != NULL ? velocity : still;
    const size_t n = weft_cloth_particles(sim->cloth);
    weft_status status = check(sim, "weft_sim_pin", i, v, err);
    status = status == WEFT_OK ? own_pins(sim, err) : status;
    if (status != WEFT_OK) {
        return status;
    }
    weft__sim_change_begins(sim);
    if (!weft__cloth_pin(sim->own, i, v)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a pin");
    }
    for (size_t k = 0; k < 3; ++k) {
        sim->y[(3 + k) * n + i] = v[k];
    }
    weft__sim_ode_changed(sim);
    return WEFT_OK;
}

weft_status weft_sim_move_pin(weft_sim *sim, size_t i, const double position[3],
                              weft_error *err)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    const weft_status status = check(sim, "weft_sim_move_pin", i, position, err);
    if (status != WEFT_OK) {
        return status;
    }
    if (!weft_cloth_pinned(sim->cloth, i)) {
        return weft_error_set(err, WEFT_INVALID, "particle %zu is not pinned", i);
    }
    weft__sim_change_begins(sim);
    for (size_t k = 0; k < 3; ++k) {
        sim->y[k * n + i] = position[k];
    }
    weft__sim_state_changed(sim);
    return WEFT_OK;
}

weft_status weft_sim_unpin(weft_sim *sim, size_t i, weft_error *err)
{
    weft_status status = check(sim, "weft_sim_unpin", i, NULL, err);
    if (status != WEFT_OK || !weft_cloth_pinned(sim->cloth, i)) {
        return status;
    }
    status = own_pins(sim, err);
    if (status == WEFT_OK) {
        weft__sim_change_begins(sim);
        weft__cloth_unpin(sim->own, i);
        weft__sim_ode_changed(sim);
    }
    return status;
}
