/* SPDX-License-Identifier: BSD-3-Clause */
/* motion.c -- the right-hand side that a stepper sees: the cloth's, then the force of
 * the embedder, then with ledger the powers. */
#include <math.h>
#include <string.h>

#include "sim/simulation.h"

/* v' += f / m of the free particles; the power f.v [W] of all of them, row by row. */
static double accelerate(const weft_sim *sim, const double *y, double *dydt)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    const size_t cols = weft_cloth_cols(sim->cloth);
    const double *v = y + 3 * n;
    double *dvdt = dydt + 3 * n;
    double power = 0.0, row = 0.0;
    for (size_t i = 0; i < n; ++i) {
        const double mass = weft_cloth_particle_mass(sim->cloth, i);
        for (size_t j = i; !weft_cloth_pinned(sim->cloth, i) && j < 3 * n; j += n) {
            dvdt[j] += sim->added[j] / mass;
            row += sim->added[j] * v[j];
        }
        if ((i + 1) % cols == 0) {
            power += row;
            row = 0.0;
        }
    }
    return power;
}

int weft__sim_rhs(double t, const double *y, double *dydt, void *ctx)
{
    weft_sim *sim = ctx;
    const size_t dim = weft_cloth_dim(sim->cloth);
    double power = 0.0;
    if (sim->def.stop != NULL && sim->def.stop(sim->def.stop_ctx)) {
        return -1;
    }
    int failed = weft__forces_rhs(&sim->forces, t, y, dydt);
    sim->refused.found = false;
    if (failed != 0 && weft__sim_checks(sim)) {
        sim->refused = weft__rhs_breach(&sim->forces, t, y);
    }
    if (sim->def.force != NULL && failed == 0) {
        memset(sim->added, 0, dim / 2 * sizeof *sim->added);
        sim->in_callback = true;
        failed = sim->def.force(sim->def.force_ctx, t, y, sim->added);
        sim->in_callback = false;
        power = accelerate(sim, y, dydt);
        failed = failed == 0 && !weft__all_finite(dydt + dim / 2, dim / 2) ? 1 : failed;
    }
    if (sim->ledger.on) {
        const bool finite
            = weft__ledger_rates(&sim->forces, t, y, power, dydt + dim) && failed >= 0;
        failed = failed == 0 && !finite ? 1 : failed;
    }
    return failed;
}
