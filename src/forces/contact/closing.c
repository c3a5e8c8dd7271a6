/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/closing.h"

#include <math.h>

#include "forces/contact/contact_law.h"

/* -cos of the angle between the normals of two shapes that a particle lies between. */
#define OPPOSED 0.5

/* Of the thickness: surfaces as near as this meet, as far as a run is concerned. */
#define TOGETHER 0.1

/* Times looked at, until two shapes meet or turn out not to. */
enum { TIMES = 200 };

/* How many times longer than at the present speed is looked ahead. */
#define SOON 4.0

/* Two shapes at a time. */
typedef struct sides {
    const weft__shape *shape[2];
    weft__pose pose[2];
} sides;

/* A particle between them. */
typedef struct between {
    double apart;   /* [m] both gaps */
    double half;    /* [m] half of their difference */
    double closing; /* [m/s] of the surfaces against each other */
    double away[3]; /* the normal of the first */
} between;

static void go_to(sides *of, double t)
{
    of->pose[0] = weft__pose_of(of->shape[0], t);
    of->pose[1] = weft__pose_of(of->shape[1], t);
}

/* False: it is not between them, or they are not nearer than that. */
static bool is_between(const sides *of, const double x[3], double within, between *out)
{
    double gap[2], normal[2][3], speed[2];
    for (size_t j = 0; j < 2; ++j) {
        const weft__pose *pose = &of->pose[j];
        double r[3], surface[3];
        law_spot spot;
        for (size_t k = 0; k < 3; ++k) {
            r[k] = x[k] - pose->at[k];
        }
        law_spot_of(pose, pose->kind, r, &spot);
        gap[j] = spot.gap;
        if (!(gap[j] < within)) {
            return false;
        }
        const double length = weft__length(spot.gradient);
        law_surface(pose, r, surface);
        for (size_t k = 0; k < 3; ++k) {
            normal[j][k] = spot.gradient[k] / length;
        }
        speed[j] = weft__dot(surface, normal[j]);
    }
    out->apart = gap[0] + gap[1];
    out->half = 0.5 * (gap[1] - gap[0]);
    out->closing = speed[0] + speed[1];
    for (size_t k = 0; k < 3; ++k) {
        out->away[k] = normal[0][k];
    }
    return weft__dot(normal[0], normal[1]) < -OPPOSED && out->apart < within;
}

static bool moves(const weft__shape *shape)
{
    return shape->motion.motion.moves || shape->motion.turns;
}

/* The particle at which both are nearest; false: there is none between them. */
static bool closing_find_nearest(const weft__closing_search *of, const sides *both,
                                 double x[3], between *out, size_t *particle)
{
    between here;
    double at[3];
    out->apart = INFINITY;
    for (size_t i = of->first; i < of->end; ++i) {
        of->place(of->ctx, i, at);
        if (is_between(both, at, of->within, &here) && here.apart < out->apart) {
            *out = here;
            *particle = i;
            for (size_t k = 0; k < 3; ++k) {
                x[k] = at[k];
            }
        }
    }
    return out->apart > TOGETHER * of->thickness && out->apart < (double)INFINITY;
}

/* Follows the middle between both from x on; `last`: [s]. */
static bool do_meet(const weft__closing_search *of, sides *both, double x[3],
                    double last, weft__closing *out)
{
    between now;
    const double two = 2.0 * of->thickness;
    double before = INFINITY; /* [m] */
    out->near_time = INFINITY;
    for (size_t i = 0; i <= TIMES; ++i) {
        out->meet_time = of->t + (last - of->t) * ((double)i / TIMES);
        go_to(both, out->meet_time);
        if (!is_between(both, x, INFINITY, &now)) {
            return false;
        }
        for (size_t k = 0; k < 3; ++k) {
            x[k] += now.half * now.away[k];
        }
        const double t = out->meet_time, pace = TIMES * (before - now.apart);
        if (now.apart <= two && isinf(out->near_time)) { /* since the time before */
            out->near_time = t - (two - now.apart) / pace * (last - of->t);
        }
        if (now.apart <= TOGETHER * of->thickness) { /* as from the time before on */
            out->meet_time = t + now.apart / pace * (last - of->t);
            return true;
        }
        before = now.apart;
    }
    return false;
}

weft__closing weft__shapes_closing(const weft__closing_search *of)
{
    weft__closing out = { .found = false };
    for (size_t j = 0; j < of->shape_count * of->shape_count && !out.found; ++j) {
        const size_t a = j % of->shape_count, b = j / of->shape_count;
        sides both = { .shape = { &of->shapes[a], &of->shapes[b] } };
        between now = { .apart = INFINITY };
        double x[3];
        if (a >= b || (!moves(both.shape[0]) && !moves(both.shape[1]))) {
            continue;
        }
        go_to(&both, of->t);
        if (!closing_find_nearest(of, &both, x, &now, &out.particle)) {
            continue;
        }
        const double soon = of->t + SOON * now.apart / now.closing;
        const double last = isfinite(of->t_last) ? of->t_last : soon;
        out.apart = now.apart;
        out.shape[0] = a, out.shape[1] = b;
        out.found = last > of->t && do_meet(of, &both, x, last, &out);
    }
    return out;
}
