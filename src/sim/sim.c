/* SPDX-License-Identifier: BSD-3-Clause */
/* sim.c -- a cloth under integration: state, time, stepper, corrections. */
#include "weft/sim.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/given.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/sized.h"
#include "cloth/model.h"
#include "forces/self/crossing.h"
#include "mesh/pins.h"
#include "plugin/methods.h"
#include "plugin/registry.h"
#include "sim/bands.h"
#include "sim/simulation.h"

void weft_sim_def_init(weft_sim_def *def, size_t size)
{
    const weft_sim_def start = {
        .struct_size = (uint32_t)size,
        .config = weft_stepper_config_default(),
        .limit = { .strain = 0.1,
                   .families = { [WEFT_STRETCH] = true, [WEFT_SHEAR] = true },
                   .sweeps = 100,
                   .tolerance = 1e-3 },
    };
    weft__sized_write(def, size, &start, sizeof start);
}

/* Completes a config of any version. */
static weft_status take_config(weft_sim *sim, weft_error *err)
{
    const weft_sim_def *def = &sim->def;
    weft_stepper_config *config = &sim->config;
    const weft_status taken = WEFT__DEF_READ(weft_stepper_config, config, &def->config,
                                             sizeof def->config_room, err);
    if (taken != WEFT_OK) {
        return taken;
    }
    config->quadratures = def->ledger ? WEFT__QUADRATURES : 0;
    config->allocator = config->allocator != NULL ? config->allocator : &sim->memory;
    config->agree = NULL;
    if (def->comm != NULL) {
        sim->agree = (weft_agree){ def->comm->self, def->comm->max };
        config->agree = &sim->agree;
    }
    if (def->ledger && (def->method->flags & WEFT_STEPPER_QUADRATURES) == 0) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "method '%.40s' cannot keep the energy ledger: it "
                              "integrates no quadratures",
                              def->method->name);
    }
    if (def->comm != NULL && def->cloth->self.law.self) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "contact of the cloth with itself needs the whole cloth: "
                              "a band does not know which others it meets");
    }
    return WEFT_OK;
}

weft_status weft__sim_outside(const weft_sim *sim, const char *function,
                              weft_error *err)
{
    return sim->callbacks > 0 ? weft_error_set(
               err, WEFT_INVALID, "%s may not be called from a callback", function)
                              : WEFT_OK;
}

weft_status weft__sim_outside_play(const weft_sim *sim, const char *function,
                                   weft_error *err)
{
    const weft_status outside = weft__sim_outside(sim, function, err);
    return outside == WEFT_OK && sim->playing > 0
               ? weft_error_set(err, WEFT_INVALID,
                                "%s may not be called from a callback of weft_sim_play",
                                function)
               : outside;
}

weft_status weft__sim_changeable(const weft_sim *sim, const char *function,
                                 weft_error *err)
{
    const weft_status outside = weft__sim_outside(sim, function, err);
    return outside == WEFT_OK ? weft__bands_exclude(sim->def.comm, function, err)
                              : outside;
}

size_t weft__sim_dim(const weft_sim *sim)
{
    return weft_cloth_dim(sim->cloth) + sim->config.quadratures;
}

weft_status weft__sim_stepper(const weft_sim *sim, double first_step, void **out,
                              weft_error *err)
{
    /* weft_ode has no const, because solvers have none */
    const weft_ode ode = { weft__sim_dim(sim), weft__sim_rhs, (void *)sim };
    weft_stepper_config config = sim->config;
    config.first_step = first_step > 0.0 ? first_step : config.first_step;
    return sim->def.method->create(sim->def.method, &ode, &config, out, err);
}

/* The stepper uses the threads of the forces, which are idle when it computes. */
static weft_status make_forces(weft_sim *sim, weft_error *err)
{
    sim->forces = weft__forces_create(sim->cloth, sim->config.threads, &sim->memory);
    const weft_comm *comm = sim->forces.comm = sim->def.comm;
    if (comm != NULL && comm->rank == 0) {
        sim->forces.all = weft__alloc(&sim->memory, weft_cloth_band(sim->cloth).rows,
                                      sizeof *sim->forces.all);
    }
    if (sim->forces.measures == NULL
        || (comm != NULL && comm->rank == 0 && sim->forces.all == NULL)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a simulation");
    }
    if (sim->forces.pool != NULL && sim->config.pool == NULL) {
        sim->worker_pool = (weft_thread_pool){ sim->forces.pool, weft__pool_run };
        sim->config.pool = &sim->worker_pool;
    }
    return WEFT_OK;
}

/* The log of the definition; ctx is the simulation. */
static void write_log(void *ctx, weft_log_level level, const char *text)
{
    weft_sim *sim = ctx;
    ++sim->callbacks;
    sim->log.write(sim->log.ctx, level, text);
    --sim->callbacks;
}

/* The simulation, filled as far as only memory can fail. */
static weft_sim *make_sim(const weft_sim_def *def)
{
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    const size_t dim = weft_cloth_dim(def->cloth);
    weft_sim *sim = weft__zeroed(&memory, 1, sizeof *sim);
    if (sim == NULL) {
        return NULL;
    }
    *sim = (weft_sim){
        .def = *def,
        .log = def->log,
        .cloth = weft__cloth_copy(def->cloth, &memory),
        .added
        = def->force == NULL ? NULL : weft__alloc(&memory, dim / 2, sizeof(double)),
        .memory = memory,
        .ledger = { .on = def->ledger },
        .event = NAN,
        .event_since = NAN,
        .y = weft__alloc(&memory, dim + WEFT__QUADRATURES, sizeof(double)),
    };
    if (sim->cloth == NULL || sim->y == NULL
        || (def->force != NULL && sim->added == NULL)) {
        weft_sim_destroy(sim);
        return NULL;
    }
    if (sim->log.write != NULL) {
        sim->def.log = (weft_log){ write_log, sim };
    }
    weft_cloth_start(sim->cloth, sim->y);
    weft__ledger_start(&sim->ledger, sim->cloth, sim->y);
    return sim;
}

/* All that needs no other band: the structure for the stepper does. */
static weft_status prepare(const weft_sim_def *def, weft_sim **out, weft_error *err)
{
    if (def->cloth == NULL || def->method == NULL) {
        return weft_error_set(err, WEFT_INVALID, "a simulation needs a %s: it is NULL",
                              def->cloth == NULL ? "cloth" : "method");
    }
    weft_status status = weft__method_check(def->method, 0, err);
    status = status == WEFT_OK ? weft__config_check(&def->config, err) : status;
    status = status == WEFT_OK ? weft__bands_check(def, err) : status;
    if (status != WEFT_OK) {
        return status;
    }
    weft_sim *sim = *out = make_sim(def);
    if (sim == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a simulation");
    }
    status = weft__limit_init(&sim->limit, &def->limit, sim->cloth, &sim->memory, err);
    status = status == WEFT_OK ? take_config(sim, err) : status;
    status = status == WEFT_OK ? make_forces(sim, err) : status;
    status = status == WEFT_OK ? weft__structure_init(sim, err) : status;
    status = status == WEFT_OK && weft__sim_checks(sim) ? weft__sim_make_start(sim, err)
                                                        : status;
    return status == WEFT_OK ? weft__between_init(sim, err) : status;
}

weft_status weft_sim_create(const weft_sim_def *given, weft_sim **out, weft_error *err)
{
    weft_sim_def own, *const def = &own;
    if (weft__given(given, out, "weft_sim_create", err) != WEFT_OK
        || WEFT__DEF_READ(weft_sim_def, def, given, WEFT__DEF_MOST, err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    weft_sim *sim = NULL;
    *out = NULL;
    weft_status status = weft__bands_comm_check(def->comm, err);
    if (status != WEFT_OK) {
        return status; /* nobody can be told */
    }
    status = weft__bands_agree(def->comm, prepare(def, &sim, err), err);
    if (status == WEFT_OK) {
        status = weft__sim_stepper(sim, 0.0, &sim->stepper, err);
        status = weft__bands_agree(def->comm, status, err);
    }
    if (status != WEFT_OK) {
        weft_sim_destroy(sim);
        return status;
    }
    sim->cloth_hash = weft__bands_cloth_hash(&sim->forces);
    sim->settings = weft__settings_hash(def, &sim->config);
    weft__log(&sim->def.log, WEFT_LOG_INFO, "%zu x %zu particles under %s",
              weft_cloth_band(def->cloth).rows, weft_cloth_cols(def->cloth),
              def->method->name);
    *out = sim;
    return WEFT_OK;
}

void weft_sim_destroy(weft_sim *sim)
{
    if (sim != NULL) {
        sim->def.method->destroy(sim->stepper);
        weft__forces_destroy(&sim->forces);
        weft__limit_free(&sim->limit, &sim->memory);
        weft__structure_free(sim);
        weft__between_free(sim);
        weft_cloth_destroy(sim->cloth);
        const weft_allocator memory = sim->memory;
        weft__free(&memory, sim->added);
        weft__free(&memory, sim->y);
        weft__free(&memory, sim->start);
        weft__free(&memory, sim);
    }
}

static bool limits(const weft_sim *sim)
{
    return sim->def.limit.method != WEFT_LIMIT_NONE;
}

static bool limit(weft_sim *sim, double h)
{
    const uint64_t before = sim->limit.stats.unconverged;
    const bool checks = weft__sim_checks(sim);
    if (checks) {
        memcpy(sim->start, sim->y, weft_cloth_dim(sim->cloth) * sizeof *sim->y);
    }
    const bool changed = weft__limit_apply(&sim->limit, h, sim->y);
    if (changed && checks) {
        weft__hold_back(&sim->forces, sim->t, sim->start, sim->y);
    }
    if (before == 0 && sim->limit.stats.unconverged > 0) {
        const weft_spring worst = weft_sim_limit_worst(sim);
        char text[96];
        weft__log(
            &sim->def.log, WEFT_LOG_WARNING,
            "limit: not met within its sweeps at t = %.9g s; %s is at %.3g %%; "
            "reported once",
            sim->t,
            weft_spring_text(&worst, weft_cloth_cols(sim->cloth), text, sizeof text),
            100.0 * worst.strain);
    }
    return changed;
}

static bool correct(weft_sim *sim, double h)
{
    ++sim->callbacks;
    const bool changed = sim->def.correct(sim->def.correct_ctx, sim->t, h, sim->y);
    --sim->callbacks;
    return changed;
}

/* `jumped`: by the embedder, so that no path leads to the state. */
static weft_status check_corrected(weft_sim *sim, bool jumped, weft_error *err)
{
    weft_error why = { 0 };
    if (!weft__all_finite(sim->y, weft_cloth_dim(sim->cloth))) {
        weft_error_set(&why, WEFT_NOT_FINITE,
                       "the correction left a state that is not finite");
        return weft__sim_fail(sim, &why, err);
    }
    sim->refused = weft__state_breach(sim->cloth, sim->t, sim->y);
    if (sim->refused.found) {
        weft__breach_error(sim->cloth, &sim->refused, "was corrected to", &why);
        return weft__sim_fail(sim, &why, err);
    }
    if (jumped) {
        (void)weft__crossing_error(&sim->cloth->self, sim->y, SIZE_MAX,
                                   "after the correction ", &why);
    }
    return why.status == WEFT_OK ? WEFT_OK : weft__sim_fail(sim, &why, err);
}

/* After an accepted step of h: the strain limit, then the embedder's own. */
static weft_status apply_corrections(weft_sim *sim, double h, weft_error *err)
{
    weft__ledger *ledger = &sim->ledger;
    bool changed = false, jumped = false;
    weft__ledger_mark(ledger, &sim->forces, sim->t, sim->y);
    if (limits(sim) && limit(sim, h)) {
        weft__ledger_account(ledger, &sim->forces, sim->t, sim->y, &ledger->limit_work);
        changed = true;
    }
    if (sim->def.correct != NULL && correct(sim, h)) {
        weft__ledger_account(ledger, &sim->forces, sim->t, sim->y,
                             &ledger->outside_work);
        changed = jumped = true;
    }
    if (changed) {
        sim->def.method->state_changed(sim->stepper);
    }
    return changed ? check_corrected(sim, jumped, err) : WEFT_OK;
}

static void log_rejected(weft_sim *sim, double h)
{
    const uint64_t rejected = weft_sim_stats(sim).rejected;
    if (rejected > sim->rejected) {
        weft__log(&sim->def.log, WEFT_LOG_DEBUG,
                  "t = %.9g s: a step of %.3g s after %" PRIu64 " rejected", sim->t, h,
                  rejected - sim->rejected);
    }
    sim->rejected = rejected;
}

weft_status weft_sim_step(weft_sim *sim, double t_end, weft_error *err)
{
    if (weft__sim_outside_play(sim, "weft_sim_step", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    if (!(t_end > sim->t) || !isfinite(t_end)) {
        return weft_error_set(err, WEFT_INVALID, "step from %.17g s to %.17g s", sim->t,
                              t_end);
    }
    weft_error why = { 0 };
    const double before = sim->t;
    sim->failure.status = WEFT_OK;
    sim->refused.found = false;
    weft__between_begin(sim);
    t_end = weft__sim_before_event(sim, t_end);
    weft_status status = weft__sim_checked_step(sim, t_end, &why);
    status = status == WEFT_OK ? weft__sim_find_event(sim, before, &why) : status;
    if (status != WEFT_OK) {
        why.status = status;
        return weft__sim_fail(sim, &why, err);
    }
    const double h = sim->t - before;
    if (sim->def.log.write != NULL) {
        log_rejected(sim, h);
    }
    return limits(sim) || sim->def.correct != NULL ? apply_corrections(sim, h, err)
                                                   : WEFT_OK;
}

weft_status weft_sim_advance(weft_sim *sim, double t_end, weft_error *err)
{
    weft_status status = WEFT_OK;
    for (bool event = false; sim->t != t_end && status == WEFT_OK && !event;) {
        status = weft_sim_step(sim, t_end, err);
        event = sim->event_passed;
    }
    return status;
}

double weft_sim_time(const weft_sim *sim)
{
    return sim->t;
}

const double *weft_sim_state(const weft_sim *sim)
{
    return sim->y;
}

const weft_cloth *weft_sim_cloth(const weft_sim *sim)
{
    return sim->cloth;
}

void weft_sim_measure_sized(weft_measures *out, size_t size, const weft_sim *sim)
{
    const weft__state at = { .t = sim->t, .y = sim->y };
    weft__measure_fn *of = sim->ledger.on ? weft__block_all : weft__block_state;
    const weft_measures all = weft__forces_measure(&sim->forces, &at, of);
    weft__sized_write(out, size, &all, sizeof all);
}

/* Of a band its first row has the counts. */
static void count_row(const void *ctx, size_t r, double *numbers)
{
    const weft_cloth *cloth = ctx;
    const bool counts = r == cloth->mesh.band.above;
    numbers[0] = weft__block_mass(cloth, r);
    numbers[1] = counts ? (double)weft_cloth_pins(cloth) : 0.0;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        numbers[2 + k]
            = counts ? (double)weft_cloth_springs(cloth, (weft_family)k) : 0.0;
    }
}

void weft_sim_totals_sized(weft_totals *out, size_t size, const weft_sim *sim)
{
    double sum[2 + WEFT_FAMILIES];
    weft__bands_sum(&sim->forces, count_row, sim->cloth, 2 + WEFT_FAMILIES, sum);
    weft_totals totals
        = { .particles = sim->cloth->mesh.band.rows * sim->cloth->mesh.cols,
            .pins = (size_t)sum[1],
            .mass = sum[0] };
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        totals.springs[k] = (size_t)sum[2 + k];
    }
    weft__sized_write(out, size, &totals, sizeof totals);
}

weft_stiffness weft_sim_stiffness(const weft_sim *sim, double t, const double *y)
{
    const weft_comm *comm = sim->def.comm;
    double most[WEFT__SIDES];
    weft__stiffness_sides(sim->cloth, t, y, most);
    if (comm != NULL) {
        weft__bands_most(&sim->forces, most, WEFT__SIDES);
    }
    return weft__stiffness_within(sim->cloth, y, most);
}

void weft_sim_stats_sized(weft_stepper_stats *out, size_t size, const weft_sim *sim)
{
    weft_stepper_stats stats = { .struct_size = sizeof stats };
    sim->def.method->stats(sim->stepper, &stats);
    stats.last_step = stats.steps > 0 ? stats.last_step : sim->earlier.last_step;
    stats.steps += sim->earlier.steps;
    stats.rejected += sim->earlier.rejected;
    stats.rhs_calls += sim->earlier.rhs_calls;
    stats.linear_iterations += sim->earlier.linear_iterations;
    stats.factorisations += sim->earlier.factorisations;
    stats.newton_failures += sim->earlier.newton_failures;
    stats.struct_size = (uint32_t)size;
    weft__sized_write(out, size, &stats, sizeof stats);
}

void weft_sim_options(const weft_sim *sim, weft_option_fn *tell, void *ctx)
{
    const weft_stepper_type *method = sim->def.method;
    weft_sim *told = (weft_sim *)sim; /* no simulation is a constant */
    if (WEFT_HAS(method, weft_stepper_type, options) && method->options != NULL) {
        ++told->callbacks;
        method->options(sim->stepper, tell, ctx);
        --told->callbacks;
    }
}

void weft_sim_ledger_sized(weft_ledger *out, size_t size, const weft_sim *sim)
{
    const weft_ledger ledger
        = weft__ledger_read(&sim->ledger, &sim->forces, sim->t, sim->y);
    weft__sized_write(out, size, &ledger, sizeof ledger);
}

double weft_sim_dissipated(const weft_sim *sim)
{
    return weft__ledger_heat(&sim->ledger, sim->cloth, sim->y);
}

uint64_t weft_sim_vetoed(const weft_sim *sim)
{
    return sim->vetoed;
}

void weft_sim_limit_stats_sized(weft_limit_stats *out, size_t size, const weft_sim *sim)
{
    weft__sized_write(out, size, &sim->limit.stats, sizeof sim->limit.stats);
}

weft_spring weft_sim_limit_worst(const weft_sim *sim)
{
    if (!limits(sim)) {
        return (weft_spring){ 0 };
    }
    const weft__state of = { .y = sim->y, .families = sim->def.limit.families };
    return weft__forces_measure(&sim->forces, &of, weft__block_worst).worst;
}

size_t weft_sim_limit_held(const weft_sim *sim)
{
    return weft__limited_excess(&sim->cloth->springs, &sim->limit.def, true, SIZE_MAX,
                                sim->y);
}

/* Copies three planes of n to triples. */
static void interleave(const double *planes, size_t n, double *xyz)
{
    for (size_t i = 0; i < n; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            xyz[3 * i + k] = planes[k * n + i];
        }
    }
}

void weft_sim_positions(const weft_sim *sim, double *xyz)
{
    interleave(sim->y, weft_cloth_particles(sim->cloth), xyz);
}

void weft_sim_velocities(const weft_sim *sim, double *xyz)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    interleave(sim->y + 3 * n, n, xyz);
}

static void set_planes(const weft_cloth *cloth, const double *xyz, double *planes)
{
    const size_t n = weft_cloth_particles(cloth);
    for (size_t i = 0; xyz != NULL && i < n; ++i) {
        for (size_t k = 0; !weft_cloth_pinned(cloth, i) && k < 3; ++k) {
            planes[k * n + i] = xyz[3 * i + k];
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
