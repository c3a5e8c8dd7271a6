/* SPDX-License-Identifier: BSD-3-Clause */
/* frame_check.c -- cloth that passes through a shape between its particles, at frames:
 * no step is taken back for it, because only particles feel shapes that are no mesh. */
#include "forces/contact/passage.h"

#include "base/log.h"
#include "mesh/triangles.h"
#include "sim/bands.h"
#include "sim/simulation.h"

/* What blocks have found. */
typedef struct look {
    double count, rate; /* [1/s] of the shortest wait */
} look;

typedef struct look_job {
    const weft_sim *sim;
    double rise; /* [m/s^2] */
    look *blocks;
} look_job;

static weft__passages of_block(const look_job *job, size_t b)
{
    const weft_sim *sim = job->sim;
    const weft__state at = { .t = sim->t, .y = sim->y };
    return weft__block_passages(&sim->cloth->contact, &at, b, job->rise);
}

static void look_at(void *ctx, size_t first, size_t end)
{
    const look_job *job = ctx;
    for (size_t b = first; b < end; ++b) {
        const weft__passages found = of_block(job, b);
        job->blocks[b - job->sim->cloth->mesh.band.above]
            = (look){ (double)found.count, 1.0 / found.wait };
    }
}

/* Of all bands, on the threads. */
static look look_for(const weft_sim *sim, const look_job *job)
{
    const weft__forces *forces = &sim->forces;
    const weft_comm *comm = forces->comm;
    look all = { 0.0, 0.0 }, *of = (look *)(void *)forces->all;
    _Static_assert(sizeof(look) <= sizeof(weft_measures), "a block's room for each");
    weft__forces_bands(forces, look_at, (void *)job);
    for (size_t b = 0; b < sim->cloth->mesh.band.own; ++b) {
        all.count += job->blocks[b].count;
        all.rate = fmax(all.rate, job->blocks[b].rate);
    }
    if (comm != NULL) {
        comm->gather(comm->self, &all, sizeof all, of);
        for (size_t k = 0; comm->rank == 0 && k < (size_t)comm->size; ++k) {
            all.count = (k == 0 ? 0.0 : all.count) + of[k].count;
            all.rate = fmax(all.rate, of[k].rate);
        }
        comm->share(comm->self, &all, sizeof all);
    }
    return all;
}

/* The first, with numbers of the definition, in all bands the same. */
static weft_passage find_first(const weft_sim *sim, const look_job *job)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    const size_t end = mesh->band.above + mesh->band.own;
    weft__passages out = { .count = 0 };
    for (size_t b = mesh->band.above; b < end && out.count == 0; ++b) {
        out = of_block(job, b);
    }
    for (size_t k = 0; k < out.first.count; ++k) {
        out.first.particle[k]
            = weft__vertex_of(mesh, weft__whole_index(mesh, out.first.particle[k]));
    }
    (void)weft__bands_first(sim->def.comm, out.count > 0, &out, sizeof out);
    return (weft_passage){ out.first, out.shape };
}

weft_status weft__sim_passages(weft_sim *sim, weft_error *err)
{
    const bool strict = sim->cloth->strict;
    if (sim->cloth->contact.shape_count == 0 || (sim->passage.told && !strict)) {
        sim->passage.next = INFINITY;
        return WEFT_OK;
    }
    const look_job job = { sim, weft__length(sim->cloth->body.gravity),
                           (look *)(void *)sim->forces.measures };
    const look found = look_for(sim, &job);
    sim->passage.next = sim->t + 1.0 / found.rate;
    if (!(found.count > 0.0)) {
        return WEFT_OK;
    }
    char text[WEFT__PASSAGE_TEXT];
    const weft_passage first = find_first(sim, &job);
    weft__passage_text(sim->cloth, sim->t, &first, found.count, text);
    sim->passage.told = true;
    if (strict) {
        return weft_error_set(err, WEFT_INVALID, "contact.strict: %s", text);
    }
    weft__log(&sim->def.log, WEFT_LOG_WARNING, "%s", text);
    return WEFT_OK;
}

bool weft_sim_passed(const weft_sim *sim)
{
    return sim->passage.told;
}
