/* SPDX-License-Identifier: BSD-3-Clause */
#include "program/loose.h"

#include <stdlib.h>
#include <string.h>

static size_t part_end(const record_faces *of, size_t part)
{
    return part + 1 < of->part_count ? of->parts[part + 1].first : of->particles;
}

/* Merges particles of a part and its loose vertices by their numbers in the file, from
 * `next` on, with `before` loose ones in the parts before. Returns the end. */
static size_t merge_part(const weft_scene *scene, const record_faces *cloth,
                         size_t part, size_t next, size_t before, loose_surface *out)
{
    const size_t *names;
    const double *places;
    const size_t count = weft_scene_loose(scene, part, &names, &places);
    const size_t first = cloth->part_count > 0 ? cloth->parts[part].first : 0;
    const size_t end = part_end(cloth, part);
    for (size_t i = first, k = 0; i < end || k < count; ++next) {
        if (k == count || (i < end && record_name(cloth, i) < names[k])) {
            out->from[next] = i++;
        } else {
            memcpy(&out->places[3 * (before + k)], &places[3 * k], 3 * sizeof *places);
            out->from[next] = cloth->particles + before + k++;
        }
    }
    return next;
}

/* The corners of all triangles by the new numbers. */
static bool renumber(const record_faces *cloth, loose_surface *out)
{
    record_faces *faces = &out->faces;
    uint32_t *number = malloc((cloth->particles + out->count) * sizeof *number);
    faces->corners = malloc(3 * cloth->triangles * sizeof *faces->corners);
    if (number == NULL || faces->corners == NULL) {
        free(number);
        return false;
    }
    for (size_t i = 0; i < faces->particles; ++i) {
        number[out->from[i]] = (uint32_t)i;
    }
    for (size_t j = 0; j < 3 * cloth->triangles; ++j) {
        faces->corners[j] = number[cloth->corners[j]];
    }
    free(number);
    return true;
}

weft_status loose_create(const weft_scene *scene, const record_faces *cloth,
                         loose_surface *out, weft_error *err)
{
    const size_t parts = cloth->part_count > 0 ? cloth->part_count : 1;
    *out = (loose_surface){ .faces = *cloth };
    out->faces.corners = NULL, out->faces.parts = NULL, out->faces.names = NULL;
    for (size_t k = 0; scene != NULL && cloth->cols == 0 && k < parts; ++k) {
        out->count += weft_scene_loose(scene, k, NULL, NULL);
    }
    if (out->count == 0) {
        return WEFT_OK;
    }
    const size_t all = out->faces.particles = cloth->particles + out->count;
    out->from = calloc(all, sizeof *out->from);
    out->places = malloc(3 * out->count * sizeof *out->places);
    out->position = malloc(3 * all * sizeof *out->position);
    out->faces.parts = calloc(parts, sizeof *out->faces.parts);
    if (out->from == NULL || out->places == NULL || out->position == NULL
        || out->faces.parts == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu vertices", all);
    }
    for (size_t k = 0, next = 0, before = 0; k < parts; ++k) {
        if (cloth->part_count > 0) {
            out->faces.parts[k] = cloth->parts[k];
            out->faces.parts[k].first = next;
        }
        next = merge_part(scene, cloth, k, next, before, out);
        before += weft_scene_loose(scene, k, NULL, NULL);
    }
    return renumber(cloth, out)
               ? WEFT_OK
               : weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu vertices", all);
}

void loose_free(loose_surface *of)
{
    free(of->from);
    free(of->places);
    free(of->position);
    free(of->faces.corners);
    free(of->faces.parts);
    *of = (loose_surface){ .count = 0 };
}

record_surface loose_add(loose_surface *of, const record_surface *cloth)
{
    const size_t particles = of->faces.particles - of->count;
    for (size_t i = 0; i < of->faces.particles; ++i) {
        const size_t from = of->from[i];
        const double *x = from < particles ? &cloth->position[3 * from]
                                           : &of->places[3 * (from - particles)];
        memcpy(&of->position[3 * i], x, 3 * sizeof *x);
    }
    return (record_surface){ .faces = of->faces,
                             .position = of->position,
                             .doubles = cloth->doubles };
}
