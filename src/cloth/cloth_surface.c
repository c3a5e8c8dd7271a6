/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth_surface.c -- what a cloth says of its particles, triangles and edges. */
#include "mesh/surface.h"

#include <stdio.h>
#include <string.h>

#include "cloth/model.h"

size_t weft_cloth_index(const weft_cloth *cloth, size_t vertex)
{
    return weft__meant(&cloth->mesh, vertex);
}

size_t weft_cloth_vertex(const weft_cloth *cloth, size_t index)
{
    return weft__shown(&cloth->mesh, index);
}

size_t weft_cloth_file_index(const weft_cloth *cloth, size_t vertex)
{
    const weft__triangles *of = cloth->mesh.triangles;
    return of != NULL && of->name != NULL ? of->name[vertex] : vertex;
}

size_t weft_cloth_parts(const weft_cloth *cloth)
{
    return cloth->mesh.triangles != NULL ? cloth->mesh.triangles->part_count : 0;
}

weft_cloth_part weft_cloth_part_at(const weft_cloth *cloth, size_t k)
{
    const weft__part *of = &cloth->mesh.triangles->parts[k];
    return (weft_cloth_part){ of->name,
                              of->first,
                              of->count,
                              { of->velocity[0], of->velocity[1], of->velocity[2] } };
}

size_t weft_cloth_part_find(const weft_cloth *cloth, const char *name)
{
    const size_t count = weft_cloth_parts(cloth);
    size_t k = 0;
    while (k < count && strcmp(cloth->mesh.triangles->parts[k].name, name) != 0) {
        ++k;
    }
    return k < count ? k : SIZE_MAX;
}

size_t weft_cloth_part_of(const weft_cloth *cloth, size_t vertex)
{
    const weft__triangles *of = cloth->mesh.triangles;
    return of != NULL ? weft__part_of(of, vertex) : 0;
}

size_t weft_cloth_triangles(const weft_cloth *cloth, uint32_t *corners)
{
    return weft__surface_triangles(&cloth->mesh, corners);
}

size_t weft_cloth_edges(const weft_cloth *cloth, uint32_t *ends)
{
    return weft__surface_edges(&cloth->mesh, ends);
}

size_t weft_cloth_uv(const weft_cloth *cloth, uint32_t *corner_uv, double *uv)
{
    return weft__surface_places(&cloth->mesh, corner_uv, uv);
}

size_t weft_cloth_panels(const weft_cloth *cloth, size_t *sewn, double *length)
{
    return weft__surface_pieces(&cloth->mesh, sewn, length);
}

const char *weft_cloth_text(const weft_cloth *cloth, char *text, size_t size)
{
    const weft__mesh *mesh = &cloth->mesh;
    if (mesh->triangles != NULL) {
        const size_t parts = mesh->triangles->part_count;
        char in[32] = "";
        if (parts > 0) {
            (void)snprintf(in, sizeof in, " in %zu cloth%s", parts,
                           parts > 1 ? "s" : "");
        }
        (void)weft_text_format(text, size, "%zu vertices, %zu triangles%s", mesh->whole,
                               mesh->whole_of != NULL
                                   ? mesh->triangles->all
                                   : weft__surface_triangles(mesh, NULL),
                               in);
    } else {
        (void)weft_text_format(text, size, "%zu x %zu particles", mesh->band.rows,
                               mesh->cols);
    }
    return text;
}

const char *weft_particle_text(const weft_cloth *cloth, size_t i, char *text,
                               size_t size)
{
    return weft__particle_name(&cloth->mesh, i, text, size);
}

const char *weft_spring_text(const weft_cloth *cloth, const weft_spring *spring,
                             char *text, size_t size)
{
    char p[WEFT__NAME_TEXT], q[WEFT__NAME_TEXT], of[WEFT__CLOTH_TEXT];
    const bool grid = cloth->mesh.triangles == NULL
                      || weft__grid_at(&cloth->mesh, spring->p) != NULL;
    (void)weft_text_format(
        text, size, "%s%s %s-%s%s", grid ? weft_family_name(spring->family) : "",
        grid ? " spring" : "edge", weft__name_text(&cloth->mesh, spring->p, p),
        weft__name_text(&cloth->mesh, spring->q, q),
        weft__cloth_name(&cloth->mesh, spring->p, of));
    return text;
}

const char *weft_primitive_text(const weft_cloth *cloth,
                                const weft_primitive *primitive, char *text,
                                size_t size)
{
    return weft__primitive_text(&cloth->mesh, primitive, text, size);
}
