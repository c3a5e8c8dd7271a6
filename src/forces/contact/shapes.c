/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/contact_law.h"

#include <string.h>

#include "base/sized.h"
const char *weft_shape_name(weft_shape_kind kind)
{
    static const char *const names[WEFT_SHAPES]
        = { "plane", "sphere", "capsule", "box", "mesh" };
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
        .turn.about = { (double)NAN, (double)NAN, (double)NAN },
    };
    weft__sized_write(out, size, &shape, sizeof shape);
}

static void give_axis(weft__shape *shape)
{
    const weft_shape *def = &shape->def;
    double displacement[3];
    for (size_t k = 0; k < 3; ++k) {
        displacement[k]
            = def->kind == WEFT_PLANE ? def->normal[k] : def->to[k] - def->at[k];
    }
    shape->length = sqrt(weft__dot(displacement, displacement));
    for (size_t k = 0; k < 3; ++k) {
        shape->axis[k] = displacement[k] / shape->length;
    }
    const double turn = weft__dot(def->spin, shape->axis);
    for (size_t k = 0; k < 3; ++k) {
        shape->spin[k] = turn * shape->axis[k];
    }
}

/* Without the numbers that its kind does not read: these may be anything. */
weft__shape weft__shape_of(const weft_shape *def, double friction)
{
    const weft__motion motion
        = weft__motion_of(def->velocity, def->amplitude, def->frequency);
    weft__shape shape = {
        .def = *def,
        .motion = weft__rigid_motion_of(&motion, &def->turn, def->at),
        .friction = weft__friction_of(def, friction),
        .radius = def->kind == WEFT_PLANE ? 0.0
                  : def->kind == WEFT_BOX ? def->rounding
                                          : def->radius,
    };
    shape.def.body = def->kind == WEFT_MESH ? def->body : NULL;
    if (def->kind == WEFT_PLANE || def->kind == WEFT_CAPSULE) {
        give_axis(&shape);
    } else {
        memcpy(shape.spin, def->spin, sizeof shape.spin);
    }
    return shape;
}

static const double *orientation_of(const weft_shape *def)
{
    static const double none[4] = { 0.0, 0.0, 0.0, 1.0 };
    return weft__length(def->orientation) > 0.0 ? def->orientation : none;
}

weft__pose weft__pose_of(const weft__shape *shape, double t)
{
    const weft_shape *def = &shape->def;
    weft__pose pose = { .kind = def->kind,
                        .length = shape->length,
                        .radius = shape->radius,
                        .friction = shape->friction,
                        .rigid = weft__rigid_at(&shape->motion, t),
                        .turned = def->kind == WEFT_BOX
                                  && (shape->motion.turns
                                      || weft__length(def->orientation) > 0.0) };
    weft__rigid_move(&shape->motion, &pose.rigid, def->at, pose.at, pose.velocity);
    weft__rotate(&pose.rigid.rotation, shape->spin, pose.spin);
    weft__rotate(&pose.rigid.rotation, shape->axis, pose.axis);
    for (size_t k = 0; k < 3; ++k) {
        pose.spin[k] += pose.rigid.omega[k];
        pose.inner[k] = def->half[k] - def->rounding;
    }
    if (def->kind == WEFT_BOX || def->kind == WEFT_MESH) {
        double q[4];
        weft__quaternion_times(pose.rigid.quaternion, orientation_of(def), q);
        pose.frame = weft__matrix_of(q);
    }
    return pose;
}

void weft__shape_rebase(const weft__shape *shape, double t, const double place[3],
                        weft_shape *to)
{
    const weft_shape *from = &shape->def;
    const weft__rigid now = weft__rigid_at(&shape->motion, t);
    weft__motion motion = weft__motion_of(to->velocity, to->amplitude, to->frequency);
    motion.since = t;
    const weft__rigid_motion moves = weft__rigid_motion_of(&motion, &to->turn, place);
    const weft__rigid next = weft__rigid_at(&moves, t);
    const double *p = next.quaternion, back[4] = { -p[0], -p[1], -p[2], p[3] };
    const double *c = moves.turn.about;
    const double arm[3] = { place[0] - c[0], place[1] - c[1], place[2] - c[2] };
    double displacement[3], q[4], offset[3], turned[3];
    weft__quaternion_times(back, now.quaternion, q);
    const weft__matrix by = weft__matrix_of(q);
    weft__motion_offset(&motion, t, offset);
    weft__rotate_back(&next.rotation, arm, turned);
    for (size_t k = 0; k < 3; ++k) {
        displacement[k] = from->to[k] - from->at[k];
        to->at[k] = c[k] + turned[k] - offset[k];
        to->turn.about[k] -= offset[k];
    }
    weft__rotate(&by, from->normal, to->normal);
    weft__rotate(&by, from->spin, to->spin);
    weft__rotate(&by, displacement, to->to);
    for (size_t k = 0; k < 3; ++k) {
        to->to[k] += to->at[k];
    }
    if (from->kind == WEFT_BOX || from->kind == WEFT_MESH) {
        weft__quaternion_times(q, orientation_of(from), to->orientation);
    }
}

/* With |q|_4 the norm, g = q^3 / |q|_4^3 by components, and d|q|_4 = g.dq. */
static void box_turn(const weft__pose *pose, const double at[3],
                     const double gradient[3], const double move[3], double turn[3])
{
    double q2[3], r[3], g[3], dx[3], local[3];
    weft__rotate_back(&pose->frame, at, r);
    weft__rotate_back(&pose->frame, gradient, g);
    weft__rotate_back(&pose->frame, move, dx);
    for (size_t k = 0; k < 3; ++k) {
        const double q = law_beyond(r[k], -pose->inner[k], pose->inner[k]);
        q2[k] = q * q;
    }
    const double norm = sqrt(sqrt(weft__dot(q2, q2)));
    const double inverse = 1.0 / norm, slope = weft__dot(g, dx);
    for (size_t k = 0; k < 3; ++k) {
        const double part = q2[k] * inverse * inverse;
        local[k] = 3.0 * inverse * (part * dx[k] - slope * g[k]);
    }
    weft__rotate(&pose->frame, local, turn);
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
    const weft__motion *motion = &shape->motion.motion;
    const double h = path->t1 - path->t0, turn = motion->omega * h;
    const double sway = WEFT__TWO_PI * shape->motion.turn.frequency * h;
    const double swing = sqrt(weft__dot(motion->amplitude, motion->amplitude));
    weft__ccd of = { .h = h,
                     .between = swing * motion->omega * fmin(2.0, turn * turn / 8.0),
                     .spins = weft__dot(shape->spin, shape->spin) != 0.0,
                     .turns = shape->motion.turns,
                     .fast = weft__rigid_fastest(&shape->motion),
                     .swing = weft__rigid_swing(&shape->motion),
                     .pose = { weft__pose_of(shape, path->t0),
                               weft__pose_of(shape, path->t1) } };
    const double *v0 = of.pose[0].velocity, *v1 = of.pose[1].velocity;
    double shift2 = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        for (size_t j = 0; j < 3; ++j) {
            of.rotation.row[k][j] = weft__dot(of.pose[1].rigid.rotation.row[k],
                                              of.pose[0].rigid.rotation.row[j]);
        }
        const double displacement = of.pose[1].at[k] - of.pose[0].at[k];
        shift2 += displacement * displacement;
    }
    of.twist = (of.fast - fabs(shape->motion.turn.rate)) * fmin(2.0, sway * sway / 8.0);
    of.shift = sqrt(shift2);
    of.fastest = sqrt(fmax(weft__dot(v0, v0), weft__dot(v1, v1))) + of.between;
    return of;
}

bool weft__ccd_clear(const weft__ccd *of, const weft__path *path, size_t n, size_t i,
                     double *gap)
{
    if (of->pose[0].kind == WEFT_MESH) { /* left to its primitives */
        *gap = (double)INFINITY;
        return true;
    }
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
