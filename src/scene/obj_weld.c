/* SPDX-License-Identifier: BSD-3-Clause */
/* obj_weld.c -- makes one of vertices that start near each other: the lowest of them.
 *
 * Two vertices in one cell of the space are near, and cells of which two vertices may
 * be near lie in 25 rows. Each row is followed beside the sorted cells, so that the
 * time is linear after the sort, however many vertices a cell has. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "scene/obj.h"

/* A file has rounded numbers: those at the bound are near. */
#define SLACK (1.0 + 1e-9)

/* A vertex by its cell, or by its place. */
typedef struct weld_spot {
    double at[3];
    uint32_t vertex;
} weld_spot;

typedef struct welder {
    weft__obj *obj;
    weld_spot *spot; /* sorted */
    uint32_t *first; /* spot of each cell, and the end */
    size_t cells;
} welder;

static int compare_at(const double a[3], const double b[3])
{
    for (size_t k = 0; k < 3; ++k) {
        if (a[k] != b[k]) {
            return a[k] < b[k] ? -1 : 1;
        }
    }
    return 0;
}

static int by_cell(const void *a, const void *b)
{
    const weld_spot *x = a, *y = b;
    const int order = compare_at(x->at, y->at);
    return order != 0 ? order : (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static uint32_t weld_root(uint32_t *lowest, uint32_t v)
{
    while (lowest[v] != v) {
        v = lowest[v] = lowest[lowest[v]];
    }
    return v;
}

static void unite(uint32_t *lowest, uint32_t a, uint32_t b)
{
    a = weld_root(lowest, a), b = weld_root(lowest, b);
    lowest[a > b ? a : b] = a < b ? a : b;
}

static bool is_within_weld(const weft__obj *obj, uint32_t a, uint32_t b)
{
    const double *x = obj->vertex[a], *y = obj->vertex[b];
    const double d[] = { x[0] - y[0], x[1] - y[1], x[2] - y[2] };
    return weft__length(d) <= SLACK * obj->weld;
}

/* The corner of all vertices, and the side of a cell: 0 if `weld` is below what their
 * coordinates resolve, where those that coincide are near. */
static double cell_side(const weft__obj *obj, double low[3])
{
    double extent = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        double high = -(double)INFINITY;
        low[k] = (double)INFINITY;
        for (size_t v = 0; v < obj->vertices; ++v) {
            low[k] = fmin(low[k], obj->vertex[v][k]);
            high = fmax(high, obj->vertex[v][k]);
        }
        extent = fmax(extent, high - low[k]);
    }
    return obj->weld > 1e-12 * extent ? obj->weld / sqrt(3.0) : 0.0;
}

static void list_cells(welder *self)
{
    weft__obj *obj = self->obj;
    double low[3];
    const double side = cell_side(obj, low);
    for (size_t v = 0; v < obj->vertices; ++v) {
        for (size_t k = 0; k < 3; ++k) {
            const double x = obj->vertex[v][k];
            self->spot[v].at[k] = side > 0.0 ? floor((x - low[k]) / side) : x;
        }
        self->spot[v].vertex = (uint32_t)v;
    }
    qsort(self->spot, obj->vertices, sizeof *self->spot, by_cell);
    for (size_t i = 0; i < obj->vertices; ++i) {
        if (i == 0 || compare_at(self->spot[i].at, self->spot[i - 1].at) != 0) {
            self->first[self->cells++] = (uint32_t)i;
        } else {
            unite(obj->lowest, self->spot[i].vertex, self->spot[i - 1].vertex);
        }
    }
    self->first[self->cells] = (uint32_t)obj->vertices;
    self->cells = side > 0.0 ? self->cells : 0;
}

/* Two cells become one set if a vertex of one is near a vertex of the other. */
static void join_cells(welder *self, size_t a, size_t b)
{
    const weld_spot *spot = self->spot;
    uint32_t *lowest = self->obj->lowest;
    const uint32_t one = spot[self->first[a]].vertex,
                   other = spot[self->first[b]].vertex;
    if (weld_root(lowest, one) == weld_root(lowest, other)) {
        return;
    }
    for (size_t i = self->first[a]; i < self->first[a + 1]; ++i) {
        for (size_t j = self->first[b]; j < self->first[b + 1]; ++j) {
            if (is_within_weld(self->obj, spot[i].vertex, spot[j].vertex)) {
                unite(lowest, one, other);
                return;
            }
        }
    }
}

/* Joins each cell with those that lie x and y cells beside it, and from `from` to 2 in
 * the third direction. */
static void join_row(welder *self, double x, double y, double from)
{
    for (size_t c = 0, next = 0; c < self->cells; ++c) {
        const double *at = self->spot[self->first[c]].at;
        const double low[] = { at[0] + x, at[1] + y, at[2] + from };
        const double high[] = { low[0], low[1], at[2] + 2.0 };
        while (next < self->cells
               && compare_at(self->spot[self->first[next]].at, low) < 0) {
            ++next;
        }
        for (size_t d = next;
             d < self->cells && compare_at(self->spot[self->first[d]].at, high) <= 0;
             ++d) {
            join_cells(self, c, d);
        }
    }
}

/* Gives a face the vertices that are left. false: two of its corners are one. */
static bool rename_face(weft__obj *obj, weft__obj_face *face)
{
    const weft__obj_face before = *face;
    for (size_t k = 0; k < 4 && face->vertex[k] != WEFT__NONE; ++k) {
        face->vertex[k] = obj->lowest[face->vertex[k]];
        for (size_t i = 0; i < k; ++i) {
            if (face->vertex[i] == face->vertex[k]) {
                weft__report_error(
                    obj->report, weft__obj_mark(obj, face->byte),
                    "'weld' makes one vertex of corners %" PRIu32 " and %" PRIu32
                    " (from 0) of this face: a smaller weld keeps them apart",
                    before.vertex[i], before.vertex[k]);
                return false;
            }
        }
    }
    return true;
}

bool weft__obj_weld(weft__obj *obj)
{
    const size_t n = obj->vertices;
    welder self = { .obj = obj };
    bool good = true;
    obj->lowest = weft__report_take(obj->report, n, sizeof *obj->lowest);
    self.spot = weft__report_take(obj->report, n, sizeof *self.spot);
    self.first = weft__report_take(obj->report, n + 1, sizeof *self.first);
    for (size_t v = 0; !obj->report->no_memory && v < n; ++v) {
        obj->lowest[v] = (uint32_t)v;
    }
    if (!obj->report->no_memory) {
        list_cells(&self);
        join_row(&self, 0.0, 0.0, 1.0);
        for (int x = 0; x <= 2; ++x) {
            for (int y = x > 0 ? -2 : 1; y <= 2; ++y) {
                join_row(&self, (double)x, (double)y, -2.0);
            }
        }
    }
    WEFT__FREE_ALL(obj->report->memory, self.spot, self.first);
    for (size_t v = 0; !obj->report->no_memory && v < n; ++v) {
        obj->lowest[v] = obj->lowest[obj->lowest[v]]; /* which is lower, and final */
        obj->welded += obj->lowest[v] != v;
    }
    for (size_t f = 0; !obj->report->no_memory && f < obj->faces; ++f) {
        good = rename_face(obj, &obj->face[f]) && good;
    }
    for (size_t p = 0; !obj->report->no_memory && p < obj->points; ++p) {
        obj->point[p].vertex = obj->lowest[obj->point[p].vertex];
    }
    return good && !obj->report->no_memory;
}
