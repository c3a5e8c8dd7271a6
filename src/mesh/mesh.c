/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh.c -- what is asked of both kinds of mesh. */
#include <string.h>

#include "mesh/blocks.h"
#include "mesh/grid_def.h"
#include "mesh/triangles_work.h"

void weft__mesh_init(weft__mesh *mesh, const weft_cloth_def *def,
                     struct weft__triangles *triangles)
{
    if (triangles == NULL) {
        weft__grid_init(mesh, def);
        return;
    }
    mesh->triangles = triangles;
    mesh->particles = mesh->stride = mesh->whole = def->mesh->vertices;
    mesh->block = WEFT__MESH_BLOCK;
    mesh->band = (weft_band){ .rows = weft__blocks(mesh), .own = weft__blocks(mesh) };
    memcpy(mesh->velocity, def->velocity, sizeof mesh->velocity);
}

static void fill_triangles(weft__mesh *mesh, const weft_cloth_def *def)
{
    weft__triangles_masses(mesh->triangles, def, mesh->mass);
    for (size_t i = 0; i < def->pin_count; ++i) {
        const weft_pin *pin = &def->pins[i];
        for (size_t k = 0; k < pin->vertex_count; ++k) {
            mesh->pin[weft__particle_of(mesh, pin->vertices[k])] = (uint32_t)(i + 1);
        }
    }
}

void weft__mesh_fill(weft__mesh *mesh, const weft_cloth_def *def, double *rows)
{
    if (mesh->triangles == NULL) {
        weft__grid_fill(mesh, def);
    } else {
        fill_triangles(mesh, def);
    }
    for (size_t i = 0; i < def->pin_count; ++i) {
        mesh->motions[i] = weft__pin_motion(&def->pins[i], rows);
        rows += WEFT__CURVE_WIDTH * def->pins[i].path.count;
    }
    mesh->motions[def->pin_count] = (weft__motion){ .moves = true, .coasts = true };
    for (size_t i = 0; i < mesh->particles; ++i) {
        mesh->pinned += mesh->pin[i] != 0;
    }
}

void weft__start_position(const weft__mesh *mesh, size_t i, double x[3])
{
    if (mesh->triangles == NULL) {
        weft__grid_start(mesh, i, x);
    } else {
        memcpy(x, &mesh->triangles->start[3 * i], 3 * sizeof *x);
    }
}

const double *weft__start_velocity(const weft__mesh *mesh, size_t i)
{
    const weft__triangles *of = mesh->triangles;
    return of == NULL || of->part_count == 0
               ? mesh->velocity
               : of->parts[weft__part_of(of, weft__whole_index(mesh, i))].velocity;
}

double weft__area(const weft__mesh *mesh, size_t i)
{
    return mesh->triangles == NULL ? weft__grid_area(mesh, i)
                                   : mesh->triangles->lumped[i];
}

void weft__rest_positions(const weft__mesh *mesh, double *xyz)
{
    for (size_t i = 0; i < mesh->particles; ++i) {
        double *x = &xyz[3 * weft__shown(mesh, i)];
        const weft__part *part = weft__grid_at(mesh, i);
        if (part != NULL) {
            weft__grid_rest(&part->grid, i - part->first, x);
        } else if (mesh->triangles == NULL) {
            weft__grid_rest(mesh, i, x);
        } else {
            weft__start_position(mesh, i, x);
        }
    }
}

void weft__def_start(const weft_mesh_def *def, size_t vertex, double x[3])
{
    const weft_cloth_def *grid = weft__grid_with(def, vertex);
    if (grid != NULL) {
        weft__mesh of = { .rows = 0 };
        weft__grid_init(&of, grid);
        weft__grid_start(&of, vertex - def->parts[weft__part_at(def, vertex)].first, x);
    } else {
        memcpy(x, &def->start[3 * vertex], 3 * sizeof *x);
    }
}

size_t weft__pin_of(const weft_cloth_def *def, size_t particle)
{
    if (def->mesh == NULL) {
        return weft__grid_pin_of(def, particle / def->cols, particle % def->cols);
    }
    for (size_t i = def->pin_count; i > 0; --i) {
        const weft_pin *pin = &def->pins[i - 1];
        for (size_t k = 0; k < pin->vertex_count; ++k) {
            if (pin->vertices[k] == particle) {
                return i;
            }
        }
    }
    return 0;
}

const char *weft__particle_text(const weft_cloth_def *def, size_t particle, char *text,
                                size_t size)
{
    const weft_mesh_def *mesh = def->mesh;
    const weft_cloth_def *grid = mesh == NULL ? def : weft__grid_with(mesh, particle);
    if (grid != NULL) {
        const weft_cloth_part *part
            = mesh == NULL ? NULL : &mesh->parts[weft__part_at(mesh, particle)];
        const size_t i = particle - (part != NULL ? part->first : 0);
        (void)weft_text_format(text, size, "particle (%zu, %zu)%s%s", i / grid->cols,
                               i % grid->cols, part != NULL ? " of " : "",
                               part != NULL ? part->name : "");
    } else {
        const bool of = mesh->part_count > 0;
        (void)weft_text_format(
            text, size, "vertex %zu%s%s",
            mesh->file_index != NULL ? mesh->file_index[particle] : particle,
            of ? " of " : "",
            of ? mesh->parts[weft__part_at(mesh, particle)].name : "");
    }
    return text;
}
