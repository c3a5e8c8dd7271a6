/* SPDX-License-Identifier: BSD-3-Clause */
/* linearise.c -- the derivatives of the forces, for weft_structure. */
#include <string.h>

#include "base/memory.h"
#include "cloth/grids.h"

/* Unless runs is NULL, which only counts, writes some of particles from `first` on. */
static void add_runs(const weft_spring_run *some, size_t count, size_t first,
                     weft_spring_run *runs, weft_structure *of)
{
    for (size_t i = 0; i < count; ++i, ++of->run_count) {
        of->pair_count += some[i].count;
        if (runs != NULL) {
            runs[of->run_count] = (weft_spring_run){ some[i].p + first,
                                                     some[i].q + first, some[i].count };
        }
    }
}

static void list_runs(const weft_cloth *cloth, weft_spring_run *runs,
                      weft_structure *of)
{
    of->run_count = of->pair_count = 0;
    for (size_t b = 0; b < weft__blocks(&cloth->mesh); ++b) {
        weft__grid_row row = { 0 };
        while (weft__grids_next(cloth, &(weft__state){ .t = 0.0 }, b, &row)) {
            weft_spring_run some[WEFT_GROUPS];
            add_runs(some, weft__springs_runs(&row.cloth->springs, row.row, some),
                     row.cloth->first, runs, of);
        }
    }
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        const bool has = force != NULL && force->couplings.runs != NULL;
        const size_t runs_before = of->run_count, springs_before = of->pair_count;
        weft_spring_run some[WEFT_GROUPS];
        for (size_t b = 0; has && b < weft__blocks(&cloth->mesh); ++b) {
            add_runs(some, force->couplings.runs(weft__own(cloth, k), b, some), 0, runs,
                     of);
        }
        if (k == WEFT__FORCE_bending) {
            of->bend_runs = of->run_count - runs_before;
            of->bend_pairs = of->pair_count - springs_before;
            of->bend_damping = cloth->bending.damping;
        }
    }
}

void *weft__list_structure(const weft_cloth *cloth, bool block_couplings,
                           const weft_allocator *memory, weft_structure *out)
{
    list_runs(cloth, NULL, out);
    out->block_coupling_count
        = block_couplings ? weft__list_block_couplings(cloth, NULL) : 0;
    out->scalar_coupling_count
        = block_couplings ? weft__list_scalar_couplings(cloth, NULL) : 0;
    const size_t run_bytes = out->run_count * sizeof *out->runs;
    const size_t bytes
        = run_bytes + out->scalar_coupling_count * sizeof *out->scalar_couplings;
    char *room = weft__alloc(
        memory, bytes + out->block_coupling_count * sizeof *out->block_couplings, 1);
    if (room != NULL) {
        weft_spring_run *runs = (void *)room;
        weft_scalar_coupling *scalar_couplings = (void *)(room + run_bytes);
        weft_block_coupling *to = (void *)(room + bytes);
        list_runs(cloth, runs, out);
        if (block_couplings) {
            (void)weft__list_block_couplings(cloth, to);
            (void)weft__list_scalar_couplings(cloth, scalar_couplings);
        }
        out->runs = runs, out->block_couplings = to,
        out->scalar_couplings = scalar_couplings;
    }
    return room;
}

int weft__linearise(const weft_cloth *cloth, void *const *spaces, const weft__state *at,
                    double *planes, size_t spring_couplings, double *blocks)
{
    double bad = 0.0;
    int failed = 0;
    if (blocks != NULL) {
        memset(blocks, 0, 15 * cloth->mesh.particles * sizeof *blocks);
    }
    for (size_t b = 0; b < weft__blocks(&cloth->mesh); ++b) {
        weft__grid_row row = { 0 };
        while (weft__grids_next(cloth, at, b, &row)) {
            planes = weft__springs_couplings(&row.cloth->springs, &row.at, row.row,
                                             planes, spring_couplings, &bad);
        }
    }
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        const void *own = weft__own(cloth, k);
        const bool has = force != NULL && force->couplings.springs != NULL;
        for (size_t b = 0; has && b < weft__blocks(&cloth->mesh); ++b) {
            planes
                = force->couplings.springs(own, at, b, planes, spring_couplings, &bad);
        }
        if (force != NULL && force->couplings.blocks != NULL && blocks != NULL) {
            failed |= force->couplings.blocks(own, spaces != NULL ? spaces[k] : NULL,
                                              at, blocks);
        }
    }
    return bad == 0.0 ? failed : 1;
}

size_t weft__list_block_couplings(const weft_cloth *cloth,
                                  weft_block_coupling *block_couplings)
{
    size_t count = 0;
    WEFT__FROM_EACH_FORCE(count +=, cloth, couplings.block_couplings,
                          block_couplings != NULL ? block_couplings + count : NULL)
    return count;
}

size_t weft__list_scalar_couplings(const weft_cloth *cloth,
                                   weft_scalar_coupling *scalar_couplings)
{
    size_t count = 0;
    WEFT__FROM_EACH_FORCE(count +=, cloth, couplings.scalar_couplings,
                          scalar_couplings != NULL ? scalar_couplings + count : NULL)
    for (size_t g = 0; g < cloth->grid_count; g += 2) {
        count += weft__bending_scalar_couplings(
            &cloth->grids[g].bending, cloth->grids[g].first,
            scalar_couplings != NULL ? scalar_couplings + count : NULL);
    }
    return count;
}

int weft__linearise_block_couplings(const weft_cloth *cloth, double t, const double *y,
                                    double *numbers)
{
    const weft__state at = { .t = t, .y = y };
    int failed = 0; /* block couplings are of one force alone */
    WEFT__FROM_EACH_FORCE(failed |=, cloth, couplings.block_numbers, &at, numbers)
    return failed;
}
