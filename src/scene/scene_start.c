/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_start.c -- warnings about where a cloth starts: it is stretched, its size is
 * that of another unit, vertices are written twice, triangles are slivers. */
#include <math.h>
#include <stdlib.h>

#include "base/plane.h"
#include "mesh/grid_def.h"
#include "mesh/triangles_work.h"
#include "scene/checks.h"

/* Where a cloth may start against its rest shape. Right files lie between 0.90
 * and 1.21, texture coordinates and other units at most at 0.31 or at least at 1.34. */
#define LEAST_STRETCH 0.8
#define MOST_STRETCH  1.25
#define LARGEST       20.0  /* [m] cloths beyond are likely in another unit */
#define SMALLEST      0.002 /* [m] */
#define SLIVER        15.0  /* [degrees] */

/* ---- stretch ------------------------------------------------------------------- */

/* Whether every vt of the file lies in 0 .. 1, as texture coordinates do. */
static bool has_textures(const weft__obj *obj)
{
    bool inside = obj->place != NULL && obj->places > 0;
    for (size_t i = 0; i < 2 * obj->def.uv_count && inside; ++i) {
        const double x = obj->place[obj->place_of[i / 2]][i % 2];
        inside = x >= -1e-3 && x <= 1.001;
    }
    return inside;
}

/* Whether a ratio is that of two units of length in use: then vt are no textures. */
static bool is_of_units(double ratio)
{
    static const double units[] = { 0.1, 0.01, 0.001, 0.0254, 0.254, 0.3048 };
    bool found = false;
    for (size_t i = 0; i < sizeof units / sizeof *units; ++i) {
        found = found || fabs(ratio - units[i]) < 0.01 * units[i]
                || fabs(ratio * units[i] - 1.0) < 0.01;
    }
    return found;
}

static void warn_of_scale(weft__reader *reader, const weft__node *at,
                          const weft_stretch *of)
{
    if (at != NULL) {
        WARNING_AT(
            reader, at,
            "the cloth starts at %g times its rest lengths: scale: 1.0 starts it "
            "at rest; another unit belongs in spacing%s",
            of->median, reader->scene->meshed ? " and outline" : "");
    }
}

static void warn_of_stretch(weft__reader *reader, weft__mark at, const weft_stretch *of)
{
    const weft__obj *obj = &reader->scene->obj;
    const bool alike = of->least > 0.75 * of->median && of->largest < 1.33 * of->median;
    char factor[64] = "";
    if (alike) {
        (void)snprintf(factor, sizeof factor, ", here each times %.4g", of->median);
    }
    weft__report_warning(reader->report, at,
                         "the cloth starts at %.3g times its rest shape (sqrt of the "
                         "areas, median of %zu "
                         "triangles); %s: write vt as lengths in the unit of v%s",
                         of->median, of->triangles,
                         has_textures(obj) && !is_of_units(of->median)
                             ? "vt from 0 to 1 are likely texture "
                               "coordinates, which weft takes for lengths"
                             : "v and vt are likely in different units",
                         factor);
}

/* ---- size ---------------------------------------------------------------------- */

/* [m] The sides of a box around places. */
static void box_of(const double *places, size_t count, double side[3])
{
    for (size_t k = 0; k < 3; ++k) {
        double low = (double)INFINITY, high = -(double)INFINITY;
        for (size_t i = 0; i < count; ++i) {
            low = fmin(low, places[3 * i + k]);
            high = fmax(high, places[3 * i + k]);
        }
        side[k] = high - low;
    }
}

/* The unit of those in use in which the size of a thing is likelier; 0: none. */
static double likely_unit(double size, double unit)
{
    static const double units[] = { 1.0, 0.01, 0.001, 0.0254 };
    for (size_t i = 0; i < sizeof units / sizeof *units; ++i) {
        const double then = size / unit * units[i];
        if (then >= 0.05 && then <= 5.0) {
            return units[i];
        }
    }
    return 0.0;
}

void weft__warn_of_size(weft__reader *reader, weft__mark at, const char *what,
                        double size, double unit)
{
    const double other = likely_unit(size, unit);
    char advice[64] = "";
    if (size <= LARGEST && size >= SMALLEST) {
        return;
    }
    if (other > 0.0) {
        (void)snprintf(advice, sizeof advice, "; with unit: %g %s would have %.3g m",
                       other, what, size / unit * other);
    }
    weft__report_warning(
        reader->report, at,
        "%s has a size of %.4g m: unit is the length of one unit of the "
        "file [m], %g now%s",
        what, size, unit, advice);
}

void weft__warn_of_body_size(weft__reader *reader, weft__mark at, const weft_body *body,
                             double unit)
{
    double side[3];
    box_of(body->positions, body->vertices, side);
    const double least = fmin(side[0], fmin(side[1], side[2]));
    const double most = fmax(side[0], fmax(side[1], side[2]));
    /* a floor may be large */
    weft__warn_of_size(reader, at, "the body",
                       least > LARGEST ? most : fmin(most, LARGEST), unit);
}

static void warn_of_lengths(weft__reader *reader, const weft__node *at, double size)
{
    if (at != NULL && !(size <= LARGEST && size >= SMALLEST)) {
        WARNING_AT(reader, at, "the cloth has a size of %.4g m: lengths are in metres",
                   size);
    }
}

/* ---- vertices and triangles of a file ------------------------------------------ */

typedef struct spot {
    double x[3];
    uint32_t vertex;
} spot;

static int compare_places(const spot *a, const spot *b)
{
    for (size_t k = 0; k < 3; ++k) {
        if (a->x[k] != b->x[k]) {
            return a->x[k] < b->x[k] ? -1 : 1;
        }
    }
    return 0;
}

static int by_place(const void *a, const void *b)
{
    const spot *x = a, *y = b;
    const int order = compare_places(x, y);
    return order != 0 ? order : (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

/* Vertices that start exactly where another does, as at seams that a program divided.
 */
static void warn_of_duplicates(weft__obj *obj)
{
    const size_t count = obj->coarse > 0 ? obj->coarse : obj->def.vertices;
    spot *spots = weft__report_take(obj->report, count, sizeof *spots);
    size_t duplicates = 0, first[2] = { 0 };
    if (spots == NULL) {
        return;
    }
    for (size_t i = 0; i < count; ++i) {
        const double *x = &obj->start[3 * i];
        spots[i] = (spot){ { x[0], x[1], x[2] }, (uint32_t)i };
    }
    qsort(spots, count, sizeof *spots, by_place);
    for (size_t i = 1, run = 0; i < count; ++i) { /* run: the first of one place */
        if (compare_places(&spots[i], &spots[run]) != 0) {
            run = i;
        } else if (duplicates++ == 0 || spots[i].vertex < first[0]) {
            first[0] = spots[i].vertex, first[1] = spots[run].vertex;
        }
    }
    weft__free(obj->report->memory, spots);
    if (duplicates > 0) {
        char more[64] = "";
        if (duplicates > 1) {
            (void)snprintf(more, sizeof more, ", the first of %zu such vertices",
                           duplicates);
        }
        weft__report_warning(
            obj->report, weft__obj_mark(obj, obj->vertex_byte[obj->name[first[0]]]),
            "vertex %zu (from 0) starts where vertex %zu does and is not sewn to it%s: "
            "'weld: 0' makes one of vertices that coincide",
            obj->name[first[0]], obj->name[first[1]], more);
    }
}

/* [degrees] at corner k of a triangle at rest. */
static double scene_start_angle_of(double corner[3][2], size_t k)
{
    const double *x[] = { corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3] };
    const double u[] = { x[1][0] - x[0][0], x[1][1] - x[0][1] };
    const double v[] = { x[2][0] - x[0][0], x[2][1] - x[0][1] };
    return 57.29577951308232
           * atan2(fabs(u[0] * v[1] - u[1] * v[0]), u[0] * v[0] + u[1] * v[1]);
}

static void warn_of_slivers(weft__obj *obj)
{
    const weft_mesh_def *def = &obj->def;
    size_t slivers = 0, first = 0;
    double least = 180.0;
    for (size_t t = 0; t < def->triangles; ++t) {
        double angle = 180.0, corner[3][2];
        weft__def_corners(def, t, corner);
        for (size_t k = 0; k < 3; ++k) {
            angle = fmin(angle, scene_start_angle_of(corner, k));
        }
        slivers += angle < SLIVER;
        if (angle < least) {
            least = angle, first = t;
        }
    }
    if (slivers > 0) {
        weft__report_warning(
            obj->report, weft__obj_mark(obj, obj->face[obj->face_of[first]].byte),
            "an angle of %.2g degrees at rest; %zu of %zu triangles have one below %g: "
            "such slivers make steps short",
            least, slivers, def->triangles, SLIVER);
    }
}

/* ---- cloths -------------------------------------------------------------------- */

/* false: there is no memory. */
static bool stretch_of(weft__reader *reader, weft_stretch *out)
{
    weft_cloth_def def = reader->scene->cloth;
    def.allocator = reader->report->memory;
    const bool made = weft_cloth_def_stretch(&def, 0, out, NULL) == WEFT_OK;
    reader->report->no_memory = reader->report->no_memory || !made;
    return made;
}

static bool is_far(const weft_stretch *of)
{
    return !(of->median >= LEAST_STRETCH && of->median <= MOST_STRETCH);
}

/* The first of the fabrics whose directions differ; NULL: all are alike in all. */
static const weft_fabric *orthotropic(const weft_mesh_def *def)
{
    const weft_fabric *found = NULL;
    for (size_t i = 0; found == NULL && i < def->fabric_count; ++i) {
        const weft_fabric *of = &def->fabrics[i];
        const double twist
            = of->twist < 0.0 ? sqrt(of->bend[0] * of->bend[1]) : of->twist;
        const double side = of->stretch[0] - of->coupling - 2.0 * of->shear;
        const bool alike = of->stretch[0] == of->stretch[1]
                           && fabs(side) <= 1e-9 * of->stretch[0]
                           && of->bend[0] == of->bend[1]
                           && fabs(of->bend[0] - twist) <= 1e-9 * of->bend[0];
        found = alike ? NULL : of;
    }
    return found;
}

/* Of the mean over all directions of the parts 11, 22, 12, 66. */
static double mean_stiffness(double a, double b, double coupling, double shear)
{
    return (3.0 * a + 3.0 * b + 2.0 * coupling + 4.0 * shear) / 8.0;
}

static void warn_of_warp(weft__reader *reader, const weft__node *mesh,
                         const weft_rest_report *of)
{
    const weft_mesh_def *def = &reader->scene->obj.def;
    const weft__node *warp = weft__value_of(mesh, "warp");
    const weft_fabric *fabric = orthotropic(def);
    if (warp == NULL && fabric != NULL) {
        const double twist = fabric->twist < 0.0
                                 ? sqrt(fabric->bend[0] * fabric->bend[1])
                                 : fabric->twist;
        const double shear = (fabric->stretch[0] + fabric->stretch[1]
                              - 2.0 * fabric->coupling + 4.0 * fabric->shear)
                             / 8.0;
        WARNING_AT(
            reader, mesh,
            "no warp: the fabric is taken alike in all directions (stretch %.4g, "
            "shear %.4g, bend %.4g)",
            mean_stiffness(fabric->stretch[0], fabric->stretch[1], fabric->coupling,
                           fabric->shear),
            shear, mean_stiffness(fabric->bend[0], fabric->bend[1], 0.0, twist / 2.0));
    } else if (warp != NULL && of->blended > 0) {
        WARNING_AT(reader, warp,
                   "warp is within 17 degrees of the normal of %zu of %zu triangles: "
                   "blended there",
                   of->blended, of->triangles);
    }
}

static void warn_of_rest(weft__reader *reader, const weft__node *mesh)
{
    weft_cloth_def def = reader->scene->cloth;
    const weft_rest *rest = &reader->scene->mesh_file.rest;
    weft_rest_report of;
    def.allocator = reader->report->memory;
    if (weft_cloth_def_rest(&def, 0, &of, NULL) != WEFT_OK) {
        reader->report->no_memory = true;
        return;
    }
    if (of.triangles > 0) {
        warn_of_warp(reader, mesh, &of);
    }
    if (of.sharp > 0 && rest->angle == WEFT_ANGLE_FLAT) {
        WARNING_AT(reader, weft__value_of(mesh, "angle"),
                   "angle: flat bends %zu edges open that start folded by more than 60 "
                   "degrees, by %.3g at most: the finer the mesh, the more energy they "
                   "have; angle: start keeps them",
                   of.sharp, 57.29577951308232 * of.fold);
    }
}

/* Sides of triangles whose length at the start is not that at rest, within 1 %. */
static size_t count_strained(const weft_mesh_def *def)
{
    size_t strained = 0;
    for (size_t t = 0; t < def->triangles; ++t) {
        double corner[3][2];
        weft__def_corners(def, t, corner);
        for (size_t k = 0; k < 3; ++k) {
            const double *a = &def->start[3 * (size_t)def->corners[3 * t + k]];
            const double *b
                = &def->start[3 * (size_t)def->corners[3 * t + (k + 1) % 3]];
            const double d[] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
            const double rest = sqrt(weft__squared(corner[k], corner[(k + 1) % 3]));
            strained += fabs(weft__length(d) / rest - 1.0) > 0.01;
        }
    }
    return strained;
}

static void warn_of_strain(weft__reader *reader, const weft__node *mesh)
{
    const weft_rest *rest = &reader->scene->mesh_file.rest;
    const weft_mesh_def *def = &reader->scene->obj.def;
    const bool kept = rest->shape == WEFT_REST_PLANE && rest->angle == WEFT_ANGLE_START;
    const size_t strained = kept ? count_strained(def) : 0;
    if (strained > 0) {
        WARNING_AT(
            reader, weft__value_of(mesh, "angle"),
            "angle: start, but %zu of %zu sides of triangles start more than 1 %% "
            "longer or shorter than at rest: the angles are of a shape that the "
            "cloth does not keep",
            strained, 3 * def->triangles);
    }
}

void weft__warn_of_mesh(weft__reader *reader, const weft__match *cloth)
{
    const weft_scene *scene = reader->scene;
    const weft__node *mesh = weft__value_in(cloth, "mesh"),
                     *cut = weft__value_in(cloth, "cut");
    weft__obj *obj = &reader->scene->obj;
    weft_stretch of;
    double side[3];
    if (!stretch_of(reader, &of)) {
        return;
    }
    box_of(obj->start, obj->def.vertices, side);
    const double size = fmax(side[0], fmax(side[1], side[2]));
    if (mesh == NULL) {
        if (is_far(&of)) {
            warn_of_scale(reader, weft__value_of(cut, "scale"), &of);
        }
        warn_of_lengths(reader, weft__value_of(cut, "spacing"), size);
        return;
    }
    if (is_far(&of)) {
        warn_of_stretch(reader, weft__value_of(mesh, "file")->at, &of);
    }
    const weft__node *unit = weft__value_of(mesh, "unit");
    weft__warn_of_size(reader, (unit != NULL ? unit : weft__value_of(mesh, "file"))->at,
                       "the cloth", size, scene->mesh_file.unit);
    warn_of_duplicates(obj);
    warn_of_slivers(obj);
    warn_of_strain(reader, mesh);
    if (obj->in_space) {
        warn_of_rest(reader, mesh);
    }
}

void weft__warn_of_grid(weft__reader *reader, const weft__match *cloth)
{
    const weft_cloth_def *def = &reader->scene->cloth;
    const weft__node *grid = weft__value_in(cloth, "grid");
    weft_stretch of;
    if (!stretch_of(reader, &of)) {
        return;
    }
    if (is_far(&of)) {
        warn_of_scale(reader, weft__value_of(grid, "scale"), &of);
    }
    warn_of_lengths(reader, weft__value_of(grid, "spacing"),
                    def->scale
                        * fmax((double)(def->rows - 1) * def->spacing[0],
                               (double)(def->cols - 1) * def->spacing[1]));
}
