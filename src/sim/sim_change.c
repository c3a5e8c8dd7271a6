/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_change.c -- changes of a simulation from outside, between two steps. */
#include "forces/self/self.h"
#include "mesh/triangles.h"
#include "sim/bands.h"
#include "sim/simulation.h"

weft_status weft__sim_changeable(const weft_sim *sim, const char *function,
                                 weft_error *err)
{
    const weft_status outside = weft__sim_outside(sim, function, err);
    return outside == WEFT_OK && sim->def.comm != NULL ? weft_error_set(
               err, WEFT_UNSUPPORTED, "%s: not possible for a cloth in bands", function)
                                                       : outside;
}

void weft__sim_take_wind(weft_sim *sim, const double velocity[3], double drag)
{
    sim->wind_changed = velocity != NULL;
    sim->cloth->wind = sim->wind;
    if (velocity != NULL) {
        memcpy(sim->cloth->wind.velocity, velocity, sizeof sim->wind.velocity);
        sim->cloth->wind.drag = drag;
        sim->cloth->wind.track.count = 0;
    }
}

weft_status weft_sim_set_wind(weft_sim *sim, const double velocity[3], double drag,
                              weft_error *err)
{
    const weft_status can = weft__sim_changeable(sim, "weft_sim_set_wind", err);
    if (can != WEFT_OK) {
        return can;
    }
    if (velocity != NULL && !weft__wind_usable(velocity, drag)) {
        return weft_error_set(err, WEFT_INVALID,
                              "wind of [%g, %g, %g] m/s, drag %g kg/(m^2 s): both must "
                              "be finite, and drag >= 0",
                              velocity[0], velocity[1], velocity[2], drag);
    }
    weft__sim_change_begins(sim);
    weft__sim_take_wind(sim, velocity, drag);
    weft__sim_change_ends(sim, true);
    return WEFT_OK;
}

static void set_planes(const weft_cloth *cloth, const double *xyz, double *planes)
{
    const weft__mesh *mesh = &cloth->mesh;
    for (size_t i = 0; xyz != NULL && i < mesh->particles; ++i) {
        const double *x = &xyz[3 * weft__vertex_of(mesh, i)];
        for (size_t k = 0; mesh->pin[i] == 0 && k < 3; ++k) {
            planes[k * mesh->particles + i] = x[k];
        }
    }
}

void weft__sim_change_begins(weft_sim *sim)
{
    weft__ledger_mark(&sim->ledger, &sim->forces, sim->t, sim->y);
}

void weft__sim_change_ends(weft_sim *sim, bool ode)
{
    weft__between_forget(sim);
    sim->event = sim->event_since = NAN;
    weft__ledger_account(&sim->ledger, &sim->forces, sim->t, sim->y,
                         &sim->ledger.outside_work);
    if (ode) {
        weft__structure_update(sim);
        weft_stepper_ode_changed(sim->def.method, sim->stepper);
    } else {
        sim->def.method->state_changed(sim->stepper);
    }
}

weft_status weft_sim_set_state(weft_sim *sim, const double *positions,
                               const double *velocities, weft_error *err)
{
    const weft_status can = weft__sim_changeable(sim, "weft_sim_set_state", err);
    if (can != WEFT_OK) {
        return can;
    }
    const size_t n = weft_cloth_particles(sim->cloth);
    if ((positions != NULL && !weft__all_finite(positions, 3 * n))
        || (velocities != NULL && !weft__all_finite(velocities, 3 * n))) {
        return weft_error_set(err, WEFT_INVALID, "a state must be finite");
    }
    if (positions != NULL && weft__sim_checks(sim)) {
        memcpy(sim->start, sim->y, 6 * n * sizeof *sim->y);
        set_planes(sim->cloth, positions, sim->start);
        const weft__breach breach = weft__state_breach(sim->cloth, sim->t, sim->start);
        if (breach.found) {
            return weft__breach_error(sim->cloth, &breach, "would be", err);
        }
        if (weft__crossing_error(&sim->cloth->self, sim->start, SIZE_MAX, "", err)
            != WEFT_OK) {
            return WEFT_INVALID;
        }
    }
    weft__sim_change_begins(sim);
    set_planes(sim->cloth, positions, sim->y);
    set_planes(sim->cloth, velocities, sim->y + 3 * n);
    weft__sim_change_ends(sim, false);
    return WEFT_OK;
}
