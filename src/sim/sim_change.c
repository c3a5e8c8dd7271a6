/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_change.c -- changes of a simulation from outside, between two steps: of its
 * state, its pins and its shapes. */
#include <math.h>

#include "base/memory.h"
#include "base/sized.h"
#include "cloth/grids.h"
#include "forces/contact/self/crossing.h"
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

/* ---- shapes ---------------------------------------------------------------------- */

static weft_status check_shape(const weft_sim *sim, const char *function, size_t k,
                               weft_error *err)
{
    TRY(weft__sim_changeable(sim, function, err));
    if (k >= sim->cloth->contact.shape_count) {
        return weft_error_set(err, WEFT_INVALID, "no shapes[%zu]: there are %zu", k,
                              sim->cloth->contact.shape_count);
    }
    return WEFT_OK;
}

static weft_status meshes_stay(const char *how, weft_error *err)
{
    return weft_error_set(err, WEFT_UNSUPPORTED,
                          "a shape of kind mesh cannot be %s: it belongs to the "
                          "definition of the cloth",
                          how);
}

/* Shape k, or one more, becomes this one, unless a free particle is in it. */
static weft_status sim_change_put(weft_sim *sim, size_t k, const weft__shape *shape,
                                  weft_error *err)
{
    weft_cloth *cloth = sim->cloth;
    const size_t count = cloth->contact.shape_count;
    const weft__shape before = k < count ? cloth->contact.shapes[k] : *shape;
    weft__sim_change_begins(sim);
    cloth->contact.shapes[k] = *shape;
    cloth->contact.shape_count = k < count ? count : count + 1;
    ++cloth->contact.changes;
    const weft__penetration penetration
        = weft__state_penetration(cloth, sim->t, sim->y);
    const weft_status crosses
        = penetration.found
              ? weft__penetration_error(cloth, &penetration, "would be", err)
          : shape->def.body != NULL ? weft__bodies_error(&cloth->bodies, sim->t, sim->y,
                                                         &(weft__search){ 0 }, err)
                                    : WEFT_OK;
    if (crosses != WEFT_OK) {
        cloth->contact.shapes[k] = before;
        cloth->contact.shape_count = count;
        ++cloth->contact.changes;
        return crosses;
    }
    weft__sim_change_ends(sim, true);
    return WEFT_OK;
}

static weft_status sim_change_make_room(weft_sim *sim, weft_error *err)
{
    weft_cloth *cloth = sim->cloth;
    weft__shape *grown = weft__resize(&sim->memory, cloth->contact.shapes,
                                      cloth->contact.shape_count + 1, sizeof *grown);
    if (grown == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for shapes[%zu]",
                              cloth->contact.shape_count);
    }
    cloth->contact.shapes = grown;
    return weft__sim_make_start(sim, err);
}

/* The caller's shape, of any version. */
static weft_status read_shape(weft_shape *to, const weft_shape *given, size_t size,
                              weft_error *err)
{
    return given == NULL || weft__sized_read(to, sizeof *to, given, size)
               ? WEFT_OK
               : weft__sized_unknown("weft_shape", err);
}

weft_status weft_sim_add_shape_sized(weft_sim *sim, const weft_shape *given,
                                     size_t size, size_t *k, weft_error *err)
{
    const size_t count = sim->cloth->contact.shape_count;
    weft_shape shape = weft_shape_default(WEFT_PLANE);
    weft__shape made;
    TRY(weft__sim_changeable(sim, "weft_sim_add_shape", err));
    TRY(read_shape(&shape, given, size, err));
    if (shape.kind == WEFT_MESH) {
        return meshes_stay("added", err);
    }
    TRY(weft__shape_make(&sim->cloth->contact, given == NULL ? NULL : &shape, sim->t,
                         count, &made, err));
    TRY(sim_change_make_room(sim, err));
    TRY(sim_change_put(sim, count, &made, err));
    if (k != NULL) {
        *k = count;
    }
    return WEFT_OK;
}

/* Shape k, with the motion of `def` from now on. */
static weft_status move_shape(weft_sim *sim, size_t k, const double place[3],
                              weft_shape *def, weft_error *err)
{
    const weft__contact *contact = &sim->cloth->contact;
    const weft__shape before = contact->shapes[k];
    weft__shape made;
    TRY(weft__shape_make(contact, def, sim->t, k, &made, err));
    weft__shape_rebase(&before, sim->t, place, def);
    TRY(weft__shape_make(contact, def, sim->t, k, &made, err));
    return sim_change_put(sim, k, &made, err);
}

weft_status weft_sim_move_shape(weft_sim *sim, size_t k, const double place[3],
                                const double velocity[3], weft_error *err)
{
    const weft_status status = check_shape(sim, "weft_sim_move_shape", k, err);
    if (status != WEFT_OK || (place == NULL && velocity == NULL)) {
        return status;
    }
    const weft_shape none = weft_shape_default(WEFT_SPHERE);
    const weft__pose now = weft__pose_of(&sim->cloth->contact.shapes[k], sim->t);
    weft_shape def = weft_cloth_shape(sim->cloth, k);
    const double *to = place != NULL ? place : now.at;
    for (size_t j = 0; now.rigid.turns && j < 3; ++j) { /* the axis goes along */
        def.turn.about[j] = now.rigid.about[j] + (to[j] - now.at[j]);
    }
    if (velocity != NULL) {
        memcpy(def.velocity, velocity, sizeof def.velocity);
        memset(def.amplitude, 0, sizeof def.amplitude);
        def.turn = none.turn;
    }
    return move_shape(sim, k, to, &def, err);
}

weft_status weft_sim_drive_shape_sized(weft_sim *sim, size_t k, const weft_shape *given,
                                       size_t size, weft_error *err)
{
    weft_shape as = weft_shape_default(WEFT_SPHERE);
    TRY(check_shape(sim, "weft_sim_drive_shape", k, err));
    TRY(read_shape(&as, given, size, err));
    const weft__pose now = weft__pose_of(&sim->cloth->contact.shapes[k], sim->t);
    weft_shape def = weft_cloth_shape(sim->cloth, k);
    memcpy(def.velocity, as.velocity, sizeof def.velocity);
    memcpy(def.amplitude, as.amplitude, sizeof def.amplitude);
    def.frequency = as.frequency;
    def.turn = as.turn;
    return move_shape(sim, k, now.at, &def, err);
}

weft_status weft_sim_remove_shape(weft_sim *sim, size_t k, weft_error *err)
{
    weft__contact *contact = &sim->cloth->contact;
    TRY(check_shape(sim, "weft_sim_remove_shape", k, err));
    if (contact->shapes[k].def.kind == WEFT_MESH) {
        return meshes_stay("removed", err);
    }
    weft__sim_change_begins(sim);
    --contact->shape_count;
    memmove(contact->shapes + k, contact->shapes + k + 1,
            (contact->shape_count - k) * sizeof *contact->shapes);
    weft__sim_change_ends(sim, true);
    return WEFT_OK;
}

typedef struct pressed {
    const weft_cloth *cloth;
    weft__state at;
    size_t k;
} pressed;

static void block_load(const void *ctx, size_t r, double *load)
{
    const pressed *shape = ctx;
    weft__block_load(&shape->cloth->contact, &shape->at, r, shape->k, load);
}

void weft_sim_shape_load(const weft_sim *sim, size_t k, double force[3],
                         double torque[3])
{
    const pressed shape
        = { .cloth = sim->cloth, .at = { .t = sim->t, .y = sim->y }, .k = k };
    double load[WEFT__LOAD];
    if (sim->cloth->contact.shapes[k].def.body != NULL) {
        weft__bodies_load(&sim->cloth->bodies, sim->forces.bodies, &shape.at, k, load);
    } else {
        weft__bands_sum(&sim->forces, block_load, &shape, WEFT__LOAD, load);
    }
    memcpy(force, load, 3 * sizeof *force);
    memcpy(torque, load + 3, 3 * sizeof *torque);
}
