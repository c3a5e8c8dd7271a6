/* SPDX-License-Identifier: BSD-3-Clause */
#include "program/record/frames.h"

#include <stdlib.h>
#include <string.h>

static bool take_names(const weft_cloth *cloth, record_faces *out)
{
    bool other = false;
    out->names = malloc(out->particles * sizeof *out->names);
    for (size_t i = 0; out->names != NULL && i < out->particles; ++i) {
        out->names[i] = (int64_t)weft_cloth_file_index(cloth, i);
        other = other || (size_t)out->names[i] != i;
    }
    if (out->names != NULL && !other) {
        free(out->names);
        out->names = NULL;
        return true;
    }
    return other;
}

static bool take_parts(const weft_cloth *cloth, record_faces *out)
{
    out->part_count = weft_cloth_parts(cloth);
    out->parts = calloc(out->part_count + 1, sizeof *out->parts);
    for (size_t i = 0; out->parts != NULL && i < out->part_count; ++i) {
        const weft_cloth_part part = weft_cloth_part_at(cloth, i);
        strcpy(out->parts[i].name, part.name);
        out->parts[i].first = part.first;
    }
    return out->parts != NULL;
}

weft_status record_faces_of(const weft_cloth *cloth, record_faces *out, weft_error *err)
{
    if (weft_cloth_cols(cloth) > 0) {
        *out = record_grid(weft_cloth_band(cloth).rows, weft_cloth_cols(cloth));
        return WEFT_OK;
    }
    *out = (record_faces){ .particles = weft_cloth_particles(cloth),
                           .triangles = weft_cloth_triangles(cloth, NULL),
                           .places = weft_cloth_uv(cloth, NULL, NULL) };
    out->corners = malloc(3 * out->triangles * sizeof *out->corners);
    out->corner_uv = malloc(3 * out->triangles * sizeof *out->corner_uv);
    out->uv = malloc(2 * out->places * sizeof *out->uv);
    if (out->corners == NULL || out->corner_uv == NULL || out->uv == NULL
        || !take_names(cloth, out) || !take_parts(cloth, out)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for triangles");
    }
    (void)weft_cloth_triangles(cloth, out->corners);
    (void)weft_cloth_uv(cloth, out->corner_uv, out->uv);
    return WEFT_OK;
}

void record_faces_free(record_faces *of)
{
    free(of->corners);
    free(of->corner_uv);
    free(of->uv);
    free(of->names);
    free(of->parts);
    *of = (record_faces){ .particles = 0 };
}

bool record_faces_same(const record_faces *a, const record_faces *b)
{
    return a->particles == b->particles && a->rows == b->rows && a->cols == b->cols
           && a->triangles == b->triangles
           && (a->triangles == 0
               || memcmp(a->corners, b->corners, 3 * a->triangles * sizeof *a->corners)
                      == 0);
}

const char *record_faces_text(const record_faces *of, char text[RECORD_FACES_TEXT])
{
    if (of->cols > 0) {
        (void)snprintf(text, RECORD_FACES_TEXT, "%zu x %zu particles", of->rows,
                       of->cols);
    } else {
        (void)snprintf(text, RECORD_FACES_TEXT, "%zu vertices, %zu triangles",
                       of->particles, of->triangles);
    }
    return text;
}

const char *record_particle_text(const record_faces *of, size_t i,
                                 char text[RECORD_FACES_TEXT])
{
    if (of->cols > 0) {
        (void)snprintf(text, RECORD_FACES_TEXT, "particle (%zu, %zu)", i / of->cols,
                       i % of->cols);
    } else {
        const bool named = of->part_count > 0;
        (void)snprintf(text, RECORD_FACES_TEXT, "vertex %zu%s%s", record_name(of, i),
                       named ? " of " : "",
                       named ? of->parts[record_part_of(of, i)].name : "");
    }
    return text;
}

weft_status record_faces_differ(const char *a_directory, const record_faces *a,
                                const char *b_directory, const record_faces *b,
                                weft_status status, weft_error *err)
{
    char text[2][RECORD_FACES_TEXT];
    if (a->cols > 0 && b->cols > 0) {
        return weft_error_set(err, status,
                              "runs of different grids: %s has %zu x %zu particles, %s "
                              "%zu x %zu",
                              a_directory, a->rows, a->cols, b_directory, b->rows,
                              b->cols);
    }
    return weft_error_set(err, status, "runs of different cloths: %s has %s, %s %s",
                          a_directory, record_faces_text(a, text[0]), b_directory,
                          record_faces_text(b, text[1]));
}
