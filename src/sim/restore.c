/* SPDX-License-Identifier: BSD-3-Clause */
/* restore.c -- a simulation from the bytes of save.c. */
#include <math.h>

#include "base/memory.h"
#include "mesh/pins.h"
#include "sim/bands.h"
#include "sim/save.h"

/* The bytes. */
typedef struct source {
    weft_save_get *get;
    void *ctx;
    size_t size;
} source;

/* A saved simulation on its way into another. */
typedef struct restored {
    weft__save_head head;
    unsigned char *front;
    size_t front_words;
    uint64_t *holds;
    double *y, *s;
    weft_cloth cloth; /* the present one with what is saved of its forces */
} restored;

static uint64_t word(const unsigned char *from, size_t at)
{
    return weft__word_at(from + at * WEFT__WORD);
}

static weft_status damaged(weft_error *err)
{
    return weft_error_set(err, WEFT_INVALID,
                          "the saved simulation is damaged or cut off");
}

/* ---- bytes, of which each band reads those of its particles ---------------------- */

static weft_status get_words(const source *from, size_t at, void *to, size_t words,
                             weft_error *err)
{
    return from->get(from->ctx, (uint64_t)at * WEFT__WORD, to, words * WEFT__WORD, err);
}

static weft__save_head head_at(const unsigned char *from)
{
    weft__save_head out;
    weft__words_get(&out, from, SAVE_HEAD);
    memcpy(out.magic, from, sizeof out.magic); /* texts are no words */
    memcpy(out.name, from + offsetof(weft__save_head, name), sizeof out.name);
    return out;
}

/* [words] Those before the planes. */
static weft_status find_front(const weft_sim *sim, const weft__save_head *head,
                              size_t size, size_t *front, weft_error *err)
{
    const size_t words = size / WEFT__WORD;
    const size_t planes = weft__save_planes(sim) * weft__save_particles(sim);
    const bool old = head->version == WEFT__SAVE_VERSION_9;
    const size_t least
        = planes + (old ? weft__save_front_9(sim) : weft__save_front(sim, 0));
    *front = words - planes;
    return words >= least && (old || head->changes == words - least)
                   && size % WEFT__WORD == 0
               ? WEFT_OK
               : damaged(err);
}

/* Whether the bytes are those of a simulation, and their places those of this one. */
static weft_status check_head(const weft_sim *sim, const weft__save_head *head,
                              weft_error *err)
{
    const weft__save_head mine = weft__save_head_of(sim);
    if (memcmp(head->magic, mine.magic, sizeof mine.magic) != 0) {
        return weft_error_set(err, WEFT_INVALID, "this is not a saved simulation");
    }
    if (head->version != mine.version && head->version != WEFT__SAVE_VERSION_9) {
        return weft_error_set(err, WEFT_INVALID,
                              "a simulation saved in format %llu, and this is %d",
                              (unsigned long long)head->version, WEFT__SAVE_VERSION);
    }
    if (head->rows != mine.rows || head->cols != mine.cols) {
        return weft_error_set(
            err, WEFT_INVALID,
            "saved of %llu x %llu particles, and these are %llu x %llu",
            (unsigned long long)head->rows, (unsigned long long)head->cols,
            (unsigned long long)mine.rows, (unsigned long long)mine.cols);
    }
    return head->quadratures == mine.quadratures
               ? WEFT_OK
               : weft_error_set(err, WEFT_INVALID, "saved %s energy balance",
                                sim->ledger.on ? "without" : "with");
}

static weft_status restore_make_room(const weft_sim *sim, restored *to, weft_error *err)
{
    const weft_allocator *memory = &sim->memory;
    to->front = weft__alloc(memory, to->front_words, WEFT__WORD);
    to->holds = weft__alloc(memory, sim->cloth->mesh.particles, sizeof *to->holds);
    to->y = weft__alloc(memory, weft__sim_dim(sim) * (1 + sim->sensitivity.count),
                        sizeof *to->y);
    to->s = to->y != NULL ? to->y + weft__sim_dim(sim) : NULL;
    return to->front != NULL && to->holds != NULL && to->y != NULL
               ? WEFT_OK
               : weft_error_set(err, WEFT_NO_MEMORY, "no memory to restore a state");
}

/* Of a plane that begins at `at`, the particles here: runs that follow one another in
 * the whole, too. */
static weft_status read_plane(const weft_sim *sim, const source *from, size_t at,
                              unsigned char *plane, weft_error *err)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    const size_t n = mesh->particles;
    for (size_t i = 0, run = 0; i < n; i += run) {
        const size_t first = weft__whole_index(mesh, i);
        for (run = 1; i + run < n && weft__whole_index(mesh, i + run) == first + run;) {
            ++run;
        }
        TRY(get_words(from, at + first, plane + i * WEFT__WORD, run, err));
    }
    return WEFT_OK;
}

static weft_status read_planes(const weft_sim *sim, const source *from, restored *to,
                               weft_error *err)
{
    const size_t n = sim->cloth->mesh.particles;
    size_t at = to->front_words;
    for (size_t k = 0; k < weft__save_planes(sim); ++k) {
        void *plane = k < 6    ? (void *)(to->y + k * n)
                      : k == 6 ? (void *)to->holds
                               : (void *)(to->s + (k - 7) * n);
        TRY(read_plane(sim, from, at, plane, err));
        weft__words_get(plane, plane, n);
        at += weft__save_particles(sim);
    }
    return WEFT_OK;
}

/* Allocates, also if it fails. */
static weft_status read_saved(const weft_sim *sim, const source *from, restored *to,
                              weft_error *err)
{
    unsigned char head[SAVE_HEAD * WEFT__WORD] = { 0 };
    if (from->size >= sizeof head) { /* else it has no magic */
        TRY(get_words(from, 0, head, SAVE_HEAD, err));
    }
    to->head = head_at(head);
    TRY(check_head(sim, &to->head, err));
    TRY(find_front(sim, &to->head, from->size, &to->front_words, err));
    TRY(restore_make_room(sim, to, err));
    TRY(get_words(from, 0, to->front, to->front_words, err));
    return read_planes(sim, from, to, err);
}

/* ---- what they say --------------------------------------------------------------- */

/* Collective. */
static weft_status restore_check_sum(const weft_sim *sim, const restored *from,
                                     weft_error *err)
{
    const size_t last = from->front_words - 1;
    const uint64_t sum
        = weft__save_sum(sim, from->y, from->s, from->holds, from->front, last);
    const bool right
        = sum == word(from->front, last) || !weft__bands_is_first(sim->def.comm);
    return weft_comm_agree(sim->def.comm, right ? WEFT_OK : damaged(err), err);
}

static weft_status check_definition(const weft_sim *sim, const restored *from,
                                    weft_error *err)
{
    const weft__save_head mine = weft__save_head_of(sim), *head = &from->head;
    if (memcmp(mine.name, head->name, sizeof mine.name) != 0) {
        return weft_error_set(err, WEFT_INVALID,
                              "saved under method '%.63s', and this is '%.63s'",
                              head->name, mine.name);
    }
    if (head->cloth != mine.cloth) {
        return weft_error_set(err, WEFT_INVALID,
                              "saved of another cloth (springs, masses, pins, forces "
                              "or contact differ)");
    }
    return head->settings == mine.settings
               ? WEFT_OK
               : weft_error_set(err, WEFT_INVALID,
                                "saved under other settings of the integrator, the "
                                "limit or sensitivities, or other callbacks");
}

/* What is wrong; NULL: nothing. Forged bytes may have a correct checksum. */
static const char *restore_fault_of(const weft_sim *sim, const restored *of)
{
    const weft__save_fields *saved = &of->head.fields;
    const size_t dim = weft_cloth_dim(sim->cloth);
    const double works[]
        = { saved->energy_start, saved->work_limit, saved->work_outside };
    bool held = true;
    for (size_t i = 0; i < sim->cloth->mesh.particles; ++i) {
        held = held && weft__can_hold(&sim->cloth->mesh, i, of->holds[i]);
    }
    return !isfinite(saved->t) || !weft__not_negative(saved->next_step)
                   || !weft__not_negative(saved->last_step)
                   || !weft__not_negative(saved->limit_step)
                   || !weft__all_finite(of->y, dim)
               ? "the saved simulation has a time, a step or a state that is not finite"
           : sim->ledger.on
                   && (!weft__all_finite(works, 3)
                       || !weft__all_finite(of->y + dim, sim->config.quadratures))
               ? "the saved simulation has an energy balance that is not finite"
           : saved->flags > WEFT__SAVED_FLAGS ? "a saved flag makes no sense"
           : !held                            ? "a saved pin makes no sense"
                                              : NULL;
}

static weft_status check_gaps(const weft_sim *sim, const restored *from,
                              weft_error *err)
{
    for (size_t i = 0; i < sim->cloth->mesh.particles; ++i) {
        const weft__penetration penetration
            = weft__particle_penetration(&from->cloth, from->head.fields.t, from->y, i);
        if (penetration.found && from->holds[i] == WEFT__FREE) {
            return weft__penetration_error(&from->cloth, &penetration, "was saved",
                                           err);
        }
    }
    return WEFT_OK;
}

static void take_fields(weft_sim *sim, const weft__save_fields *from)
{
    sim->t = from->t;
    sim->ledger.start = from->energy_start;
    sim->ledger.work_limit = from->work_limit;
    sim->ledger.work_outside = from->work_outside;
    sim->rejected = from->rejected;
    sim->limit.last_step = from->limit_step;
    sim->event.since = from->event_since;
    sim->limit.stats = from->limit;
    sim->guard.vetoed = from->vetoed;
    sim->passage.next = -INFINITY;
    sim->passage.told = (from->flags & WEFT__SAVED_PASSAGE) != 0;
}

static void restore_swap(double *a, double *b, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        const double kept = a[i];
        a[i] = b[i];
        b[i] = kept;
    }
}

/* Pins, changes of forces and state of the simulation for those saved; once more: back.
 * The new stepper is made in between, as a method may refuse other pins than its own.
 */
static void exchange(weft_sim *sim, restored *with)
{
    weft__mesh *mesh = &sim->cloth->mesh;
    for (size_t i = 0; i < weft_cloth_particles(sim->cloth); ++i) {
        const weft__hold hold = weft__hold_of(mesh, i);
        weft__set_hold(mesh, i, (weft__hold)with->holds[i]);
        with->holds[i] = hold;
    }
    restore_swap(sim->y, with->y, weft__sim_dim(sim));
    weft__sensitivity_unpack(sim);
    restore_swap(sim->sensitivity.s, with->s,
                 weft__sim_dim(sim) * sim->sensitivity.count);
    weft__sensitivity_pack(sim);
    weft__changes_exchange(sim->cloth, &with->cloth);
    weft__pins_changed(mesh, sim->y);
    weft__structure_update(sim);
}

/* Of an older format. */
static weft_status renew_front(const weft_sim *sim, restored *of, weft_error *err)
{
    if (of->head.version == WEFT__SAVE_VERSION) {
        return WEFT_OK;
    }
    unsigned char *old = of->front;
    of->front = weft__save_from_9(sim, old, of->front_words, &of->front_words);
    weft__free(&sim->memory, old);
    return of->front != NULL
               ? WEFT_OK
               : weft_error_set(err, WEFT_NO_MEMORY, "no memory to restore a state");
}

/* Of checked bytes; the arrays are there. */
static weft_status read_fields(weft_sim *sim, restored *to, weft_error *err)
{
    const size_t quadratures = sim->config.quadratures;
    TRY(renew_front(sim, to, err));
    const unsigned char *from = to->front + SAVE_HEAD * WEFT__WORD;
    to->head = head_at(to->front);
    TRY(check_definition(sim, to, err));
    weft__words_get(to->y + weft_cloth_dim(sim->cloth), from, quadratures);
    const char *fault = restore_fault_of(sim, to);
    TRY(fault != NULL ? weft_error_set(err, WEFT_INVALID, "%s", fault) : WEFT_OK);
    to->cloth = *sim->cloth;
    TRY(weft__changes_take(&to->cloth, from + quadratures * WEFT__WORD,
                           (size_t)to->head.changes, &sim->memory, err));
    TRY(check_gaps(sim, to, err));
    return weft__cloth_checks(&to->cloth) ? weft__sim_make_start(sim, err) : WEFT_OK;
}

/* Leaves arrays behind in *to. Collective. */
static weft_status restore(weft_sim *sim, const source *from, restored *to,
                           weft_error *err)
{
    const weft_comm *comm = sim->def.comm;
    ++sim->callbacks;
    const weft_status read = read_saved(sim, from, to, err);
    --sim->callbacks;
    TRY(weft_comm_agree(comm, read, err));
    TRY(restore_check_sum(sim, to, err));
    TRY(weft_comm_agree(comm, read_fields(sim, to, err), err));
    exchange(sim, to);
    const weft_status status = weft__sim_renew(sim, &to->head.fields, err);
    if (status == WEFT_OK) {
        take_fields(sim, &to->head.fields);
        weft_stepper_ode_changed(sim->def.method, sim->stepper);
    } else {
        exchange(sim, to);
    }
    return status;
}

weft_status weft_sim_restore_parts(weft_sim *sim, weft_save_get *get, void *ctx,
                                   size_t size, weft_error *err)
{
    TRY(weft__sim_outside_play(sim, "weft_sim_restore_parts", err));
    const source from = { get, ctx, size };
    restored to = { .front_words = 0 };
    const weft_status status = restore(sim, &from, &to, err);
    weft__changes_drop(&to.cloth, &sim->memory);
    WEFT__FREE_ALL(&sim->memory, to.front, to.holds, to.y);
    return status;
}

/* Of the bytes that *ctx points to. */
static weft_status get_copy(void *ctx, uint64_t at, void *to, size_t size,
                            weft_error *err)
{
    const unsigned char *const *bytes = ctx;
    (void)err;
    memcpy(to, *bytes + at, size);
    return WEFT_OK;
}

weft_status weft_sim_restore(weft_sim *sim, const void *bytes, size_t size,
                             weft_error *err)
{
    TRY(weft__sim_outside_play(sim, "weft_sim_restore", err));
    const unsigned char *from = bytes;
    return weft_sim_restore_parts(sim, get_copy, &from, bytes == NULL ? 0 : size, err);
}
