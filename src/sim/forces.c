/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/forces.h"

#include <stdatomic.h>

#include "base/memory.h"
#include "cloth/sums.h"
#include "sim/bands.h"
#include "sim/spaces.h"

/* PARTICLES_PER_THREAD: their evaluation takes ten times as long as handing it to a
 * thread that is awake; with forces between any two of them, that of fewer. More
 * spans than threads, where a span costs little beside its blocks (it computes one row
 * twice), shorten the wait for a thread that is kept from running. One thread takes
 * spans where the state is beyond the caches: the kernel takes tile after tile of
 * columns, and long tiles leave nothing there for the next (1000 x 1000: 8 % of a
 * step). */
enum {
    PARTICLES_PER_THREAD = 2048,
    PAIRED_PER_THREAD = 128,
    PARTICLES_CACHED = 1 << 17,
    BLOCKS_PER_SPAN = 48
};

weft__forces weft__forces_create(const weft_cloth *cloth, size_t threads,
                                 const weft_allocator *given)
{
    const weft_allocator memory = weft_allocator_or_malloc(given);
    const size_t each_thread
        = weft__cloth_pairs(cloth) ? PAIRED_PER_THREAD : PARTICLES_PER_THREAD;
    const size_t worth = weft_cloth_particles(cloth) / each_thread;
    const size_t blocks = cloth->mesh.band.own;
    const size_t useful = worth < blocks ? worth : blocks;
    weft_measures *measures = weft__alloc(&memory, blocks, sizeof *measures);
    weft__pool *pool = weft__pool_create(threads < useful ? threads : useful, &memory);
    const size_t count = weft__pool_threads(pool);
    const size_t each = blocks / (BLOCKS_PER_SPAN * count);
    const bool many = count > 1 || weft_cloth_particles(cloth) > PARTICLES_CACHED;
    const size_t spans = count * (many && each > 1 ? each : 1);
    weft__forces out = { .cloth = cloth,
                         .pool = pool,
                         .spans = spans < WEFT_PARTS ? spans : WEFT_PARTS,
                         .measures = measures,
                         .memory = memory,
                         .piece = (double)NAN };
    if (!weft__spaces_make(&out, cloth, NULL)
        || !weft__range_stiffness_create(cloth, &memory, &out.range_stiffness)) {
        weft__free(&memory, measures);
        out.measures = NULL;
    }
    return out;
}

void weft__forces_destroy(weft__forces *forces)
{
    weft__spaces_destroy(forces);
    weft__pool_destroy(forces->pool);
    WEFT__FREE_ALL(&forces->memory, forces->range_stiffness, forces->measures,
                   forces->all, forces->exchange.parcels, forces->exchange.sent,
                   forces->exchange.room, forces->exchange.edge,
                   forces->exchange.gather.room, forces->exchange.gather.parcels);
}

/* The first block of a span, the last that of none. */
static size_t first_block(const weft__forces *forces, size_t span)
{
    const weft_band own = forces->cloth->mesh.band;
    const size_t each = own.own / forces->spans, more = own.own % forces->spans;
    return own.above + span * each + (span < more ? span : more);
}

typedef struct spans_job {
    const weft__forces *forces;
    weft__span_fn *task;
    void *ctx;
} spans_job;

static void forces_do_span(void *ctx, size_t i)
{
    const spans_job *of = ctx;
    of->task(of->ctx, first_block(of->forces, i), first_block(of->forces, i + 1));
}

void weft__forces_spans(const weft__forces *forces, weft__span_fn *task, void *ctx)
{
    spans_job of = { forces, task, ctx };
    weft__pool_run(forces->pool, forces_do_span, &of, forces->spans);
}

typedef struct call {
    const weft__forces *forces;
    const weft__state *at;
    double *dydt;
    atomic_int failed;
    weft__measure_fn *measure;
} call;

static void force_span(void *ctx, size_t first, size_t end)
{
    call *of = ctx;
    if (weft__rhs_blocks(of->forces->cloth, of->at, of->dydt, first, end) != 0) {
        atomic_store(&of->failed, 1);
    }
}

int weft__forces_rhs(const weft__forces *forces, double t, const double *y,
                     double *dydt)
{
    const weft__state at = weft__forces_state(forces, t, y);
    call all = { .forces = forces, .at = &at, .dydt = dydt };
    if (forces->comm != NULL) {
        return weft__bands_rhs(forces, &at, dydt);
    }
    weft__forces_spans(forces, force_span, &all);
    return atomic_load(&all.failed)
           | weft__rhs_all(forces->cloth, forces->spaces, &at, WEFT__ACCELERATION,
                           dydt + 3 * forces->cloth->mesh.particles);
}

static void measure_span(void *ctx, size_t first, size_t end)
{
    const call *of = ctx;
    const weft_cloth *cloth = of->forces->cloth;
    const weft__mesh *mesh = &cloth->mesh;
    for (size_t b = first; b < end; ++b) {
        weft_measures *block = &of->forces->measures[b - mesh->band.above];
        *block = weft__block_start;
        of->measure(cloth, of->at, b, block);
        block->worst.p = weft__whole_index(mesh, block->worst.p);
        block->worst.q = weft__whole_index(mesh, block->worst.q);
        block->gap_particle = weft__whole_index(mesh, block->gap_particle);
    }
}

weft_measures weft__forces_measure(const weft__forces *forces, const weft__state *at,
                                   weft__measure_fn *of)
{
    call all = { .forces = forces, .at = at, .measure = of };
    weft_measures sum = weft__measures_start;
    weft__forces_spans(forces, measure_span, &all);
    const weft_measures *blocks
        = weft__bands_blocks(forces, forces->measures, sizeof *forces->measures);
    for (size_t b = 0; blocks != NULL && b < forces->cloth->mesh.band.rows; ++b) {
        weft__measures_add(&sum, &blocks[b]);
    }
    weft__bands_share(forces->comm, &sum, sizeof sum);
    if (weft__spaces_any(forces) && of != weft__block_worst) {
        weft__gather_measure(forces, at, &sum);
    }
    return sum;
}
