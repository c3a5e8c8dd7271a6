/* SPDX-License-Identifier: BSD-3-Clause */
/* linearise.c -- the derivatives of the forces, for weft_structure. */
#include <string.h>

#include "cloth/model.h"

weft__run_count weft__list_runs(const weft_cloth *cloth, size_t k, weft_bonds *runs)
{
    const weft__force *force = weft__force_at(cloth, k);
    const bool has = force != NULL && force->runs != NULL;
    weft_bonds some[WEFT_GROUPS];
    weft__run_count all = { 0, 0 };
    for (size_t b = 0; has && b < weft__blocks(&cloth->mesh); ++b) {
        const size_t count = force->runs(weft__own(cloth, k), b, some);
        for (size_t i = 0; i < count; ++i) {
            if (runs != NULL) {
                runs[all.runs] = some[i];
            }
            ++all.runs;
            all.bonds += some[i].count;
        }
    }
    return all;
}

int weft__linearise(const weft_cloth *cloth, double t, const double *y, double *planes,
                    size_t bonds, double *blocks)
{
    const weft__state at = { .t = t, .y = y };
    double bad = 0.0;
    int failed = 0;
    if (blocks != NULL) {
        memset(blocks, 0, 15 * cloth->mesh.particles * sizeof *blocks);
    }
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        const void *own = weft__own(cloth, k);
        const bool has = force != NULL && force->bonds != NULL;
        for (size_t b = 0; has && b < weft__blocks(&cloth->mesh); ++b) {
            planes = force->bonds(own, &at, b, planes, bonds, &bad);
        }
        if (force != NULL && force->blocks != NULL && blocks != NULL) {
            failed |= force->blocks(own, &at, blocks);
        }
    }
    return bad == 0.0 ? failed : 1;
}

size_t weft__list_links(const weft_cloth *cloth, weft_link *links)
{
    size_t count = 0;
    WEFT__FROM_EACH_FORCE(count +=, cloth, links, links != NULL ? links + count : NULL)
    return count;
}

size_t weft__list_ties(const weft_cloth *cloth, weft_tie *ties)
{
    size_t count = 0;
    WEFT__FROM_EACH_FORCE(count +=, cloth, ties, ties != NULL ? ties + count : NULL)
    return count;
}

int weft__linearise_links(const weft_cloth *cloth, double t, const double *y,
                          double *numbers)
{
    const weft__state at = { .t = t, .y = y };
    int failed = 0; /* links are of one force alone */
    WEFT__FROM_EACH_FORCE(failed |=, cloth, link_numbers, &at, numbers)
    return failed;
}
