/* SPDX-License-Identifier: BSD-3-Clause */
/* sim.c -- a cloth under integration: made of a definition, and freed. */
#include "weft/sim.h"

#include <math.h>
#include <string.h>

#include "base/finite.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/sized.h"
#include "base/thread_pool.h"
#include "cloth/model.h"
#include "plugin/methods.h"
#include "plugin/plugin_check.h"
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
    TRY(WEFT__DEF_READ(weft_stepper_config, config, &def->config,
                       sizeof def->config_room, err));
    config->quadratures = def->ledger ? WEFT__QUADRATURES : 0;
    config->allocator = config->allocator != NULL ? config->allocator : &sim->memory;
    config->agree = NULL;
    if (def->comm != NULL) {
        sim->agree = (weft_agree){ def->comm->self, def->comm->max };
        config->agree = &sim->agree;
    }
    if (def->ledger && (def->method->flags & WEFT_STEPPER_QUADRATURES) == 0) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "method '%.40s' cannot keep the energy balance: it "
                              "integrates no quadratures; choose a method that does, "
                              "or keep none",
                              def->method->name);
    }
    const char *refusal = weft__pool_refusal(config->threads);
    if (refusal != NULL) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "%zu threads: %s", config->threads,
                              refusal);
    }
    const char *whole
        = def->cloth->untangle > 0.0 ? "untangle" : weft__cloth_no_bands(def->cloth);
    if (def->comm != NULL && whole != NULL) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "not possible for a cloth in bands: %s needs the whole "
                              "cloth",
                              whole);
    }
    return WEFT_OK;
}

weft_status weft__sim_stepper(const weft_sim *sim, double first_step, void **out,
                              weft_error *err)
{
    /* weft_ode has no const, because solvers have none */
    const size_t count = sim->sensitivity.count;
    const weft_ode ode
        = { weft__sim_dim(sim) * (1 + count),
            count > 0 ? weft__sensitivity_rhs : weft__sim_rhs, (void *)sim };
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
        || !weft__gather_create(&sim->forces,
                                sim->ledger.on || sim->def.event == weft_stop_event)
        || (comm != NULL && comm->rank == 0 && sim->forces.all == NULL)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a simulation");
    }
    if (sim->forces.pool != NULL && sim->config.team == NULL) {
        sim->worker_pool = (weft_team){ sim->forces.pool, weft__pool_run };
        sim->config.team = &sim->worker_pool;
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
static weft_sim *sim_make_sim(const weft_sim_def *def)
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
        .passage.next = weft__cloth_passages(def->cloth) ? -INFINITY : INFINITY,
        .event.value = NAN,
        .event.since = NAN,
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
    return sim;
}

/* Whether the embedder asks the simulation or its cloth to stop. */
static bool must_stop(void *ctx)
{
    weft_sim *sim = ctx;
    weft__stop of_cloth = sim->cloth->stop;
    return weft__sim_must_stop(sim) || weft__stops(&of_cloth);
}

/* The first state: of the definition, or that of the cloth, relaxed if it asks for it.
 */
static weft_status sim_make_state(weft_sim *sim, weft_error *err)
{
    const double *given = sim->def.start;
    const weft__stop stop = { .ask = must_stop, .ctx = sim };
    const weft_log *log
        = sim->cloth->log.write != NULL ? &sim->cloth->log : &sim->def.log;
    if (given == NULL) {
        return weft__relax_start(sim->cloth, sim->y, &stop, log, err);
    }
    if (!weft__all_finite(given, weft_cloth_dim(sim->cloth))) {
        return weft_error_set(err, WEFT_INVALID, "a state must be finite");
    }
    memcpy(sim->y, given, weft_cloth_dim(sim->cloth) * sizeof *given);
    return WEFT_OK;
}

/* All that needs no other band: the structure for the stepper does. */
static weft_status sim_prepare(const weft_sim_def *def, weft_sim **out, weft_error *err)
{
    if (def->cloth == NULL || def->method == NULL) {
        return weft_error_set(err, WEFT_INVALID, "a simulation needs a %s",
                              def->cloth == NULL
                                  ? "cloth: it is NULL"
                                  : "method: it is NULL, which is what "
                                    "weft_plugin_method returns for a name that the "
                                    "plugin does not have; weft_registry_method also "
                                    "reports the nearest name");
    }
    TRY(weft__method_check(def->method, 0, err));
    TRY(weft__config_check(&def->config, err));
    TRY(weft__bands_check(def, err));
    weft_sim *sim = *out = sim_make_sim(def);
    if (sim == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a simulation");
    }
    TRY(weft__limit_init(&sim->limit, &def->limit, sim->cloth, &sim->memory, err));
    TRY(take_config(sim, err));
    TRY(sim_make_state(sim, err));
    TRY(make_forces(sim, err));
    TRY(weft__sim_make_pass(sim, err));
    TRY(weft__structure_init(sim, err));
    TRY(weft__sim_checks(sim) ? weft__sim_make_start(sim, err) : WEFT_OK);
    TRY(weft__between_init(sim, err));
    TRY(def->sensitivity != NULL ? weft__sensitivity_init(sim, err) : WEFT_OK);
    sim->bytes = weft__sim_bytes(sim);
    return WEFT_OK;
}

weft_status weft_sim_create(const weft_sim_def *given, weft_sim **out, weft_error *err)
{
    weft_sim_def own, *const def = &own;
    TRY(weft__given(given, out, "weft_sim_create", err));
    weft_sim *sim = *out = NULL;
    TRY(WEFT__DEF_READ(weft_sim_def, def, given, WEFT__DEF_MOST, err));
    TRY(weft__bands_comm_check(def->comm, err)); /* nobody can be told */
    weft_status status = weft_comm_agree(def->comm, sim_prepare(def, &sim, err), err);
    status = status == WEFT_OK ? weft__bands_handshake(&sim->forces, err) : status;
    if (status == WEFT_OK) {
        status = weft__sim_stepper(sim, 0.0, &sim->stepper, err);
        status = weft_comm_agree(def->comm, status, err);
    }
    if (status != WEFT_OK) {
        weft_sim_destroy(sim);
        return status;
    }
    weft__ledger_start(&sim->ledger, &sim->forces, sim->y);
    sim->cloth_hash = weft__bands_cloth_hash(&sim->forces);
    sim->settings = weft__sensitivity_hash(sim, weft__settings_hash(def, &sim->config));
    char size[64];
    weft__log(&sim->def.log, WEFT_LOG_INFO, "%s under %s",
              weft_cloth_text(def->cloth, size, sizeof size), def->method->name);
    *out = sim;
    return WEFT_OK;
}

void weft_sim_destroy(weft_sim *sim)
{
    if (sim != NULL) {
        sim->def.method->destroy(sim->stepper);
        weft__wave_destroy(sim->wave);
        weft__forces_destroy(&sim->forces);
        weft__sensitivity_free(sim);
        weft_cloth_destroy(sim->cloth);
        const weft_allocator memory = sim->memory;
        WEFT__FREE_ALL(&memory, sim->limit.x, sim->lists, sim->masses, sim->added,
                       sim->y, sim->guard.start, sim->between.start, sim);
    }
}
