/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_change.c -- changes of a simulation from outside, between two steps: of its
 * state and its pins. */
#include <math.h>

#include "base/memory.h"
#include "base/sized.h"
#include "cloth/grids.h"
#include "mesh/pins.h"
#include "mesh/triangles.h"
#include "sim/bands.h"
#include "sim/simulation.h"

weft_status weft__sim_changeable(const weft_sim *sim, const char *function,
                                 weft_error *err)
{
    TRY(weft__sim_outside(sim, function, err));
    const char *why = sim->def.comm != NULL        ? "for a cloth in bands"
                      : sim->sensitivity.count > 0 ? "with sensitivities"
                                                   : NULL;
    return why == NULL ? WEFT_OK
                       : weft_error_set(err, WEFT_UNSUPPORTED, "%s: not possible %s",
                                        function, why);
}

weft_status weft_sim_set_wind(weft_sim *sim, const double velocity[3], double drag,
                              weft_error *err)
{
    TRY(weft__sim_changeable(sim, "weft_sim_set_wind", err));
    weft__wind now = sim->cloth->wind;
    if (!weft__wind_set(&now, velocity, drag)) {
        return weft_error_set(err, WEFT_INVALID,
                              "wind of [%g, %g, %g] m/s, drag %g kg/(m^2 s): both must "
                              "be finite, and drag >= 0",
                              velocity[0], velocity[1], velocity[2], drag);
    }
    weft__sim_change_begins(sim);
    sim->cloth->wind = now;
    weft__grids_attach(sim->cloth);
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
    sim->event.value = sim->event.since = NAN;
    sim->passage.next = -INFINITY;
    weft__ledger_account(&sim->ledger, &sim->forces, sim->t, sim->y,
                         &sim->ledger.work_outside);
    if (ode) {
        weft__structure_update(sim);
        weft_stepper_ode_changed(sim->def.method, sim->stepper);
    } else {
        sim->def.method->state_changed(sim->stepper);
    }
}

/* x y z of each vertex; NULL: none are given. */
static weft_status sim_change_check_finite(const weft_sim *sim, const char *what,
                                           const double *values, weft_error *err)
{
    const size_t count = 3 * weft_cloth_particles(sim->cloth);
    char name[64];
    for (size_t j = 0; values != NULL && j < count; ++j) {
        if (!isfinite(values[j])) {
            return weft_error_set(
                err, WEFT_INVALID, "a state must be finite: the %s of %s has %c = %g",
                what, weft_particle_text(sim->cloth, j / 3, name, sizeof name),
                "xyz"[j % 3], weft__unsigned_nan(values[j]));
        }
    }
    return WEFT_OK;
}

weft_status weft_sim_set_state(weft_sim *sim, const double *positions,
                               const double *velocities, weft_error *err)
{
    TRY(weft__sim_changeable(sim, "weft_sim_set_state", err));
    const size_t n = weft_cloth_particles(sim->cloth);
    TRY(sim_change_check_finite(sim, "position", positions, err));
    TRY(sim_change_check_finite(sim, "velocity", velocities, err));
    if (positions != NULL && weft__sim_checks(sim)) {
        memcpy(sim->guard.start, sim->y, 6 * n * sizeof *sim->y);
        set_planes(sim->cloth, positions, sim->guard.start);
        const weft__penetration penetration
            = weft__state_penetration(sim->cloth, sim->t, sim->guard.start);
        if (penetration.found) {
            return weft__penetration_error(sim->cloth, &penetration, "would be", err);
        }
        TRY(weft__crossings_error(sim->cloth, sim->t, sim->guard.start,
                                  &(weft__search){ 0 }, err));
    }
    weft__sim_change_begins(sim);
    set_planes(sim->cloth, positions, sim->y);
    set_planes(sim->cloth, velocities, sim->y + 3 * n);
    weft__sim_change_ends(sim, false);
    return WEFT_OK;
}

/* ---- pins ------------------------------------------------------------------------ */

static weft_status check_particle(const weft_sim *sim, const char *function, size_t i,
                                  const double numbers[3], weft_error *err)
{
    TRY(weft__sim_changeable(sim, function, err));
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

/* Of the function that a refusal names. */
static weft_status sim_change_pin(weft_sim *sim, const char *function,
                                  const size_t *particles, const double *velocities,
                                  size_t count, weft_error *err)
{
    for (size_t j = 0; j < count; ++j) {
        TRY(check_particle(sim, function, particles[j],
                           velocities != NULL ? velocities + 3 * j : NULL, err));
    }
    if (count == 0) {
        return WEFT_OK;
    }
    weft__mesh *mesh = &sim->cloth->mesh;
    const size_t n = mesh->particles;
    weft__sim_change_begins(sim);
    for (size_t j = 0; j < count; ++j) {
        const size_t i = weft__particle_of(mesh, particles[j]);
        for (size_t k = 0; k < 3; ++k) {
            sim->y[(3 + k) * n + i] = velocities != NULL ? velocities[3 * j + k] : 0.0;
        }
        weft__set_hold(mesh, i, WEFT__COASTING);
    }
    weft__pins_changed(mesh, sim->y);
    weft__sim_change_ends(sim, true);
    return WEFT_OK;
}

weft_status weft_sim_pin_many(weft_sim *sim, const size_t *particles,
                              const double *velocities, size_t count, weft_error *err)
{
    return sim_change_pin(sim, "weft_sim_pin_many", particles, velocities, count, err);
}

weft_status weft_sim_pin(weft_sim *sim, size_t vertex, const double velocity[3],
                         weft_error *err)
{
    return sim_change_pin(sim, "weft_sim_pin", &vertex, velocity, 1, err);
}

static void sim_change_place(weft_sim *sim, size_t i, const double position[3])
{
    const size_t n = weft_cloth_particles(sim->cloth);
    for (size_t k = 0; k < 3; ++k) {
        sim->y[k * n + i] = position[k];
    }
}

weft_status weft_sim_move_pin(weft_sim *sim, size_t vertex, const double position[3],
                              weft_error *err)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    TRY(check_particle(sim, "weft_sim_move_pin", vertex, position, err));
    if (position == NULL || !weft_cloth_pinned(sim->cloth, vertex)) {
        return weft_error_set(err, WEFT_INVALID, "particle %zu %s", vertex,
                              position == NULL ? "has no position to go to: it is NULL"
                                               : "is not pinned");
    }
    const size_t i = weft__particle_of(&sim->cloth->mesh, vertex);
    const double before[3] = { sim->y[i], sim->y[n + i], sim->y[2 * n + i] };
    weft__sim_change_begins(sim);
    sim_change_place(sim, i, position);
    if (weft__crossings_error(sim->cloth, sim->t, sim->y, &(weft__search){ 0 }, err)
        != WEFT_OK) {
        sim_change_place(sim, i, before);
        return WEFT_INVALID;
    }
    weft__sim_change_ends(sim, false);
    return WEFT_OK;
}

weft_status weft_sim_unpin(weft_sim *sim, size_t vertex, weft_error *err)
{
    TRY(check_particle(sim, "weft_sim_unpin", vertex, NULL, err));
    if (weft_cloth_pinned(sim->cloth, vertex)) {
        const size_t i = weft__particle_of(&sim->cloth->mesh, vertex);
        const weft__penetration penetration
            = weft__particle_penetration(sim->cloth, sim->t, sim->y, i);
        if (penetration.found) {
            return weft__penetration_error(sim->cloth, &penetration, "is", err);
        }
        TRY(weft__crossings_error(sim->cloth, sim->t, sim->y,
                                  &(weft__search){ .loose = i + 1 }, err));
        weft__sim_change_begins(sim);
        weft__set_hold(&sim->cloth->mesh, i, WEFT__FREE);
        weft__pins_changed(&sim->cloth->mesh, sim->y);
        weft__sim_change_ends(sim, true);
    }
    return WEFT_OK;
}
