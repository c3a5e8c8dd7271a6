/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_cut.c -- cloth.cut: its keys, and the mesh that the program makes of it as the
 * text of an OBJ file, which is read as any other and kept with the results. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/plane.h"
#include "cloth/model.h"
#include "mesh/grid_def.h"
#include "scene/checks.h"
#include "weft/elementary.h"

/* [vertices] Larger cuts are refused. */
#define MOST_VERTICES (4.0 * 1024 * 1024)
/* [spacings] A longer side is refused: places are compared on a grid of integers. */
#define MOST_ACROSS 8192.0
#define MOST_POINTS 100000 /* of all paths: each is compared with many others */
#define LEAST_ANGLE 25.0   /* [degrees] smaller ones are warned of */

/* ---- keys ---------------------------------------------------------------------- */

static void read_path(weft__reader *reader, const weft__key *key,
                      const weft__node *node, weft__cut_path *path)
{
    const bool line = strncmp(key->name, "line", 4) == 0;
    path->node = node;
    path->closed = !line || node->type == WEFT__MAP;
    if (node->type == WEFT__MAP) {
        weft__read_section(reader, key->section, key->name, node, path);
    } else if (weft__item_count(node) < (line ? 2 : 3)) {
        char wanted[80];
        (void)snprintf(wanted, sizeof wanted,
                       "a list of %d or more points [u, v] [m], or {disc: radius}",
                       line ? 2 : 3);
        weft__refuse(reader, node, key->name, wanted, false, NULL);
    } else {
        path->points
            = (void *)weft__read_table(reader, key, node, 2, "a point [u, v] [m]");
        path->count = path->points != NULL ? node->count : 0;
    }
}

void weft__read_paths(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    weft__cut_paths *paths = to;
    const bool one = key->kind == WEFT__PATH;
    if (!one && node->type != WEFT__LIST) {
        weft__refuse_value(reader, key, node);
        return;
    }
    const size_t count = one ? 1 : node->count;
    paths->list = weft__tree_take(reader->tree, count, sizeof *paths->list);
    paths->count = paths->list == NULL ? 0 : count;
    for (size_t i = 0; i < paths->count; ++i) {
        char name[64];
        weft__key item = *key;
        (void)snprintf(name, sizeof name, "%s[%zu]", key->name, i);
        item.name = one ? key->name : name;
        read_path(reader, &item, one ? node : weft__item(node, i), &paths->list[i]);
    }
}

/* ---- paths --------------------------------------------------------------------- */

/* Points on a circle, as far from each other as the spacing. */
static void take_disc(weft__reader *reader, double spacing, weft__cut_path *path)
{
    const double around = 6.283185307179586 * path->radius / spacing;
    const double count = fmax(8.0, rint(around));
    if (!(around >= 0.1 && around < MOST_POINTS)) {
        ERROR_AT(reader, path->node,
                 "a disc of %g m is %.3g spacings around, of 0.1 to %d", path->radius,
                 around, MOST_POINTS);
        return;
    }
    path->points = weft__tree_take(reader->tree, (size_t)count, sizeof *path->points);
    path->count = path->points == NULL ? 0 : (size_t)count;
    for (size_t i = 0; i < path->count; ++i) {
        double sine, cosine;
        weft_sincos_turns((double)i / count, 1.0, &sine, &cosine);
        path->points[i][0] = path->centre[0] + path->radius * cosine;
        path->points[i][1] = path->centre[1] + path->radius * sine;
    }
}

/* [m^2] of a closed path, > 0 if it runs counterclockwise. */
static double area_of(const weft__cut_path *path)
{
    double sum = 0.0;
    for (size_t i = 1; i + 1 < path->count; ++i) {
        sum += 0.5
               * weft__plane_turn(path->points[0], path->points[i],
                                  path->points[i + 1]);
    }
    return sum;
}

static void turn_path(weft__cut_path *path)
{
    path->reversed = path->closed && area_of(path) < 0.0;
    for (size_t i = 1, j = path->count - 1; path->reversed && i < j; ++i, --j) {
        for (size_t k = 0; k < 2; ++k) {
            const double x = path->points[i][k];
            path->points[i][k] = path->points[j][k];
            path->points[j][k] = x;
        }
    }
}

/* Points of all paths in order; false: one is wrong, or there are too many. */
static bool take_paths(weft__reader *reader, weft__cut *cut)
{
    const size_t before = reader->report->mistakes;
    const weft__cut_paths *const all[] = { &cut->outline, &cut->holes, &cut->lines };
    size_t count = 0;
    for (size_t k = 0; k < 3; ++k) {
        for (size_t i = 0; i < all[k]->count; ++i) {
            weft__cut_path *path = &all[k]->list[i];
            if (path->radius > 0.0) {
                take_disc(reader, cut->grid.spacing[0], path);
            }
            if (path->count > 0) {
                turn_path(path);
            }
            count += path->count;
        }
    }
    if (count > MOST_POINTS) {
        ERROR_AT(reader, cut->outline.list[0].node,
                 "a cut has at most %d points, not %zu", MOST_POINTS, count);
    }
    return reader->report->mistakes == before && !reader->report->no_memory;
}

/* Whether the spacing suits the size of the piece. */
static bool check_spacing(weft__reader *reader, const weft__node *at,
                          const weft__cut *cut)
{
    const weft__cut_path *outline = cut->outline.list;
    const double h = cut->grid.spacing[0];
    double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
    for (size_t i = 0; i < 2 * outline->count; ++i) {
        low[i % 2] = fmin(low[i % 2], outline->points[i / 2][i % 2]);
        high[i % 2] = fmax(high[i % 2], outline->points[i / 2][i % 2]);
    }
    const double u = high[0] - low[0], v = high[1] - low[1];
    double area = area_of(outline);
    for (size_t i = 0; i < cut->holes.count; ++i) {
        area -= area_of(&cut->holes.list[i]);
    }
    const double vertices = area / (0.866 * h * h);
    const bool good
        = h <= fmin(u, v) && fmax(u, v) <= MOST_ACROSS * h && vertices <= MOST_VERTICES;
    if (!(h <= fmin(u, v))) {
        ERROR_AT(reader, at, "spacing %g m is larger than the piece of %g x %g m", h, u,
                 v);
    } else if (!good) {
        ERROR_AT(reader, at,
                 "spacing %g m makes some %.3g vertices of the piece of %g x "
                 "%g m; a cut has at most %g, and %g spacings across",
                 h, fmax(vertices, 1.0), u, v, MOST_VERTICES, MOST_ACROSS);
    }
    return good;
}

/* ---- the text ------------------------------------------------------------------ */

/* Room for a line of each kind with its longest numbers. */
enum { VERTEX_BYTES = 140, TRIANGLE_BYTES = 72, POINT_BYTES = 16, NAME_BYTES = 64 };

typedef struct writer {
    char *text;
    size_t length;
} writer;

WEFT_PRINTF(2, 3) static void put(writer *to, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    to->length
        += (size_t)vsnprintf(to->text + to->length, VERTEX_BYTES, format, values);
    va_end(values);
}

static void put_vertices(writer *to, const weft__cut *cut, const weft_cut_mesh *mesh)
{
    const weft_cloth_def *grid = &cut->grid;
    const double right = weft__length(grid->right), down = weft__length(grid->down);
    for (size_t i = 0; i < mesh->vertices; ++i) {
        const double *place = &mesh->uv[2 * i];
        double x[3];
        for (size_t k = 0; k < 3; ++k) {
            x[k] = grid->origin[k]
                   + grid->scale
                         * (place[0] * (grid->right[k] / right)
                            - place[1] * (grid->down[k] / down));
        }
        put(to, "v %.17g %.17g %.17g\n", x[0], x[1], x[2]);
    }
    for (size_t i = 0; i < mesh->vertices; ++i) {
        put(to, "vt %.17g %.17g\n", mesh->uv[2 * i], mesh->uv[2 * i + 1]);
    }
}

/* The points of each path as a group. Whether every path has some. */
static void put_groups(writer *to, weft__reader *reader, const weft__cut *cut,
                       const weft__cut_lines *lines, const weft_cut_mesh *mesh)
{
    const size_t paths = 1 + cut->holes.count + cut->lines.count;
    size_t e = 0;
    for (size_t p = 0; p < paths; ++p) {
        const size_t line = p - 1 - cut->holes.count, first = e;
        if (p == 0) {
            put(to, "g outline\n");
        } else if (p <= cut->holes.count) {
            put(to, "g hole%zu\n", p - 1);
        } else {
            put(to, "g line%zu\n", line);
        }
        for (; e < mesh->edges && lines->path[mesh->edge[3 * e + 2]] == p; ++e) {
            put(to, "p %" PRIu32 " %" PRIu32 "\n", mesh->edge[3 * e] + 1,
                mesh->edge[3 * e + 1] + 1);
        }
        if (e == first && p > cut->holes.count) {
            ERROR_AT(reader, cut->lines.list[line].node,
                     "this line has no part of its own inside the piece");
        }
    }
}

static bool write_text(weft__reader *reader, const weft__cut *cut,
                       const weft__cut_lines *lines, const weft_cut_mesh *mesh)
{
    weft__obj *obj = &reader->scene->obj;
    const size_t groups = 1 + cut->holes.count + cut->lines.count;
    const size_t most = mesh->vertices * VERTEX_BYTES + mesh->triangles * TRIANGLE_BYTES
                        + 2 * mesh->edges * POINT_BYTES + groups * NAME_BYTES
                        + VERTEX_BYTES;
    writer to = { .text = weft__report_take(reader->report, most, 1) };
    if (to.text == NULL) {
        return false;
    }
    put_vertices(&to, cut, mesh);
    put(&to, "usemtl cloth\n");
    for (size_t t = 0; t < mesh->triangles; ++t) {
        const uint32_t *c = &mesh->corners[3 * t], a = c[0] + 1, b = c[1] + 1,
                       d = c[2] + 1;
        put(&to,
            "f %" PRIu32 "/%" PRIu32 " %" PRIu32 "/%" PRIu32 " %" PRIu32 "/%" PRIu32
            "\n",
            a, a, b, b, d, d);
    }
    put_groups(&to, reader, cut, lines, mesh);
    obj->file.text = to.text;
    obj->file.length = to.length;
    obj->kept = true;
    (void)weft__resized(reader->report->memory, &obj->file.text, to.length + 1, 1);
    return true;
}

/* ---- the mesh ------------------------------------------------------------------ */

static void warn_of_angle(weft__reader *reader, const weft__node *at,
                          const weft_cut_mesh *mesh)
{
    if (mesh->least_angle < LEAST_ANGLE) {
        WARNING_AT(reader, at,
                   "the mesh has an angle of %.1f degrees at [%.4g, %.4g] m, "
                   "below %g",
                   mesh->least_angle, mesh->least_at[0], mesh->least_at[1],
                   LEAST_ANGLE);
    }
}

static bool make_mesh(weft__reader *reader, const weft__match *match,
                      const weft__cut *cut, const weft__cut_lines *lines)
{
    const weft_allocator *memory = reader->report->memory;
    const weft_scene_def *def = reader->def;
    weft_cut_mesh mesh = { .vertices = 0 };
    weft_error err;
    if (def->mesh_cut == NULL) {
        ERROR_AT(reader, match->map,
                 "cut needs the mesher of the program weft, built with Qhull: "
                 "'weft export SCENE --garment FILE.obj' writes a file for "
                 "cloth.mesh");
        return false;
    }
    const weft_cut given
        = { lines->points,       lines->point_count,   lines->lines, lines->line_count,
            lines->border_count, cut->grid.spacing[0], cut->seed,    memory };
    const weft_status status = def->mesh_cut(def->mesh_ctx, &given, &mesh, &err);
    reader->report->no_memory = reader->report->no_memory || status == WEFT_NO_MEMORY;
    if (status == WEFT_OK) {
        warn_of_angle(reader, weft__value_in(match, "spacing"), &mesh);
    } else if (status != WEFT_NO_MEMORY) {
        ERROR_AT(reader, match->map, "%s", err.message);
    }
    const bool written = status == WEFT_OK && write_text(reader, cut, lines, &mesh);
    WEFT__FREE_ALL(memory, mesh.uv, mesh.corners, mesh.edge);
    return written;
}

void weft__check_cut(weft__reader *reader, const weft__match *match, void *base)
{
    weft__cut *cut = base;
    weft_scene *scene = reader->scene;
    const size_t before = reader->report->mistakes;
    scene->meshed = true;
    char *path = weft__mesh_path(reader, NULL, NULL);
    const size_t finer = reader->def->refine > 1 ? reader->def->refine : 1;
    scene->renumbered = finer > 1 && path == NULL;
    cut->grid.rows = cut->grid.cols = 2;
    cut->grid.spacing[0] /= scene->renumbered ? (double)finer : 1.0;
    cut->grid.spacing[1] = cut->grid.spacing[0];
    if (match->wrong || weft__value_in(match, "outline") == NULL
        || weft__value_in(match, "spacing") == NULL) {
        return;
    }
    (void)weft__grid_check(&cut->grid, 0, &match->faults);
    weft__cut_lines lines;
    if (!take_paths(reader, cut) || !weft__cut_lines_of(reader, cut, &lines)
        || !check_spacing(reader, weft__value_in(match, "spacing"), cut)) {
        return;
    }
    scene->obj = (weft__obj){ .report = reader->report,
                              .at = match->map->at,
                              .file.path = path == NULL ? "cut" : path };
    const bool read = path != NULL ? weft__obj_load(&scene->obj, path)
                                         && weft__obj_refine(&scene->obj, finer)
                                   : make_mesh(reader, match, cut, &lines)
                                         && weft__obj_read(&scene->obj);
    if (read && reader->report->mistakes == before) {
        scene->cloth.mesh = &scene->obj.def;
        scene->mesh_path = path;
    }
}
