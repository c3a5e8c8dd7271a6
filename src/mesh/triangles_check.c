/* SPDX-License-Identifier: BSD-3-Clause */
/* triangles_check.c -- the numbers, indices and triangles of a definition, one by one.
 */
#include "mesh/triangles_work.h"

#include "base/finite.h"
#include "base/memory.h"
#include "base/name.h"
#include "base/plane.h"

#define MAX_VERTICES  ((size_t)1 << 31)
#define MAX_TRIANGLES ((size_t)UINT32_MAX / 3)
#define LEAST_HEIGHT  1e-4 /* of the longest edge */

/* ---- numbers --------------------------------------------------------------------- */

static void triangles_check_check_arrays(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    const bool none = def->grids != NULL && def->triangles == 0;
    const bool plane = weft__any_in_plane(def);
    const char *missing = none                                                ? NULL
                          : def->start == NULL                                ? "start"
                          : (plane || def->uv_count > 0) && def->rest == NULL ? "rest"
                          : def->corners == NULL ? "corners"
                          : def->fabrics == NULL ? "fabrics"
                                                 : NULL;
    if (def->vertices < 3 || def->vertices > MAX_VERTICES
        || def->triangles > MAX_TRIANGLES || def->uv_count > UINT32_MAX
        || (!none
            && (def->triangles < 1 || (plane && def->uv_count < 3)
                || def->fabric_count < 1))) {
        weft__mesh_fault(
            at, WEFT__MESH_DEF, 0,
            "a mesh of %zu vertices, %zu places, %zu triangles and %zu fabrics: it "
            "has 3 vertices or more, at most %zu, 3 places, a triangle and a fabric",
            def->vertices, def->uv_count, def->triangles, def->fabric_count,
            MAX_VERTICES);
    } else if (missing != NULL) {
        weft__mesh_fault(at, WEFT__MESH_DEF, 0, "mesh: %s is NULL", missing);
    } else if ((unsigned)def->seams > WEFT_SEAM_HINGE) {
        weft__mesh_fault(at, WEFT__MESH_DEF, 0, "mesh: seams is %d, no weft_seam",
                         (int)def->seams);
    }
}

static bool is_named_before(const weft_mesh_def *def, size_t part)
{
    size_t i = 0;
    while (i < part && strcmp(def->parts[i].name, def->parts[part].name) != 0) {
        ++i;
    }
    return i < part;
}

static void check_parts(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    size_t next = 0;
    if (def->part_count > WEFT_CLOTHS_MAX
        || (def->part_count > 0 && def->parts == NULL)) {
        weft__mesh_fault(at, WEFT__MESH_DEF, 0, "mesh: %zu parts, of at most %d%s",
                         def->part_count, WEFT_CLOTHS_MAX,
                         def->parts == NULL ? "; parts is NULL" : "");
    }
    for (size_t i = 0; !at->failed && i < def->part_count; ++i) {
        const weft_cloth_part *of = &def->parts[i];
        if (!WEFT__IS_CLOTH_NAME(of->name) || is_named_before(def, i)) {
            weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                             "mesh: part %zu: name '%.60s' is not one of its own of "
                             "1 to %d letters, digits, _ and -",
                             i, of->name == NULL ? "" : of->name, WEFT_CLOTH_NAME_MAX);
        } else if (of->first != next || of->count < 3 || of->count > def->vertices) {
            weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                             "mesh: part %zu, %s, has vertices %zu and %zu more: the "
                             "parts have 3 or more each, from %zu on here",
                             i, of->name, of->first, of->count, next);
        } else if (def->grids != NULL && def->grids[i] != NULL
                   && of->count != def->grids[i]->rows * def->grids[i]->cols) {
            weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                             "mesh: part %zu, %s, has %zu vertices, but its grid %zu "
                             "rows of %zu",
                             i, of->name, of->count, def->grids[i]->rows,
                             def->grids[i]->cols);
        } else if (!weft__all_finite(of->velocity, 3)) {
            weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                             "mesh: part %zu, %s: its velocity is not finite", i,
                             of->name);
        }
        next += of->count;
    }
    if (!at->failed && def->part_count > 0 && next != def->vertices) {
        weft__mesh_fault(at, WEFT__MESH_DEF, 0,
                         "mesh: its parts have %zu vertices, not all %zu", next,
                         def->vertices);
    }
}

static void check_positions(weft__work *at)
{
    const weft_mesh_def *def = at->def;
    for (size_t i = 0; i < def->vertices; ++i) {
        if (weft__grid_with(def, i) == NULL
            && !weft__all_finite(&def->start[3 * i], 3)) {
            weft__mesh_fault(
                at, WEFT__MESH_VERTEX, i,
                "vertex %zu starts at [%g, %g, %g] m, not at finite coordinates",
                weft__name_of(at, i), def->start[3 * i], def->start[3 * i + 1],
                def->start[3 * i + 2]);
        }
    }
    for (size_t i = 0; i < def->uv_count; ++i) {
        if (!weft__all_finite(&def->rest[2 * i], 2)) {
            weft__mesh_fault(at, WEFT__MESH_PLACE, i,
                             "place %zu of the rest shape is [%g, %g] m, not finite", i,
                             def->rest[2 * i], def->rest[2 * i + 1]);
        }
    }
}

double weft__twice_area(const weft_mesh_def *def, size_t t, double *longest)
{
    const double *x[3];
    if (weft__rest_in_space(def, weft__vertex_at(def, t, 0)) != NULL) {
        return weft__space_twice_area(def, t, longest);
    }
    /* callers go through them all */
    const size_t soon = weft__soon(t, 32, def->triangles);
    double square = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        x[k] = &def->rest[2 * (size_t)weft__place_at(def, t, k)];
        __builtin_prefetch(def->rest + 2 * (size_t)weft__place_at(def, soon, k));
    }
    for (size_t k = 0; k < 3; ++k) {
        square = fmax(square, weft__squared(x[k], x[(k + 1) % 3]));
    }
    *longest = sqrt(square);
    return weft__plane_turn(x[0], x[1], x[2]);
}

static bool check_indices(weft__work *at, size_t t)
{
    const weft_mesh_def *def = at->def;
    bool good = true;
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t vertex = weft__vertex_at(def, t, k),
                       place = weft__place_at(def, t, k);
        const bool space
            = vertex < def->vertices && weft__rest_in_space(def, vertex) != NULL;
        if (vertex >= def->vertices || (!space && place >= def->uv_count)) {
            weft__mesh_fault(
                at, WEFT__MESH_TRIANGLE, t,
                "triangle %zu has corner %u at place %u, of %zu vertices and %zu "
                "places",
                t, vertex, place, def->vertices, def->uv_count);
            good = false;
        }
    }
    if (def->fabric_of != NULL && def->fabric_of[t] >= def->fabric_count) {
        weft__mesh_fault(at, WEFT__MESH_TRIANGLE, t,
                         "triangle %zu has fabric %u of %zu", t, def->fabric_of[t],
                         def->fabric_count);
    }
    return good;
}

static bool check_triangle(weft__work *at, size_t t)
{
    const uint32_t a = weft__vertex_at(at->def, t, 0),
                   b = weft__vertex_at(at->def, t, 1),
                   c = weft__vertex_at(at->def, t, 2);
    double longest;
    const double area = weft__twice_area(at->def, t, &longest),
                 height = fabs(area) / longest;
    const size_t part = weft__part_at(at->def, a);
    const char *where
        = weft__rest_in_space(at->def, a) != NULL
              ? ", in the start shape, which `rest: start` makes the rest "
                "shape"
              : "";
    at->clockwise[t] = area < 0.0;
    if (part != weft__part_at(at->def, b) || part != weft__part_at(at->def, c)) {
        weft__mesh_fault(at, WEFT__MESH_TRIANGLE, t,
                         "triangle %zu has corners %u, %u, %u of different parts", t, a,
                         b, c);
        return false;
    }
    if (weft__grid_with(at->def, a) != NULL) {
        weft__mesh_fault(at, WEFT__MESH_TRIANGLE, t,
                         "triangle %zu has a corner of part %zu, which is a grid", t,
                         part);
        return false;
    }
    if (a == b || b == c || c == a) {
        weft__mesh_fault(at, WEFT__MESH_TRIANGLE, t,
                         "a triangle with vertex %zu at two corners",
                         weft__name_of(at, a == b ? a : c));
        return false;
    }
    if (longest == 0.0) {
        weft__mesh_fault(
            at, WEFT__MESH_TRIANGLE, t,
            "the triangle of vertices %zu, %zu, %zu is degenerate at rest: its "
            "corners have the same place in the rest shape%s",
            weft__name_of(at, a), weft__name_of(at, b), weft__name_of(at, c), where);
        return false;
    }
    if (!isfinite(area)) {
        weft__mesh_fault(at, WEFT__MESH_TRIANGLE, t,
                         "the triangle of vertices %zu, %zu, %zu is too large at rest "
                         "for a double",
                         weft__name_of(at, a), weft__name_of(at, b),
                         weft__name_of(at, c));
        return false;
    }
    if (!(height >= LEAST_HEIGHT * longest) || !isfinite(1.0 / area)) {
        weft__mesh_fault(
            at, WEFT__MESH_TRIANGLE, t,
            "the triangle of vertices %zu, %zu, %zu is %s at rest: its height is "
            "%.3g m, below %g of its longest edge of %.3g m%s",
            weft__name_of(at, a), weft__name_of(at, b), weft__name_of(at, c),
            area == 0.0 ? "degenerate" : "too thin", height, LEAST_HEIGHT, longest,
            where);
        return false;
    }
    return true;
}

static void check_triangles(weft__work *at)
{
    at->clockwise = weft__work_take(at, at->def->triangles, sizeof *at->clockwise);
    at->bad = weft__work_take(at, at->def->triangles, sizeof *at->bad);
    for (size_t t = 0; !at->no_memory && t < at->def->triangles; ++t) {
        at->bad[t] = !check_indices(at, t) || !check_triangle(at, t);
    }
}

/* Unused vertices have no mass. */
static void check_used(weft__work *at)
{
    uint8_t *used = weft__work_take(at, at->def->vertices, 1);
    for (size_t i = 0; used != NULL && i < 3 * at->def->triangles; ++i) {
        used[at->def->corners[i]] = 1;
    }
    for (size_t i = 0; used != NULL && i < at->def->vertices; ++i) {
        if (!used[i] && weft__grid_with(at->def, i) == NULL) {
            weft__mesh_fault(at, WEFT__MESH_VERTEX, i, "vertex %zu is in no triangle",
                             weft__name_of(at, i));
        }
    }
    weft__free(at->memory, used);
}

void weft__triangles_check(weft__work *at)
{
    triangles_check_check_arrays(at);
    check_parts(at);
    if (!at->failed) {
        weft__rests_check(at);
    }
    if (!at->failed) {
        check_positions(at);
        check_triangles(at);
    }
    if (!at->failed) {
        check_used(at);
        weft__warps_check(at);
    }
}
