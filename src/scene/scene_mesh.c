/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_mesh.c -- a cloth of triangles: its file, its fabrics, and what of a grid it
 * has not. */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/finite.h"
#include "cloth/model.h"
#include "scene/checks.h"

enum { MOST_FABRICS = 64 };

/* ---- the file ----------------------------------------------------------------- */

char *weft__mesh_path(weft__reader *reader, const char *name, const char *copy)
{
    char own[32] = "scene.obj";
    const char *scene = reader->def->file == NULL ? "" : reader->def->file;
    const char *slash = strrchr(scene, '/');
    const size_t folder = slash == NULL ? 0 : (size_t)(slash - scene) + 1;
    if (reader->scene->part > 0) {
        (void)snprintf(own, sizeof own, "scene-%zu.obj", reader->scene->part - 1);
    }
    copy = copy == NULL ? own : copy;
    const size_t length = name == NULL ? 0 : strlen(name), least = strlen(copy);
    char *path = weft__tree_take(reader->tree,
                                 folder + (length < least ? least : length) + 1, 1);
    if (path == NULL) {
        return NULL;
    }
    const bool copied = strcmp(scene + folder, "scene.yaml") == 0
                        || strcmp(scene + folder, "fitted.yaml") == 0;
    memcpy(path, scene, folder);
    strcpy(path + folder, copy);
    if (!copied || access(path, F_OK) != 0) {
        if (name == NULL) {
            return NULL;
        }
        strcpy(path + (name[0] == '/' ? 0 : folder), name);
    }
    return path;
}

void weft__check_turn(weft__reader *reader, const weft__match *match, void *base)
{
    const double *turn = base; /* its axis is first */
    const weft__node *axis = weft__value_in(match, "axis");
    if (axis != NULL && !weft__found_in(match, "axis")->wrong
        && !weft__positive(weft__length(turn))) {
        ERROR_AT(reader, axis, "axis is [%g, %g, %g], which is no direction", turn[0],
                 turn[1], turn[2]);
    }
}

/* What the file does not show at once. */
static void note_file(weft__reader *reader, const weft__obj *obj)
{
    const double *warp = obj->warp;
    if (obj->welds) {
        weft__note_add(reader, "weld", "%zu of the file's %zu vertices became another",
                       obj->welded, obj->vertices);
    }
    if (obj->flat_rest) {
        weft__note_add(reader, "rest",
                       "no vt: v is flat and its own rest shape, warp along [%.4g, "
                       "%.4g, %.4g] of the file",
                       warp[0], warp[1], warp[2]);
    }
}

/* The keys about the rest shape. */
static void check_rest(weft__reader *reader, const weft__match *match,
                       const weft_rest *rest)
{
    const weft__node *warp = weft__value_in(match, "warp");
    const bool read = warp != NULL && !weft__found_in(match, "warp")->wrong;
    if (read && rest->shape == WEFT_REST_PLANE) {
        ERROR_AT(reader, weft__key_in(match, "warp"),
                 "warp needs rest: start; in the plane the warp lies along v");
    } else if (read && !weft__positive(weft__length(rest->warp))) {
        ERROR_AT(reader, warp, "warp is [%g, %g, %g], which is no direction",
                 rest->warp[0], rest->warp[1], rest->warp[2]);
    }
    if (reader->def->refine > 1 && rest->shape == WEFT_REST_START
        && rest->angle == WEFT_ANGLE_FLAT) {
        ERROR_AT(reader, weft__key_in(match, "angle"),
                 "a mesh with rest: start and angle: flat is not refined: the "
                 "triangles that it is divided into lie on its own, and their folds "
                 "stay; give finer files");
    }
}

void weft__check_mesh(weft__reader *reader, const weft__match *match, void *base)
{
    const weft__mesh_file *from = base;
    weft_scene *scene = reader->scene;
    const size_t before = reader->report->mistakes;
    scene->meshed = true;
    check_rest(reader, match, &from->rest);
    char *path = match->wrong || from->file == NULL
                     ? NULL
                     : weft__mesh_path(reader, from->file, NULL);
    if (path == NULL) {
        return;
    }
    scene->obj = (weft__obj){ .report = reader->report,
                              .at = weft__value_in(match, "file")->at,
                              .in_space = from->rest.shape == WEFT_REST_START,
                              .file.path = path,
                              .welds = weft__key_in(match, "weld") != NULL,
                              .weld = from->weld / from->unit };
    if (weft__obj_load(&scene->obj, path) && reader->report->mistakes == before) {
        note_file(reader, &scene->obj);
        scene->obj.def.rests = &from->rest;
        weft__obj_move(&scene->obj, from->unit, from->turn.axis, from->turn.angle,
                       from->at);
        if (weft__obj_refine(&scene->obj, reader->def->refine)) {
            scene->cloth.mesh = &scene->obj.def;
            scene->mesh_path = path;
        }
    }
}

/* ---- fabrics ------------------------------------------------------------------ */

/* Their names are the keys; the first of the array is left to `fabric`. */
void weft__read_fabrics(weft__reader *reader, const weft__key *key,
                        const weft__node *node, void *to)
{
    weft__fabrics *fabrics = to;
    if (node->type != WEFT__MAP || node->count > MOST_FABRICS) {
        weft__refuse_value(reader, key, node);
        return;
    }
    fabrics->list
        = weft__tree_take(reader->tree, node->count + 1, sizeof *fabrics->list);
    if (fabrics->list == NULL) {
        return;
    }
    fabrics->node = node;
    for (size_t i = 0; i < node->count; ++i) {
        const weft__entry *entry = &node->entries[i];
        const char *name = weft__text_of(entry->key);
        if (name == NULL || entry->value == NULL) {
            ERROR_AT(reader, entry->key,
                     "the name of a fabric, as of usemtl, must stand here");
        } else if (weft__find_key(node, name, entry->key->count) != i) {
            ERROR_AT(reader, entry->key, "duplicate fabric '%s'", name);
        } else {
            weft__read_section(reader, key->section, name, entry->value,
                               &fabrics->list[i + 1]);
        }
    }
}

/* The fabric of each statement usemtl; 0: that of all others. */
static void find_fabrics(weft__reader *reader, uint32_t *of)
{
    const weft__obj *obj = &reader->scene->obj;
    const weft__node *node = reader->scene->fabrics.node;
    for (size_t i = 0; i < node->count; ++i) {
        const weft__node *name = node->entries[i].key;
        if (!weft__obj_named(&obj->fabrics, name->text, name->count, of,
                             (uint32_t)(i + 1))) {
            char near[80];
            ERROR_AT(reader, name, "the mesh has no usemtl '%.60s'%s", name->text,
                     weft__obj_near(&obj->fabrics, name->text, near, sizeof near));
        }
    }
}

/* Gives each triangle its fabric. */
static void put_fabrics(weft__reader *reader)
{
    weft_scene *scene = reader->scene;
    weft__obj *obj = &scene->obj;
    scene->fabrics.list[0] = scene->fabric;
    obj->def.fabrics = scene->fabrics.list;
    obj->def.fabric_count = scene->fabrics.node->count + 1;
    uint32_t *of = weft__report_take(reader->report,
                                     (size_t)obj->fabrics.statements + 1, sizeof *of);
    obj->fabric_of
        = weft__report_take(reader->report, obj->def.triangles, sizeof *obj->fabric_of);
    if (of != NULL && obj->fabric_of != NULL) {
        find_fabrics(reader, of);
        for (size_t t = 0; t < obj->def.triangles; ++t) {
            obj->fabric_of[t] = of[obj->face[obj->face_of[t]].fabric];
        }
    }
    obj->def.fabric_of = obj->fabric_of;
    weft__free(reader->report->memory, of);
}

/* ---- the cloth ---------------------------------------------------------------- */

static void find_part(void *ctx, weft__mesh_part part, size_t index,
                      const char *message)
{
    const weft__match *cloth = ctx;
    weft_scene *scene = cloth->reader->scene;
    if (part == WEFT__MESH_FABRIC) {
        const weft__node *at = index == 0 ? weft__key_in(cloth, "fabric")
                                          : scene->fabrics.node->entries[index - 1].key;
        ERROR_AT(cloth->reader, at, "%s", message);
    } else {
        weft__obj_fault(&scene->obj, part, index, message);
    }
}

static void find_fault(void *ctx, size_t field, size_t other, const char *message)
{
    const weft__match *cloth = ctx;
    const bool held = field == offsetof(weft_cloth_def, pins);
    const weft__node *pins = weft__key_in(cloth, "pins");
    (void)other;
    ERROR_AT(cloth->reader, (held && pins != NULL ? pins : cloth->map), "%s", message);
}

void weft__check_grid_cloth(weft__reader *reader, const weft__match *cloth)
{
    static const char *const excluded[] = { "fabrics", "seams", "membrane", NULL };
    const weft__node *fabric = weft__value_in(cloth, "fabric");
    const size_t slot = fabric == NULL || fabric->type != WEFT__MAP
                            ? 0
                            : weft__find_key(fabric, "coupling", strlen("coupling"));
    (void)weft__report_excluded(reader, cloth, excluded, "needs a mesh of triangles");
    if (fabric != NULL && fabric->type == WEFT__MAP && slot < fabric->count) {
        ERROR_AT(reader, fabric->entries[slot].key,
                 "coupling needs a mesh of triangles: the springs of a grid "
                 "make it equal to shear");
    }
}

void weft__check_mesh_cloth(weft__reader *reader, const weft__match *cloth)
{
    static const char *const excluded[] = { "mass", "density", "springs", NULL };
    weft_scene *scene = reader->scene;
    (void)weft__report_excluded(reader, cloth, excluded,
                                "needs a grid: a mesh of triangles has a fabric");
    if (weft__lacks(cloth, "fabric")) {
        ERROR_AT(reader, cloth->map,
                 "%s lacks 'fabric', which a mesh of triangles is made of",
                 cloth->title);
    }
    if (scene->obj.in_space && weft__key_in(cloth, "seams") != NULL) {
        ERROR_AT(reader, weft__key_in(cloth, "seams"),
                 "rest: start has no panels: seams has nothing to act on");
    }
    if (scene->cloth.mesh == NULL || weft__key_in(cloth, "fabric") == NULL) {
        return;
    }
    if (scene->fabrics.node != NULL) {
        put_fabrics(reader);
    } else {
        scene->obj.def.fabrics = &scene->fabric;
        scene->obj.def.fabric_count = 1;
    }
    if (reader->report->mistakes == scene->mistakes && !reader->report->no_memory) {
        weft__mesh_check(&scene->cloth,
                         &(weft__mesh_faults){ find_part, (void *)cloth },
                         &(weft__faults){ find_fault, (void *)cloth }, NULL,
                         &reader->report->no_memory);
    }
    if (reader->report->mistakes == scene->mistakes && !reader->report->no_memory) {
        weft__warn_of_mesh(reader, cloth);
    }
}
