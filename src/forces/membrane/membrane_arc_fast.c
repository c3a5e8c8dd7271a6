/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_arc_fast.c -- the arcs of membrane.h, one group after the other, with
 * vectors in space as records x, y, z, 0. */
#include "forces/lanes.h"
#include "forces/membrane/membrane.h"

#include <string.h>

#include "forces/membrane/membrane_law.h"

typedef struct arc_local {
    record x[WEFT__ARC_NEAR], v[WEFT__ARC_NEAR];
    record item[2 * WEFT__ARC_EDGES]; /* h and d; then S h and E d */
    weft__bent bent[WEFT__ARC_EDGES];
    double pull[2 * WEFT__ARC_EDGES]; /* S and E */
} arc_local;

#define DOT(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])

INLINE void membrane_arc_fast_copy(const double *from, size_t n, const uint32_t *near,
                                   size_t count, record *to)
{
    for (size_t j = 0; j < count; ++j) {
        const double *x = from + near[j];
        to[j] = (record){ x[0], x[n], x[2 * n], 0.0 };
    }
}

/* h and d of an edge. */
INLINE void bow(const weft__arc *of, const weft__arc_edge *edge, const record *x,
                record out[2])
{
    const uint16_t *near = of->row + edge[0].row;
    const double *share = of->share + edge[0].row;
    const size_t parts = edge[1].row - edge[0].row;
    const record from = x[parts > 0 ? near[0] : 0];
    record sums[2] = { { 0.0, 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0, 0.0 } };
    size_t j = 0;
    for (; j + 2 <= parts; j += 2) {
        sums[0] += ALL(share[j]) * (x[near[j]] - from);
        sums[1] += ALL(share[j + 1]) * (x[near[j + 1]] - from);
    }
    if (j < parts) {
        sums[0] += ALL(share[j]) * (x[near[j]] - from);
    }
    out[0] = sums[0] + sums[1];
    out[1] = x[edge->end[1]] - x[edge->end[0]];
}

INLINE void bend(const weft__arc *of, const weft__arc_group *group, bool damped,
                 arc_local *in)
{
    for (size_t e = 0; e < group[1].edge - group[0].edge; ++e) {
        const weft__arc_edge *edge = &of->edge[group[0].edge + e];
        record *at = &in->item[2 * e], rate[2];
        bow(of, edge, in->x, at);
        weft__bent *to = &in->bent[e];
        *to = (weft__bent){ .chord = DOT(at[1], at[1]), .arc = DOT(at[0], at[0]) };
        if (damped) {
            bow(of, edge, in->v, rate);
            to->chord_rate = DOT(at[1], rate[1]);
            to->arc_rate = DOT(at[0], rate[0]);
        }
    }
}

INLINE void membrane_arc_fast_pull(const weft__arc_triangle *of, arc_local *in)
{
    double z[3], q[3], s[3];
    for (size_t i = 0; i < 3; ++i) {
        const weft__bent *b = &in->bent[of->edge[i]];
        z[i] = b->arc + of->lag * b->arc_rate;
        q[i] = ((b->chord - of->square[i]) + of->lag * b->chord_rate) + z[i];
    }
    for (size_t k = 0; k < 2; ++k) {
        const double *k6 = of->stiff, *by = k == 0 ? q : z;
        s[0] = (k6[0] * by[0] + k6[3] * by[1]) + k6[4] * by[2];
        s[1] = (k6[3] * by[0] + k6[1] * by[1]) + k6[5] * by[2];
        s[2] = (k6[4] * by[0] + k6[5] * by[1]) + k6[2] * by[2];
        for (size_t i = 0; i < 3; ++i) {
            in->pull[2 * of->edge[i] + k] += s[i];
        }
    }
}

/* Adds to three planes; 0 or NaN. */
INLINE double membrane_arc_fast_add(const weft__membrane *own, weft__unit unit,
                                    const weft__arc_group *group, const record *item,
                                    double *to)
{
    const size_t n = own->mesh->particles;
    double bad = 0.0;
    for (size_t i = group[0].particle; i < group[1].particle; ++i) {
        const double by = unit == WEFT__FORCE ? 1.0 : own->mesh->inverse_mass[i];
        const weft__arc_part *part = own->arc.part + own->arc.begin[i];
        const size_t parts = own->arc.begin[i + 1] - own->arc.begin[i];
        record sums[2] = { { 0.0, 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0, 0.0 } };
        size_t j = 0;
        for (; j + 2 <= parts; j += 2) {
            sums[0] -= ALL(part[j].share) * item[part[j].local];
            sums[1] -= ALL(part[j + 1].share) * item[part[j + 1].local];
        }
        if (j < parts) {
            sums[0] -= ALL(part[j].share) * item[part[j].local];
        }
        const record sum = sums[0] + sums[1];
        for (size_t k = 0; k < 3; ++k) {
            to[k * n + i] += by * sum[k];
            bad += to[k * n + i] * 0.0;
        }
    }
    return bad;
}

int NAME(arc, LEVEL)(const void *own, const weft__state *at, weft__unit unit,
                     double *to, size_t first, size_t end)
{
    const weft__membrane *of = own;
    const weft__arc *arc = &of->arc;
    const size_t n = of->mesh->particles;
    double bad = 0.0;
    arc_local in;
    for (size_t g = arc->block[first]; g < arc->block[end]; ++g) {
        const weft__arc_group *group = &arc->group[g];
        const size_t edges = group[1].edge - group[0].edge;
        const size_t near = group[1].near - group[0].near;
        if (edges == 0) {
            bad += weft__arc_particles(of, at, unit, to, group[0].particle,
                                       group[1].particle);
            continue;
        }
        membrane_arc_fast_copy(at->y, n, arc->near + group->near, near, in.x);
        if (of->damped) {
            membrane_arc_fast_copy(at->y + 3 * n, n, arc->near + group->near, near,
                                   in.v);
        }
        bend(arc, group, of->damped, &in);
        memset(in.pull, 0, 2 * edges * sizeof *in.pull);
        for (size_t j = group[0].triangle; j < group[1].triangle; ++j) {
            membrane_arc_fast_pull(&arc->triangle[j], &in);
        }
        for (size_t j = 0; j < 2 * edges; ++j) {
            const double s = in.pull[j];
            in.item[j] *= (record){ s, s, s, s };
        }
        bad += membrane_arc_fast_add(of, unit, group, in.item, to);
    }
    return bad == 0.0 ? 0 : 1;
}
