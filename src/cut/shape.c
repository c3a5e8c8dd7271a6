/* SPDX-License-Identifier: BSD-3-Clause */
/* shape.c -- a net's triangles made even: each point moves to the mean of the centroids
 * around it, weighted by area (L. Chen, M. Holst, Comput. Methods Appl. Mech. Engrg.
 * 200, 2011), between flips; where an angle stays small, points at centres of circles
 * or in the middle of a marked edge are added (J. Ruppert, J. Algorithms 18, 1995). */
#include "cut/shape.h"

#include <math.h>
#include <stdlib.h>

enum { ROUNDS = 24, SWEEPS = 40, POLISH = 6 };

#define SMALL 0.5095 /* tan(27 degrees): smaller angles are refined */
/* [sizes] Sizes grow from point to point, so that points end; edges and halves of parts
 * that are shorter are not divided. */
#define GROWTH       1.5
#define LEAST_EDGE   0.25
#define LEAST_HALF   0.12
#define POLISH_BELOW 0.7 /* tan(35 degrees) */

static double squared(const double a[2], const double b[2])
{
    return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

static double twice_area(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double shape_angle(const cut_net *net, const net_triangle *at, unsigned *corner)
{
    const double *x[3];
    unsigned k = 0;
    for (unsigned i = 0; i < 3; ++i) {
        x[i] = net->at[at->corner[i]];
    }
    for (unsigned i = 1; i < 3; ++i) {
        k = squared(x[(i + 1) % 3], x[(i + 2) % 3])
                    < squared(x[(k + 1) % 3], x[(k + 2) % 3])
                ? i
                : k;
    }
    const double *a = x[k], *b = x[(k + 1) % 3], *c = x[(k + 2) % 3];
    *corner = k;
    return twice_area(a, b, c)
           / ((b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]));
}

/* ---- moves --------------------------------------------------------------------- */

/* The mean of the centroids around a point, and the smallest angle there. false: it is
 * on a marked edge, or outside. */
static bool middle_of(const cut_net *net, uint32_t point, double to[2], double *least)
{
    uint32_t t = net->of[point];
    double sum[3] = { 0.0 };
    *least = INFINITY;
    do {
        const net_triangle *at = &net->triangle[t];
        const uint32_t *c = at->corner;
        const unsigned k = c[0] == point ? 0 : c[1] == point ? 1 : 2;
        unsigned corner;
        if (at->outside || at->mark[(k + 1) % 3] != 0) {
            return false;
        }
        const double *x = net->at[c[0]], *y = net->at[c[1]], *z = net->at[c[2]];
        const double area = twice_area(x, y, z);
        sum[0] += area * (x[0] + y[0] + z[0]);
        sum[1] += area * (x[1] + y[1] + z[1]);
        sum[2] += 3.0 * area;
        *least = fmin(*least, shape_angle(net, at, &corner));
        t = at->beside[(k + 1) % 3];
    } while (t != net->of[point]);
    to[0] = sum[0] / sum[2];
    to[1] = sum[1] / sum[2];
    return true;
}

void shape_smooth(cut_net *net)
{
    for (unsigned round = 0; round < ROUNDS; ++round) {
        for (uint32_t i = 0; i < net->points; ++i) {
            double to[2], least;
            if (middle_of(net, i, to, &least)) {
                (void)net_move(net, i, to);
            }
        }
        net_restore(net);
    }
}

/* Moves a point a part of the way, if that makes the smallest angle there larger. */
static void polish(cut_net *net, uint32_t point)
{
    const double before[] = { net->at[point][0], net->at[point][1] };
    double to[2], unused[2], least, now = 0.0;
    if (!middle_of(net, point, to, &least) || least > POLISH_BELOW) {
        return;
    }
    for (double part = 1.0; part > 0.1 && now <= least; part *= 0.5) {
        const double at[] = { before[0] + part * (to[0] - before[0]),
                              before[1] + part * (to[1] - before[1]) };
        now = 0.0;
        if (net_move(net, point, at) && middle_of(net, point, unused, &now)
            && now <= least) {
            (void)net_move(net, point, before);
        }
    }
}

/* ---- further points ------------------------------------------------------------ */

static bool add_part(cut_shape *self, shape_part part)
{
    if (self->parts == self->part_room) {
        const size_t room = self->parts + self->parts / 2 + 64;
        shape_part *more = realloc(self->part, room * sizeof *more);
        if (more == NULL) {
            self->net.no_memory = true;
            return false;
        }
        self->part = more;
        self->part_room = room;
    }
    self->part[self->parts++] = part;
    return true;
}

bool shape_add_part(cut_shape *self, shape_part part)
{
    double *size = self->net.size;
    const double length = sqrt(squared(self->net.at[part.from], self->net.at[part.to]));
    size[part.from] = fmin(size[part.from], length);
    size[part.to] = fmin(size[part.to], length);
    return add_part(self, part);
}

static bool divide_part(cut_shape *self, uint32_t edge)
{
    cut_net *net = &self->net;
    const uint32_t mark = net->triangle[edge / 3].mark[edge % 3];
    const shape_part whole = self->part[mark - 1];
    const double *a = net->at[whole.from], *b = net->at[whole.to];
    const double middle[] = { 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]) };
    const double size = fmin(net->size[whole.from], net->size[whole.to]);
    if (squared(a, b) < 4.0 * LEAST_HALF * LEAST_HALF * size * size) {
        return false;
    }
    const uint32_t point = net_add(net, middle);
    const shape_part behind = { point, whole.to, whole.line, whole.next };
    if (point == NET_NONE || !add_part(self, behind)) {
        return false;
    }
    net->size[point] = fmin(self->spacing, GROWTH * size);
    if (!net_split(net, edge, whole.from, mark, (uint32_t)self->parts)) {
        net_drop(net);
        --self->parts;
        return false;
    }
    self->part[mark - 1].to = point;
    self->part[mark - 1].next = (uint32_t)self->parts - 1;
    return true;
}

static void centre_of(const cut_net *net, const net_triangle *at, double out[2])
{
    const double *a = net->at[at->corner[0]], *b = net->at[at->corner[1]],
                 *c = net->at[at->corner[2]];
    const double d = 2.0 * twice_area(a, b, c), p = squared(a, b), q = squared(a, c);
    out[0] = a[0] + ((c[1] - a[1]) * p - (b[1] - a[1]) * q) / d;
    out[1] = a[1] + ((b[0] - a[0]) * q - (c[0] - a[0]) * p) / d;
}

/* Whether a point was added for a triangle. */
static bool improve(cut_shape *self, uint32_t t)
{
    cut_net *net = &self->net;
    const net_triangle *at = &net->triangle[t];
    unsigned k;
    double centre[2];
    if (at->outside || shape_angle(net, at, &k) >= SMALL) {
        return false;
    }
    const double *a = net->at[at->corner[(k + 1) % 3]],
                 *b = net->at[at->corner[(k + 2) % 3]];
    const double size = fmin(net->size[at->corner[0]],
                             fmin(net->size[at->corner[1]], net->size[at->corner[2]]));
    if ((at->mark[(k + 1) % 3] != 0 && at->mark[(k + 2) % 3] != 0)
        || squared(a, b) < LEAST_EDGE * LEAST_EDGE * size * size) {
        return false;
    }
    centre_of(net, at, centre);
    const uint32_t point = net_add(net, centre);
    const uint32_t edge = point == NET_NONE ? NET_NONE : net_insert(net, t);
    const bool added = point != NET_NONE && net->of[point] != NET_NONE;
    if (added) {
        net->size[point] = fmin(self->spacing, GROWTH * size);
    }
    if (point != NET_NONE && !added) {
        net_drop(net);
    }
    return added || (edge != NET_NONE && divide_part(self, edge));
}

static bool sweep(cut_shape *self)
{
    bool changed = false;
    for (size_t t = 0; t < self->net.triangles && self->net.points < self->most
                       && !self->net.no_memory;
         ++t) {
        changed = improve(self, (uint32_t)t) || changed;
    }
    return changed;
}

void shape_refine(cut_shape *self)
{
    for (unsigned i = 0; i < SWEEPS && sweep(self); ++i) {
    }
    for (unsigned round = 0; round < POLISH; ++round) {
        for (uint32_t i = 0; i < self->net.points; ++i) {
            polish(&self->net, i);
        }
        net_restore(&self->net);
    }
}
