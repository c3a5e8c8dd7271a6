/* SPDX-License-Identifier: BSD-3-Clause */
/* export_csv.c -- writes one state as CSV and reads it back. */
#include "program/record/export/export.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "program/record/result.h"

#define GRID_HEADER "row,col,x,y,z"
#define MESH_HEADER "vertex,x,y,z"
#define VELOCITY    ",vx,vy,vz"
#define CLOTH       "cloth," /* before the vertex, of several */

static void write_vector(FILE *stream, const double *v, bool doubles)
{
    for (size_t k = 0; k < 3; ++k) {
        fprintf(stream, ",%.*g", doubles ? 17 : 9, v[k]);
    }
}

void record_csv(FILE *stream, const record_surface *surface)
{
    const record_faces *faces = &surface->faces;
    fprintf(stream, "%s%s%s\n", faces->part_count > 0 ? CLOTH : "",
            faces->cols > 0 ? GRID_HEADER : MESH_HEADER,
            surface->velocity == NULL ? "" : VELOCITY);
    for (size_t i = 0; i < faces->particles; ++i) {
        if (faces->cols > 0) {
            fprintf(stream, "%zu,%zu", i / faces->cols, i % faces->cols);
        } else {
            fprintf(stream, "%s%s%zu",
                    faces->part_count > 0 ? faces->parts[record_part_of(faces, i)].name
                                          : "",
                    faces->part_count > 0 ? "," : "", record_name(faces, i));
        }
        write_vector(stream, &surface->position[3 * i], surface->doubles);
        if (surface->velocity != NULL) {
            write_vector(stream, &surface->velocity[3 * i], surface->doubles);
        }
        fputc('\n', stream);
    }
}

static bool read_row(FILE *stream, const record_faces *faces, size_t i, double *x,
                     double *v)
{
    size_t row = 0, col = 0;
    char cloth[WEFT_CLOTH_NAME_MAX + 1];
    if (faces->part_count > 0
        && (fscanf(stream, " %40[^,],", cloth) != 1
            || strcmp(cloth, faces->parts[record_part_of(faces, i)].name) != 0)) {
        return false;
    }
    const bool named
        = faces->cols > 0
              ? fscanf(stream, "%zu,%zu", &row, &col) == 2 && row == i / faces->cols
                    && col == i % faces->cols
              : fscanf(stream, "%zu", &row) == 1 && row == record_name(faces, i);
    return named
           && fscanf(stream, ",%lf,%lf,%lf,%lf,%lf,%lf", &x[0], &x[1], &x[2], &v[0],
                     &v[1], &v[2])
                  == 6;
}

static weft_status read_state(const char *directory, const record_faces *faces,
                              double *position, double *velocity, weft_error *err)
{
    char path[RECORD_PATH];
    const char *wanted = faces->part_count > 0 ? CLOTH MESH_HEADER VELOCITY "\n"
                         : faces->cols > 0     ? GRID_HEADER VELOCITY "\n"
                                               : MESH_HEADER VELOCITY "\n";
    char header[sizeof CLOTH GRID_HEADER VELOCITY "\n"];
    weft_status status = WEFT_OK;
    FILE *stream = record_open(directory, "final.csv", path, err);
    if (stream == NULL) {
        return WEFT_IO;
    }
    if (fgets(header, sizeof header, stream) == NULL || strcmp(header, wanted) != 0) {
        status = weft_error_set(err, WEFT_IO, "%s: not a state: line 1", path);
    }
    for (size_t i = 0; status == WEFT_OK && i < faces->particles; ++i) {
        if (!read_row(stream, faces, i, &position[3 * i], &velocity[3 * i])) {
            status
                = weft_error_set(err, WEFT_IO, "%s: damaged at line %zu", path, i + 2);
        }
    }
    (void)fclose(stream);
    return status;
}

static weft_status check_hash(const char *directory, const record_faces *faces,
                              const weft_cloth *cloth, const double *position,
                              const double *velocity, weft_error *err)
{
    const size_t n = faces->particles;
    uint64_t recorded = 0;
    double *y = malloc(6 * n * sizeof *y);
    if (y == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state");
    }
    for (size_t i = 0; i < 3 * n; ++i) { /* planes */
        const size_t at = cloth == NULL ? i / 3 : weft_cloth_index(cloth, i / 3);
        y[i % 3 * n + at] = position[i];
        y[(3 + i % 3) * n + at] = velocity[i];
    }
    const uint64_t hash = cloth == NULL ? weft_state_hash(y, faces->rows, faces->cols)
                                        : weft_cloth_state_hash(cloth, y);
    free(y);
    return record_result_hash(directory, &recorded) && hash == recorded
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO,
                                "%s/final.csv: damaged: its state has hash %016" PRIx64
                                ", that of result.yaml %016" PRIx64
                                ": other versions? see manifest.yaml",
                                directory, hash, recorded);
}

weft_status record_final_read(const char *directory, const record_faces *faces,
                              const weft_cloth *cloth, double *position,
                              double *velocity, weft_error *err)
{
    TRY(read_state(directory, faces, position, velocity, err));
    return check_hash(directory, faces, cloth, position, velocity, err);
}
