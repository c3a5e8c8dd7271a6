/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/forces.h"

#include <stdatomic.h>

#include "cloth/rows.h"

/* Particles that are worth a thread: their evaluation takes ten times as long as it
 * takes a thread that is awake to hear of it. More bands than threads, where each costs
 * little beside its rows (a band takes one row twice), are less to wait for when a
 * thread is kept from running. */
enum { PARTICLES_PER_THREAD = 2048, ROWS_PER_BAND = 48 };

weft__forces weft__forces_create(const weft_cloth *cloth, size_t threads)
{
    const size_t worth = weft_cloth_particles(cloth) / PARTICLES_PER_THREAD;
    const size_t rows = weft_cloth_rows(cloth);
    const size_t useful = worth < rows ? worth : rows;
    weft__team *team = weft__team_create(threads < useful ? threads : useful);
    const size_t count = weft__team_threads(team);
    const size_t each = rows / (ROWS_PER_BAND * count);
    const size_t bands = count * (each > 1 ? each : 1);
    return (weft__forces){ .cloth = cloth,
                           .team = team,
                           .bands = bands < WEFT_PARTS ? bands : WEFT_PARTS };
}

void weft__forces_destroy(weft__forces *forces)
{
    weft__team_destroy(forces->team);
}

typedef struct call {
    const weft__forces *forces;
    double t;
    const double *y;
    double *dydt;
    atomic_int failed;
} call;

static void band(void *ctx, size_t i)
{
    call *of = ctx;
    const size_t rows = weft_cloth_rows(of->forces->cloth), bands = of->forces->bands;
    const size_t each = rows / bands, more = rows % bands;
    const size_t first = i * each + (i < more ? i : more);
    const size_t end = first + each + (i < more ? 1 : 0);
    if (weft__rhs_rows(of->forces->cloth, of->t, of->y, of->dydt, first, end) != 0) {
        atomic_store(&of->failed, 1);
    }
}

int weft__forces_rhs(const weft__forces *forces, double t, const double *y,
                     double *dydt)
{
    if (forces->team == NULL) {
        return weft_cloth_rhs(forces->cloth, t, y, dydt);
    }
    call all = { .forces = forces, .t = t, .y = y, .dydt = dydt };
    weft__team_run(forces->team, band, &all, forces->bands);
    return atomic_load(&all.failed);
}
