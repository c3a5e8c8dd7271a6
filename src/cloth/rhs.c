/* SPDX-License-Identifier: BSD-3-Clause */
/* rhs.c -- the equations of motion as a first-order system y' = f(t, y):
 *
 *     free particle     x' = v,   v' = (the forces of WEFT_FORCES) / m
 *     pinned particle   x' = V + w A cos(w t),   v' = -w^2 A sin(w t),  w = 2 pi f
 *
 * A pinned particle has inverse mass 0 and follows its prescribed motion; one without
 * motion has x' = v' = 0 and keeps its position bit for bit. */
#include <string.h>

#include "cloth/sums.h"

#define PLACE(name) { &weft__##name##_force, offsetof(struct weft_cloth, name) },
const weft__line weft__table[WEFT__FORCES] = { WEFT_FORCES(PLACE) };

int weft__sum_carried(const weft_cloth *cloth, const weft__state *at,
                      weft__carry *carry, weft__unit unit, double *to, size_t first,
                      size_t end)
{
    double *planes = unit == WEFT__FORCE ? to : to + 3 * cloth->mesh.stride;
    weft__sum_fn *grids = cloth->sum_grids;
    int failed = weft__table[0].force->law.start(weft__own(cloth, 0), &cloth->body, at,
                                                 carry, unit, to, first, end);
    failed |= grids != NULL ? grids(cloth, at, unit, to, first, end) : 0;
    return failed | weft__rhs_others(cloth, at, unit, planes, first, end);
}

int weft__sum_blocks(const weft_cloth *cloth, const weft__state *at, weft__unit unit,
                     double *to, size_t first, size_t end)
{
    return weft__sum_carried(cloth, at, NULL, unit, to, first, end);
}

int weft__rhs_others(const weft_cloth *cloth, const weft__state *at, weft__unit unit,
                     double *planes, size_t first, size_t end)
{
    const weft__state along = { .y = at->along };
    int failed = 0;
    for (size_t k = 1; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        const bool change = at->along != NULL && force != NULL && !force->law.linear;
        weft__add_fn *add = force == NULL ? NULL
                            : change      ? force->law.change
                                          : force->law.add;
        const weft__state *of = at->along != NULL && !change ? &along : at;
        if (add != NULL) {
            failed |= add(weft__own(cloth, k), of, unit, planes, first, end);
        }
    }
    return failed;
}

int weft__rhs_blocks(const weft_cloth *cloth, const weft__state *at, double *dydt,
                     size_t first, size_t end)
{
    const weft__mesh *mesh = &cloth->mesh;
    int failed = weft__sum_blocks(cloth, at, WEFT__ACCELERATION, dydt, first, end);
    if (at->along == NULL) {
        const size_t low = weft__block(mesh, first);
        weft__move_pins(mesh, at->t, weft__piece(at), dydt + low, mesh->particles, low,
                        weft__block(mesh, end));
    }
    return failed;
}

int weft__rhs_all(const weft_cloth *cloth, void *const *spaces, const weft__state *at,
                  weft__unit unit, double *dvdt)
{
    int failed = 0;
    WEFT__FROM_EACH_FORCE(failed |=, cloth, whole.add,
                          spaces != NULL ? spaces[k_] : NULL, at, unit, dvdt)
    return failed;
}

void weft__ghost_blocks(const weft_cloth *cloth, const weft__state *at, double *dydt,
                        size_t first, size_t end)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles, low = weft__block(mesh, first);
    const size_t high = weft__block(mesh, end);
    for (size_t k = 0; k < 3; ++k) {
        memcpy(dydt + k * n + low, at->y + (k + 3) * n + low,
               (high - low) * sizeof *dydt);
    }
    weft__move_pins(mesh, at->t, weft__piece(at), dydt + low, n, low, high);
}

int weft_cloth_rhs(const weft_cloth *cloth, double t, const double *y, double *dydt)
{
    const weft__state at = { .t = t, .y = y };
    return weft__rhs_blocks(cloth, &at, dydt, 0, weft__blocks(&cloth->mesh))
           | weft__rhs_all(cloth, NULL, &at, WEFT__ACCELERATION,
                           dydt + 3 * cloth->mesh.particles);
}

void weft_cloth_force(const weft_cloth *cloth, double t, const double *y, double *f)
{
    const weft__state at = { .t = t, .y = y };
    (void)weft__sum_blocks(cloth, &at, WEFT__FORCE, f, 0, weft__blocks(&cloth->mesh));
    (void)weft__rhs_all(cloth, NULL, &at, WEFT__FORCE, f);
}
