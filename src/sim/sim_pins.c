/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_pins.c -- pins that change while a simulation runs. */
#include <math.h>

#include "forces/self/self.h"
#include "mesh/pins.h"
#include "mesh/triangles.h"
#include "sim/simulation.h"

static weft_status check(const weft_sim *sim, const char *function, size_t i,
                         const double numbers[3], weft_error *err)
{
    const weft_status can = weft__sim_changeable(sim, function, err);
    if (can != WEFT_OK) {
        return can;
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

weft_status weft_sim_pin_many(weft_sim *sim, const size_t *particles,
                              const double *velocities, size_t count, weft_error *err)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    weft__mesh *mesh = &sim->cloth->mesh;
    weft_status status = WEFT_OK;
    for (size_t j = 0; status == WEFT_OK && j < count; ++j) {
        status = check(sim, "weft_sim_pin_many", particles[j],
                       velocities != NULL ? velocities + 3 * j : NULL, err);
    }
    if (status != WEFT_OK || count == 0) {
        return status;
    }
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

weft_status weft_sim_pin(weft_sim *sim, size_t vertex, const double velocity[3],
                         weft_error *err)
{
    return weft_sim_pin_many(sim, &vertex, velocity, 1, err);
}

static void place(weft_sim *sim, size_t i, const double position[3])
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
    const weft_status status = check(sim, "weft_sim_move_pin", vertex, position, err);
    if (status != WEFT_OK) {
        return status;
    }
    if (position == NULL || !weft_cloth_pinned(sim->cloth, vertex)) {
        return weft_error_set(err, WEFT_INVALID, "particle %zu %s", vertex,
                              position == NULL ? "has no position to go to: it is NULL"
                                               : "is not pinned");
    }
    const size_t i = weft__particle_of(&sim->cloth->mesh, vertex);
    const double before[3] = { sim->y[i], sim->y[n + i], sim->y[2 * n + i] };
    weft__sim_change_begins(sim);
    place(sim, i, position);
    if (weft__crossing_error(&sim->cloth->self, sim->y, SIZE_MAX, "", err) != WEFT_OK) {
        place(sim, i, before);
        return WEFT_INVALID;
    }
    weft__sim_change_ends(sim, false);
    return WEFT_OK;
}

weft_status weft_sim_unpin(weft_sim *sim, size_t vertex, weft_error *err)
{
    const weft_status status = check(sim, "weft_sim_unpin", vertex, NULL, err);
    if (status == WEFT_OK && weft_cloth_pinned(sim->cloth, vertex)) {
        const size_t i = weft__particle_of(&sim->cloth->mesh, vertex);
        const weft__breach breach
            = weft__particle_breach(sim->cloth, sim->t, sim->y, i);
        if (breach.found) {
            return weft__breach_error(sim->cloth, &breach, "is", err);
        }
        if (weft__crossing_error(&sim->cloth->self, sim->y, i, "", err) != WEFT_OK) {
            return WEFT_INVALID;
        }
        weft__sim_change_begins(sim);
        weft__set_hold(&sim->cloth->mesh, i, WEFT__FREE);
        weft__pins_changed(&sim->cloth->mesh, sim->y);
        weft__sim_change_ends(sim, true);
    }
    return status;
}
