/* SPDX-License-Identifier: BSD-3-Clause */
/* bodies_closing.c -- as forces/contact/closing.c, of shapes of which one at least is
 * of triangles: two surfaces that push the same particle of the cloth from opposite
 * sides are followed, each point with its shape. */
#include <math.h>
#include <string.h>

#include "forces/contact/bodies/bodies.h"

/* As in closing.c. */
#define OPPOSED  0.5
#define TOGETHER 0.1
#define SOON     4.0
enum { TIMES = 200 };

/* Particles looked at, by their number modulo this. */
enum { SLOTS = 256 };

/* Where a shape pushes a particle. */
typedef struct closing_spot {
    size_t particle, shape;
    double gap;                           /* [m] */
    double at[3], normal[3], velocity[3]; /* of the surface */
} closing_spot;

typedef struct closing_spots {
    const weft__bodies *own;
    double t, thickness;
    const double *y; /* of all points */
    bool used[SLOTS];
    closing_spot slots[SLOTS];
    weft__closing found;
} closing_spots;

/* A point of a surface at another time. */
static void bodies_closing_move(const closing_spots *of, const closing_spot *from,
                                double t, double x[3])
{
    const weft__shape *shape = &of->own->contact->shapes[from->shape];
    const weft__rigid_motion *motion = &shape->motion;
    if (shape->def.body != NULL && shape->def.body->keys > 1) {
        for (size_t k = 0; k < 3; ++k) {
            x[k] = from->at[k] + (t - of->t) * from->velocity[k];
        }
        return;
    }
    const weft__rigid now = weft__rigid_at(motion, of->t);
    const weft__rigid then = weft__rigid_at(motion, t);
    double arm[3], start[3];
    for (size_t k = 0; k < 3; ++k) {
        arm[k] = from->at[k] - now.about[k];
    }
    weft__rotate_back(&now.rotation, arm, start);
    for (size_t k = 0; k < 3; ++k) {
        start[k] += motion->turn.about[k];
    }
    weft__rigid_move(motion, &then, start, x, NULL);
}

/* [m] How far a is above b, along the normal of b. */
static double apart_at(const closing_spots *of, const closing_spot *a,
                       const closing_spot *b, double t)
{
    double p[3], q[3];
    bodies_closing_move(of, a, t, p);
    bodies_closing_move(of, b, t, q);
    const double displacement[3] = { p[0] - q[0], p[1] - q[1], p[2] - q[2] };
    return weft__dot(displacement, b->normal);
}

static void compare(closing_spots *of, const closing_spot *a, const closing_spot *b)
{
    const double apart = apart_at(of, a, b, of->t);
    const double closing
        = weft__dot(a->velocity, a->normal) + weft__dot(b->velocity, b->normal);
    if (of->found.found || a->shape == b->shape
        || weft__dot(a->normal, b->normal) > -OPPOSED || !(closing > 0.0)
        || !(apart > TOGETHER * of->thickness)) {
        return;
    }
    const double step = SOON * apart / closing / TIMES;
    double before = apart;
    for (size_t i = 1; i <= TIMES; ++i) {
        const double t = of->t + step * (double)i, now = apart_at(of, a, b, t);
        if (now <= TOGETHER * of->thickness) {
            of->found = (weft__closing){ .found = true,
                                         .particle = a->particle,
                                         .apart = apart,
                                         .meet_time = t + step * now / (before - now) };
            of->found.shape[0] = a->shape < b->shape ? a->shape : b->shape;
            of->found.shape[1] = a->shape < b->shape ? b->shape : a->shape;
            return;
        }
        before = now;
    }
}

static void bodies_closing_look(closing_spots *of, const closing_spot *at)
{
    const size_t slot = at->particle % SLOTS;
    if (!of->used[slot]) {
        of->slots[slot] = *at;
        of->used[slot] = true;
    } else if (of->slots[slot].particle == at->particle) {
        compare(of, at, &of->slots[slot]);
    }
}

/* Of a pair, at the point of the cloth and that of the body with the largest force. */
static void look_at_pair(closing_spots *of, const weft__pushes *from, size_t lane,
                         size_t count)
{
    const size_t n = of->own->pairs.mesh->particles, points = of->own->pairs.points;
    double most[2] = { 0.0, 0.0 }, sum[3] = { 0.0 };
    size_t point[2] = { 0, 0 };
    for (size_t k = 0; k < count; ++k) {
        const double f[3] = { from->force[k][0][lane], from->force[k][1][lane],
                              from->force[k][2][lane] };
        const size_t i = (size_t)from->particle[k][lane];
        const size_t side = i < n ? 0 : 1;
        if (weft__dot(f, f) > most[side]) {
            most[side] = weft__dot(f, f);
            point[side] = i;
        }
        for (size_t j = 0; side == 0 && j < 3; ++j) {
            sum[j] += f[j];
        }
    }
    const double force = sqrt(weft__dot(sum, sum));
    if (!(force > 0.0) || !(most[1] > 0.0) || !isfinite(force)) {
        return;
    }
    closing_spot at = { .particle = point[0],
                        .shape = weft__bodies_shape(of->own, point[1]),
                        .gap = from->gap[lane] };
    for (size_t k = 0; k < 3; ++k) {
        at.normal[k] = sum[k] / force;
        at.at[k] = of->y[k * points + point[0]] - at.gap * at.normal[k];
        at.velocity[k] = of->y[(3 + k) * points + point[1]];
    }
    bodies_closing_look(of, &at);
}

static void look_at_pairs(void *ctx, weft__pair_kind kind, const weft__pushes *pushes,
                          size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        look_at_pair(ctx, &pushes[i / WEFT__BLOCK], i % WEFT__BLOCK,
                     weft__kind_particles(kind));
    }
}

/* Where shapes that are no mesh push. */
static void look_at_touches(closing_spots *of, const weft__state *at)
{
    const size_t n = of->own->pairs.mesh->particles;
    for (weft__touches all = weft__touches_of(of->own->contact, at->t, at->y, 0, n);
         weft__each_touch(&all);) {
        closing_spot to
            = { .particle = all.i, .shape = all.shapes - 1, .gap = all.touch.gap };
        memcpy(to.normal, all.touch.normal, sizeof to.normal);
        memcpy(to.velocity, all.touch.surface, sizeof to.velocity);
        for (size_t k = 0; k < 3; ++k) {
            to.at[k] = at->y[k * n + all.i] - to.gap * to.normal[k];
        }
        if (!of->used[all.i % SLOTS]) {
            bodies_closing_look(of, &to);
        }
    }
}

weft__closing weft__bodies_closing(const void *own, void *space, const weft__state *at)
{
    closing_spots of = { .own = own, .t = at->t };
    const weft__contact *contact = of.own->contact;
    bool moves = false;
    of.thickness = contact->law.thickness;
    for (size_t k = 0; contact->shape_count > 1 && k < contact->shape_count; ++k) {
        moves = moves || weft__body_moves(&contact->shapes[k], at->t);
    }
    if (moves) {
        look_at_touches(&of, at);
        (void)weft__bodies_each(own, space, at, look_at_pairs, &of, &of.y);
    }
    return of.found;
}
