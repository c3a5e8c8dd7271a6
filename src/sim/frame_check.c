/* SPDX-License-Identifier: BSD-3-Clause */
/* frame_check.c -- cloth that passes through a shape between its particles, at frames
 * and within steps: no step is rejected for it, because only particles feel shapes
 * that are no mesh. */
#include "base/log.h"
#include "mesh/surface.h"
#include "sim/bands.h"
#include "sim/simulation.h"

/* Within one step, at most: of a shape that is very thin for its speed. */
enum { LOOKS = 64 };

/* What blocks have found. */
typedef struct look {
    double count, rate; /* [1/s] of the shortest wait */
} look;

typedef struct look_job {
    const weft_sim *sim;
    weft__state at;
    double rise; /* [m/s^2] */
    look *blocks;
} look_job;

static weft__passages frame_check_of_block(const look_job *job, size_t b)
{
    return weft__block_passages(job->sim->cloth, &job->at, b, job->rise);
}

static void frame_check_look_at(void *ctx, size_t first, size_t end)
{
    const look_job *job = ctx;
    for (size_t b = first; b < end; ++b) {
        const weft__passages found = frame_check_of_block(job, b);
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
    weft__forces_spans(forces, frame_check_look_at, (void *)job);
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
static weft_passage frame_check_find_first(const weft_sim *sim, const look_job *job)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    const size_t end = mesh->band.above + mesh->band.own;
    weft__passages out = { .count = 0 };
    for (size_t b = mesh->band.above; b < end && out.count == 0; ++b) {
        out = frame_check_of_block(job, b);
    }
    for (size_t k = 0; k < out.first.count; ++k) {
        out.first.particle[k]
            = weft__vertex_of(mesh, weft__whole_index(mesh, out.first.particle[k]));
    }
    (void)weft__bands_first(sim->def.comm, out.count > 0, &out, sizeof out);
    return (weft_passage){ out.first, out.shape };
}

static weft_status check_state(weft_sim *sim, double t, const double *y,
                               weft_error *err)
{
    const bool strict = sim->cloth->strict;
    if (!weft__cloth_passages(sim->cloth) || (sim->passage.told && !strict)) {
        sim->passage.next = INFINITY;
        return WEFT_OK;
    }
    const look_job job = { sim,
                           { .t = t, .y = y },
                           weft__length(sim->cloth->body.gravity),
                           (look *)(void *)sim->forces.measures };
    const look found = look_for(sim, &job);
    sim->passage.next = t + 1.0 / found.rate;
    if (!(found.count > 0.0)) {
        return WEFT_OK;
    }
    char text[WEFT__PASSAGE_TEXT];
    const weft_passage first = frame_check_find_first(sim, &job);
    weft__passage_text(sim->cloth, t, &first, found.count, text);
    sim->passage.told = true;
    if (strict) {
        return weft_error_set(err, WEFT_INVALID, "contact.strict: %s", text);
    }
    weft__log(&sim->def.log, WEFT_LOG_WARNING, "%s", text);
    return WEFT_OK;
}

weft_status weft__sim_passages(weft_sim *sim, weft_error *err)
{
    return check_state(sim, sim->t, sim->y, err);
}

/* Particles go straight, as those of the check of the step do. */
weft_status weft__sim_look_within(weft_sim *sim, double t0, weft_error *err)
{
    const double *start = sim->between.start != NULL ? sim->between.start
                                                     : sim->guard.start; /* at t0 */
    const size_t dim = weft_cloth_dim(sim->cloth);
    const double h = sim->t - t0;
    double t = fmax(sim->passage.next, t0);
    while (t < sim->t) {
        double *const y = weft__sim_room(sim), s = (t - t0) / h;
        for (size_t i = 0; i < dim; ++i) {
            y[i] = start[i] + s * (sim->y[i] - start[i]);
        }
        TRY(check_state(sim, t, y, err));
        t = fmax(sim->passage.next, t + h / LOOKS);
    }
    return WEFT_OK;
}

bool weft_sim_passed(const weft_sim *sim)
{
    return sim->passage.told;
}
