/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_body.c -- the triangles of a mesh in contact.shapes: one OBJ file, or one for
 * each key frame; or those that weft makes of another shape. */
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/finite.h"
#include "base/grow.h"
#include "forces/contact/mesh_shape.h"
#include "forces/contact/tessellate.h"
#include "scene/contact/contact_checks.h"

enum { MOST_KEYS = 100000, WIDEST = 9 };

/* A name with the place of a number, which has a width if it begins with zeros. */
typedef struct pattern {
    const char *name, *rest; /* behind %04d; NULL: no number */
    size_t before;
    int width;
} pattern;

static pattern pattern_of(const char *name)
{
    const char *at = strchr(name, '%');
    pattern out = { .name = name };
    if (at != NULL) {
        const bool wide = at[1] == '0' && at[2] > '0' && at[2] <= '0' + WIDEST;
        out.before = (size_t)(at - name);
        out.width = wide ? at[2] - '0' : 1;
        at += wide ? 3 : 1;
        out.rest = *at == 'd' && strchr(at, '%') == NULL ? at + 1 : NULL;
    }
    return out;
}

/* The file of key k, from `start` on; NULL: no memory. */
static char *key_path(weft__reader *reader, const pattern *of, size_t start, size_t key)
{
    char name[1024], copy[64];
    if (of->rest == NULL) {
        (void)snprintf(name, sizeof name, "%s", of->name);
        (void)snprintf(copy, sizeof copy, WEFT__BODY_COPY ".obj", reader->shape);
    } else {
        (void)snprintf(name, sizeof name, "%.*s%0*zu%s", (int)of->before, of->name,
                       of->width, start + key, of->rest);
        (void)snprintf(copy, sizeof copy, WEFT__BODY_COPY "-%04zu.obj", reader->shape,
                       key);
    }
    return weft__mesh_path(reader, name, copy);
}

static bool is_there(weft__reader *reader, const pattern *of, size_t start, size_t key)
{
    const char *path = key_path(reader, of, start, key);
    struct stat at; /* of a link itself: one that leads nowhere is no end of the keys */
    return path != NULL && lstat(path, &at) == 0;
}

/* How many files there are, the first with number *start. */
static size_t count_keys(weft__reader *reader, const pattern *of, size_t *start)
{
    size_t count = 0;
    *start = !is_there(reader, of, 0, 0);
    while (count < MOST_KEYS && !reader->report->no_memory
           && is_there(reader, of, *start, count)) {
        ++count;
    }
    return count;
}

/* The number of a pattern in the name of a file, or of a folder if it stands in one, if
 * it is written as the pattern writes it; else 0. */
static size_t number_in(const char *entry, const pattern *of)
{
    size_t begin
        = of->before; /* of the part of the pattern's path that has the number */
    char written[32];
    while (begin > 0 && of->name[begin - 1] != '/') {
        --begin;
    }
    const size_t before = of->before - begin, after = strcspn(of->rest, "/");
    if (strncmp(entry, of->name + begin, before) != 0) {
        return 0;
    }
    const size_t number = strtoul(entry + before, NULL, 10);
    const size_t length
        = (size_t)snprintf(written, sizeof written, "%0*zu", of->width, number);
    const char *end = entry + before + length;
    const bool same = strncmp(entry + before, written, length) == 0
                      && strncmp(end, of->rest, after) == 0 && end[after] == '\0';
    return same ? number : 0;
}

/* The least number above `last` in the folder of key 0, whose path is `first`; 0: none.
 */
static size_t next_number(const char *first, const pattern *of, size_t last)
{
    char folder[4096];
    size_t length = strlen(first), next = 0, up = 1; /* parts of the path behind it */
    for (const char *rest = of->rest; (rest = strchr(rest, '/')) != NULL; ++rest) {
        ++up;
    }
    while (up > 0 && length > 0) {
        up -= first[--length] == '/';
    }
    (void)snprintf(folder, sizeof folder, "%.*s%s", (int)length, first,
                   up > 0 ? "." : "/.");
    DIR *listed = opendir(folder);
    for (const struct dirent *at; listed != NULL && (at = readdir(listed)) != NULL;) {
        const size_t number = number_in(at->d_name, of);
        next = number > last && (next == 0 || number < next) ? number : next;
    }
    if (listed != NULL) {
        (void)closedir(listed);
    }
    return next;
}

/* Reports a key that is missing between others. The files are `count` from `start` on,
 * or their copies, which are numbered from 0. */
static void find_gap(weft__reader *reader, const weft__node *at, const pattern *of,
                     size_t start, size_t count)
{
    char copy[64];
    (void)snprintf(copy, sizeof copy, WEFT__BODY_COPY "-%%04d.obj", reader->shape);
    const pattern copies = pattern_of(copy);
    const char *first = count > 0 ? key_path(reader, of, start, 0) : NULL;
    if (first == NULL) {
        return;
    }
    const char *slash = strrchr(first, '/');
    const char *name = slash == NULL ? first : slash + 1;
    const bool copied = strncmp(name, copy, copies.before) == 0;
    const pattern *names = copied ? &copies : of;
    const size_t from = copied ? 0 : start;
    const size_t next = next_number(first, names, from + count - 1);
    if (next > 0) {
        ERROR_AT(
            reader, at,
            "key frame %0*zu of '%.200s' is missing, but %0*zu is there: key frames "
            "are numbered one after another",
            names->width, from + count, names->name, names->width, next);
    }
}

/* A body while its keys are read. */
typedef struct making {
    weft__reader *reader;
    weft_body *to;
    bool *flat; /* triangles without area at some key, which are dropped */
} making;

/* Makes room for all keys, whose triangles are those of the first. */
static bool take_first(making *self, const weft_mesh_def *def)
{
    weft__tree *tree = self->reader->tree;
    const size_t t = def->triangles, n = def->vertices;
    uint32_t *corners = weft__tree_take(tree, 3 * t, sizeof *corners);
    self->to->positions = weft__tree_take(tree, 3 * n * self->to->keys, sizeof(double));
    self->flat = weft__tree_take(tree, t, sizeof *self->flat);
    if (corners == NULL || self->to->positions == NULL || self->flat == NULL) {
        return false;
    }
    memcpy(corners, def->corners, 3 * t * sizeof *corners);
    self->to->vertices = n, self->to->triangles = t;
    self->to->corners = corners;
    return true;
}

/* Whether a key has the triangles of the first, or the mistake is reported. */
static bool is_like_first(const making *self, weft__obj *obj)
{
    const weft_body *to = self->to;
    const weft_mesh_def *def = &obj->def;
    const bool same = def->vertices == to->vertices && def->triangles == to->triangles;
    for (size_t t = 0; t < to->triangles; ++t) {
        const size_t size = 3 * sizeof *to->corners;
        if (!same || memcmp(&to->corners[3 * t], &def->corners[3 * t], size) != 0) {
            weft__obj_fault(obj, WEFT__MESH_TRIANGLE, same ? t : 0,
                            "key frames must have the same vertices and faces: this "
                            "one differs from the first");
            return false;
        }
    }
    return true;
}

static void warn_of_flat(const making *self, weft__obj *obj, size_t count,
                         uint32_t first)
{
    if (count > 0) {
        weft__report_warning(
            obj->report, weft__obj_mark(obj, first),
            "%zu %s of this body %s no area, the first here, and %s left out%s", count,
            count == 1 ? "triangle" : "triangles", count == 1 ? "has" : "have",
            count == 1 ? "is" : "are", self->to->keys > 1 ? " of every key frame" : "");
    }
}

static void normal_of(const weft_mesh_def *def, size_t t, double out[3])
{
    const uint32_t *v = &def->corners[3 * t];
    weft__obj_normal(&def->start[3 * (size_t)v[0]], &def->start[3 * (size_t)v[1]],
                     &def->start[3 * (size_t)v[2]], out);
}

/* Warns of faces of which a triangle is turned against the largest: those are concave,
 * and the triangle covers what the face leaves open. */
static void warn_of_concave(weft__obj *obj)
{
    const weft_mesh_def *def = &obj->def;
    size_t count = 0;
    uint32_t first = 0;
    for (size_t t = 0, end; t < def->triangles; t = end) {
        const uint32_t byte = obj->face[obj->face_of[t]].byte;
        double largest[3] = { 0.0 }, normal[3];
        bool turned = false;
        for (end = t; end < def->triangles && obj->face[obj->face_of[end]].byte == byte;
             ++end) {
            normal_of(def, end, normal);
            if (weft__length(normal) > weft__length(largest)) {
                memcpy(largest, normal, sizeof largest);
            }
        }
        for (size_t i = t; i < end; ++i) {
            normal_of(def, i, normal);
            turned = turned
                     || weft__dot(normal, largest)
                            < -1e-9 * weft__length(normal) * weft__length(largest);
        }
        first = turned && count++ == 0 ? byte : first;
    }
    if (count > 0) {
        weft__report_warning(
            obj->report, weft__obj_mark(obj, first),
            "%zu %s of this body, the first here, %s concave: the triangles that weft "
            "makes of %s go beyond %s; triangulate the mesh on export",
            count, count == 1 ? "face" : "faces", count == 1 ? "is" : "are",
            count == 1 ? "it" : "them", count == 1 ? "its outline" : "their outlines");
    }
}

/* Finds triangles without area, and reports what else is wrong with a key. */
static void check_key(making *self, weft__obj *obj, size_t key)
{
    const weft_body *to = self->to;
    const double *places = to->positions + 3 * to->vertices * key;
    size_t count = key == 0 ? obj->flat : 0, all = 0;
    uint32_t first = obj->flat_byte;
    if (!weft__all_finite(places, 3 * to->vertices)) {
        weft__obj_fault(obj, WEFT__MESH_VERTEX, 0,
                        "its body has a place that is not finite");
        return;
    }
    for (size_t t = 0; t < to->triangles; ++t) {
        bool flat;
        const char *fault = weft__body_flaw(places, &to->corners[3 * t], &flat);
        if (fault != NULL && !flat) {
            weft__obj_fault(obj, WEFT__MESH_TRIANGLE, t, fault);
            return;
        }
        all += flat;
        if (flat && !self->flat[t]) {
            self->flat[t] = true;
            const uint32_t byte = obj->face[obj->face_of[t]].byte;
            first = count++ == 0 || byte < first ? byte : first;
        }
    }
    if (all == to->triangles) {
        weft__obj_fault(obj, WEFT__MESH_TRIANGLE, 0,
                        "no face of this body has an area");
    } else {
        warn_of_flat(self, obj, count, first);
    }
}

static void read_key_frame(making *self, weft__mark at, const char *path, double unit,
                           size_t key)
{
    weft__report *report = self->reader->report;
    const size_t before = report->mistakes;
    weft_body *to = self->to;
    weft__obj obj = { .report = report,
                      .at = at,
                      .file = { .path = path, .order = key },
                      .body = true,
                      .like = key == 0 ? NULL : to };
    if (path != NULL && weft__obj_load(&obj, path) && report->mistakes == before
        && (key == 0 ? take_first(self, &obj.def) : is_like_first(self, &obj))) {
        double *places = weft__unconst(to->positions);
        for (size_t i = 0; i < 3 * to->vertices; ++i) {
            places[3 * to->vertices * key + i] = unit * obj.def.start[i];
        }
        check_key(self, &obj, key);
        if (key == 0) {
            warn_of_concave(&obj);
        }
    }
    weft__obj_close(&obj, report->memory);
}

/* Leaves out triangles without area, and the vertices that no other has. */
static void drop_flat(making *self, const weft__node *file)
{
    weft_body *to = self->to;
    uint32_t *corners = weft__unconst(to->corners);
    double *places = weft__unconst(to->positions);
    const size_t all = to->vertices;
    size_t kept = 0, vertices = 0;
    for (size_t t = 0; t < to->triangles; ++t) {
        if (!self->flat[t]) {
            memmove(&corners[3 * kept++], &corners[3 * t], 3 * sizeof *corners);
        }
    }
    if (kept == to->triangles) {
        return;
    }
    uint32_t *number = weft__tree_take(self->reader->tree, all, sizeof *number);
    if (number == NULL) {
        return;
    }
    if (kept == 0) {
        ERROR_AT(self->reader, file,
                 "no triangle of this body has an area at every key");
        return;
    }
    for (size_t i = 0; i < 3 * kept; ++i) {
        number[corners[i]] = 1;
    }
    for (size_t i = 0; i < all * to->keys;
         ++i) { /* by keys: never ahead of the reader */
        const size_t v = i % all;
        if (number[v] != 0) {
            memmove(&places[3 * vertices++], &places[3 * i], 3 * sizeof *places);
        }
    }
    to->vertices = vertices / to->keys;
    to->triangles = kept;
    for (size_t v = 0, next = 0; v < all; ++v) {
        number[v] = number[v] != 0 ? (uint32_t)next++ : WEFT__NONE;
    }
    for (size_t i = 0; i < 3 * kept; ++i) {
        corners[i] = number[corners[i]];
    }
}

/* The files of a body, which the scene lists. */
static bool list_files(weft__reader *reader, weft__body_files *to, const pattern *of,
                       size_t start, size_t keys)
{
    to->shape = reader->shape;
    to->keyed = of->rest != NULL;
    to->paths = weft__tree_take(reader->tree, keys, sizeof *to->paths);
    for (size_t k = 0; to->paths != NULL && k < keys; ++k) {
        to->paths[k] = key_path(reader, of, start, k);
        to->count += to->paths[k] != NULL;
    }
    to->next = reader->scene->body_files;
    reader->scene->body_files = to;
    return to->count == keys;
}

void weft__read_body(weft__reader *reader, const weft__match *match,
                     weft__shape_item *item)
{
    const weft__node *file = weft__value_in(match, "file");
    const weft__node *fps = weft__key_in(match, "fps");
    const pattern of = pattern_of(item->file);
    const bool keyed = strchr(item->file, '%') != NULL;
    const size_t before = reader->report->mistakes;
    size_t start = 0, keys = 1;
    if (strlen(item->file) > 900 || (keyed && of.rest == NULL)) {
        ERROR_AT(reader, file,
                 "the name of key frames needs one number: %%d, or %%04d");
        return;
    }
    if (keyed != (fps != NULL)) {
        ERROR_AT(reader, keyed ? file : fps,
                 keyed ? "key frames need fps, their number a second"
                       : "fps needs key frames: a file with %%04d for their number");
        return;
    }
    keys = keyed ? count_keys(reader, &of, &start) : 1;
    if (keyed) {
        find_gap(reader, file, &of, start, keys);
    }
    if (reader->report->mistakes > before) {
        return;
    }
    if (keys < 1 + (size_t)keyed || keys == MOST_KEYS) {
        ERROR_AT(reader, file,
                 "key frames '%.200s': there are %zu files from 0 or 1 on; 2 to %d are "
                 "needed",
                 item->file, keys, MOST_KEYS - 1);
        return;
    }
    weft_body *body = weft__tree_take(reader->tree, 1, sizeof *body);
    weft__body_files *files = weft__tree_take(reader->tree, 1, sizeof *files);
    if (body == NULL || files == NULL || !list_files(reader, files, &of, start, keys)) {
        return;
    }
    body->keys = keys, body->fps = keyed ? item->fps : 0.0;
    making made = { .reader = reader, .to = body };
    for (size_t k = 0;
         k < keys && reader->report->mistakes == before && !reader->report->no_memory;
         ++k) {
        read_key_frame(&made, file->at, files->paths[k], item->unit, k);
    }
    if (reader->report->mistakes == before && !reader->report->no_memory) {
        drop_flat(&made, file);
    }
    item->shape.body = body;
    if (reader->report->mistakes == before && !reader->report->no_memory) {
        const weft__node *unit = weft__value_in(match, "unit");
        weft__warn_of_body_size(reader, (unit == NULL ? file : unit)->at, body,
                                item->unit);
    }
}

/* ---- triangles of a sphere, capsule or box --------------------------------------- */

void weft__read_facets(weft__reader *reader, const weft__key *key,
                       const weft__node *node, void *to)
{
    const char *text = weft__text_of(node);
    double edge = 0.0;
    if (weft__number_of(node, &edge) ? weft__positive(edge)
        : text != NULL               ? strcmp(text, "false") == 0
                                     : false) {
        *(double *)to = edge;
    } else if (text != NULL && strcmp(text, "true") == 0) {
        *(double *)to = -1.0;
    } else {
        weft__refuse_value(reader, key, node);
    }
}

/* An edge with which there are not too many triangles: their number falls at least as
 * its square, until it is one cell along each rounding. */
static double edge_that_suits(const weft_shape *shape, double edge)
{
    weft__lattice lattice;
    do {
        edge *= 1.25;
        (void)weft__lattice_of(shape, edge, &lattice);
    } while (lattice.triangles > WEFT__MOST_FACETS);
    return edge;
}

void weft__make_facets(weft__reader *reader, const weft__match *match,
                       weft__shape_item *item)
{
    const weft__node *key = weft__value_in(match, "triangles");
    const double thickness = reader->scene->cloth.contact.thickness;
    const double edge
        = item->facets > 0.0 ? item->facets : weft__facet_edge(&item->shape, thickness);
    weft__lattice lattice;
    weft_body *body = weft__tree_take(reader->tree, 1, sizeof *body);
    if (!(edge > 0.0) || body == NULL) { /* the thickness was refused */
        return;
    }
    const char *fault = weft__lattice_of(&item->shape, edge, &lattice);
    if (fault != NULL || lattice.triangles > WEFT__MOST_FACETS) {
        if (fault != NULL) {
            ERROR_AT(reader, key, "%s", fault);
        } else {
            ERROR_AT(reader, key,
                     "edges of %.3g m make %zu triangles, more than %d: write "
                     "triangles: %.2g, or a larger rounding or thickness",
                     edge, lattice.triangles, WEFT__MOST_FACETS,
                     edge_that_suits(&item->shape, edge));
        }
        return;
    }
    double *places
        = weft__tree_take(reader->tree, 3 * lattice.vertices, sizeof *places);
    uint32_t *corners
        = weft__tree_take(reader->tree, 3 * lattice.triangles, sizeof *corners);
    if (places == NULL || corners == NULL) {
        return;
    }
    weft__lattice_fill(&lattice, places, corners);
    *body = (weft_body){ .vertices = lattice.vertices,
                         .triangles = lattice.triangles,
                         .keys = 1,
                         .positions = places,
                         .corners = corners };
    item->shape.kind = WEFT_MESH;
    item->shape.body = body;
}

bool weft_scene_shape_made(const weft_scene *scene, size_t k)
{
    const weft_contact_def *contact = &scene->cloth.contact;
    bool made = k < contact->shape_count && contact->shapes[k].kind == WEFT_MESH;
    for (const weft__body_files *at = scene->body_files; at != NULL; at = at->next) {
        made = made && at->shape != k;
    }
    return made;
}

bool weft__same_shapes(const weft_scene *a, const weft_scene *b)
{
    const weft_contact_def *of[2] = { &a->cloth.contact, &b->cloth.contact };
    bool same = of[0]->shape_count == of[1]->shape_count;
    for (size_t k = 0; same && k < of[0]->shape_count; ++k) {
        const weft_body *x = of[0]->shapes[k].body, *y = of[1]->shapes[k].body;
        same
            = (x == NULL) == (y == NULL) && (x == NULL || x->triangles == y->triangles);
    }
    return same;
}
