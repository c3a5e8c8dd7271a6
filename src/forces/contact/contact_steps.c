/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_steps.c -- what contact with shapes asks of steps: no free particle gets into
 * a shape or through it. */
#include <math.h>

#include "forces/contact/closing.h"

/* Of a displacement, before it is given up. */
enum { HALVINGS = 60 };

bool weft__contact_clear(const void *own, const weft__path *path, size_t first,
                         size_t end)
{
    const weft__contact *of = own;
    return of->clear(of, path, first, end);
}

void weft__contact_first(const void *own, const weft__path *path, size_t first,
                         size_t end, weft__penetration *out)
{
    const weft__contact *of = own;
    const weft__mesh *mesh = of->mesh;
    const size_t last = weft__block(mesh, end);
    for (size_t k = 0; k < of->shape_count; ++k) {
        const weft__ccd shape = weft__ccd_of(&of->shapes[k], path);
        const size_t before = out->found ? out->particle : last;
        for (size_t i = weft__block(mesh, first); i < before; ++i) {
            double gap;
            if (mesh->pin[i] == 0
                && !weft__ccd_clear(&shape, path, mesh->particles, i, &gap)) {
                *out = (weft__penetration){
                    .found = true, .particle = i, .shape = k, .gap = gap, .t = path->t1
                };
                break;
            }
        }
    }
}

double weft__contact_gap(const void *own, double t, const double x[3], size_t *shape)
{
    const weft__contact *of = own;
    double least = INFINITY;
    *shape = 0;
    for (size_t k = 0; k < of->shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&of->shapes[k], t);
        const double gap = weft__gap_at(&pose, x);
        if (gap < least) {
            least = gap, *shape = k;
        }
    }
    return least;
}

void weft__contact_other(const void *own, void *space, const weft__state *at,
                         size_t than, weft_measures *least)
{
    const weft__contact *of = own;
    const weft__mesh *mesh = of->mesh;
    const size_t n = mesh->particles;
    const size_t end = weft__block(mesh, mesh->band.above + mesh->band.own);
    (void)space;
    for (size_t k = 0; k < of->shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&of->shapes[k], at->t);
        for (size_t i = weft__block(mesh, mesh->band.above); k != than && i < end;
             ++i) {
            const double x[3] = { at->y[i], at->y[n + i], at->y[2 * n + i] };
            if (mesh->pin[i] == 0) {
                weft__keep_gap(least, weft__gap_at(&pose, x), i, k);
            }
        }
    }
}

typedef struct particles {
    const double *y;
    size_t count;
} particles;

static void particle_place(const void *ctx, size_t i, double x[3])
{
    const particles *of = ctx;
    for (size_t k = 0; k < 3; ++k) {
        x[k] = of->y[k * of->count + i];
    }
}

weft__closing weft__contact_closing(const void *own, void *space, const weft__state *at)
{
    const weft__contact *of = own;
    const particles all = { at->y, of->mesh->particles };
    const weft__closing_search search = { .shapes = of->shapes,
                                          .shape_count = of->shape_count,
                                          .end = all.count,
                                          .place = particle_place,
                                          .ctx = &all,
                                          .thickness = of->law.thickness,
                                          .within = 2.0 * of->law.thickness,
                                          .t = at->t,
                                          .t_last = INFINITY };
    (void)space;
    return of->shape_count > 1 ? weft__shapes_closing(&search)
                               : (weft__closing){ .found = false };
}

/* ---- corrections ----------------------------------------------------------------- */

typedef struct displacements {
    const weft__mesh *mesh;
    const double *from;
    double *y;
} displacements;

/* All six numbers of a particle, `share` of the displacement from where they were. */
static void shorten(const displacements *of, size_t i, double share)
{
    for (size_t j = i; j < 6 * of->mesh->particles; j += of->mesh->particles) {
        of->y[j] = of->from[j] + share * (of->y[j] - of->from[j]);
    }
}

/* The displacement is shorter than d0 + d1: so is each first part of it that is left by
 * another shape. */
static bool line_clear(const displacements *of, const weft__pose *pose, size_t i)
{
    const size_t n = of->mesh->particles;
    const double *a = of->from + i, *b = of->y + i;
    const double x0[3] = { a[0], a[n], a[2 * n] }, x1[3] = { b[0], b[n], b[2 * n] };
    const double displacement[3] = { x1[0] - x0[0], x1[1] - x0[1], x1[2] - x0[2] };
    const double square = weft__dot(displacement, displacement);
    const double end = square == 0.0 ? 0.0 : weft__gap_at(pose, x1);
    return square == 0.0 || (end > 0.0 && sqrt(square) < weft__gap_at(pose, x0) + end);
}

void weft__contact_hold(const void *own, double t, const double *from, double *y,
                        size_t first, size_t end)
{
    const weft__contact *of = own;
    const weft__mesh *mesh = of->mesh;
    const displacements moves = { mesh, from, y };
    const size_t last = weft__block(mesh, end);
    for (size_t k = 0; k < of->shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&of->shapes[k], t);
        for (size_t i = weft__block(mesh, first); i < last; ++i) {
            for (int tries = 0; mesh->pin[i] == 0 && !line_clear(&moves, &pose, i);
                 ++tries) {
                shorten(&moves, i, tries < HALVINGS ? 0.5 : 0.0);
            }
        }
    }
}
