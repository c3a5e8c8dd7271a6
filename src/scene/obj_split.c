/* SPDX-License-Identifier: BSD-3-Clause */
/* obj_split.c -- a mesh refined: each of its triangles in four, through the middles of
 * its sides, at the start and at rest. Vertices keep their numbers; middles follow. */
#include <stdlib.h>
#include <string.h>

#include "base/plane.h"
#include "scene/obj.h"

/* Numbers the sides of triangles; side i leads from corner i to the next of its
 * triangle. Writes the number of each side, and the two ends of each number to ends. */
static size_t number_sides(const weft__obj *obj, const uint32_t *corner,
                           uint32_t *number, uint32_t (*ends)[2])
{
    const size_t sides = 3 * obj->def.triangles;
    weft__ends *list = weft__report_take(obj->report, sides, sizeof *list);
    size_t count = 0;
    if (list == NULL) {
        return 0;
    }
    for (size_t i = 0; i < sides; ++i) {
        const uint32_t a = corner[i], b = corner[i % 3 == 2 ? i - 2 : i + 1];
        list[i] = weft__ends_of(a, b, (uint32_t)i);
    }
    qsort(list, sides, sizeof *list, weft__compare_ends);
    for (size_t i = 0; i < sides; ++i) {
        if (i == 0 || weft__compare_ends(&list[i], &list[i - 1]) != 0) {
            ends[count][0] = list[i].low;
            ends[count++][1] = list[i].high;
        }
        number[list[i].number] = (uint32_t)count - 1;
    }
    weft__free(obj->report->memory, list);
    return count;
}

/* Appends the middles of `count` sides to an array of `size` numbers a point. */
static void add_middles(double *points, size_t size, size_t before, size_t count,
                        const uint32_t (*ends)[2])
{
    for (size_t i = 0; i < count * size; ++i) {
        const uint32_t *end = ends[i / size];
        points[before * size + i]
            = 0.5
              * (points[end[0] * size + i % size] + points[end[1] * size + i % size]);
    }
}

/* Corners of triangles in four; number: of the middles of their sides, from `before`.
 */
static void split_corners(uint32_t *corner, size_t triangles, const uint32_t *number,
                          size_t before)
{
    for (size_t t = triangles; t-- > 0;) {
        uint32_t c[3], m[3];
        for (size_t k = 0; k < 3; ++k) {
            c[k] = corner[3 * t + k];
            m[k] = (uint32_t)(before + number[3 * t + k]);
        }
        const uint32_t four[] = { c[0], m[0], m[2], m[0], c[1], m[1],
                                  m[2], m[1], c[2], m[0], m[1], m[2] };
        memcpy(&corner[12 * t], four, sizeof four);
    }
}

/* Sides of one level: of vertices and of places. */
typedef struct split {
    size_t vertices, places;  /* new ones */
    uint32_t *vertex, *place; /* of each side */
    uint32_t (*vertex_ends)[2], (*place_ends)[2];
} split;

static bool obj_split_make_room(weft__obj *obj, const split *at)
{
    const weft_allocator *memory = obj->report->memory;
    const size_t n = obj->def.vertices + at->vertices,
                 p = obj->def.uv_count + at->places, t = obj->def.triangles;
    return weft__resized(memory, &obj->start, n, 3 * sizeof *obj->start)
           && weft__resized(memory, &obj->name, n, sizeof *obj->name)
           && weft__resized(memory, &obj->parent, n - obj->coarse, sizeof *obj->parent)
           && (obj->space == NULL
               || weft__resized(memory, &obj->space, n, 3 * sizeof *obj->space))
           && weft__resized(memory, &obj->rest, p, 2 * sizeof *obj->rest)
           && weft__resized(memory, &obj->place_of, p, sizeof *obj->place_of)
           && weft__resized(memory, &obj->corner, t, 12 * sizeof *obj->corner)
           && weft__resized(memory, &obj->corner_place, t,
                            12 * sizeof *obj->corner_place)
           && weft__resized(memory, &obj->face_of, t, 4 * sizeof *obj->face_of);
}

static void apply_split(weft__obj *obj, const split *at)
{
    weft_mesh_def *def = &obj->def;
    const uint32_t(*ends)[2] = (const uint32_t(*)[2])at->vertex_ends;
    add_middles(obj->start, 3, def->vertices, at->vertices, ends);
    if (obj->space != NULL) {
        add_middles(obj->space, 3, def->vertices, at->vertices, ends);
    }
    add_middles(obj->rest, 2, def->uv_count, at->places,
                (const uint32_t(*)[2])at->place_ends);
    memcpy(&obj->parent[def->vertices - obj->coarse], ends,
           at->vertices * sizeof *obj->parent);
    for (size_t i = 0; i < at->vertices; ++i) {
        const size_t v = def->vertices + i;
        obj->name[v] = obj->vertices + v - obj->coarse;
    }
    for (size_t i = 0; i < at->places; ++i) {
        obj->place_of[def->uv_count + i] = obj->place_of[at->place_ends[i][0]];
    }
    split_corners(obj->corner, def->triangles, at->vertex, def->vertices);
    if (!obj->in_space) {
        split_corners(obj->corner_place, def->triangles, at->place, def->uv_count);
    }
    for (size_t t = 4 * def->triangles; t-- > 0;) {
        obj->face_of[t] = obj->face_of[t / 4];
    }
    def->vertices += at->vertices;
    def->uv_count += at->places;
    def->triangles *= 4;
    const bool named = def->file_index != NULL;
    weft__obj_show(obj);
    def->file_index = named ? obj->name : NULL;
}

static void split_once(weft__obj *obj)
{
    weft__report *report = obj->report;
    const size_t sides = 3 * obj->def.triangles;
    split at
        = { .vertex = weft__report_take(report, sides, sizeof *at.vertex),
            .place = weft__report_take(report, sides, sizeof *at.place),
            .vertex_ends = weft__report_take(report, sides, sizeof *at.vertex_ends),
            .place_ends = weft__report_take(report, sides, sizeof *at.place_ends) };
    if (!report->no_memory) {
        at.vertices = number_sides(obj, obj->corner, at.vertex, at.vertex_ends);
        at.places = obj->in_space
                        ? 0
                        : number_sides(obj, obj->corner_place, at.place, at.place_ends);
        report->no_memory = report->no_memory || !obj_split_make_room(obj, &at);
    }
    if (!report->no_memory) {
        apply_split(obj, &at);
    }
    WEFT__FREE_ALL(report->memory, at.vertex, at.place, at.vertex_ends, at.place_ends);
}

bool weft__obj_refine(weft__obj *obj, size_t by)
{
    enum { MOST = 1 << 26 }; /* triangles */
    const size_t triangles = obj->def.triangles;
    if (by > 1 && ((by & (by - 1)) != 0 || by > MOST || triangles > MOST / by / by)) {
        ERROR_AT(obj, obj,
                 "a mesh of %zu triangles is refined by 2, 4, 8, ... to at "
                 "most %d, not by %zu",
                 triangles, MOST, by);
        return false;
    }
    obj->coarse = obj->def.vertices;
    for (; by > 1 && !obj->report->no_memory; by /= 2) {
        split_once(obj);
    }
    return !obj->report->no_memory;
}
