/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_shapes.c -- shapes that are added, moved and removed between two steps, and the
 * load on them. */
#include <string.h>

#include "base/memory.h"
#include "base/sized.h"
#include "forces/contact/bodies/bodies.h"
#include "sim/bands.h"
#include "sim/simulation.h"

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
        weft__bodies_load(&sim->cloth->bodies, sim->forces.spaces[WEFT__FORCE_bodies],
                          &shape.at, k, load);
    } else {
        weft__bands_sum(&sim->forces, block_load, &shape, WEFT__LOAD, load);
    }
    memcpy(force, load, 3 * sizeof *force);
    memcpy(torque, load + 3, 3 * sizeof *torque);
}
