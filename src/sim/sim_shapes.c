/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_shapes.c -- shapes that change while a simulation runs. */
#include <string.h>

#include "base/finite.h"
#include "base/memory.h"
#include "base/sized.h"
#include "sim/bands.h"
#include "sim/simulation.h"

static weft_status check(const weft_sim *sim, const char *function, size_t k,
                         weft_error *err)
{
    const weft_status can = weft__sim_changeable(sim, function, err);
    if (can != WEFT_OK) {
        return can;
    }
    if (k >= sim->cloth->contact.shape_count) {
        return weft_error_set(err, WEFT_INVALID, "no shapes[%zu]: there are %zu", k,
                              sim->cloth->contact.shape_count);
    }
    return WEFT_OK;
}

/* Shape k, or one more, becomes this one, unless a free particle is in it. */
static weft_status put(weft_sim *sim, size_t k, const weft__shape *shape,
                       weft_error *err)
{
    weft_cloth *cloth = sim->cloth;
    const size_t count = cloth->contact.shape_count;
    const weft__shape before = k < count ? cloth->contact.shapes[k] : *shape;
    weft__sim_change_begins(sim);
    cloth->contact.shapes[k] = *shape;
    cloth->contact.shape_count = k < count ? count : count + 1;
    const weft__breach breach = weft__state_breach(cloth, sim->t, sim->y);
    if (breach.found) {
        cloth->contact.shapes[k] = before;
        cloth->contact.shape_count = count;
        return weft__breach_error(cloth, &breach, "would be", err);
    }
    weft__sim_change_ends(sim, true);
    return WEFT_OK;
}

static weft_status make_room(weft_sim *sim, weft_error *err)
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

weft_status weft_sim_add_shape_sized(weft_sim *sim, const weft_shape *given,
                                     size_t size, size_t *k, weft_error *err)
{
    const size_t count = sim->cloth->contact.shape_count;
    weft_shape shape = weft_shape_default(WEFT_PLANE);
    weft__shape made;
    weft_status status = weft__sim_changeable(sim, "weft_sim_add_shape", err);
    if (status == WEFT_OK && given != NULL
        && !weft__sized_read(&shape, sizeof shape, given, size)) {
        status = weft__sized_unknown("weft_shape", err);
    }
    if (status == WEFT_OK) {
        status = weft__shape_make(&sim->cloth->contact, given == NULL ? NULL : &shape,
                                  sim->t, count, &made, err);
    }
    if (status == WEFT_OK) {
        status = make_room(sim, err);
    }
    if (status == WEFT_OK) {
        status = put(sim, count, &made, err);
    }
    if (status == WEFT_OK && k != NULL) {
        *k = count;
    }
    return status;
}

/* Its place at `t` becomes `to`, from where it moves on as `def` says. A velocity that
 * is not finite is left to the check of `def`. */
static void move_to(weft_shape *def, double t, const double to[3])
{
    if (!weft__all_finite(def->velocity, 3)) {
        return;
    }
    weft__motion motion
        = weft__motion_of(def->velocity, def->amplitude, def->frequency);
    double swing[3];
    motion.since = t;
    weft__motion_offset(&motion, t, swing);
    for (size_t k = 0; k < 3; ++k) {
        const double at = to[k] - swing[k];
        def->to[k] += at - def->at[k];
        def->at[k] = at;
    }
}

weft_status weft_sim_move_shape(weft_sim *sim, size_t k, const double place[3],
                                const double velocity[3], weft_error *err)
{
    weft_status status = check(sim, "weft_sim_move_shape", k, err);
    if (status != WEFT_OK || (place == NULL && velocity == NULL)) {
        return status;
    }
    weft_shape def = weft_cloth_shape(sim->cloth, k);
    weft__shape made;
    double present[3];
    weft_cloth_shape_pose(sim->cloth, k, sim->t, present, NULL);
    if (velocity != NULL) {
        memcpy(def.velocity, velocity, sizeof def.velocity);
        memset(def.amplitude, 0, sizeof def.amplitude);
    }
    move_to(&def, sim->t, place != NULL ? place : present);
    status = weft__shape_make(&sim->cloth->contact, &def, sim->t, k, &made, err);
    return status == WEFT_OK ? put(sim, k, &made, err) : status;
}

weft_status weft_sim_remove_shape(weft_sim *sim, size_t k, weft_error *err)
{
    const weft_status status = check(sim, "weft_sim_remove_shape", k, err);
    if (status == WEFT_OK) {
        weft_cloth *cloth = sim->cloth;
        weft__sim_change_begins(sim);
        --cloth->contact.shape_count;
        memmove(cloth->contact.shapes + k, cloth->contact.shapes + k + 1,
                (cloth->contact.shape_count - k) * sizeof *cloth->contact.shapes);
        weft__sim_change_ends(sim, true);
    }
    return status;
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
    weft__bands_sum(&sim->forces, block_load, &shape, WEFT__LOAD, load);
    memcpy(force, load, 3 * sizeof *force);
    memcpy(torque, load + 3, 3 * sizeof *torque);
}
