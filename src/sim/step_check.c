/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/step_check.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "mesh/surface.h"

typedef struct path_check {
    const weft_cloth *cloth;
    const weft__path *path;
    atomic_bool failed;
} path_check;

static void step_check_check_span(void *ctx, size_t first, size_t end)
{
    path_check *of = ctx;
    bool clear = !atomic_load_explicit(&of->failed, memory_order_relaxed);
    for (size_t k = 0; k < WEFT__FORCES && clear; ++k) {
        const weft__force *force = weft__force_at(of->cloth, k);
        clear = force == NULL || force->checks.clear == NULL
                || force->checks.clear(weft__own(of->cloth, k), of->path, first, end);
        if (!clear) {
            atomic_store(&of->failed, true);
        }
    }
}

/* Of the pairs of force k, in the states that weft__path_clear gathered. */
static weft__penetration pair_penetration(const weft__forces *forces,
                                          const weft__path *path, size_t k)
{
    const weft__gather *of = &forces->exchange.gather;
    const weft__path whole = { path->t0, path->t1, weft__gather_last(of, path->y0, 0),
                               weft__gather_last(of, path->y1, 1) };
    const weft__force_checks *checks = &weft__table[k].force->checks;
    const void *own = weft__own(weft__gather_cloth(of, forces->cloth), k);
    weft__penetration out = { .t = path->t1 };
    out.found = checks->clear_pairs != NULL
                && !checks->clear_pairs(own, forces->spaces[k], &whole, &out);
    return out;
}

bool weft__path_clear(const weft__forces *forces, const weft__path *path)
{
    path_check of = { .cloth = forces->cloth, .path = path };
    weft__gather_begin(forces, path->y0);
    (void)weft__gather_end(forces, path->y0, 0);
    weft__gather_begin(forces, path->y1);
    weft__forces_spans(forces, step_check_check_span, &of);
    (void)weft__gather_end(forces, path->y1, 1);
    bool clear = !atomic_load(&of.failed);
    for (size_t k = 0; k < WEFT__FORCES && clear; ++k) {
        clear = forces->spaces[k] == NULL || !pair_penetration(forces, path, k).found;
    }
    return clear;
}

/* With bands all of them forget what they know, for the first of all pairs. */
static void forget(const weft__forces *forces)
{
    for (size_t k = 0; k < WEFT__FORCES && forces->exchange.gather.part; ++k) {
        if (forces->spaces[k] != NULL && weft__table[k].force->checks.forget != NULL) {
            weft__table[k].force->checks.forget(forces->spaces[k]);
        }
    }
}

weft__penetration weft__path_penetration(const weft__forces *forces,
                                         const weft__path *path)
{
    const weft_cloth *cloth = forces->cloth;
    const weft_band band = cloth->mesh.band;
    weft__penetration out = { .t = path->t1 };
    WEFT__EACH_FORCE(cloth, checks.first, path, band.above, band.above + band.own, &out)
    out.particle = out.found ? weft__whole_index(&cloth->mesh, out.particle) : 0;
    forget(forces);
    for (size_t k = WEFT__FORCES; k-- > 0 && !out.found;) {
        out = forces->spaces[k] != NULL ? pair_penetration(forces, path, k) : out;
    }
    return out;
}

const char *weft__penetration_text(const weft__mesh *mesh,
                                   const weft__penetration *penetration,
                                   char text[WEFT__PENETRATION_TEXT])
{
    char names[2][WEFT__PENETRATION_TEXT / 2 - 4];
    if (penetration->pair[0].count > 0) {
        for (size_t k = 0; k < 2; ++k) {
            const weft_primitive of = weft__primitive_of(mesh, penetration->pair[k]);
            weft__primitive_text(mesh, &of, names[k], sizeof names[k]);
        }
        (void)snprintf(text, WEFT__PENETRATION_TEXT, "%s and %s", names[0], names[1]);
    } else {
        weft__particle_name(mesh, weft__vertex_of(mesh, penetration->particle),
                            names[0], sizeof names[0]);
        (void)snprintf(text, WEFT__PENETRATION_TEXT, "%s and shapes[%zu]", names[0],
                       penetration->shape);
    }
    return text;
}

weft__penetration weft__state_penetration(const weft_cloth *cloth, double t,
                                          const double *y)
{
    weft__penetration out = { .t = t };
    out.gap = weft_cloth_gap(cloth, t, y, &out.particle, &out.shape);
    out.particle = weft__meant(&cloth->mesh, out.particle);
    out.found = out.gap <= 0.0;
    return out;
}

weft__penetration weft__rhs_penetration(const weft__forces *forces, double t,
                                        const double *y)
{
    weft__penetration out = weft__state_penetration(forces->cloth, t, y);
    out.particle
        = out.found ? weft__whole_index(&forces->cloth->mesh, out.particle) : 0;
    for (size_t k = 0; k < WEFT__FORCES && !out.found; ++k) {
        const weft__gather *with = &forces->exchange.gather;
        const weft__state of = { .t = t, .y = weft__gather_last(with, y, 0) };
        const weft__force_checks *checks = &weft__table[k].force->checks;
        if (forces->spaces[k] != NULL && checks->meet != NULL) {
            checks->meet(weft__own(weft__gather_cloth(with, forces->cloth), k),
                         with->part ? NULL : forces->spaces[k], &of, &out);
        }
    }
    return out;
}

weft__penetration weft__particle_penetration(const weft_cloth *cloth, double t,
                                             const double *y, size_t i)
{
    const size_t n = cloth->mesh.particles;
    const double x[3] = { y[i], y[n + i], y[2 * n + i] };
    weft__penetration out = { .particle = i, .gap = INFINITY, .t = t };
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(cloth, k);
        size_t shape = 0;
        const double gap = force != NULL && force->checks.gap != NULL
                               ? force->checks.gap(weft__own(cloth, k), t, x, &shape)
                               : INFINITY;
        if (gap < out.gap) {
            out.gap = gap, out.shape = shape;
        }
    }
    out.found = out.gap <= 0.0;
    return out;
}

weft_status weft__penetration_error(const weft_cloth *cloth,
                                    const weft__penetration *penetration,
                                    const char *what, weft_error *err)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t i
        = weft__vertex_of(mesh, weft__whole_index(mesh, penetration->particle));
    char name[64];
    return weft_error_set(err, WEFT_INVALID, "%s %s %.3g mm inside shapes[%zu]",
                          weft__particle_name(mesh, i, name, sizeof name), what,
                          1e3 * fabs(penetration->gap), penetration->shape);
}

/* ---- corrections ----------------------------------------------------------------- */

typedef struct correction {
    const weft_cloth *cloth;
    double t;
    const double *from;
    double *y;
} correction;

static void hold_span(void *ctx, size_t first, size_t end)
{
    const correction *of = ctx;
    WEFT__EACH_FORCE(of->cloth, checks.hold, of->t, of->from, of->y, first, end)
}

void weft__hold_back(const weft__forces *forces, double t, const double *from,
                     double *y)
{
    correction of = { forces->cloth, t, from, y };
    weft__forces_spans(forces, hold_span, &of);
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force_checks *checks = &weft__table[k].force->checks;
        if (forces->spaces[k] != NULL && checks->hold_pairs != NULL) {
            checks->hold_pairs(forces->spaces[k], t, from, y);
        }
    }
}
