/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane_arc_init.c -- the tables of membrane.h. */
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"
#include "base/plane.h"
#include "forces/membrane/membrane.h"

typedef struct arc_maker {
    weft__membrane *own;
    const weft__triangles *of;
    const weft_allocator *memory;
    uint32_t *edge, *triangle, *near; /* 1 + their places in the group; 0: not in it */
    size_t group_room, near_room, edge_room, triangle_room, row_room;
} arc_maker;

/* The parts of each particle: of h in the order of edges, then ends. */
static bool list_parts(arc_maker *by)
{
    weft__arc *arc = &by->own->arc;
    const weft__edge_slopes *rows = &arc->rows;
    const size_t n = by->own->mesh->particles, edges = by->of->edges;
    size_t *begin = weft__zeroed(by->memory, n + 2, sizeof *begin);
    arc->begin = begin;
    arc->part = weft__alloc(by->memory, rows->count + 2 * edges, sizeof *arc->part);
    if (begin == NULL || arc->part == NULL) {
        return false;
    }
    for (size_t j = 0; j < rows->count; ++j) {
        ++begin[rows->particle[j] + 2];
    }
    for (size_t j = 0; j < 2 * edges; ++j) {
        ++begin[by->of->particle[by->of->edge_list[j / 2].place[j % 2]] + 2];
    }
    for (size_t i = 2; i < n + 2; ++i) {
        begin[i] += begin[i - 1];
    }
    for (size_t e = 0; e < edges; ++e) {
        for (size_t j = rows->first[e]; j < rows->first[e + 1]; ++j) {
            arc->part[begin[rows->particle[j] + 1]++]
                = (weft__arc_part){ rows->share[j], (uint32_t)(2 * e), 0 };
        }
    }
    for (size_t j = 0; j < 2 * edges; ++j) {
        const size_t i = by->of->particle[by->of->edge_list[j / 2].place[j % 2]];
        arc->part[begin[i + 1]++]
            = (weft__arc_part){ j % 2 == 0 ? -1.0 : 1.0, (uint32_t)(j | 1), 0 };
    }
    return true;
}

/* ---- groups ---------------------------------------------------------------------- */

/* Room for one more of everything, and for all parts of an edge. */
static bool reserve_edge(arc_maker *by)
{
    weft__arc *arc = &by->own->arc;
    const size_t rows = by->row_room;
    bool made = weft__reserve(by->memory, &arc->edge, &by->edge_room, arc->edges + 2,
                              sizeof *arc->edge)
                && weft__reserve(by->memory, &arc->near, &by->near_room,
                                 arc->nears + 2 + WEFT__CURVE_PARTS, sizeof *arc->near)
                && weft__reserve(by->memory, &arc->row, &by->row_room,
                                 arc->rows_near + WEFT__CURVE_PARTS, sizeof *arc->row);
    if (made && rows != by->row_room) {
        made = weft__resized(by->memory, &arc->share, by->row_room, sizeof *arc->share);
    }
    return made;
}

static uint16_t near_of(arc_maker *by, const weft__arc_group *from, uint32_t particle)
{
    weft__arc *arc = &by->own->arc;
    if (by->near[particle] == 0) {
        arc->near[arc->nears++] = particle;
        by->near[particle] = (uint32_t)(arc->nears - from->near);
    }
    return (uint16_t)(by->near[particle] - 1);
}

static bool take_edge(arc_maker *by, const weft__arc_group *from, uint32_t e)
{
    weft__arc *arc = &by->own->arc;
    const weft__edge_slopes *rows = &arc->rows;
    if (by->edge[e] != 0) {
        return true;
    }
    if (!reserve_edge(by)) {
        return false;
    }
    weft__arc_edge *to = &arc->edge[arc->edges++];
    to->edge = e;
    for (size_t k = 0; k < 2; ++k) {
        to->end[k] = near_of(by, from, by->of->particle[by->of->edge_list[e].place[k]]);
    }
    for (size_t j = rows->first[e]; j < rows->first[e + 1]; ++j) {
        arc->share[arc->rows_near] = rows->share[j];
        arc->row[arc->rows_near++] = near_of(by, from, rows->particle[j]);
    }
    to[1].row = (uint32_t)arc->rows_near;
    by->edge[e] = (uint32_t)(arc->edges - from->edge);
    return true;
}

static bool take_triangle(arc_maker *by, uint32_t t)
{
    weft__arc *arc = &by->own->arc;
    if (t != WEFT__NONE && by->triangle[t] == 0) {
        if (!weft__reserve(by->memory, &arc->triangle, &by->triangle_room,
                           arc->triangles + 1, sizeof *arc->triangle)) {
            return false;
        }
        arc->triangle[arc->triangles++].triangle = t;
        by->triangle[t] = 1;
    }
    return true;
}

static bool take_edges(arc_maker *by, const weft__arc_group *from,
                       weft__arc_triangle *tri)
{
    double c[WEFT__CONSTANTS];
    bool made = true;
    for (size_t k = 0; made && k < 3; ++k) {
        const uint32_t e = by->of->edge[tri->triangle][k];
        made = take_edge(by, from, e);
        tri->edge[k] = (uint16_t)(by->edge[e] - 1);
    }
    weft__membrane_constants(by->of, tri->triangle, c);
    memcpy(tri->stiff, c + WEFT__STIFF, sizeof tri->stiff);
    for (size_t k = 0; k < 3; ++k) {
        tri->square[k] = c[WEFT__SQUARE + k] + weft__arc_bow(by->own, tri->triangle, k);
    }
    tri->lag = c[WEFT__LAG];
    return made;
}

/* The triangles about all edges that particles [first, end) are parts of, their edges,
 * and what these need. */
static bool membrane_arc_init_gather(arc_maker *by, const weft__arc_group *from,
                                     size_t first, size_t end)
{
    weft__arc *arc = &by->own->arc;
    bool made = reserve_edge(by);
    if (made) {
        arc->edge[arc->edges].row = (uint32_t)arc->rows_near;
    }
    for (size_t j = arc->begin[first]; made && j < arc->begin[end]; ++j) {
        const uint32_t *both = by->of->edge_list[arc->part[j].item / 2].triangle;
        made = take_triangle(by, both[0]) && take_triangle(by, both[1]);
    }
    if (made) {
        qsort(arc->triangle + from->triangle, arc->triangles - from->triangle,
              sizeof *arc->triangle, weft__ascending);
    }
    for (size_t j = from->triangle; j < arc->triangles; ++j) {
        by->triangle[arc->triangle[j].triangle] = 0;
        made = made && take_edges(by, from, &arc->triangle[j]);
    }
    for (size_t j = arc->begin[first]; made && j < arc->begin[end]; ++j) {
        weft__arc_part *part = &arc->part[j];
        part->local = 2 * (by->edge[part->item / 2] - 1) + part->item % 2;
    }
    for (size_t e = from->edge; e < arc->edges; ++e) {
        by->edge[arc->edge[e].edge] = 0;
    }
    for (size_t j = from->near; j < arc->nears; ++j) {
        by->near[arc->near[j]] = 0;
    }
    return made;
}

/* A group of the particles from `first` on, at most to `end`, half as many as long as
 * it is too large; returns where the next begins, 0: no memory. */
static size_t membrane_arc_init_add_group(arc_maker *by, size_t first, size_t end)
{
    weft__arc *arc = &by->own->arc;
    const weft__arc_group from = { first, arc->nears, arc->edges, arc->triangles };
    const size_t rows = arc->rows_near;
    if (!weft__reserve(by->memory, &arc->group, &by->group_room, arc->groups + 2,
                       sizeof *arc->group)) {
        return 0;
    }
    arc->group[arc->groups] = from;
    while (membrane_arc_init_gather(by, &from, first, end)) {
        const bool fits = arc->edges - from.edge <= WEFT__ARC_EDGES
                          && arc->nears - from.near <= WEFT__ARC_NEAR;
        if (!fits) {
            arc->nears = from.near, arc->edges = from.edge;
            arc->triangles = from.triangle, arc->rows_near = rows;
        }
        if (fits || end - first == 1) {
            arc->group[++arc->groups]
                = (weft__arc_group){ end, arc->nears, arc->edges, arc->triangles };
            return end;
        }
        end = first + (end - first) / 2;
    }
    return 0;
}

static bool membrane_arc_init_make_groups(arc_maker *by)
{
    weft__arc *arc = &by->own->arc;
    const weft__mesh *mesh = by->own->mesh;
    const size_t blocks = weft__blocks(mesh);
    arc->block = weft__zeroed(by->memory, blocks + 1, sizeof *arc->block);
    bool made = arc->block != NULL;
    for (size_t b = 0; made && b < blocks; ++b) {
        size_t first = weft__block(mesh, b);
        while (made && first < weft__block(mesh, b + 1)) {
            first = membrane_arc_init_add_group(by, first, weft__block(mesh, b + 1));
            made = first != 0;
        }
        arc->block[b + 1] = arc->groups;
    }
    return made;
}

/* ---- the whole ------------------------------------------------------------------- */

static bool membrane_arc_init_weight_sums(arc_maker *by)
{
    weft__arc *arc = &by->own->arc;
    arc->weight_sum = weft__zeroed(by->memory, by->of->edges, sizeof *arc->weight_sum);
    for (size_t e = 0; arc->weight_sum != NULL && e < by->of->edges; ++e) {
        for (size_t j = arc->rows.first[e]; j < arc->rows.first[e + 1]; ++j) {
            arc->weight_sum[e]
                += fabs(arc->rows.share[j]) * by->own->weight[arc->rows.particle[j]];
        }
    }
    return arc->weight_sum != NULL;
}

/* |h|^2 of each edge at rest, where that lies in space. */
static bool measure_bows(weft__membrane *own, const weft_allocator *memory)
{
    const weft__triangles *of = own->mesh->triangles;
    const size_t n = own->mesh->particles;
    double *x = weft__alloc(memory, n, 3 * sizeof *x), h[3];
    own->arc.bow = weft__zeroed(memory, of->edges, sizeof *own->arc.bow);
    const bool made = x != NULL && own->arc.bow != NULL;
    for (size_t j = 0; made && j < 3 * n; ++j) {
        x[j % 3 * n + j / 3] = of->space[j];
    }
    for (size_t e = 0; made && e < of->edges; ++e) {
        if (weft__in_space(of, of->edge_list[e].triangle[0])) {
            weft__arc_row(own, x, e, h);
            own->arc.bow[e] = weft__dot(h, h);
        }
    }
    weft__free(memory, x);
    return made;
}

bool weft__arc_measure(weft__membrane *own, weft__stop *stop,
                       const weft_allocator *memory)
{
    const weft__triangles *of = own->mesh->triangles;
    if (!of->arc) {
        return true;
    }
    bool *held = weft__held_triangles(of, own->mesh->pin, memory);
    const bool made
        = held != NULL
          && weft__edge_slopes_create(&own->arc.rows, of, held, true, stop, memory)
          && (of->in_space == NULL || measure_bows(own, memory));
    weft__free(memory, held);
    return made;
}

bool weft__arc_create(weft__membrane *own, const weft_allocator *memory)
{
    const weft__triangles *of = own->mesh->triangles;
    arc_maker by = { .own = own, .of = of, .memory = memory };
    if (!of->arc) {
        return true;
    }
    by.edge = weft__zeroed(memory, of->edges, sizeof *by.edge);
    by.triangle = weft__zeroed(memory, of->count, sizeof *by.triangle);
    by.near = weft__zeroed(memory, own->mesh->particles, sizeof *by.near);
    const bool made = by.edge != NULL && by.triangle != NULL && by.near != NULL
                      && list_parts(&by) && membrane_arc_init_weight_sums(&by)
                      && membrane_arc_init_make_groups(&by);
    WEFT__FREE_ALL(memory, by.edge, by.triangle, by.near);
    return made;
}

void weft__arc_free(weft__arc *of, const weft_allocator *memory)
{
    weft__edge_slopes_free(&of->rows, memory);
    WEFT__FREE_ALL(memory, of->begin, of->part, of->bow, of->weight_sum, of->block,
                   of->group, of->near, of->edge, of->triangle, of->row, of->share);
}

size_t weft__arc_bytes(const weft__membrane *own)
{
    const weft__arc *of = &own->arc;
    if (of->begin == NULL) {
        return 0;
    }
    return of->rows.count * (sizeof *of->rows.share + sizeof *of->rows.particle)
           + of->begin[own->mesh->particles] * sizeof *of->part
           + own->mesh->particles * sizeof *of->begin
           + own->mesh->triangles->edges
                 * (sizeof *of->weight_sum + sizeof *of->rows.first)
           + (of->bow != NULL ? own->mesh->triangles->edges * sizeof *of->bow : 0)
           + of->nears * sizeof *of->near + of->edges * sizeof *of->edge
           + of->triangles * sizeof *of->triangle
           + of->rows_near * (sizeof *of->row + sizeof *of->share)
           + of->groups * sizeof *of->group;
}
