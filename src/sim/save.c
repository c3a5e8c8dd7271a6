/* SPDX-License-Identifier: BSD-3-Clause */
/* save.c -- a simulation as bytes, and back.
 *
 * A solver's memory of its past cannot be read, so it is dropped: saving replaces the
 * stepper here as restoring will there. Only its counts and its next h remain.
 *
 * Words (bytes.h): "weftsave", version, rows, cols, quadratures, hashes of the cloth's
 * definition and of the settings, the method's name in 64 bytes, fields, y, the hold of
 * each particle, the number of shapes, a hash of the law of contact, the shapes (kind,
 * the numbers of weft_shape from `at` on, since when it moves so), checksum. */
#include <math.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "cloth/pins.h"
#include "cloth/shapes.h"
#include "sim/bands.h"
#include "sim/simulation.h"

static const unsigned char magic[WEFT__WORD] = "weftsave";

#define VERSION 5

#define NAME_WORDS 8

/* All that is saved besides the state, in words. */
typedef struct fields {
    double t, next_step, last_step;                /* [s] */
    double energy_start, limit_work, outside_work; /* [J] */
    double limit_step;                             /* [s] */
    uint64_t steps, rejected, rhs_calls;
    weft_limit_stats limit;
    uint64_t vetoed;
    uint64_t linear_iterations, factorisations, newton_failures;
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

/* What weft_shape has behind `kind`. */
enum {
    AT_REALS = offsetof(weft_shape, at),
    SHAPE_REALS = (sizeof(weft_shape) - AT_REALS) / sizeof(double),
    SHAPE_WORDS = 1 + SHAPE_REALS + 1
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
        .vetoed = sim->vetoed,
        .linear_iterations = stats.linear_iterations,
        .factorisations = stats.factorisations,
        .newton_failures = stats.newton_failures,
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
    sim->vetoed = from->vetoed;
}

/* Replaces the stepper; only the h to try and the counts remain. */
static weft_status renew(weft_sim *sim, const fields *counted, weft_error *err)
{
    void *fresh = NULL;
    const weft_status mine = weft__sim_stepper(sim, counted->next_step, &fresh, err);
    const weft_status status = weft__bands_agree(sim->def.comm, mine, err);
    if (status != WEFT_OK) {
        sim->def.method->destroy(fresh);
    } else {
        sim->def.method->destroy(sim->stepper);
        sim->stepper = fresh;
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
    if (weft__sim_outside(sim, "weft_sim_restart", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    const fields now = fields_of(sim);
    return renew(sim, &now, err);
}

/* ---- to bytes ---------------------------------------------------------------- */

/* Of the whole cloth. */
static size_t saved_particles(const weft_sim *sim)
{
    return sim->cloth->band.rows * sim->cloth->cols;
}

/* Where the holds begin, behind the state. */
static size_t at_holds(const weft_sim *sim)
{
    return AT_STATE + 6 * saved_particles(sim) + sim->config.quadratures;
}

/* Where the number of shapes is, behind the particles. */
static size_t at_shapes(const weft_sim *sim)
{
    return at_holds(sim) + saved_particles(sim);
}

static size_t saved_words(const weft_sim *sim)
{
    return at_shapes(sim) + 2 + SHAPE_WORDS * weft_cloth_shapes(sim->cloth) + 1;
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
    weft__word_put(to + AT_ROWS * WEFT__WORD, sim->cloth->band.rows);
    weft__word_put(to + AT_COLS * WEFT__WORD, weft_cloth_cols(sim->cloth));
    weft__word_put(to + AT_QUADRATURES * WEFT__WORD, sim->config.quadratures);
    weft__word_put(to + AT_CLOTH * WEFT__WORD, sim->cloth_hash);
    weft__word_put(to + AT_SETTINGS * WEFT__WORD, sim->settings);
    memcpy(to + AT_NAME * WEFT__WORD, name, sizeof name);
}

static void put_shapes(const weft_cloth *cloth, unsigned char *to)
{
    weft__word_put(to, cloth->shape_count);
    weft__word_put(to + WEFT__WORD, weft__contact_hash(cloth));
    to += 2 * WEFT__WORD;
    for (size_t k = 0; k < cloth->shape_count; ++k, to += SHAPE_WORDS * WEFT__WORD) {
        const weft__shape *shape = &cloth->shapes[k];
        weft__word_put(to, (uint64_t)shape->def.kind);
        weft__words_put(to + WEFT__WORD, (const char *)&shape->def + AT_REALS,
                        SHAPE_REALS);
        weft__real_put(to + (1 + SHAPE_REALS) * WEFT__WORD, shape->motion.since);
    }
}

/* Of the own particles; NULL: no memory. */
static uint64_t *list_holds(const weft_sim *sim)
{
    const size_t first = sim->cloth->band.above * sim->cloth->cols;
    const size_t own = sim->cloth->band.own * sim->cloth->cols;
    uint64_t *holds = weft__alloc(&sim->memory, own, sizeof *holds);
    for (size_t i = 0; holds != NULL && i < own; ++i) {
        holds[i] = weft__cloth_hold(sim->cloth, first + i);
    }
    return holds;
}

/* The parts that all bands have together; band 0 has `to`. */
static void put_particles(const weft_sim *sim, const uint64_t *holds, unsigned char *to)
{
    const size_t n = weft_cloth_particles(sim->cloth), all = saved_particles(sim);
    const double *own = sim->y + sim->cloth->band.above * sim->cloth->cols;
    const bool first = weft__bands_is_first(sim->def.comm);
    for (size_t k = 0; k < 6; ++k) {
        weft__bands_put(&sim->forces, own + k * n,
                        first ? to + (AT_STATE + k * all) * WEFT__WORD : NULL);
    }
    weft__bands_put(&sim->forces, holds,
                    first ? to + at_holds(sim) * WEFT__WORD : NULL);
}

static weft_status save_with(weft_sim *sim, const uint64_t *holds, unsigned char *to,
                             weft_error *err)
{
    const size_t words = saved_words(sim), n = weft_cloth_particles(sim->cloth);
    const weft_status status = weft_sim_restart(sim, err);
    if (status != WEFT_OK) {
        return status;
    }
    weft__cloth_pins_changed(sim->cloth, sim->y); /* as restore will */
    put_particles(sim, holds, to);
    if (weft__bands_is_first(sim->def.comm)) {
        const fields now = fields_of(sim);
        put_head(sim, to);
        weft__words_put(to + AT_FIELDS * WEFT__WORD, &now, FIELDS);
        weft__words_put(to + (at_holds(sim) - sim->config.quadratures) * WEFT__WORD,
                        sim->y + 6 * n, sim->config.quadratures);
        put_shapes(sim->cloth, to + at_shapes(sim) * WEFT__WORD);
        weft__word_put(to + (words - 1) * WEFT__WORD, weft__words_sum(to, words - 1));
    }
    return WEFT_OK;
}

weft_status weft_sim_save(weft_sim *sim, void *bytes, size_t size, weft_error *err)
{
    if (weft__sim_outside(sim, "weft_sim_save", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    const size_t least = weft_sim_save_size(sim);
    const bool room = bytes != NULL && size >= least;
    uint64_t *holds = list_holds(sim);
    weft_status status
        = !room && weft__bands_is_first(sim->def.comm)
              ? weft_error_set(err, WEFT_INVALID,
                               "a saved simulation needs %zu bytes, not %zu", least,
                               bytes == NULL ? 0 : size)
          : holds == NULL
              ? weft_error_set(err, WEFT_NO_MEMORY, "no memory to save a simulation")
              : WEFT_OK;
    status = weft__bands_agree(sim->def.comm, status, err);
    status = status == WEFT_OK ? save_with(sim, holds, bytes, err) : status;
    weft__free(&sim->memory, holds);
    return status;
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
    const size_t rows = sim->cloth->band.rows, cols = weft_cloth_cols(sim->cloth);
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
    const size_t words = size / WEFT__WORD, at = at_shapes(sim);
    const size_t left = words < at + 3 ? 1 : words - (at + 3);
    return left % SHAPE_WORDS == 0 && word(from, at) == left / SHAPE_WORDS
               ? WEFT_OK
               : damaged(err);
}

static weft_status check_definition(const weft_sim *sim, const unsigned char *from,
                                    weft_error *err)
{
    const size_t at = at_shapes(sim);
    if (word(from, AT_CLOTH) != sim->cloth_hash
        || (word(from, at) > 0
            && word(from, at + 1) != weft__contact_hash(sim->cloth))) {
        return weft_error_set(err, WEFT_INVALID,
                              "saved of another cloth (springs, masses, pins, forces "
                              "or contact differ)");
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

/* Forged bytes may have a correct checksum. */
static weft_status check_numbers(const weft_sim *sim, const fields *saved,
                                 const double *y, weft_error *err)
{
    return isfinite(saved->t) && weft__not_negative(saved->next_step)
                   && weft__not_negative(saved->last_step)
                   && weft__not_negative(saved->limit_step)
                   && weft__all_finite(y, weft_cloth_dim(sim->cloth))
               ? WEFT_OK
               : not_finite("a time, a step or a state", err);
}

/* The residual is not finite if any of the ledger's numbers is not. */
static weft_status check_ledger(const weft_sim *sim, const fields *saved,
                                const double *y, weft_error *err)
{
    if (!sim->ledger.on) {
        return WEFT_OK;
    }
    const weft__ledger ledger = { .on = sim->ledger.on,
                                  .start = saved->energy_start,
                                  .limit_work = saved->limit_work,
                                  .outside_work = saved->outside_work };
    weft_cloth loose = *sim->cloth; /* whose present shapes mean nothing */
    weft__forces forces = sim->forces;
    loose.shape_count = 0;
    forces.cloth = &loose;
    return isfinite(weft__ledger_read(&ledger, &forces, saved->t, y).residual)
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

/* A saved simulation on its way into another. */
typedef struct restored {
    fields fields;
    const unsigned char *holds;
    double *y;
    weft__shape *shapes; /* shape_count of them */
    size_t shape_count;
} restored;

static weft_status read_shapes(const weft_sim *sim, const unsigned char *from,
                               restored *to, weft_error *err)
{
    from += (at_shapes(sim) + 2) * WEFT__WORD;
    for (size_t k = 0; k < to->shape_count; ++k, from += SHAPE_WORDS * WEFT__WORD) {
        const double since = weft__real_at(from + (1 + SHAPE_REALS) * WEFT__WORD);
        weft_shape def = { .kind = WEFT_SHAPES };
        if (word(from, 0) < WEFT_SHAPES) {
            def.kind = (weft_shape_kind)word(from, 0);
        }
        weft__words_get((char *)&def + AT_REALS, from + WEFT__WORD, SHAPE_REALS);
        if (!isfinite(since)
            || weft__shape_make(sim->cloth, &def, since, k, &to->shapes[k], NULL)
                   != WEFT_OK) {
            return weft_error_set(err, WEFT_INVALID, "a saved shape makes no sense");
        }
    }
    return WEFT_OK;
}

static weft_status check_gaps(const weft_sim *sim, const restored *from,
                              weft_error *err)
{
    weft_cloth as_saved = *sim->cloth;
    as_saved.shapes = from->shapes;
    as_saved.shape_count = from->shape_count;
    for (size_t i = 0; i < as_saved.particles; ++i) {
        const weft__breach breach
            = weft__particle_breach(&as_saved, from->fields.t, from->y, i);
        if (breach.found && word(from->holds, i) == WEFT__FREE) {
            return weft__breach_error(&as_saved, &breach, "was saved", err);
        }
    }
    return WEFT_OK;
}

/* Nothing fails any more. */
static void take(weft_sim *sim, const restored *from)
{
    for (size_t i = 0; i < weft_cloth_particles(sim->cloth); ++i) {
        weft__cloth_set_hold(sim->cloth, i, (weft__hold)word(from->holds, i));
    }
    weft__cloth_pins_changed(sim->cloth, from->y);
    weft__free(&sim->memory, sim->cloth->shapes);
    sim->cloth->shapes = from->shapes;
    sim->cloth->shape_count = from->shape_count;
    take_fields(sim, &from->fields);
    memcpy(sim->y, from->y, weft__sim_dim(sim) * sizeof *sim->y);
    weft__structure_update(sim);
    weft_stepper_ode_changed(sim->def.method, sim->stepper);
}

/* Where in the bytes the words of the particles here are, from those of all on. */
static const unsigned char *words_here(const weft_sim *sim, const unsigned char *from,
                                       size_t at)
{
    return from + (at + weft__whole_index(sim->cloth, 0)) * WEFT__WORD;
}

/* The checked bytes; *to has room for its arrays. */
static weft_status read_fields(weft_sim *sim, const unsigned char *from, restored *to,
                               weft_error *err)
{
    const size_t n = weft_cloth_particles(sim->cloth), all = saved_particles(sim);
    to->holds = words_here(sim, from, at_holds(sim));
    weft__words_get(&to->fields, from + AT_FIELDS * WEFT__WORD, FIELDS);
    for (size_t k = 0; k < 6; ++k) {
        weft__words_get(to->y + k * n, words_here(sim, from, AT_STATE + k * all), n);
    }
    weft__words_get(to->y + 6 * n,
                    from + (at_holds(sim) - sim->config.quadratures) * WEFT__WORD,
                    sim->config.quadratures);
    weft_status status = check_numbers(sim, &to->fields, to->y, err);
    status = status == WEFT_OK ? check_ledger(sim, &to->fields, to->y, err) : status;
    status = status == WEFT_OK ? check_holds(sim, to->holds, err) : status;
    status = status == WEFT_OK ? read_shapes(sim, from, to, err) : status;
    status = status == WEFT_OK ? check_gaps(sim, to, err) : status;
    return status == WEFT_OK && to->shape_count > 0 ? weft__sim_make_start(sim, err)
                                                    : status;
}

/* All that needs no other band. */
static weft_status read_saved(weft_sim *sim, const unsigned char *from, size_t size,
                              restored *to, weft_error *err)
{
    const weft_allocator memory = sim->memory;
    weft_status status = check_whole(from, from == NULL ? 0 : size, err);
    status = status == WEFT_OK ? check_kind(sim, from, size, err) : status;
    status = status == WEFT_OK ? check_definition(sim, from, err) : status;
    if (status != WEFT_OK) {
        return status;
    }
    to->shape_count = (size_t)word(from, at_shapes(sim));
    to->y = weft__alloc(&memory, weft__sim_dim(sim), sizeof *to->y);
    to->shapes = weft__alloc(&memory, to->shape_count, sizeof *to->shapes);
    return to->y == NULL || to->shapes == NULL
               ? weft_error_set(err, WEFT_NO_MEMORY, "no memory to restore a state")
               : read_fields(sim, from, to, err);
}

weft_status weft_sim_restore(weft_sim *sim, const void *bytes, size_t size,
                             weft_error *err)
{
    if (weft__sim_outside(sim, "weft_sim_restore", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    restored to = { .shape_count = 0 };
    weft_status status
        = weft__bands_agree(sim->def.comm, read_saved(sim, bytes, size, &to, err), err);
    status = status == WEFT_OK ? renew(sim, &to.fields, err) : status;
    if (status == WEFT_OK) {
        take(sim, &to);
    } else {
        weft__free(&sim->memory, to.shapes);
    }
    weft__free(&sim->memory, to.y);
    return status;
}
