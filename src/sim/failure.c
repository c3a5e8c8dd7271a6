/* SPDX-License-Identifier: BSD-3-Clause */
/* failure.c -- where a run that cannot go on hurts most: its fastest particle and its
 * most strained spring in the last good state. */
#include <math.h>
#include <string.h>

#include "sim/simulation.h"

static size_t fastest_particle(const weft_sim *sim, double *speed)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    const double *v = sim->y + 3 * n;
    size_t fastest = 0;
    *speed = 0.0;
    for (size_t i = 0; i < n; ++i) {
        const double here
            = sqrt(v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
        if (here > *speed) {
            *speed = here;
            fastest = i;
        }
    }
    return fastest;
}

void weft__sim_trouble(const weft_sim *sim, const weft_error *why, weft_error *err)
{
    const size_t cols = weft_cloth_cols(sim->cloth);
    const weft_measures all = weft_sim_measure(sim);
    const weft_spring worst = all.worst;
    const weft_stepper_stats stats = weft_sim_stats(sim);
    double speed;
    const size_t fastest = fastest_particle(sim, &speed);
    char spring[128] = "no springs", time[64] = "";
    if (worst.p != worst.q) {
        (void)snprintf(spring, sizeof spring,
                       "most strained %s spring (%zu, %zu)-(%zu, %zu) at %.3g %%",
                       weft_family_name(worst.family), worst.p / cols, worst.p % cols,
                       worst.q / cols, worst.q % cols, 100.0 * worst.strain);
    }
    if (strstr(why->message, " t = ") == NULL) { /* else the stepper has told it */
        (void)snprintf(time, sizeof time, " at t = %.9g s", sim->t);
    }
    const size_t n = weft_cloth_particles(sim->cloth);
    const double *x = sim->y + fastest;
    weft_error_set(err, why->status,
                   "%s%s, last h = %.3g s; fastest particle (%zu, %zu) at "
                   "(%.3g, %.3g, %.3g) m, %.3g m/s; %s; energy %.4g J before that step",
                   why->message, time, stats.last_step, fastest / cols, fastest % cols,
                   x[0], x[n], x[2 * n], speed, spring, weft_energy_total(all.energy));
}
