/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_pass.c -- what a simulation offers to a method: attempts in one pass, with the
 * memory that both take, and the rms norm. */
#include <math.h>

#include "cloth/model.h"
#include "mesh/blocks.h"
#include "sim/bands.h"
#include "sim/round.h"
#include "sim/simulation.h"

/* ---- the rms norm ---------------------------------------------------------------- */

enum { PLANES = 6 };

typedef struct squares {
    const weft__mesh *mesh;
    const double *e, *w;
} squares;

/* The sums of planes do not wait for one another. */
static void block_squares(const void *ctx, size_t b, double *number)
{
    const squares *of = ctx;
    const size_t n = of->mesh->particles, end = weft__block(of->mesh, b + 1);
    double sum[PLANES] = { 0.0 };
    for (size_t i = weft__block(of->mesh, b); i < end; ++i) {
        for (size_t k = 0; k < PLANES; ++k) {
            const double part = of->e[k * n + i] * of->w[k * n + i];
            sum[k] += part * part;
        }
    }
    *number = sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5];
}

/* As weft_rms.of. */
static double rms(void *ctx, const double *e, const double *w)
{
    const weft__forces *forces = ctx;
    const squares of = { &forces->cloth->mesh, e, w };
    double sum;
    weft__bands_sum(forces, block_squares, &of, 1, &sum);
    return sqrt(sum / (double)(PLANES * weft__whole_particles(of.mesh)));
}

/* ---- a pass ---------------------------------------------------------------------- */

/* After `calls` evaluations that found nothing wrong: each may be asked to stop. */
static int count_calls(weft_sim *sim, int calls, int *counted)
{
    if (weft__sim_checks(sim)) {
        sim->guard.calls += (uint64_t)calls;
        sim->guard.penetration = (weft__penetration){ .call = sim->guard.calls };
    }
    for (*counted = 1; *counted <= calls; ++*counted) {
        if (weft__sim_must_stop(sim)) {
            return -1;
        }
    }
    *counted = calls;
    return 0;
}

/* As weft_pass.run; sim->rates: somebody takes those of each stage. */
static int run_pass(void *ctx, weft_attempt *attempt)
{
    weft_sim *sim = ctx;
    const int calls = attempt->stages - 1 - (attempt->k_end == NULL);
    const bool made = sim->wave != NULL && sim->rates == NULL
                      && weft__wave_run(sim->wave, &sim->forces, attempt) == 0;
    return made ? count_calls(sim, calls, &attempt->calls) : 1;
}

static int run_round(void *ctx, weft_round *round)
{
    weft_sim *sim = ctx;
    int calls;
    const bool made = sim->rates == NULL && weft__round_run(&sim->forces, round) == 0;
    return made ? count_calls(sim, round->f != NULL, &calls) : 1;
}

weft_status weft__sim_make_pass(weft_sim *sim, weft_error *err)
{
    const weft_sim_def *def = &sim->def;
    const weft_butcher *table = sim->config.butcher;
    const bool means
        = sim->config.norm == WEFT_NORM_RMS && sim->config.fixed_step == 0.0;
    const size_t stages
        = 1 + (size_t)(table != NULL ? table->stages : def->method->stages);
    const bool once = table == NULL && stages == 2; /* no stages to be taken in one */
    const bool takes = sim->config.pass == NULL && def->force == NULL && !def->ledger
                       && def->sensitivity == NULL && !means
                       && (def->method->flags & (uint32_t)WEFT_STEPPER_PASS) != 0;
    sim->rms = (weft_rms){ &sim->forces, rms };
    sim->config.rms = means && def->sensitivity == NULL
                              && (def->method->flags & WEFT_STEPPER_DISTRIBUTED) != 0
                          ? &sim->rms
                          : NULL;
    const bool pays
        = once ? weft__round_pays(&sim->forces) : weft__wave_pays(&sim->forces, stages);
    sim->config.pass = NULL;
    if (!takes || !pays) {
        return WEFT_OK;
    }
    if (!once) {
        sim->wave = weft__wave_create(&sim->forces, stages, &sim->memory);
        if (sim->wave == NULL) {
            return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a simulation");
        }
    }
    sim->pass = (weft_pass){ sim, (int)stages, run_pass, run_round };
    sim->config.pass = &sim->pass;
    return WEFT_OK;
}

uint64_t weft__sim_bytes(const weft_sim *sim)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    if (mesh->triangles != NULL || sim->forces.spaces[WEFT__FORCE_self] != NULL
        || sim->between.start != NULL || sim->sensitivity.count > 0) {
        return 0;
    }
    const size_t each = sizeof *mesh->pin + sizeof *mesh->inverse_mass
                        + 2 * sizeof *sim->masses
                        + (sim->added != NULL ? 3 * sizeof *sim->added : 0)
                        + (weft__sim_limits(sim) ? 9 * sizeof *sim->limit.x : 0);
    const size_t vectors = sim->guard.start != NULL ? 2 : 1;
    return each * mesh->particles + vectors * weft__sim_dim(sim) * sizeof *sim->y
           + weft__wave_bytes(sim->wave);
}
