/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_cloths.c -- several cloths: each is read as the cloth of a scene of its own,
 * then all of them become one mesh of named parts, some of which may be grids. */
#include <string.h>

#include "base/name.h"
#include "cloth/model.h"
#include "mesh/grid_def.h"
#include "scene/checks.h"

/* ---- one of them --------------------------------------------------------------- */

void weft__scene_begin(weft_scene *scene)
{
    scene->cloth.struct_size = sizeof scene->cloth;
    scene->cloth.load_size = sizeof(weft_load);
    scene->cloth.pin_size = sizeof(weft_pin);
    scene->cloth.shape_size = sizeof(weft_shape);
}

static void check_name(weft__reader *reader, const weft__match *match)
{
    const weft__node *name = weft__value_in(match, "name");
    if (name != NULL && !weft__found_in(match, "name")->wrong
        && !WEFT__IS_CLOTH_NAME(reader->scene->part_name)) {
        ERROR_AT(reader, name,
                 "'%.60s' is no name of a cloth: 1 to %d letters, digits, _ and -",
                 reader->scene->part_name, WEFT_CLOTH_NAME_MAX);
    }
}

void weft__check_part(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_cloth_def *cloth = base;
    check_name(reader, match);
    weft__check_cloth(reader, match, base);
    if (reader->def->refine > 1 && !reader->scene->meshed) {
        ERROR_AT(reader, match->map,
                 "a grid among several cloths is not refined: weft converge takes "
                 "meshes and cuts, or one grid as cloth");
    }
    if (!reader->scene->meshed && (cloth->rows == 1 || cloth->cols == 1)) {
        ERROR_AT(reader,
                 weft__value_of(weft__value_in(match, "grid"),
                                cloth->rows == 1 ? "rows" : "cols"),
                 "a grid of %zu x %zu has no triangles, by which it touches other "
                 "cloths: among several it has 2 rows and 2 columns or more",
                 cloth->rows, cloth->cols);
    }
}

/* The first one that is no grid, or the last one. */
static const weft_scene *first_mesh(const weft_scene *scene)
{
    size_t k = 0;
    while (k + 1 < scene->part_count && !scene->parts[k].meshed) {
        ++k;
    }
    return &scene->parts[k];
}

/* Keys of one mesh, which its parts must agree on: at the second of two that do not. */
static void check_same(weft__reader *reader, const weft__node *node, const char *key,
                       size_t part, bool differs)
{
    const weft__node *value = weft__value_of(node, key);
    if (differs) {
        ERROR_AT(reader, (value == NULL ? node : value),
                 "%s of cloths[%zu] differs from that of cloths[%zu]: it is the same "
                 "for all meshes",
                 key, part, (size_t)(first_mesh(reader->scene) - reader->scene->parts));
    }
}

static void check_pair(weft__reader *reader, const weft__node *list, size_t part)
{
    const weft_scene *all = reader->scene->parts, *own = &all[part];
    const weft__node *node = weft__item(list, part);
    for (size_t i = 0; i < part; ++i) {
        if (own->part_name != NULL && all[i].part_name != NULL
            && strcmp(all[i].part_name, own->part_name) == 0) {
            ERROR_AT(reader, weft__value_of(node, "name"),
                     "cloths[%zu] is called '%.60s' too", i, own->part_name);
        }
    }
    const weft_mesh_def *first = &first_mesh(reader->scene)->obj.def;
    if (own->meshed) {
        check_same(reader, node, "seams", part, own->obj.def.seams != first->seams);
        check_same(reader, node, "membrane", part, own->obj.def.arc != first->arc);
    }
}

static void read_part(weft__reader *reader, const weft__key *key,
                      const weft__node *node, size_t index)
{
    char title[32];
    weft_scene *part = &reader->scene->parts[index];
    weft__reader own = *reader;
    (void)snprintf(title, sizeof title, "cloths[%zu]", index);
    weft__scene_begin(part);
    part->meshed = weft__value_of(node, "grid") == NULL;
    part->part = index + 1;
    part->mistakes = reader->report->mistakes;
    own.scene = part;
    weft__read_section(&own, key->section, title, node, &part->cloth);
    weft__obj_forget(&part->obj);
}

/* ---- all of them ---------------------------------------------------------------- */

/* What a pin or a load is on: vertices of a mesh, or rows and columns of a grid, as
 * vertices that are `first` higher, of the tree. */
static weft__vertices shifted(weft__reader *reader, const weft_cloth_def *of,
                              weft__vertices from, const weft__place *place,
                              size_t first)
{
    size_t row[2] = { 0, 0 }, col[2] = { 0, 0 }, wide = 1;
    if (of->mesh == NULL) {
        (void)weft__range_resolve(place->rows, of->rows, &row[0], &row[1]);
        (void)weft__range_resolve(place->cols, of->cols, &col[0], &col[1]);
        wide = col[1] + 1 - col[0];
        from.count = (row[1] + 1 - row[0]) * wide;
    }
    size_t *to = weft__tree_take(reader->tree, from.count, sizeof *to);
    for (size_t i = 0; to != NULL && i < from.count; ++i) {
        to[i]
            = first
              + (of->mesh != NULL ? from.list[i]
                                  : (row[0] + i / wide) * of->cols + col[0] + i % wide);
    }
    return (weft__vertices){ to, to != NULL ? from.count : 0 };
}

/* The pins and loads of a part behind those that are there. */
static void add_held(weft__reader *reader, const weft_cloth_def *from, size_t first)
{
    weft_cloth_def *to = &reader->scene->cloth;
    weft_pin *pins = (weft_pin *)to->pins + to->pin_count;
    weft_load *loads = (weft_load *)to->loads + to->load_count;
    for (size_t i = 0; i < from->pin_count; ++i) {
        const weft_pin *pin = &from->pins[i];
        const weft__vertices of = shifted(
            reader, from, (weft__vertices){ pin->vertices, pin->vertex_count },
            &(weft__place){ pin->rows, pin->cols }, first);
        pins[i] = *pin;
        pins[i].vertices = of.list, pins[i].vertex_count = of.count;
    }
    for (size_t i = 0; i < from->load_count; ++i) {
        const weft_load *load = &from->loads[i];
        const weft__vertices of = shifted(
            reader, from, (weft__vertices){ load->vertices, load->vertex_count },
            &(weft__place){ load->rows, load->cols }, first);
        loads[i] = *load;
        loads[i].vertices = of.list, loads[i].vertex_count = of.count;
    }
    to->pin_count += from->pin_count;
    to->load_count += from->load_count;
}

/* The mesh of a part behind those that are there. */
static void add_mesh(weft__obj *to, const weft_mesh_def *from, weft_fabric *fabrics)
{
    weft_mesh_def *def = &to->def;
    memcpy(to->start + 3 * def->vertices, from->start,
           3 * from->vertices * sizeof *to->start);
    memcpy(to->space + 3 * def->vertices,
           from->space != NULL ? from->space : from->start,
           3 * from->vertices * sizeof *to->space);
    if (from->uv_count > 0) {
        memcpy(to->rest + 2 * def->uv_count, from->rest,
               2 * from->uv_count * sizeof *to->rest);
    }
    for (size_t i = 0; i < from->vertices; ++i) {
        to->name[def->vertices + i]
            = from->file_index != NULL ? from->file_index[i] : i;
    }
    for (size_t j = 0; j < 3 * from->triangles; ++j) {
        const size_t at = 3 * def->triangles + j;
        to->corner[at] = from->corners[j] + (uint32_t)def->vertices;
        to->corner_place[at] = (from->corner_uv != NULL ? from->corner_uv[j] : 0)
                               + (uint32_t)def->uv_count;
        to->fabric_of[at / 3]
            = (uint32_t)def->fabric_count
              + (from->fabric_of != NULL ? from->fabric_of[j / 3] : 0);
    }
    memcpy(fabrics + def->fabric_count, from->fabrics,
           from->fabric_count * sizeof *fabrics);
    def->vertices += from->vertices;
    def->uv_count += from->uv_count;
    def->triangles += from->triangles;
    def->fabric_count += from->fabric_count;
}

/* Room for all. false: they are too many, or no memory. */
static bool scene_cloths_make_room(weft__reader *reader, const weft__node *node,
                                   weft_fabric **fabrics, weft_cloth_part **parts)
{
    weft_scene *scene = reader->scene;
    weft__obj *obj = &scene->obj;
    weft__report *report = reader->report;
    size_t vertices = 0, places = 0, triangles = 0, own = 0, pins = 0, loads = 0;
    for (size_t i = 0; i < scene->part_count; ++i) {
        const weft_cloth_def *from = &scene->parts[i].cloth;
        vertices += weft__particles_in(&scene->parts[i]);
        places += from->mesh != NULL ? from->mesh->uv_count : 0;
        triangles += from->mesh != NULL ? from->mesh->triangles : 0;
        own += from->mesh != NULL ? from->mesh->fabric_count : 0;
        pins += from->pin_count;
        loads += from->load_count;
    }
    if (places > UINT32_MAX || triangles > UINT32_MAX / 3) {
        ERROR_AT(reader, node, "%zu triangles in all are too many", triangles);
        return false;
    }
    obj->start = weft__report_take(report, vertices, 3 * sizeof *obj->start);
    obj->space = weft__report_take(report, vertices, 3 * sizeof *obj->space);
    obj->name = weft__report_take(report, vertices, sizeof *obj->name);
    obj->rest = weft__report_take(report, places, 2 * sizeof *obj->rest);
    obj->corner = weft__report_take(report, triangles, 3 * sizeof *obj->corner);
    obj->corner_place
        = weft__report_take(report, triangles, 3 * sizeof *obj->corner_place);
    obj->fabric_of = weft__report_take(report, triangles, sizeof *obj->fabric_of);
    *fabrics = weft__tree_take(reader->tree, own, sizeof **fabrics);
    *parts = weft__tree_take(reader->tree, scene->part_count, sizeof **parts);
    scene->cloth.pins = weft__tree_take(reader->tree, pins, sizeof(weft_pin));
    scene->cloth.loads = weft__tree_take(reader->tree, loads, sizeof(weft_load));
    return !report->no_memory;
}

static void join(weft__reader *reader, const weft__node *node)
{
    weft_scene *scene = reader->scene;
    weft__obj *obj = &scene->obj;
    weft_fabric *fabrics;
    weft_cloth_part *parts;
    const weft_cloth_def **grids
        = weft__tree_take(reader->tree, scene->part_count, sizeof *grids);
    weft_rest *rests = weft__tree_take(reader->tree, scene->part_count, sizeof *rests);
    const weft_scene *mesh = first_mesh(scene);
    if (!scene_cloths_make_room(reader, node, &fabrics, &parts) || grids == NULL
        || rests == NULL) {
        return;
    }
    obj->def = weft_mesh_def_default();
    obj->def.seams = mesh->obj.def.seams;
    obj->def.arc = mesh->obj.def.arc;
    for (size_t i = 0; i < scene->part_count; ++i) {
        const weft_scene *part = &scene->parts[i];
        parts[i] = (weft_cloth_part){ .name = part->part_name,
                                      .first = obj->def.vertices,
                                      .count = weft__particles_in(part) };
        memcpy(parts[i].velocity, part->cloth.velocity, sizeof parts[i].velocity);
        add_held(reader, &part->cloth, obj->def.vertices);
        grids[i] = part->cloth.mesh == NULL ? &part->cloth : NULL;
        rests[i] = part->mesh_file.rest;
        if (part->cloth.mesh != NULL) {
            add_mesh(obj, part->cloth.mesh, fabrics);
            continue;
        }
        weft__mesh grid = { .rows = 0 };
        weft__grid_init(&grid, &part->cloth);
        for (size_t k = 0; k < parts[i].count; ++k, ++obj->def.vertices) {
            weft__grid_start(&grid, k, &obj->start[3 * obj->def.vertices]);
            obj->name[obj->def.vertices] = k;
        }
        obj->def.grids = grids;
    }
    weft__obj_show(obj);
    obj->def.fabrics = fabrics;
    obj->def.rests = rests;
    obj->def.parts = parts;
    obj->def.part_count = scene->part_count;
    scene->cloth.mesh = &obj->def;
    scene->fabric = mesh->fabric;
    weft__warn_of_held(reader, node);
}

void weft__read_cloths(weft__reader *reader, const weft__key *key,
                       const weft__node *node, void *to)
{
    weft_scene *scene = reader->scene;
    const size_t before = reader->report->mistakes, count = weft__item_count(node);
    scene->meshed = true;
    if (count == 0 || count > WEFT_CLOTHS_MAX) {
        weft__refuse_value(reader, key, node);
        return;
    }
    weft_scene *parts = weft__tree_take(reader->tree, count, sizeof *parts);
    if (parts == NULL) {
        return;
    }
    memcpy(to, &parts, sizeof parts);
    scene->part_count = count;
    for (size_t i = 0; i < count; ++i) {
        read_part(reader, key, weft__item(node, i), i);
        check_pair(reader, node, i);
    }
    const bool alone = scene->obj.report == NULL; /* no mesh of `cloth` beside them */
    if (alone && reader->report->mistakes == before && !reader->report->no_memory) {
        join(reader, node);
    }
}
