/* SPDX-License-Identifier: BSD-3-Clause */
/* obj.c -- the faces of an OBJ file as a definition of triangles. */
#include "scene/obj.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/suggest.h"
#include "mesh/rigid.h"
#include "weft/elementary.h"

/* Places of one vertex: more are no seam, and take long to compare. */
enum { MOST_PLACES = 1000 };

/* Compared lengths that differ less are equal: a file has rounded numbers. */
#define EQUAL 1e-9

/* ---- places in the file -------------------------------------------------------- */

weft__mark weft__obj_mark(weft__obj *obj, uint32_t byte)
{
    weft__mark at = obj->at;
    at.in = &obj->file;
    at.order = obj->file.order;
    at.byte = (size_t)byte + 1;
    return at;
}

void weft__obj_fault(void *ctx, weft__mesh_part part, size_t index, const char *message)
{
    weft__obj *obj = ctx;
    weft__mark at = obj->at;
    if (part == WEFT__MESH_VERTEX && obj->name[index] < obj->vertices) {
        at = weft__obj_mark(obj, obj->vertex_byte[obj->name[index]]);
    } else if (part == WEFT__MESH_PLACE) {
        at = weft__obj_mark(obj, obj->place_byte[obj->place_of[index]]);
    } else if (part == WEFT__MESH_TRIANGLE) {
        at = weft__obj_mark(obj, obj->face[obj->face_of[index]].byte);
    }
    weft__report_error(obj->report, at, "%s", message);
}

/* ---- quadrilaterals ------------------------------------------------------------ */

/* Of the lines from corner 0 to 2 and from 1 to 3, by their lengths. */
static bool shorter_at_1(const uint32_t v[4], double a, double b)
{
    return fabs(a - b) > EQUAL * (a + b)
               ? b < a
               : (v[1] < v[3] ? v[1] : v[3]) < (v[0] < v[2] ? v[0] : v[2]);
}

void weft__obj_normal(const double a[3], const double b[3], const double c[3],
                      double out[3])
{
    const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    const double v[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
    weft__cross(u, v, out);
}

/* Whether the triangles a, b, c and a, c, d are turned the same way. */
static bool run_alike(const double a[3], const double b[3], const double c[3],
                      const double d[3])
{
    double one[3], other[3];
    weft__obj_normal(a, b, c, one);
    weft__obj_normal(a, c, d, other);
    return weft__dot(one, other) > 0.0;
}

/* Whether a quadrilateral is divided from corner 1 to 3 rather than from 0 to 2: by the
 * shorter line, of equal ones that with the lowest vertex, but not outside of it. */
static bool splits_at_1(const weft__obj *obj, const weft__obj_face *face)
{
    const uint32_t *v = face->vertex;
    double x[4][3];
    const size_t t = obj->def.triangles;
    if (obj->like != NULL && t < obj->like->triangles) {
        return obj->like->corners[3 * t] == obj->vertex_of[v[1]];
    }
    for (size_t k = 0; k < 4; ++k) {
        const bool flat = !obj->body && !obj->in_space;
        const double *at = flat ? obj->place[face->place[k]] : obj->vertex[v[k]];
        const double height = flat ? 0.0 : at[2];
        memcpy(x[k], (double[]){ at[0], at[1], height }, sizeof x[k]);
    }
    const bool in_02 = run_alike(x[0], x[1], x[2], x[3]);
    const bool in_13 = run_alike(x[1], x[2], x[3], x[0]);
    double d[2][3];
    for (size_t k = 0; k < 3; ++k) {
        d[0][k] = x[2][k] - x[0][k];
        d[1][k] = x[3][k] - x[1][k];
    }
    const double a = weft__length(d[0]), b = weft__length(d[1]);
    return in_02 != in_13 ? in_13 : shorter_at_1(v, a, b);
}

/* ---- the definition ------------------------------------------------------------ */

/* The place of a vertex in the file that was found first, and its vt. */
typedef struct first_place {
    uint32_t place, vt; /* WEFT__NONE: none */
} first_place;

typedef struct obj_builder {
    weft__obj *obj;
    first_place *first;
    uint32_t *next;                          /* place of the same vertex */
    size_t rest_room, next_room, place_room; /* of arrays as long as the places */
} obj_builder;

static bool same_place(const weft__obj *obj, uint32_t a, uint32_t b)
{
    const double *x = obj->place[a], *y = obj->place[b];
    return a == b || (x[0] == y[0] && x[1] == y[1]);
}

/* The place of a corner: a new one if its vertex has none at the same vt yet. */
static uint32_t find_place(obj_builder *self, const weft__obj_face *face, size_t corner)
{
    weft__obj *obj = self->obj;
    first_place *first = &self->first[face->vertex[corner]];
    uint32_t *slot = &first->place;
    const uint32_t vt = face->place[corner];
    const size_t count = obj->def.uv_count;
    size_t before = 0;
    if (first->vt == vt) {
        return first->place;
    }
    for (; *slot != WEFT__NONE; slot = &self->next[*slot], ++before) {
        if (same_place(obj, obj->place_of[*slot], vt)) {
            return *slot;
        }
    }
    if (before == MOST_PLACES) {
        weft__report_error(obj->report, weft__obj_mark(obj, face->byte),
                           "a vertex of this face has more than %d places in the rest "
                           "shape (vt)",
                           MOST_PLACES);
        return 0;
    }
    *slot = (uint32_t)count; /* before the arrays may move */
    first->vt = before == 0 ? vt : first->vt;
    if (!weft__report_reserve(obj->report, &obj->rest, &self->rest_room, count + 1,
                              2 * sizeof *obj->rest)
        || !weft__report_reserve(obj->report, &self->next, &self->next_room, count + 1,
                                 sizeof *self->next)
        || !weft__report_reserve(obj->report, &obj->place_of, &self->place_room,
                                 count + 1, sizeof *obj->place_of)) {
        return 0;
    }
    memcpy(&obj->rest[2 * count], obj->place[vt], 2 * sizeof *obj->rest);
    self->next[count] = WEFT__NONE;
    obj->place_of[count] = vt;
    ++obj->def.uv_count;
    return (uint32_t)count;
}

static void add_triangle(obj_builder *self, size_t face, const uint32_t place[4],
                         size_t a, size_t b, size_t c)
{
    weft__obj *obj = self->obj;
    const size_t corner[] = { a, b, c }, t = obj->def.triangles++;
    for (size_t k = 0; k < 3; ++k) {
        obj->corner[3 * t + k] = obj->vertex_of[obj->face[face].vertex[corner[k]]];
        obj->corner_place[3 * t + k] = place[corner[k]];
    }
    obj->face_of[t] = (uint32_t)face;
}

static void add_face(obj_builder *self, size_t index)
{
    const weft__obj_face *face = &self->obj->face[index];
    const size_t corners = face->vertex[3] == WEFT__NONE ? 3 : 4;
    uint32_t place[4] = { 0 };
    for (size_t k = 0; k < corners && self->obj->places > 0; ++k) {
        place[k] = find_place(self, face, k);
    }
    if (corners == 3) {
        add_triangle(self, index, place, 0, 1, 2);
    } else if (splits_at_1(self->obj, face)) {
        add_triangle(self, index, place, 1, 2, 3);
        add_triangle(self, index, place, 1, 3, 0);
    } else {
        add_triangle(self, index, place, 0, 1, 2);
        add_triangle(self, index, place, 0, 2, 3);
    }
}

/* Whether a vertex of the file did not become another one. */
static bool stands_alone(const weft__obj *obj, size_t v)
{
    return obj->lowest == NULL || obj->lowest[v] == v;
}

static void warn_of_unused(weft__obj *obj, size_t first, size_t count)
{
    char more[48] = "";
    if (count > 1) {
        (void)snprintf(more, sizeof more, ", the first of %zu", count);
    }
    weft__report_warning(obj->report, weft__obj_mark(obj, obj->vertex_byte[first]),
                         "vertex %zu (from 0) belongs to no face and is dropped%s",
                         first, more);
}

/* Keeps vertices of a cloth that no face has, for what counts those of the file. */
static void keep_loose(weft__obj *obj, size_t count)
{
    obj->loose_name = weft__report_take(obj->report, count, sizeof *obj->loose_name);
    obj->loose_start
        = weft__report_take(obj->report, count, 3 * sizeof *obj->loose_start);
    for (size_t v = 0; !obj->report->no_memory && v < obj->vertices; ++v) {
        if (obj->vertex_of[v] == WEFT__NONE && stands_alone(obj, v)) {
            obj->loose_name[obj->loose] = v;
            memcpy(&obj->loose_start[3 * obj->loose++], obj->vertex[v],
                   sizeof *obj->vertex);
        }
    }
}

/* Numbers the vertices of faces in the order of the file. */
static void take_vertices(weft__obj *obj, bool whole)
{
    size_t unused = 0, first = 0;
    memset(obj->vertex_of, 0xff, obj->vertices * sizeof *obj->vertex_of);
    for (size_t f = 0; f < obj->faces; ++f) {
        for (size_t k = 0; k < 4; ++k) {
            if (obj->face[f].vertex[k] != WEFT__NONE) {
                obj->vertex_of[obj->face[f].vertex[k]] = 0;
            }
        }
    }
    for (size_t v = 0; v < obj->vertices; ++v) {
        if (!stands_alone(obj, v)) { /* the lower one has its number already */
            obj->vertex_of[v] = obj->vertex_of[obj->lowest[v]];
            continue;
        }
        if (obj->vertex_of[v] == WEFT__NONE) {
            first = unused++ == 0 ? v : first;
            continue;
        }
        const size_t i = obj->def.vertices++;
        obj->vertex_of[v] = (uint32_t)i;
        obj->name[i] = v;
        memcpy(&obj->start[3 * i], obj->vertex[v], sizeof *obj->vertex);
        if (obj->in_space) {
            memcpy(&obj->space[3 * i], obj->vertex[v], sizeof *obj->vertex);
        }
    }
    if (unused > 0 && whole) {
        warn_of_unused(obj, first, unused);
    }
    if (unused > 0 && whole && !obj->body) {
        keep_loose(obj, unused);
    }
}

static bool obj_make_room(obj_builder *self)
{
    weft__obj *obj = self->obj;
    weft__report *report = obj->report;
    const size_t n = obj->vertices, most = 2 * obj->faces;
    self->first = weft__report_take(report, n, sizeof *self->first);
    obj->vertex_of = weft__report_take(report, n, sizeof *obj->vertex_of);
    obj->name = weft__report_take(report, n, sizeof *obj->name);
    obj->start = weft__report_take(report, n, 3 * sizeof *obj->start);
    obj->corner = weft__report_take(report, most, 3 * sizeof *obj->corner);
    obj->corner_place = weft__report_take(report, most, 3 * sizeof *obj->corner_place);
    obj->face_of = weft__report_take(report, most, sizeof *obj->face_of);
    if (obj->in_space) {
        obj->space = weft__report_take(report, n, 3 * sizeof *obj->space);
    }
    return !report->no_memory;
}

/* Faces of a file that has no order take half the time. */
static void fetch_ahead(const obj_builder *self, size_t f)
{
    const weft__obj *obj = self->obj;
    const weft__obj_face *later = &obj->face[weft__soon(f, 16, obj->faces)];
    for (size_t k = 0; k < 3; ++k) {
        __builtin_prefetch(&self->first[later->vertex[k]], 1);
        __builtin_prefetch(&obj->vertex_of[later->vertex[k]]);
        __builtin_prefetch(obj->places == 0 ? NULL : &obj->place[later->place[k]]);
    }
}

void weft__obj_show(weft__obj *obj)
{
    obj->def.start = obj->start;
    obj->def.file_index = obj->name;
    obj->def.rest = obj->rest;
    obj->def.space = obj->space;
    obj->def.corners = obj->corner;
    obj->def.corner_uv = obj->in_space ? NULL : obj->corner_place;
    obj->def.fabric_of = obj->fabric_of;
}

/* whole: no face is left out. */
static bool build(weft__obj *obj, bool whole)
{
    static const weft_rest in_space
        = { .shape = WEFT_REST_START, .angle = WEFT_ANGLE_FLAT };
    obj_builder self = { .obj = obj };
    const size_t before = obj->report->mistakes;
    obj->def = weft_mesh_def_default();
    obj->def.rests = obj->in_space ? &in_space : NULL;
    if (obj_make_room(&self)) {
        memset(self.first, 0xff, obj->vertices * sizeof *self.first);
        take_vertices(obj, whole);
        for (size_t f = 0; f < obj->faces && !obj->report->no_memory; ++f) {
            fetch_ahead(&self, f);
            add_face(&self, f);
        }
    }
    WEFT__FREE_ALL(obj->report->memory, self.first, self.next);
    weft__obj_show(obj);
    obj->def.file_index = obj->def.vertices < obj->vertices ? obj->name : NULL;
    return !obj->report->no_memory && obj->report->mistakes == before;
}

/* ---- files --------------------------------------------------------------------- */

/* Reports what else is wrong with the faces whose statements have no mistakes. */
static void check_faces(weft__obj *obj)
{
    const weft_fabric any = { .density = 1.0 };
    size_t good = 0;
    const bool placed = obj->places > 0;
    for (size_t f = 0; (placed || obj->in_space) && f < obj->faces; ++f) {
        const weft__obj_face *face = &obj->face[f];
        bool finite = true;
        for (size_t k = 0; k < 4 && face->vertex[k] != WEFT__NONE; ++k) {
            finite = finite && isfinite(obj->vertex[face->vertex[k]][0])
                     && (!placed || isfinite(obj->place[face->place[k]][0]));
        }
        obj->face[good] = *face;
        good += finite;
    }
    obj->faces = good;
    if (good > 0 && build(obj, false)) {
        weft_mesh_def def = obj->def;
        def.fabrics = &any, def.fabric_count = 1;
        (void)weft__triangles_create(NULL, &def, obj->report->memory,
                                     &(weft__mesh_faults){ weft__obj_fault, obj },
                                     &obj->report->no_memory);
    }
}

bool weft__obj_read(weft__obj *obj)
{
    const bool read = weft__obj_parse(obj);
    if (!read && !obj->report->no_memory) {
        check_faces(obj);
    }
    return read && (!obj->welds || weft__obj_weld(obj))
           && (obj->body || obj->in_space || obj->places > 0 || weft__obj_lay_flat(obj))
           && build(obj, true);
}

static bool read_all(weft__obj *obj, FILE *stream)
{
    const long size = fseek(stream, 0, SEEK_END) == 0 ? ftell(stream) : -1;
    if (size < 0 || (size_t)size > WEFT__OBJ_BYTES) {
        ERROR_AT(obj, obj, "%.200s has %ld bytes; an OBJ file has at most %zu",
                 obj->file.path, size, WEFT__OBJ_BYTES);
        return false;
    }
    rewind(stream);
    obj->file.text = weft__report_take(obj->report, (size_t)size + 1, 1);
    if (obj->file.text == NULL) {
        return false;
    }
    obj->file.length = fread(obj->file.text, 1, (size_t)size, stream);
    if (ferror(stream)) {
        ERROR_AT(obj, obj, "%.200s: %s", obj->file.path, strerror(errno));
    }
    return !ferror(stream);
}

bool weft__obj_load(weft__obj *obj, const char *path)
{
    weft_error err;
    FILE *stream = weft__file_open(path, "r", &err);
    obj->file.path = path;
    if (stream == NULL) {
        UNOPENED_AT(obj, obj, err);
        return false;
    }
    const bool read = read_all(obj, stream);
    (void)fclose(stream);
    return read && weft__obj_read(obj);
}

/* ---- what scenes ask ----------------------------------------------------------- */

/* Multiplies by the unit, turns by sine and cosine about k, and moves. */
static void move_point(double *p, double unit, const double k[3], double sine,
                       double cosine, const double at[3])
{
    const double x[] = { unit * p[0], unit * p[1], unit * p[2] };
    const double along = (1.0 - cosine) * weft__dot(k, x);
    for (size_t c = 0; c < 3; ++c) {
        const size_t d = (c + 1) % 3, e = (c + 2) % 3;
        p[c]
            = cosine * x[c] + sine * (k[d] * x[e] - k[e] * x[d]) + along * k[c] + at[c];
    }
}

void weft__obj_move(weft__obj *obj, double unit, const double axis[3], double angle,
                    const double at[3])
{
    const double length = weft__length(axis);
    const double k[] = { axis[0] / length, axis[1] / length, axis[2] / length };
    double sine, cosine;
    for (size_t j = 0; obj->space != NULL && j < 3 * obj->def.vertices; ++j) {
        obj->space[j] = unit * obj->start[j];
    }
    weft_sincos_turns(angle / 360.0, 1.0, &sine, &cosine);
    for (size_t i = 0; i < obj->def.vertices; ++i) {
        move_point(&obj->start[3 * i], unit, k, sine, cosine, at);
    }
    for (size_t i = 0; i < obj->loose; ++i) {
        move_point(&obj->loose_start[3 * i], unit, k, sine, cosine, at);
    }
    for (size_t i = 0; i < 2 * obj->def.uv_count; ++i) {
        obj->rest[i] *= unit;
    }
}

bool weft__obj_named(const weft__obj_names *names, const char *name, size_t length,
                     uint32_t *of, uint32_t value)
{
    bool found = false;
    for (size_t i = 0; i < names->count; ++i) {
        const weft__obj_name *one = &names->list[i];
        if (one->length == length && memcmp(one->text, name, length) == 0) {
            of[one->statement] = value;
            found = true;
        }
    }
    return found;
}

bool weft__obj_group(const weft__obj *obj, const char *name, bool *member)
{
    uint32_t *listed = weft__report_take(
        obj->report, (size_t)obj->groups.statements + 1, sizeof *listed);
    if (listed == NULL) {
        return true;
    }
    const bool found = weft__obj_named(&obj->groups, name, strlen(name), listed, true);
    for (size_t f = 0; found && f < obj->faces; ++f) {
        const weft__obj_face *face = &obj->face[f];
        for (size_t k = 0; listed[face->groups] != 0 && k < 4; ++k) {
            if (face->vertex[k] != WEFT__NONE) {
                member[obj->vertex_of[face->vertex[k]]] = true;
            }
        }
    }
    for (size_t p = 0; found && p < obj->points; ++p) {
        const uint32_t vertex = obj->vertex_of[obj->point[p].vertex];
        if (listed[obj->point[p].groups] != 0 && vertex != WEFT__NONE) {
            member[vertex] = true;
        }
    }
    for (size_t i = obj->coarse; obj->parent != NULL && i < obj->def.vertices; ++i) {
        const uint32_t *parent = obj->parent[i - obj->coarse];
        member[i] = member[parent[0]] && member[parent[1]];
    }
    weft__free(obj->report->memory, listed);
    return found;
}

const char *weft__obj_near(const weft__obj_names *names, const char *typed, char *out,
                           size_t size)
{
    enum { MOST = 1000 }; /* compared */
    char best[64] = "", name[sizeof best];
    weft__guess guess = { 0 };
    for (size_t i = 0; i < names->count && i < MOST; ++i) {
        const weft__obj_name *one = &names->list[i];
        (void)snprintf(name, sizeof name, "%.*s", (int)one->length, one->text);
        weft__guess_try(&guess, typed, name);
        if (guess.name == name) {
            (void)strcpy(best, name);
            guess.name = best;
        }
    }
    return weft__guess_text(&guess, out, size);
}

/* ---- memory -------------------------------------------------------------------- */

void weft__obj_forget(weft__obj *obj)
{
    if (obj->report == NULL) {
        return;
    }
    WEFT__FREE_ALL(obj->report->memory, obj->kept ? NULL : obj->file.text, obj->vertex,
                   obj->place, obj->vertex_byte, obj->place_byte, obj->face, obj->point,
                   obj->fabrics.list, obj->groups.list, obj->lowest, obj->vertex_of,
                   obj->place_of, obj->face_of, obj->parent);
    if (obj->def.file_index == NULL) {
        weft__free(obj->report->memory, obj->name);
        obj->name = NULL;
    }
    *obj = (weft__obj){ .file.text = obj->kept ? obj->file.text : NULL,
                        .in_space = obj->in_space,
                        .def = obj->def,
                        .start = obj->start,
                        .rest = obj->rest,
                        .space = obj->space,
                        .corner = obj->corner,
                        .corner_place = obj->corner_place,
                        .fabric_of = obj->fabric_of,
                        .name = obj->name,
                        .welded = obj->welded,
                        .loose = obj->loose,
                        .loose_name = obj->loose_name,
                        .loose_start = obj->loose_start };
}

void weft__obj_close(weft__obj *obj, const weft_allocator *memory)
{
    weft__obj_forget(obj);
    WEFT__FREE_ALL(memory, obj->start, obj->rest, obj->space, obj->corner,
                   obj->corner_place, obj->fabric_of, obj->name, obj->loose_name,
                   obj->loose_start, obj->file.text);
    *obj = (weft__obj){ .def = { 0 } };
}
