/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/contact_law.h"

#include <string.h>

#include "base/sized.h"
const char *weft_shape_name(weft_shape_kind kind)
{
    static const char *const names[WEFT_SHAPES]
        = { "plane", "sphere", "capsule", "box" };
    return (unsigned)kind < WEFT_SHAPES ? names[kind] : "unknown";
}

void weft_shape_default_sized(weft_shape *out, size_t size, weft_shape_kind kind)
{
    const weft_shape shape = {
        .kind = kind,
        .to = { 1.0, 0.0, 0.0 },
        .normal = { 0.0, 1.0, 0.0 },
        .radius = 1.0,
        .half = { 1.0, 1.0, 1.0 },
        .rounding = 0.01,
        .friction = -1.0,
    };
    weft__sized_write(out, size, &shape, sizeof shape);
}

static void give_axis(weft__shape *shape)
{
    const weft_shape *def = &shape->def;
    double way[3];
    for (size_t k = 0; k < 3; ++k) {
        way[k] = def->kind == WEFT_PLANE ? def->normal[k] : def->to[k] - def->at[k];
    }
    shape->length = sqrt(weft__dot(way, way));
    for (size_t k = 0; k < 3; ++k) {
        shape->axis[k] = way[k] / shape->length;
    }
    const double turn = weft__dot(def->spin, shape->axis);
    for (size_t k = 0; k < 3; ++k) {
        shape->spin[k] = turn * shape->axis[k];
    }
}

/* Without the numbers that its kind does not read: these may be anything. */
weft__shape weft__shape_of(const weft_shape *def, double friction)
{
    weft__shape shape = {
        .def = *def,
        .motion = weft__motion_of(def->velocity, def->amplitude, def->frequency),
        .friction = weft__friction_of(def, friction),
        .radius = def->kind == WEFT_PLANE ? 0.0
                  : def->kind == WEFT_BOX ? def->rounding
                                          : def->radius,
    };
    if (def->kind == WEFT_PLANE || def->kind == WEFT_CAPSULE) {
        give_axis(&shape);
    } else {
        memcpy(shape.spin, def->spin, sizeof shape.spin);
    }
    return shape;
}

weft__pose weft__pose_of(const weft__shape *shape, double t)
{
    const weft_shape *def = &shape->def;
    weft__pose pose = { .kind = def->kind,
                        .length = shape->length,
                        .radius = shape->radius,
                        .friction = shape->friction };
    double offset[3], rate[6];
    weft__motion_offset(&shape->motion, t, offset);
    weft__motion_rate(&shape->motion, t, rate);
    for (size_t k = 0; k < 3; ++k) {
        pose.at[k] = def->at[k] + offset[k];
        pose.velocity[k] = rate[k];
        pose.spin[k] = shape->spin[k];
        pose.axis[k] = shape->axis[k];
        pose.inner[k] = def->half[k] - def->rounding;
    }
    return pose;
}

/* With |q|_4 the norm, g = q^3 / |q|_4^3 by components, and d|q|_4 = g.dq. */
static void box_turn(const weft__pose *pose, const double r[3], const double g[3],
                     const double dx[3], double turn[3])
{
    double q2[3];
    for (size_t k = 0; k < 3; ++k) {
        const double q = law_beyond(r[k], -pose->inner[k], pose->inner[k]);
        q2[k] = q * q;
    }
    const double norm = sqrt(sqrt(weft__dot(q2, q2)));
    const double inverse = 1.0 / norm, slope = weft__dot(g, dx);
    for (size_t k = 0; k < 3; ++k) {
        const double part = q2[k] * inverse * inverse;
        turn[k] = 3.0 * inverse * (part * dx[k] - slope * g[k]);
    }
}

/* The same of side rho^2 / norm^3 + axis q^3 / norm^3. */
static void capsule_turn(const weft__pose *pose, const double r[3], const double g[3],
                         const double dx[3], double turn[3])
{
    const double along = weft__dot(r, pose->axis), move = weft__dot(dx, pose->axis);
    const double q = law_beyond(along, 0.0, pose->length), q2 = q * q;
    double side[3], aside[3];
    for (size_t k = 0; k < 3; ++k) {
        side[k] = r[k] - along * pose->axis[k];
        aside[k] = dx[k] - move * pose->axis[k];
    }
    const double rho2 = weft__dot(side, side);
    const double norm = sqrt(sqrt(rho2 * rho2 + q2 * q2));
    const double inverse = 1.0 / norm, slope = weft__dot(g, dx);
    const double cube = inverse * inverse * inverse;
    for (size_t k = 0; k < 3; ++k) {
        turn[k] = cube
                      * (2.0 * weft__dot(side, aside) * side[k] + rho2 * aside[k]
                         + 3.0 * q2 * move * pose->axis[k])
                  - 3.0 * inverse * slope * g[k];
    }
}

void weft__shape_turn(const weft__pose *pose, const double x[3],
                      const double gradient[3], const double dx[3], double turn[3])
{
    const double r[3] = { x[0] - pose->at[0], x[1] - pose->at[1], x[2] - pose->at[2] };
    if (pose->kind == WEFT_CAPSULE) {
        capsule_turn(pose, r, gradient, dx, turn);
    } else if (pose->kind == WEFT_BOX) {
        box_turn(pose, r, gradient, dx, turn);
    } else {
        const double curvature
            = pose->kind == WEFT_SPHERE ? 1.0 / weft__length(r) : 0.0;
        const double slope = weft__dot(gradient, dx);
        for (size_t k = 0; k < 3; ++k) {
            turn[k] = curvature * (dx[k] - slope * gradient[k]);
        }
    }
}

double weft__gap_at(const weft__pose *pose, const double x[3])
{
    const double r[3] = { x[0] - pose->at[0], x[1] - pose->at[1], x[2] - pose->at[2] };
    law_spot at;
    law_spot_of(pose, pose->kind, r, &at);
    return at.gap;
}

/* ---- continuous collision detection ------------------------------------------------
 */

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
