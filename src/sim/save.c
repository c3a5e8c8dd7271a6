/* SPDX-License-Identifier: BSD-3-Clause */
/* save.c -- a simulation as bytes, and back.
 *
 * A solver's memory of its past cannot be read, so it is dropped: saving replaces the
 * stepper here as restoring will there. Only its counts and its next h remain.
 *
 * Words (bytes.h): "weftsave", version, rows, cols, quadratures, hashes of the cloth's
 * definition and of the settings, the method's name in 64 bytes, fields, y, the hold of
 * each particle, checksum. */
#include <math.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "cloth/pins.h"
#include "sim/simulation.h"

static const unsigned char magic[WEFT__WORD] = "weftsave";

#define VERSION 4

#define NAME_WORDS 8

/* All that is saved besides the state, in words. */
typedef struct fields {
    double t, next_step, last_step;                /* [s] */
    double energy_start, limit_work, outside_work; /* [J] */
    double limit_step;                             /* [s] */
    uint64_t steps, rejected, rhs_calls;
    weft_limit_stats limit;
} fields;

enum { FIELDS = sizeof(fields) / WEFT__WORD };

enum {
    AT_VERSION = 1,
    AT_ROWS,
    AT_COLS,
    AT_QUADRATURES,
    AT_CLOTH,
    AT_SETTINGS,
    AT_NAME,
    AT_FIELDS = AT_NAME + NAME_WORDS,
    AT_STATE = AT_FIELDS + FIELDS
};

static fields fields_of(const weft_sim *sim)
{
    const weft_stepper_stats stats = weft_sim_stats(sim);
    return (fields){
        .t = sim->t,
        .next_step = stats.next_step,
        .last_step = stats.last_step,
        .energy_start = sim->ledger.start,
        .limit_work = sim->ledger.limit_work,
        .outside_work = sim->ledger.outside_work,
        .limit_step = sim->limit.last_step,
        .steps = stats.steps,
        .rejected = stats.rejected,
        .rhs_calls = stats.rhs_calls,
        .limit = sim->limit.stats,
    };
}

static void take_fields(weft_sim *sim, const fields *from)
{
    sim->t = from->t;
    sim->ledger.start = from->energy_start;
    sim->ledger.limit_work = from->limit_work;
    sim->ledger.outside_work = from->outside_work;
    sim->rejected = from->rejected;
    sim->limit.last_step = from->limit_step;
    sim->limit.stats = from->limit;
}

/* Replaces the stepper; only the h to try and the counts remain. */
static weft_status renew(weft_sim *sim, const fields *counted, weft_error *err)
{
    void *fresh = NULL;
    const weft_status status = weft__sim_stepper(sim, counted->next_step, &fresh, err);
    if (status == WEFT_OK) {
        sim->def.method->destroy(sim->stepper);
        sim->stepper = fresh;
        sim->earlier = (weft_stepper_stats){ .steps = counted->steps,
                                             .rejected = counted->rejected,
                                             .rhs_calls = counted->rhs_calls,
                                             .last_step = counted->last_step };
    }
    return status;
}

weft_status weft_sim_restart(weft_sim *sim, weft_error *err)
{
    if (weft__sim_outside(sim, "weft_sim_restart", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    const fields now = fields_of(sim);
    return renew(sim, &now, err);
}

/* ---- to bytes ---------------------------------------------------------------- */

static size_t saved_words(const weft_sim *sim)
{
    return AT_STATE + weft__sim_dim(sim) + weft_cloth_particles(sim->cloth) + 1;
}

size_t weft_sim_save_size(const weft_sim *sim)
{
    return saved_words(sim) * WEFT__WORD;
}

/* The name of a method, cut to the room, then zeros. */
static void pad_name(const weft_sim *sim, char name[NAME_WORDS * WEFT__WORD])
{
    const size_t size = NAME_WORDS * WEFT__WORD - 1;
    const char *full = sim->def.method->name;
    const size_t length = strlen(full) < size ? strlen(full) : size;
    memset(name, 0, size + 1);
    memcpy(name, full, length);
}

static void put_head(const weft_sim *sim, unsigned char *to)
{
    char name[NAME_WORDS * WEFT__WORD];
    pad_name(sim, name);
    memcpy(to, magic, sizeof magic);
    weft__word_put(to + AT_VERSION * WEFT__WORD, VERSION);
    weft__word_put(to + AT_ROWS * WEFT__WORD, weft_cloth_rows(sim->cloth));
    weft__word_put(to + AT_COLS * WEFT__WORD, weft_cloth_cols(sim->cloth));
    weft__word_put(to + AT_QUADRATURES * WEFT__WORD, sim->config.quadratures);
    weft__word_put(to + AT_CLOTH * WEFT__WORD, sim->cloth_hash);
    weft__word_put(to + AT_SETTINGS * WEFT__WORD, sim->settings);
    memcpy(to + AT_NAME * WEFT__WORD, name, sizeof name);
}

weft_status weft_sim_save(weft_sim *sim, void *bytes, size_t size, weft_error *err)
{
    if (weft__sim_outside(sim, "weft_sim_save", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    const size_t words = saved_words(sim), dim = weft__sim_dim(sim);
    unsigned char *to = bytes, *holds = to + (AT_STATE + dim) * WEFT__WORD;
    if (size < words * WEFT__WORD) {
        return weft_error_set(err, WEFT_INVALID,
                              "a saved simulation needs %zu bytes, not %zu",
                              words * WEFT__WORD, size);
    }
    const weft_status status = weft_sim_restart(sim, err);
    if (status != WEFT_OK) {
        return status;
    }
    weft__cloth_pins_changed(sim->cloth, sim->y); /* as restore will */
    const fields now = fields_of(sim);
    put_head(sim, to);
    weft__words_put(to + AT_FIELDS * WEFT__WORD, &now, FIELDS);
    weft__words_put(to + AT_STATE * WEFT__WORD, sim->y, dim);
    for (size_t i = 0; i < weft_cloth_particles(sim->cloth); ++i) {
        weft__word_put(holds + i * WEFT__WORD, weft__cloth_hold(sim->cloth, i));
    }
    weft__word_put(to + (words - 1) * WEFT__WORD, weft__words_sum(to, words - 1));
    return WEFT_OK;
}

/* ---- and back ---------------------------------------------------------------- */

static uint64_t word(const unsigned char *from, size_t at)
{
    return weft__word_at(from + at * WEFT__WORD);
}

static weft_status damaged(weft_error *err)
{
    return weft_error_set(err, WEFT_INVALID,
                          "the saved simulation is damaged or cut off");
}

static weft_status check_whole(const unsigned char *from, size_t size, weft_error *err)
{
    const size_t words = size / WEFT__WORD;
    if (words <= AT_STATE || memcmp(from, magic, sizeof magic) != 0) {
        return weft_error_set(err, WEFT_INVALID, "this is not a saved simulation");
    }
    if (word(from, AT_VERSION) != VERSION) {
        return weft_error_set(err, WEFT_INVALID,
                              "a simulation saved in format %llu, and this is %d",
                              (unsigned long long)word(from, AT_VERSION), VERSION);
    }
    return size % WEFT__WORD == 0
                   && weft__words_sum(from, words - 1) == word(from, words - 1)
               ? WEFT_OK
               : damaged(err);
}

static weft_status check_kind(const weft_sim *sim, const unsigned char *from,
                              size_t size, weft_error *err)
{
    char name[NAME_WORDS * WEFT__WORD];
    const char *other = (const char *)from + AT_NAME * WEFT__WORD;
    const size_t rows = weft_cloth_rows(sim->cloth), cols = weft_cloth_cols(sim->cloth);
    pad_name(sim, name);
    if (word(from, AT_ROWS) != rows || word(from, AT_COLS) != cols) {
        return weft_error_set(err, WEFT_INVALID,
                              "saved of %llu x %llu particles, and these are %zu x %zu",
                              (unsigned long long)word(from, AT_ROWS),
                              (unsigned long long)word(from, AT_COLS), rows, cols);
    }
    if (memcmp(name, other, sizeof name) != 0) {
        return weft_error_set(err, WEFT_INVALID,
                              "saved under method '%.63s', and this is '%.63s'", other,
                              name);
    }
    if (word(from, AT_QUADRATURES) != sim->config.quadratures) {
        return weft_error_set(err, WEFT_INVALID, "saved %s energy ledger",
                              sim->ledger.on ? "without" : "with");
    }
    return size == weft_sim_save_size(sim) ? WEFT_OK : damaged(err);
}

static weft_status check_definition(const weft_sim *sim, const unsigned char *from,
                                    weft_error *err)
{
    if (word(from, AT_CLOTH) != sim->cloth_hash) {
        return weft_error_set(err, WEFT_INVALID,
                              "saved of another cloth (springs, masses, pins or forces "
                              "differ)");
    }
    if (word(from, AT_SETTINGS) != sim->settings) {
        return weft_error_set(err, WEFT_INVALID,
                              "saved under other settings of the stepper or the limit, "
                              "or other callbacks");
    }
    return WEFT_OK;
}

static weft_status not_finite(const char *what, weft_error *err)
{
    return weft_error_set(err, WEFT_INVALID,
                          "the saved simulation has %s that is not finite", what);
}

/* Forged bytes may have a correct checksum. The residual is not finite if any number of
 * the ledger is not. */
static weft_status check_numbers(const weft_sim *sim, const fields *saved,
                                 const double *y, weft_error *err)
{
    const weft__ledger ledger = { .on = sim->ledger.on,
                                  .start = saved->energy_start,
                                  .limit_work = saved->limit_work,
                                  .outside_work = saved->outside_work };
    if (!(isfinite(saved->t) && weft__not_negative(saved->next_step)
          && weft__not_negative(saved->last_step)
          && weft__not_negative(saved->limit_step)
          && weft__all_finite(y, weft_cloth_dim(sim->cloth)))) {
        return not_finite("a time, a step or a state", err);
    }
    return isfinite(weft__ledger_read(&ledger, &sim->forces, saved->t, y).residual)
               ? WEFT_OK
               : not_finite("an energy ledger", err);
}

static weft_status check_holds(const weft_sim *sim, const unsigned char *holds,
                               weft_error *err)
{
    for (size_t i = 0; i < weft_cloth_particles(sim->cloth); ++i) {
        if (!weft__cloth_can_hold(sim->cloth, i, word(holds, i))) {
            return weft_error_set(err, WEFT_INVALID, "a saved pin makes no sense");
        }
    }
    return WEFT_OK;
}

/* The checked bytes, into y[weft__sim_dim]. */
static weft_status restore_to(weft_sim *sim, const unsigned char *from, double *y,
                              weft_error *err)
{
    const size_t dim = weft__sim_dim(sim);
    const unsigned char *holds = from + (AT_STATE + dim) * WEFT__WORD;
    fields saved;
    weft__words_get(&saved, from + AT_FIELDS * WEFT__WORD, FIELDS);
    weft__words_get(y, from + AT_STATE * WEFT__WORD, dim);
    weft_status status = check_numbers(sim, &saved, y, err);
    status = status == WEFT_OK ? check_holds(sim, holds, err) : status;
    status = status == WEFT_OK ? renew(sim, &saved, err) : status;
    if (status != WEFT_OK) {
        return status;
    }
    for (size_t i = 0; i < weft_cloth_particles(sim->cloth); ++i) {
        weft__cloth_set_hold(sim->cloth, i, (weft__hold)word(holds, i));
    }
    weft__cloth_pins_changed(sim->cloth, y);
    take_fields(sim, &saved);
    memcpy(sim->y, y, dim * sizeof *y);
    return WEFT_OK;
}

weft_status weft_sim_restore(weft_sim *sim, const void *bytes, size_t size,
                             weft_error *err)
{
    if (weft__sim_outside(sim, "weft_sim_restore", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    const unsigned char *from = bytes;
    weft_status status = check_whole(from, size, err);
    status = status == WEFT_OK ? check_kind(sim, from, size, err) : status;
    status = status == WEFT_OK ? check_definition(sim, from, err) : status;
    if (status != WEFT_OK) {
        return status;
    }
    const weft_allocator memory = sim->memory;
    double *y = weft__alloc(&memory, weft__sim_dim(sim), sizeof *y);
    status = y == NULL
                 ? weft_error_set(err, WEFT_NO_MEMORY, "no memory to restore a state")
                 : restore_to(sim, from, y, err);
    weft__free(&memory, y);
    return status;
}
