/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/contact_law.h"

/* With linear interpolation between its ends, V is off by at most h^2 / 8 max |V''|. */
weft__ccd weft__ccd_of(const weft__shape *shape, const weft__path *path)
{
    const weft__motion *motion = &shape->motion;
    const double h = path->t1 - path->t0, turn = motion->omega * h;
    const double swing = sqrt(weft__dot(motion->amplitude, motion->amplitude));
    weft__ccd of = { .h = h,
                     .between = swing * motion->omega * fmin(2.0, turn * turn / 8.0),
                     .spins = weft__dot(shape->spin, shape->spin) != 0.0,
                     .pose = { weft__pose_of(shape, path->t0),
                               weft__pose_of(shape, path->t1) } };
    const double *v0 = of.pose[0].velocity, *v1 = of.pose[1].velocity;
    double shift2 = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const double way = of.pose[1].at[k] - of.pose[0].at[k];
        shift2 += way * way;
    }
    of.shift = sqrt(shift2);
    of.fastest = sqrt(fmax(weft__dot(v0, v0), weft__dot(v1, v1))) + of.between;
    return of;
}

bool weft__ccd_clear(const weft__ccd *of, const weft__path *path, size_t n, size_t i,
                     double *gap)
{
    double x[2][3], v[2][3], d[2];
    for (size_t k = 0; k < 3; ++k) {
        x[0][k] = path->y0[k * n + i], v[0][k] = path->y0[(3 + k) * n + i];
        x[1][k] = path->y1[k * n + i], v[1][k] = path->y1[(3 + k) * n + i];
    }
    const bool clear = law_clear(of, of->pose[0].kind, x, v, d) != 0;
    *gap = d[1];
    return clear;
}

bool weft__clear_loops(const weft__contact *own, const weft__path *path, size_t first,
                       size_t end)
{
    const weft__mesh *mesh = own->mesh;
    for (size_t k = 0; k < own->shape_count; ++k) {
        const weft__ccd of = weft__ccd_of(&own->shapes[k], path);
        for (size_t i = weft__block(mesh, first); i < weft__block(mesh, end); ++i) {
            double gap;
            if (mesh->pin[i] == 0
                && !weft__ccd_clear(&of, path, mesh->particles, i, &gap)) {
                return false;
            }
        }
    }
    return true;
}
