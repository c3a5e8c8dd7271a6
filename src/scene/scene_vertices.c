/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_vertices.c -- which vertices of a mesh a pin holds, or a load lies on. */
#include <math.h>
#include <string.h>

#include "cloth/model.h"
#include "scene/checks.h"

#define INSIDE 1e-9 /* [m] within so much of a shape counts as in it */

/* Makes a list of the members; `none` says why there must be one. */
static void put_members(weft__reader *reader, const bool *member, weft__vertices *to)
{
    const size_t all = reader->scene->cloth.mesh->vertices;
    size_t count = 0;
    for (size_t i = 0; i < all; ++i) {
        count += member[i];
    }
    size_t *list = weft__tree_take(reader->tree, count, sizeof *list);
    *to = (weft__vertices){ list, list == NULL ? 0 : count };
    for (size_t i = 0, k = 0; list != NULL && i < all; ++i) {
        if (member[i]) {
            list[k++] = i;
        }
    }
}

/* ---- by number ---------------------------------------------------------------- */

static bool scene_vertices_read_vertex(weft__reader *reader, const weft__node *node,
                                       size_t *out)
{
    const weft__obj *obj = &reader->scene->obj;
    long long number;
    if (!weft__integer_of(node, &number)) {
        weft__refuse(reader, node, "a vertex", "an integer", true, NULL);
        return false;
    }
    if (number < 0 || (unsigned long long)number >= obj->vertices) {
        ERROR_AT(reader, node, "vertex %lld is not there: the mesh has 0 to %zu",
                 number, obj->vertices - 1);
        return false;
    }
    if (obj->vertex_of[number] == WEFT__NONE) {
        ERROR_AT(reader, node, "vertex %lld belongs to no face", number);
        return false;
    }
    *out = obj->vertex_of[number];
    return true;
}

/* Leaves one of several names of a welded vertex, so that a load counts once. */
static size_t drop_names(weft__reader *reader, size_t *list, size_t count)
{
    const size_t all = reader->scene->cloth.mesh->vertices;
    size_t kept = 0;
    bool *listed = weft__report_take(reader->report, all, sizeof *listed);
    for (size_t i = 0; listed != NULL && i < count; ++i) {
        const size_t vertex = list[i];
        if (!listed[vertex]) {
            listed[vertex] = true;
            list[kept++] = vertex;
        }
    }
    weft__free(reader->report->memory, listed);
    return kept;
}

void weft__read_vertices(weft__reader *reader, const weft__key *key,
                         const weft__node *node, void *to)
{
    const size_t count = weft__item_count(node);
    weft__vertices *vertices = to;
    if (node->type != WEFT__LIST || count == 0) {
        weft__refuse_value(reader, key, node);
    } else if (reader->scene->renumbered) {
        ERROR_AT(reader, node,
                 "vertices have other numbers in a finer cut: group, near or "
                 "inside hold there");
        return;
    }
    if (reader->scene->cloth.mesh == NULL || count == 0) {
        return;
    }
    size_t *list = weft__tree_take(reader->tree, count, sizeof *list);
    for (size_t i = 0; list != NULL && i < count; ++i) {
        vertices->count += scene_vertices_read_vertex(reader, weft__item(node, i),
                                                      &list[vertices->count]);
    }
    vertices->list = list;
    if (list != NULL && reader->scene->obj.lowest != NULL) {
        vertices->count = drop_names(reader, list, vertices->count);
    }
}

/* ---- by group ----------------------------------------------------------------- */

void weft__read_group(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    const char *name = weft__text_of(node);
    const weft_mesh_def *mesh = reader->scene->cloth.mesh;
    char near[80];
    if (name == NULL) {
        weft__refuse_value(reader, key, node);
    }
    if (name == NULL || mesh == NULL) {
        return;
    }
    bool *member = weft__report_take(reader->report, mesh->vertices, sizeof *member);
    if (member == NULL) {
        return;
    }
    if (weft__obj_group(&reader->scene->obj, name, member)) {
        put_members(reader, member, to);
    } else {
        ERROR_AT(reader, node, "the mesh has no group '%.60s'%s", name,
                 weft__obj_near(&reader->scene->obj.groups, name, near, sizeof near));
    }
    weft__free(reader->report->memory, member);
}

/* ---- by place ----------------------------------------------------------------- */

/* A point in another unit than m is the usual cause. */
static void warn_of_distance(weft__reader *reader, const weft__node *node,
                             size_t nearest, double away)
{
    const weft_mesh_def *mesh = reader->scene->cloth.mesh;
    const double *x = &mesh->start[3 * nearest];
    const double longest = weft__longest_edge(&reader->scene->cloth, true);
    if (away > longest && longest > 0.0) {
        WARNING_AT(reader, node,
                   "the nearest vertex, %zu at (%.4g, %.4g, %.4g) m, is %.4g m away "
                   "from this point, and the longest edge has %.4g m: the point is in "
                   "metres, as the mesh is after `unit`",
                   mesh->file_index != NULL ? mesh->file_index[nearest] : nearest, x[0],
                   x[1], x[2], away, longest);
    }
}

void weft__read_near(weft__reader *reader, const weft__key *key, const weft__node *node,
                     void *to)
{
    const weft_mesh_def *mesh = reader->scene->cloth.mesh;
    const weft__key vector
        = { .name = key->name, .kind = WEFT__VECTOR, .unit = key->unit };
    double at[3] = { NAN, NAN, NAN }, least = INFINITY;
    size_t *nearest = weft__tree_take(reader->tree, 1, sizeof *nearest);
    weft__read_vector(reader, &vector, node, at);
    if (mesh == NULL || nearest == NULL) {
        return;
    }
    for (size_t i = 0; i < mesh->vertices; ++i) {
        const double *x = &mesh->start[3 * i];
        const double away[] = { x[0] - at[0], x[1] - at[1], x[2] - at[2] };
        const double square = weft__dot(away, away);
        *nearest = square < least ? i : *nearest;
        least = fmin(least, square);
    }
    if (isfinite(least)) {
        warn_of_distance(reader, node, *nearest, sqrt(least));
    }
    *(weft__vertices *)to = (weft__vertices){ nearest, 1 };
}

void weft__read_inside(weft__reader *reader, const weft__key *key,
                       const weft__node *node, void *to)
{
    const weft_mesh_def *mesh = reader->scene->cloth.mesh;
    const size_t before = reader->report->mistakes;
    weft_shape shape;
    weft__read_shape(reader, key, node, &shape);
    if (shape.kind == WEFT_MESH && reader->report->mistakes == before) {
        ERROR_AT(reader, node, "inside needs a shape with an inside, not a mesh");
    }
    if (mesh == NULL || reader->report->mistakes > before) {
        return;
    }
    bool *member = weft__report_take(reader->report, mesh->vertices, sizeof *member);
    if (member == NULL) {
        return;
    }
    const weft__shape made = weft__shape_of(&shape, 0.0);
    const weft__pose pose = weft__pose_of(&made, 0.0);
    weft__vertices *vertices = to;
    for (size_t i = 0; i < mesh->vertices; ++i) {
        member[i] = weft__gap_at(&pose, &mesh->start[3 * i]) <= INSIDE;
    }
    put_members(reader, member, vertices);
    if (vertices->count == 0) {
        ERROR_AT(reader, node, "no vertex of the mesh starts inside this %s",
                 weft_shape_name(shape.kind));
    }
    weft__free(reader->report->memory, member);
}

/* ---- pins and loads ------------------------------------------------------------ */

void weft__check_vertices(weft__reader *reader, const weft__match *match, void *base)
{
    (void)base;
    static const char *const names[] = { "vertices", "group", "near", "inside", NULL },
                             *const at[] = { "at", NULL };
    if (reader->scene->meshed) {
        const bool one = weft__check_exclusive(reader, match, names);
        if (!weft__report_excluded(reader, match, at,
                                   "needs a grid: vertices of a mesh are given by "
                                   "vertices, group, near or inside")
            && !one) {
            ERROR_AT(reader, match->map,
                     "%s lacks 'vertices', 'group', 'near' or 'inside', one of which "
                     "is required",
                     match->title);
        }
    } else if (!weft__report_excluded(reader, match, names,
                                      "needs a mesh of triangles: places of a grid are "
                                      "given by 'at'")
               && weft__lacks(match, "at")) {
        ERROR_AT(reader, match->map, "%s lacks the required key 'at': which particles",
                 match->title);
    }
}
