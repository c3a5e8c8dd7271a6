/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_rhs.c -- the right-hand side that a stepper sees: the cloth's, then the force of
 * the embedder, then with ledger the powers. */
#include <math.h>
#include <string.h>

#include "cloth/sums.h"
#include "sim/simulation.h"

/* v' += f / m of the free particles; the power f.v [W] of all of them, block by block.
 */
static double accelerate(const weft_sim *sim, const double *y, double *dydt)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    const size_t n = mesh->particles;
    const double *v = y + 3 * n;
    double *dvdt = dydt + 3 * n;
    double power = 0.0, block = 0.0;
    for (size_t i = 0; i < n; ++i) {
        for (size_t j = i; mesh->pin[i] == 0 && j < 3 * n; j += n) {
            dvdt[j] += sim->added[j] / mesh->mass[i];
            block += sim->added[j] * v[j];
        }
        if ((i + 1) % mesh->block == 0 || i + 1 == n) {
            power += block;
            block = 0.0;
        }
    }
    return power;
}

/* With other bands a method also evaluates states that are not finite, where the whole
 * cloth would not be evaluated: these leave what was found before. */
static void note_penetration(weft_sim *sim, double t, const double *y, int failed)
{
    const uint64_t call = ++sim->guard.calls;
    if (failed == 0) {
        sim->guard.penetration = (weft__penetration){ .call = call };
    } else if (sim->def.comm == NULL || weft__gather_finite(&sim->forces, y)) {
        sim->guard.penetration = weft__rhs_penetration(&sim->forces, t, y);
        sim->guard.penetration.call = call;
    }
}

bool weft__sim_must_stop(weft_sim *sim)
{
    ++sim->callbacks;
    const bool stop = sim->def.stop != NULL && sim->def.stop(sim->def.stop_ctx);
    --sim->callbacks;
    return stop;
}

int weft__sim_rhs(double t, const double *y, double *dydt, void *ctx)
{
    weft_sim *sim = ctx;
    const size_t dim = 6 * sim->cloth->mesh.particles;
    double power = 0.0;
    const bool stop = weft__sim_must_stop(sim);
    if (stop && sim->def.comm == NULL) { /* other bands would wait for this one */
        return -1;
    }
    int failed = weft__forces_rhs(&sim->forces, t, y, dydt);
    if (sim->rates != NULL) {
        memcpy(sim->rates, dydt, dim * sizeof *dydt);
    }
    if (weft__sim_checks(sim)) {
        note_penetration(sim, t, y, failed);
    }
    if (sim->def.force != NULL) { /* what an earlier call left is no reason any more */
        memset(sim->added, 0, dim / 2 * sizeof *sim->added);
    }
    if (sim->def.force != NULL && failed == 0) {
        ++sim->callbacks;
        failed = sim->def.force(sim->def.force_ctx, t, y, sim->added);
        --sim->callbacks;
        power = accelerate(sim, y, dydt);
        failed = failed == 0 && !weft__all_finite(dydt + dim / 2, dim / 2) ? 1 : failed;
    }
    if (sim->ledger.on) {
        const bool finite
            = weft__ledger_rates(&sim->forces, t, y, power, dydt + dim) && failed >= 0;
        failed = failed == 0 && !finite ? 1 : failed;
    }
    return stop ? -1 : failed;
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
