/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/forces.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "mesh/surface.h"

/* Of a correction, before it is given up. */
enum { HALVINGS = 60 };

typedef struct path_check {
    const weft_cloth *cloth;
    const weft__path *path;
    atomic_bool failed;
} path_check;

static void step_check_check_span(void *ctx, size_t first, size_t end)
{
    path_check *of = ctx;
    if (!atomic_load_explicit(&of->failed, memory_order_relaxed)
        && !of->cloth->contact.clear(&of->cloth->contact, of->path, first, end)) {
        atomic_store(&of->failed, true);
    }
}

/* In the states that weft__path_clear joined. */
static weft__penetration self_penetration(const weft__forces *forces,
                                          const weft__path *path)
{
    const weft__gather *of = &forces->exchange.gather;
    const weft__stride stride
        = { &weft__gather_cloth(of, forces->cloth)->self,
            weft__gather_last(of, path->y0, 0), weft__gather_last(of, path->y1, 1),
            path->t1 - path->t0 };
    weft__penetration out = { .t = path->t1 };
    out.found = forces->self != NULL
                && !weft__self_list_clear(forces->self, &stride, out.pair, &out.gap);
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
    weft__bodies_penetration with;
    return !atomic_load(&of.failed) && !self_penetration(forces, path).found
           && (forces->bodies == NULL
               || weft__bodies_clear(forces->bodies, path, &with));
}

weft__penetration weft__path_penetration(const weft__forces *forces,
                                         const weft__path *path)
{
    const weft_cloth *cloth = forces->cloth;
    const weft_band band = cloth->mesh.band;
    const size_t first = weft__block(&cloth->mesh, band.above);
    const size_t last = weft__block(&cloth->mesh, band.above + band.own);
    weft__penetration out = { .t = path->t1 };
    for (size_t k = 0; k < cloth->contact.shape_count; ++k) {
        const weft__ccd shape = weft__ccd_of(&cloth->contact.shapes[k], path);
        const size_t end = out.found ? out.particle : last;
        for (size_t i = first; i < end; ++i) {
            double gap;
            if (cloth->mesh.pin[i] == 0
                && !weft__ccd_clear(&shape, path, cloth->mesh.particles, i, &gap)) {
                out = (weft__penetration){
                    .found = true, .particle = i, .shape = k, .gap = gap, .t = path->t1
                };
                break;
            }
        }
    }
    out.particle = out.found ? weft__whole_index(&cloth->mesh, out.particle) : 0;
    weft__bodies_penetration with;
    if (!out.found && forces->bodies != NULL
        && !weft__bodies_clear(forces->bodies, path, &with)) {
        out = (weft__penetration){ .found = true,
                                   .particle = with.particle,
                                   .shape = with.shape,
                                   .gap = with.gap,
                                   .t = path->t1 };
    }
    if (forces->exchange.gather.part) { /* the first of all pairs */
        weft__self_list_forget(forces->self);
    }
    return out.found ? out : self_penetration(forces, path);
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
    if (!out.found && forces->self != NULL) {
        const weft__gather *with = &forces->exchange.gather;
        const weft__state of = { .t = t, .y = weft__gather_last(with, y, 0) };
        weft_measures sum = weft__measures_start;
        weft__self_measure(&weft__gather_cloth(with, forces->cloth)->self,
                           with->part ? NULL : forces->self, &of, &sum);
        memcpy(out.pair, sum.self_pair, sizeof out.pair);
        out.gap = sum.self_gap;
        out.found = out.gap <= 0.0;
    }
    return out;
}

weft__penetration weft__particle_penetration(const weft_cloth *cloth, double t,
                                             const double *y, size_t i)
{
    const size_t n = cloth->mesh.particles;
    const double x[3] = { y[i], y[n + i], y[2 * n + i] };
    weft__penetration out = { .particle = i, .gap = INFINITY, .t = t };
    for (size_t k = 0; k < cloth->contact.shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&cloth->contact.shapes[k], t);
        const double gap = weft__gap_at(&pose, x);
        if (gap < out.gap) {
            out.gap = gap, out.shape = k;
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

/* All six numbers of a particle, `share` of the displacement from where they were. */
static void step_check_shorten(const correction *of, size_t i, double share)
{
    for (size_t j = i; j < 6 * of->cloth->mesh.particles;
         j += of->cloth->mesh.particles) {
        of->y[j] = of->from[j] + share * (of->y[j] - of->from[j]);
    }
}

/* The displacement is shorter than d0 + d1: so is each first part of it that is left by
 * another shape. */
static bool line_clear(const correction *of, const weft__pose *pose, size_t i)
{
    const size_t n = of->cloth->mesh.particles;
    const double *a = of->from + i, *b = of->y + i;
    const double x0[3] = { a[0], a[n], a[2 * n] }, x1[3] = { b[0], b[n], b[2 * n] };
    const double displacement[3] = { x1[0] - x0[0], x1[1] - x0[1], x1[2] - x0[2] };
    const double square = weft__dot(displacement, displacement);
    const double end = square == 0.0 ? 0.0 : weft__gap_at(pose, x1);
    return square == 0.0 || (end > 0.0 && sqrt(square) < weft__gap_at(pose, x0) + end);
}

static void hold_span(void *ctx, size_t first, size_t end)
{
    const correction *of = ctx;
    const weft_cloth *cloth = of->cloth;
    const size_t last = weft__block(&cloth->mesh, end);
    for (size_t k = 0; k < cloth->contact.shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&cloth->contact.shapes[k], of->t);
        for (size_t i = weft__block(&cloth->mesh, first); i < last; ++i) {
            for (int tries = 0; cloth->mesh.pin[i] == 0 && !line_clear(of, &pose, i);
                 ++tries) {
                step_check_shorten(of, i, tries < HALVINGS ? 0.5 : 0.0);
            }
        }
    }
}

void weft__hold_back(const weft__forces *forces, double t, const double *from,
                     double *y)
{
    correction of = { forces->cloth, t, from, y };
    weft__forces_spans(forces, hold_span, &of);
    if (forces->self != NULL) {
        weft__self_list_hold(forces->self, from, y);
    }
    if (forces->bodies != NULL) {
        weft__bodies_hold(forces->bodies, t, from, y);
    }
}
