/* SPDX-License-Identifier: BSD-3-Clause */
/* save.c -- a simulation as bytes.
 *
 * A solver's memory of its past cannot be read, so it is dropped: saving replaces the
 * stepper here as restoring will there. Only its counts and its next h remain. */
#include "sim/save.h"

#include <math.h>

#include "base/finite.h"
#include "base/memory.h"
#include "mesh/pins.h"
#include "sim/bands.h"

static weft__save_fields fields_of(const weft_sim *sim)
{
    const weft_stepper_stats stats = weft_sim_stats(sim);
    return (weft__save_fields){
        .t = sim->t,
        .next_step = stats.next_step,
        .last_step = stats.last_step,
        .energy_start = sim->ledger.start,
        .work_limit = sim->ledger.work_limit,
        .work_outside = sim->ledger.work_outside,
        .limit_step = sim->limit.last_step,
        .event_since = sim->event.since,
        .steps = stats.steps,
        .rejected = stats.rejected,
        .rhs_calls = stats.rhs_calls,
        .limit = sim->limit.stats,
        .vetoed = sim->guard.vetoed,
        .linear_iterations = stats.linear_iterations,
        .factorisations = stats.factorisations,
        .newton_failures = stats.newton_failures,
        .flags = sim->passage.told ? WEFT__SAVED_PASSAGE : 0,
    };
}

weft_status weft__sim_renew(weft_sim *sim, const weft__save_fields *counted,
                            weft_error *err)
{
    void *fresh = NULL;
    const weft_status mine = weft__sim_stepper(sim, counted->next_step, &fresh, err);
    const weft_status status = weft_comm_agree(sim->def.comm, mine, err);
    sim->def.method->destroy(status == WEFT_OK ? sim->stepper : fresh);
    if (status == WEFT_OK) {
        sim->stepper = fresh;
        sim->event.value = NAN;
        weft__between_forget(sim);
        sim->earlier
            = (weft_stepper_stats){ .steps = counted->steps,
                                    .rejected = counted->rejected,
                                    .rhs_calls = counted->rhs_calls,
                                    .last_step = counted->last_step,
                                    .linear_iterations = counted->linear_iterations,
                                    .factorisations = counted->factorisations,
                                    .newton_failures = counted->newton_failures };
    }
    return status;
}

weft_status weft_sim_restart(weft_sim *sim, weft_error *err)
{
    TRY(weft__sim_outside(sim, "weft_sim_restart", err));
    const weft__save_fields now = fields_of(sim);
    return weft__sim_renew(sim, &now, err);
}

/* ---- what bytes there are -------------------------------------------------------- */

size_t weft_sim_save_size(const weft_sim *sim)
{
    return (weft__save_front(sim, weft__changes_words(sim->cloth))
            + weft__save_planes(sim) * weft__save_particles(sim))
           * WEFT__WORD;
}

weft__save_head weft__save_head_of(const weft_sim *sim)
{
    weft__save_head out = { .version = WEFT__SAVE_VERSION,
                            .rows = sim->cloth->mesh.band.rows,
                            .cols = weft__width_of(&sim->cloth->mesh),
                            .quadratures = sim->config.quadratures,
                            .cloth = sim->cloth_hash,
                            .settings = sim->settings,
                            .fields = fields_of(sim),
                            .changes = weft__changes_words(sim->cloth) };
    memcpy(out.magic, WEFT__SAVE_MAGIC, sizeof out.magic);
    (void)snprintf(out.name, sizeof out.name, "%s", sim->def.method->name);
    return out;
}

static uint64_t add_words(uint64_t sum, const void *words, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        uint64_t word;
        memcpy(&word, (const unsigned char *)words + i * WEFT__WORD, sizeof word);
        sum = weft__hash_word(sum, word);
    }
    return sum;
}

uint64_t weft__save_sum(const weft_sim *sim, const double *y, const double *s,
                        const uint64_t *holds, const unsigned char *front, size_t words)
{
    const weft__forces *forces = &sim->forces;
    const weft_cloth *cloth = sim->cloth;
    uint64_t *own = (uint64_t *)(void *)forces->measures;
    for (size_t r = 0; r < cloth->mesh.band.own; ++r) {
        const size_t b = cloth->mesh.band.above + r;
        const size_t first = weft__block(&cloth->mesh, b);
        const size_t count = weft__block(&cloth->mesh, b + 1) - first;
        own[r] = WEFT__HASH_START;
        for (size_t k = 0; k < 6; ++k) {
            own[r] = add_words(own[r], y + k * cloth->mesh.particles + first, count);
        }
        own[r] = add_words(own[r], holds + first, count);
        for (size_t k = 0; k < 6 * sim->sensitivity.count; ++k) {
            own[r] = add_words(own[r], s + k * cloth->mesh.particles + first, count);
        }
    }
    const uint64_t *rows = weft__bands_blocks(forces, own, sizeof *own);
    const uint64_t sum = weft__words_sum(front, rows == NULL ? 0 : words);
    return rows == NULL ? sum : add_words(sum, rows, cloth->mesh.band.rows);
}

/* ---- to bytes -------------------------------------------------------------------- */

/* All but the checksum. */
static void put_front(const weft_sim *sim, unsigned char *to)
{
    const weft__save_head head = weft__save_head_of(sim);
    const size_t quadratures = sim->config.quadratures;
    weft__words_put(to, &head, SAVE_HEAD);
    memcpy(to, head.magic, sizeof head.magic); /* texts are no words */
    memcpy(to + offsetof(weft__save_head, name), head.name, sizeof head.name);
    to += SAVE_HEAD * WEFT__WORD;
    weft__words_put(to, sim->y + weft_cloth_dim(sim->cloth), quadratures);
    weft__changes_put(sim->cloth, to + quadratures * WEFT__WORD);
}

/* Where bytes go, and room on the way: of the front, of a plane of holds and of own
 * particles of a plane. */
typedef struct parts {
    weft_save_put *put;
    void *ctx;
    unsigned char *front;
    uint64_t *holds;
    unsigned char *plane;
} parts;

/* On a band that fails all calls are made too. */
static weft_status put_planes(const weft_sim *sim, const parts *to, weft_status status,
                              weft_error *err)
{
    const weft_cloth *cloth = sim->cloth;
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles, skip = weft__block(mesh, mesh->band.above);
    const size_t own = weft__block(mesh, mesh->band.above + mesh->band.own) - skip;
    size_t at = weft__save_front(sim, weft__changes_words(cloth))
                + mesh->band.first * mesh->block;
    for (size_t k = 0; k < weft__save_planes(sim); ++k) {
        const void *from
            = k < 6    ? (const void *)(sim->y + k * n + skip)
              : k == 6 ? (const void *)(to->holds + skip)
                       : (const void *)(sim->sensitivity.s + (k - 7) * n + skip);
        weft__words_put(to->plane, from, own);
        const weft_status one
            = to->put(to->ctx, (uint64_t)at * WEFT__WORD, to->plane, own * WEFT__WORD,
                      status == WEFT_OK ? err : NULL);
        status = status == WEFT_OK ? one : status;
        at += weft__save_particles(sim);
    }
    return status;
}

static weft_status put_all(weft_sim *sim, const parts *to, weft_error *err)
{
    const size_t words = weft__save_front(sim, weft__changes_words(sim->cloth));
    const bool first = weft__bands_is_first(sim->def.comm);
    TRY(weft_sim_restart(sim, err));
    weft__pins_changed(&sim->cloth->mesh, sim->y); /* as restore will */
    for (size_t i = 0; i < sim->cloth->mesh.particles; ++i) {
        to->holds[i] = weft__hold_of(&sim->cloth->mesh, i);
    }
    put_front(sim, to->front);
    weft__sensitivity_unpack(sim);
    weft__word_put(to->front + (words - 1) * WEFT__WORD,
                   weft__save_sum(sim, sim->y, sim->sensitivity.s, to->holds, to->front,
                                  words - 1));
    ++sim->callbacks;
    weft_status status = to->put(to->ctx, 0, first ? to->front : NULL,
                                 first ? words * WEFT__WORD : 0, err);
    status = put_planes(sim, to, status, err);
    --sim->callbacks;
    return weft_comm_agree(sim->def.comm, status, err);
}

weft_status weft_sim_save_parts(weft_sim *sim, weft_save_put *put, void *ctx,
                                weft_error *err)
{
    TRY(weft__sim_outside(sim, "weft_sim_save_parts", err));
    const char *what = sim->ledger.on && !isfinite(weft_sim_ledger(sim).residual)
                           ? "energy balance"
                       : sim->def.correct != NULL
                               && !weft__all_finite(sim->y, weft_cloth_dim(sim->cloth))
                           ? "state that `correct` left"
                           : NULL;
    if (what != NULL) {
        return weft_error_set(err, WEFT_NOT_FINITE,
                              "the %s is not finite: it could not be restored", what);
    }
    const weft_allocator *memory = &sim->memory;
    const size_t n = sim->cloth->mesh.particles;
    const size_t front = weft__save_front(sim, weft__changes_words(sim->cloth));
    parts to = { .put = put, .ctx = ctx };
    to.front = weft__alloc(memory, front, WEFT__WORD);
    to.holds = weft__alloc(memory, n, sizeof *to.holds);
    to.plane = weft__alloc(memory, n, WEFT__WORD);
    weft_status status
        = to.front == NULL || to.holds == NULL || to.plane == NULL
              ? weft_error_set(err, WEFT_NO_MEMORY, "no memory to save a simulation")
              : WEFT_OK;
    status = weft_comm_agree(sim->def.comm, status, err);
    status = status == WEFT_OK ? put_all(sim, &to, err) : status;
    WEFT__FREE_ALL(memory, to.front, to.holds, to.plane);
    return status;
}

typedef struct whole {
    const weft_comm *comm;
    unsigned char *bytes; /* on band 0 */
} whole;

/* The parts of the bands follow one another, band 0's first. */
static weft_status put_whole(void *ctx, uint64_t at, const void *bytes, size_t size,
                             weft_error *err)
{
    const whole *to = ctx;
    (void)err;
    if (to->comm == NULL) {
        memcpy(to->bytes + at, bytes, size);
    } else {
        to->comm->gather(to->comm->self, bytes, size,
                         to->comm->rank == 0 ? to->bytes + at : NULL);
    }
    return WEFT_OK;
}

weft_status weft_sim_save(weft_sim *sim, void *bytes, size_t size, weft_error *err)
{
    TRY(weft__sim_outside(sim, "weft_sim_save", err));
    const size_t least = weft_sim_save_size(sim);
    const bool room
        = (bytes != NULL && size >= least) || !weft__bands_is_first(sim->def.comm);
    whole to = { sim->def.comm, bytes };
    const weft_status mine
        = room ? WEFT_OK
               : weft_error_set(err, WEFT_INVALID,
                                "a saved simulation needs %zu bytes, not %zu", least,
                                bytes == NULL ? 0 : size);
    TRY(weft_comm_agree(sim->def.comm, mine, err));
    return weft_sim_save_parts(sim, put_whole, &to, err);
}
