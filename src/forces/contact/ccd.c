/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/ccd.h"

#include <math.h>

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

/* [m^2/s^2] of a particle beside the surface, or beside a shape that does not spin. */
static double speed2(const weft__pose *pose, const double x[3], const double v[3])
{
    double surface[3], with[3], without[3];
    weft__surface_velocity(pose, x, surface);
    for (size_t k = 0; k < 3; ++k) {
        with[k] = v[k] - surface[k];
        without[k] = v[k] - pose->velocity[k];
    }
    return fmax(weft__dot(with, with), weft__dot(without, without));
}

bool weft__ccd_clear(const weft__ccd *of, const weft__path *path, size_t n, size_t i,
                     double *gap)
{
    const double *ends[2] = { path->y0 + i, path->y1 + i };
    double d[2], r[2][3], square = 0.0, way2 = 0.0;
    for (size_t e = 0; e < 2; ++e) {
        const double *y = ends[e];
        const double x[3] = { y[0], y[n], y[2 * n] };
        const double v[3] = { y[3 * n], y[4 * n], y[5 * n] };
        d[e] = weft__gap_at(&of->pose[e], x);
        square = fmax(square, speed2(&of->pose[e], x, v));
        for (size_t k = 0; k < 3; ++k) {
            r[e][k] = x[k] - of->pose[e].at[k];
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        way2 += (r[1][k] - r[0][k]) * (r[1][k] - r[0][k]);
    }
    *gap = d[1];
    return d[1] > 0.0 && sqrt(way2) < d[0] + d[1]
           && of->h * (sqrt(square) + of->between) < d[0] + d[1];
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
