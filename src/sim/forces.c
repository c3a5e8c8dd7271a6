/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/forces.h"

#include <stdatomic.h>

#include "base/memory.h"
#include "cloth/model.h"

/* PARTICLES_PER_THREAD: their evaluation takes ten times as long as handing it to a
 * thread that is awake; with contact of the cloth with itself, that of fewer. More
 * bands than threads, where a band costs little beside its rows (it computes one row
 * twice), shorten the wait for a thread that is kept from running. One thread takes
 * bands where the state is beyond the caches: the kernel takes tile after tile of
 * columns, and long tiles leave nothing there for the next (1000 x 1000: 8 % of a
 * step). */
enum {
    PARTICLES_PER_THREAD = 2048,
    SELF_PER_THREAD = 128,
    PARTICLES_CACHED = 1 << 17,
    ROWS_PER_BAND = 48
};

weft__forces weft__forces_create(const weft_cloth *cloth, size_t threads,
                                 const weft_allocator *given)
{
    const weft_allocator memory = weft_allocator_or_malloc(given);
    const size_t each_thread
        = cloth->contact.self ? SELF_PER_THREAD : PARTICLES_PER_THREAD;
    const size_t worth = weft_cloth_particles(cloth) / each_thread;
    const size_t rows = weft_cloth_rows(cloth);
    const size_t useful = worth < rows ? worth : rows;
    weft_measures *measures = weft__alloc(&memory, rows, sizeof *measures);
    weft__team *team = weft__team_create(threads < useful ? threads : useful, &memory);
    const size_t count = weft__team_threads(team);
    const size_t each = rows / (ROWS_PER_BAND * count);
    const bool many = count > 1 || weft_cloth_particles(cloth) > PARTICLES_CACHED;
    const size_t bands = count * (many && each > 1 ? each : 1);
    weft__self_list *self = NULL;
    if (cloth->contact.self && measures != NULL) {
        self = weft__self_list_create(cloth, team, &memory);
        if (self == NULL) {
            weft__free(&memory, measures);
            measures = NULL;
        }
    }
    return (weft__forces){ .cloth = cloth,
                           .team = team,
                           .bands = bands < WEFT_PARTS ? bands : WEFT_PARTS,
                           .self = self,
                           .measures = measures,
                           .memory = memory };
}

void weft__forces_destroy(weft__forces *forces)
{
    weft__self_list_destroy(forces->self);
    weft__team_destroy(forces->team);
    weft__free(&forces->memory, forces->measures);
}

/* The first row of a band, the last that of none. */
static size_t first_row(const weft__forces *forces, size_t band)
{
    const size_t rows = weft_cloth_rows(forces->cloth);
    const size_t each = rows / forces->bands, more = rows % forces->bands;
    return band * each + (band < more ? band : more);
}

typedef struct bands_job {
    const weft__forces *forces;
    weft__band_fn *task;
    void *ctx;
} bands_job;

static void do_band(void *ctx, size_t i)
{
    const bands_job *of = ctx;
    of->task(of->ctx, first_row(of->forces, i), first_row(of->forces, i + 1));
}

void weft__forces_bands(const weft__forces *forces, weft__band_fn *task, void *ctx)
{
    bands_job of = { forces, task, ctx };
    if (forces->team != NULL) {
        weft__team_run(forces->team, do_band, &of, forces->bands);
        return;
    }
    for (size_t i = 0; i < forces->bands; ++i) {
        do_band(&of, i);
    }
}

typedef struct call {
    const weft__forces *forces;
    const weft__subject *subject;
    double *dydt;
    atomic_int failed;
    weft__row_fn *row;
} call;

static void force_band(void *ctx, size_t first, size_t end)
{
    call *of = ctx;
    if (weft__rhs_rows(of->subject, of->dydt, first, end) != 0) {
        atomic_store(&of->failed, 1);
    }
}

int weft__forces_rhs(const weft__forces *forces, double t, const double *y,
                     double *dydt)
{
    const weft__subject of = { .cloth = forces->cloth, .t = t, .y = y };
    call all = { .forces = forces, .subject = &of, .dydt = dydt };
    weft__forces_bands(forces, force_band, &all);
    if (forces->self != NULL) {
        double *to = dydt + 3 * forces->cloth->particles;
        return atomic_load(&all.failed) | weft__self_list_add(forces->self, &of, to);
    }
    return atomic_load(&all.failed);
}

static void measure_band(void *ctx, size_t first, size_t end)
{
    const call *of = ctx;
    for (size_t r = first; r < end; ++r) {
        weft_measures *row = &of->forces->measures[r];
        *row = weft__row_start;
        of->row(of->subject, r, row);
    }
}

weft_measures weft__forces_measure(const weft__forces *forces, const weft__subject *of,
                                   weft__row_fn *row)
{
    call all = { .forces = forces, .subject = of, .row = row };
    weft_measures sum = weft__measures_start;
    weft__forces_bands(forces, measure_band, &all);
    for (size_t r = 0; r < weft_cloth_rows(forces->cloth); ++r) {
        weft__measures_add(&sum, &forces->measures[r]);
    }
    if (forces->self != NULL && row != weft__row_worst) {
        weft__self_list_measure(forces->self, of, &sum);
    }
    return sum;
}
