/* SPDX-License-Identifier: BSD-3-Clause */
/* fit_data.c -- tracks of particles, a point a line: time,row,col,x,y,z or, of a mesh,
 * time,vertex,x,y,z. A coordinate that is empty is missing. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/fit/fit.h"

enum { MOST_CELLS = 6 };

typedef struct table {
    const char *file;
    FILE *stream;
    char line[512];
    size_t number, cells;
    char *cell[MOST_CELLS];
    size_t *particle_of, names; /* of a vertex' number; SIZE_MAX: none */
} table;

static weft_status wrong(const table *of, const char *why, weft_error *err)
{
    return weft_error_set(err, WEFT_IO, "%.200s:%zu: %s", of->file, of->number, why);
}

/* Splits the next line that is not blank; WEFT_STOPPED: there is none. */
static weft_status next_line(table *of, weft_error *err)
{
    do {
        ++of->number;
        if (fgets(of->line, sizeof of->line, of->stream) == NULL) {
            return ferror(of->stream) ? record_failed(of->file, err) : WEFT_STOPPED;
        }
        if (strlen(of->line) + 1 == sizeof of->line) {
            return wrong(of, "a line of more than 510 characters", err);
        }
        of->line[strcspn(of->line, "\r\n")] = '\0';
    } while (of->line[strspn(of->line, " \t")] == '\0');
    of->cells = 0;
    for (char *at = of->line; at != NULL; ++of->cells) {
        if (of->cells < MOST_CELLS) {
            of->cell[of->cells] = at;
        }
        at = strchr(at, ',');
        if (at != NULL) {
            *at++ = '\0';
        }
    }
    return WEFT_OK;
}

static weft_status read_header(table *of, size_t cols, weft_error *err)
{
    static const char *const grid[] = { "time", "row", "col", "x", "y", "z" };
    static const char *const mesh[] = { "time", "vertex", "x", "y", "z" };
    const char *const *names = cols > 0 ? grid : mesh;
    const size_t count = cols > 0 ? 6 : 5;
    const weft_status status = next_line(of, err);
    bool same = status == WEFT_OK && of->cells == count;
    for (size_t i = 0; same && i < count; ++i) {
        same = strcmp(of->cell[i], names[i]) == 0;
    }
    return same ? WEFT_OK
           : status != WEFT_OK && status != WEFT_STOPPED
               ? status
               : wrong(of,
                       cols > 0 ? "the first line must be time,row,col,x,y,z"
                                : "the first line must be time,vertex,x,y,z",
                       err);
}

/* By the names that files have of vertices. */
static weft_status name_vertices(table *of, const weft_cloth *cloth, weft_error *err)
{
    const size_t n = weft_cloth_particles(cloth);
    for (size_t i = 0; i < n; ++i) {
        const size_t name = weft_cloth_name(cloth, i);
        of->names = name < of->names ? of->names : name + 1;
    }
    of->particle_of = malloc(of->names * sizeof *of->particle_of);
    if (of->particle_of == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the data");
    }
    memset(of->particle_of, 0xff, of->names * sizeof *of->particle_of);
    for (size_t i = 0; i < n; ++i) {
        of->particle_of[weft_cloth_name(cloth, i)] = i;
    }
    return WEFT_OK;
}

static weft_status find_particle(const table *of, const weft_cloth *cloth, size_t *out,
                                 weft_error *err)
{
    const size_t rows = weft_cloth_rows(cloth), cols = weft_cloth_cols(cloth);
    size_t at, col = 0;
    const bool is = option_count(of->cell[1], '\0', &at)
                    && (cols == 0 || option_count(of->cell[2], '\0', &col));
    if (cols > 0) {
        *out = at * cols + col;
        return is && at < rows && col < cols
                   ? WEFT_OK
                   : wrong(of, "the grid has no such row and col", err);
    }
    *out = is && at < of->names ? of->particle_of[at] : SIZE_MAX;
    return *out != SIZE_MAX ? WEFT_OK : wrong(of, "the mesh has no such vertex", err);
}

static weft_status read_point(fit *self, const table *of, const weft_cloth *cloth,
                              weft_error *err)
{
    const size_t first = weft_cloth_cols(cloth) > 0 ? 3 : 2;
    fit_point *point = &self->points[self->point_count];
    if (of->cells != first + 3) {
        return wrong(of, first == 3 ? "6 cells must be here" : "5 cells must be here",
                     err);
    }
    *point = (fit_point){ .time = option_real(of->cell[0]), .line = of->number };
    if (!(point->time >= 0.0 && isfinite(point->time))) {
        return wrong(of, "time must be a number of at least 0 s", err);
    }
    TRY(find_particle(of, cloth, &point->particle, err));
    for (size_t k = 0; k < 3; ++k) {
        const char *text = of->cell[first + k];
        point->x[k] = option_real(text);
        if (text[strspn(text, " \t")] != '\0' && !isfinite(point->x[k])) {
            return wrong(of, "x, y and z must be numbers [m], or empty", err);
        }
        self->coordinates += isfinite(point->x[k]) ? 1 : 0;
    }
    ++self->point_count;
    return WEFT_OK;
}

static weft_status read_points(fit *self, table *of, const weft_cloth *cloth,
                               weft_error *err)
{
    size_t capacity = 0;
    TRY(read_header(of, weft_cloth_cols(cloth), err));
    if (weft_cloth_cols(cloth) == 0) {
        TRY(name_vertices(of, cloth, err));
    }
    for (weft_status status; (status = next_line(of, err)) != WEFT_STOPPED;) {
        TRY(status);
        if (self->point_count == capacity) {
            capacity = capacity == 0 ? 256 : 2 * capacity;
            fit_point *grown = realloc(self->points, capacity * sizeof *grown);
            if (grown == NULL) {
                return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the data");
            }
            self->points = grown;
        }
        TRY(read_point(self, of, cloth, err));
    }
    return WEFT_OK;
}

static int by_time(const void *a, const void *b)
{
    const fit_point *x = a, *y = b;
    return x->time != y->time ? (x->time > y->time ? 1 : -1)
                              : (x->line > y->line) - (x->line < y->line);
}

weft_status fit_read(fit *self, const char *file, weft_error *err)
{
    char path[RECORD_PATH];
    table of = { .file = file, .stream = record_open(NULL, file, path, err) };
    weft_cloth *cloth = NULL;
    if (of.stream == NULL) {
        return WEFT_IO;
    }
    weft_status status
        = cloth_create(self->scene, weft_scene_cloth(self->scene), &cloth, err);
    if (status == WEFT_OK) {
        self->particles = weft_cloth_particles(cloth);
        status = read_points(self, &of, cloth, err);
    }
    if (status == WEFT_OK && self->coordinates < self->numbers) {
        status = weft_error_set(err, WEFT_IO, "%.200s: %zu coordinates for %zu numbers",
                                file, self->coordinates, self->numbers);
    }
    if (self->point_count > 0) {
        qsort(self->points, self->point_count, sizeof *self->points, by_time);
    }
    weft_cloth_destroy(cloth);
    free(of.particle_of);
    (void)fclose(of.stream);
    return status;
}
