/* SPDX-License-Identifier: BSD-3-Clause */
/* augmented.c -- the weft_structure of a state with its sensitivities, for implicit and
 * stabilised methods: that of the state once for each part, as if all were cloths side
 * by side. It lacks how s' depends on the state, d(J s + df/dp)/dy, which changes no
 * mode; of a matrix, Newton's iteration and W-methods allow that. */
#include "base/memory.h"
#include "sim/simulation.h"

/* The structure of the state of which that of all parts is made, and their number. */
static const weft_structure *augmented_parts_of(const weft_sim *sim, size_t *count)
{
    *count = 1 + sim->sensitivity.count;
    return &sim->structure;
}

/* Planes of one part, `width` apart, to the same of part i, `all` apart. */
static void augmented_repeat(const double *from, size_t planes, size_t first,
                             size_t count, size_t width, double *to, size_t all,
                             size_t at)
{
    for (size_t k = 0; k < planes; ++k) {
        memcpy(to + k * all + at, from + k * width + first, count * sizeof *to);
    }
}

static int augmented_linearise(double t, const double *y, double *planes,
                               double *blocks, void *ctx)
{
    const weft_sim *sim = ctx;
    size_t parts;
    const weft_structure *of = augmented_parts_of(sim, &parts);
    const size_t n = of->particles, spring_couplings = of->pair_count,
                 bend = of->bend_pairs;
    double *own = sim->sensitivity.own,
           *touched = own + WEFT_PAIR_PLANES * spring_couplings;
    weft__sensitivity_state(sim, y, sim->sensitivity.room[0]);
    const int failed = of->linearise(t, sim->sensitivity.room[0], own,
                                     blocks != NULL ? touched : NULL, of->ctx);
    for (size_t i = 0; i < parts; ++i) {
        augmented_repeat(own, WEFT_PAIR_PLANES, 0, spring_couplings - bend,
                         spring_couplings, planes, parts * spring_couplings,
                         i * (spring_couplings - bend));
        augmented_repeat(own, WEFT_PAIR_PLANES, spring_couplings - bend, bend,
                         spring_couplings, planes, parts * spring_couplings,
                         parts * (spring_couplings - bend) + i * bend);
        if (blocks != NULL) {
            augmented_repeat(touched, WEFT_BLOCK_PLANES, 0, n, n, blocks, parts * n,
                             i * n);
        }
    }
    return failed;
}

static size_t augmented_modes(double t, const double *y, double (*corners)[2],
                              size_t room, void *ctx)
{
    const weft_sim *sim = ctx;
    if (y != NULL) {
        weft__sensitivity_state(sim, y, sim->sensitivity.room[0]);
    }
    return sim->structure.modes(t, y != NULL ? sim->sensitivity.room[0] : NULL, corners,
                                room, sim->structure.ctx);
}

weft_status weft__augmented_init(weft_sim *sim, weft_error *err)
{
    size_t parts;
    const weft_structure *of = augmented_parts_of(sim, &parts);
    weft__sensitivity *to = &sim->sensitivity;
    const size_t n = of->particles, plain = of->run_count - of->bend_runs;
    weft_spring_run *runs
        = weft__alloc(&sim->memory, parts * of->run_count, sizeof *runs);
    double *masses = weft__alloc(&sim->memory, parts * n, 2 * sizeof *masses);
    to->runs = runs, to->masses = masses;
    to->own = weft__alloc(&sim->memory,
                          WEFT_PAIR_PLANES * of->pair_count + WEFT_BLOCK_PLANES * n,
                          sizeof *to->own);
    if (runs == NULL || masses == NULL || to->own == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for sensitivities");
    }
    for (size_t i = 0; i < parts; ++i) {
        memcpy(masses + i * n, of->mass, n * sizeof *masses);
        memcpy(masses + (parts + i) * n, of->drag, n * sizeof *masses);
        for (size_t r = 0; r < of->run_count; ++r) {
            const size_t at = r < plain ? i * plain + r
                                        : parts * plain + i * of->bend_runs + r - plain;
            runs[at] = (weft_spring_run){ of->runs[r].p + i * n, of->runs[r].q + i * n,
                                          of->runs[r].count };
        }
    }
    to->structure = *of;
    to->structure.particles *= parts, to->structure.run_count *= parts;
    to->structure.pair_count *= parts, to->structure.bend_runs *= parts;
    to->structure.bend_pairs *= parts;
    to->structure.runs = runs;
    to->structure.mass = masses, to->structure.drag = masses + parts * n;
    to->structure.linearise = augmented_linearise,
    to->structure.modes = augmented_modes;
    to->structure.block_coupling_count = to->structure.scalar_coupling_count = 0;
    to->structure.ctx = sim;
    sim->config.structure = &to->structure;
    return WEFT_OK;
}
