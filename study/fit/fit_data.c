/* SPDX-License-Identifier: BSD-3-Clause */
/* fit_data.c -- tracks of particles, one point per line, whose empty coordinates are
 * missing, or an outline: `kinds` has the headers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "study/fit/fit.h"

#define DEGREES 57.295779513082321 /* per rad */
#define WIDEST  90.0 /* [degrees] from one point of an outline to the next */

enum { MOST_CELLS = 6 };

typedef enum kind { OF_GRID, OF_MESH, OF_CLOTHS, BY_ANGLE, IN_PLANE, KINDS } kind;

static const struct {
    const char *header;
    size_t cells;
} kinds[KINDS] = { { "time,row,col,x,y,z", 6 },
                   { "time,vertex,x,y,z", 5 },
                   { "time,cloth,vertex,x,y,z", 6 },
                   { "angle,radius", 2 },
                   { "x,y", 2 } };

typedef struct table {
    const char *file;
    FILE *stream;
    char line[512];
    kind kind;
    size_t number, cells;
    char *cell[MOST_CELLS];
} table;

static weft_status wrong(const table *of, const char *why, weft_error *err)
{
    return weft_error_set(err, WEFT_IO, "%.200s:%zu: %s", of->file, of->number, why);
}

/* The next line that is not blank; WEFT_STOPPED: there is none. */
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
    return WEFT_OK;
}

static weft_status split_line(table *of, weft_error *err)
{
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
    char text[48];
    (void)snprintf(text, sizeof text, "%zu cells must be here: %s",
                   kinds[of->kind].cells, kinds[of->kind].header);
    return of->cells == kinds[of->kind].cells ? WEFT_OK : wrong(of, text, err);
}

static weft_status read_header(table *of, kind tracks, weft_error *err)
{
    const weft_status status = next_line(of, err);
    if (status == WEFT_OK) {
        of->kind = tracks;
        while (of->kind < KINDS && strcmp(of->line, kinds[of->kind].header) != 0) {
            of->kind = of->kind < BY_ANGLE ? BY_ANGLE : of->kind + 1;
        }
    }
    char text[128];
    (void)snprintf(text, sizeof text,
                   "the first line must be %s, or of an outline angle,radius or x,y",
                   kinds[tracks].header);
    return status == WEFT_OK && of->kind < KINDS         ? WEFT_OK
           : status == WEFT_OK || status == WEFT_STOPPED ? wrong(of, text, err)
                                                         : status;
}

/* The names of vertices ascend, those of each cloth from 0: none is below its place. */
static weft_status find_particle(const table *of, const weft_cloth *cloth, size_t *out,
                                 weft_error *err)
{
    const size_t rows = weft_cloth_rows(cloth), cols = weft_cloth_cols(cloth);
    const size_t part
        = of->kind == OF_CLOTHS ? weft_cloth_part_find(cloth, of->cell[1]) : SIZE_MAX;
    size_t at = 0, col = 0, first = 0, i = weft_cloth_particles(cloth) - 1;
    if (of->kind == OF_CLOTHS && part == SIZE_MAX) {
        return wrong(of, "the scene has no such cloth", err);
    }
    const bool is = option_count(of->cell[part == SIZE_MAX ? 1 : 2], '\0', &at)
                    && (of->kind != OF_GRID || option_count(of->cell[2], '\0', &col));
    if (of->kind == OF_GRID) {
        *out = at * cols + col;
        return is && at < rows && col < cols
                   ? WEFT_OK
                   : wrong(of, "the grid has no such row and col", err);
    }
    if (part != SIZE_MAX) {
        first = weft_cloth_part_at(cloth, part).first;
        i = weft_cloth_part_at(cloth, part).count - 1;
    }
    for (i = at < i ? at : i; i > 0 && weft_cloth_file_index(cloth, first + i) > at;) {
        --i;
    }
    *out = first + i;
    return is && weft_cloth_file_index(cloth, *out) == at
               ? WEFT_OK
               : wrong(of, "the mesh has no such vertex", err);
}

static weft_status read_point(fit *self, const table *of, const weft_cloth *cloth,
                              weft_error *err)
{
    const size_t first = kinds[of->kind].cells - 3;
    fit_point *point = &self->points[self->point_count];
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

/* A point of an outline. */
static weft_status read_direction(fit *self, const table *of, weft_error *err)
{
    const double a = option_real(of->cell[0]), b = option_real(of->cell[1]);
    const double radius = of->kind == BY_ANGLE ? b : hypot(a, b);
    fit_point *point = &self->points[self->point_count];
    if (!(radius > 0.0 && isfinite(radius))
        || (of->kind == BY_ANGLE && !(a >= -180.0 && a <= 360.0))) {
        return wrong(of,
                     of->kind == BY_ANGLE
                         ? "angle must be -180 to 360 degrees, radius above 0 m"
                         : "x and y must be numbers [m], not both 0",
                     err);
    }
    *point = (fit_point){ .time = weft_scene_run(self->scene)->duration,
                          .line = of->number,
                          .x = { radius, NAN, NAN } };
    point->angle
        = fmod(360.0 + (of->kind == BY_ANGLE ? a : atan2(b, a) * DEGREES), 360.0);
    if (of->kind == BY_ANGLE) {
        weft_sincos_turns(1.0 / 360.0, a, &point->direction[1], &point->direction[0]);
    } else {
        point->direction[0] = a / radius, point->direction[1] = b / radius;
    }
    ++self->coordinates;
    ++self->point_count;
    return WEFT_OK;
}

static weft_status read_points(fit *self, table *of, const weft_cloth *cloth,
                               weft_error *err)
{
    size_t capacity = 0;
    TRY(read_header(of,
                    weft_cloth_cols(cloth) > 0    ? OF_GRID
                    : weft_cloth_parts(cloth) > 0 ? OF_CLOTHS
                                                  : OF_MESH,
                    err));
    for (weft_status status; (status = next_line(of, err)) != WEFT_STOPPED;) {
        TRY(status);
        TRY(split_line(of, err));
        if (self->point_count == capacity) {
            capacity = capacity == 0 ? 256 : 2 * capacity;
            fit_point *grown = realloc(self->points, capacity * sizeof *grown);
            if (grown == NULL) {
                return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the data");
            }
            self->points = grown;
        }
        TRY(of->kind < BY_ANGLE ? read_point(self, of, cloth, err)
                                : read_direction(self, of, err));
    }
    return WEFT_OK;
}

static int by_time(const void *a, const void *b)
{
    const fit_point *x = a, *y = b;
    const double later = x->time != y->time ? x->time - y->time : x->angle - y->angle;
    return later != 0.0 ? (later > 0.0 ? 1 : -1)
                        : (x->line > y->line) - (x->line < y->line);
}

/* It goes around the origin, and has one point per angle. */
static weft_status check_outline(fit *self, table *of, const weft_cloth *cloth,
                                 weft_error *err)
{
    TRY(shadow_init(&self->shadow, cloth, weft_scene_cloth(self->scene)->gravity, err));
    for (size_t i = 0; i < self->point_count; ++i) {
        const bool last = i + 1 == self->point_count;
        const fit_point *at = &self->points[i], *next = &self->points[last ? 0 : i + 1];
        const double gap = next->angle - at->angle + (last ? 360.0 : 0.0);
        char text[128];
        of->number = gap == 0.0 ? next->line : at->line;
        if (gap == 0.0) {
            (void)snprintf(text, sizeof text,
                           "a second point at %g degrees; the first is on line %zu",
                           at->angle, at->line);
        } else {
            (void)snprintf(text, sizeof text,
                           "the outline is open: the next point after %g degrees is "
                           "%g degrees away",
                           at->angle, gap);
        }
        if (!(gap > 0.0 && gap <= WIDEST)) {
            return wrong(of, text, err);
        }
    }
    return WEFT_OK;
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
    if (self->point_count > 0) {
        qsort(self->points, self->point_count, sizeof *self->points, by_time);
    }
    if (status == WEFT_OK && of.kind >= BY_ANGLE) {
        status = check_outline(self, &of, cloth, err);
    }
    if (status == WEFT_OK && self->coordinates < self->parameters) {
        status = weft_error_set(err, WEFT_IO, "%.200s: %zu coordinates for %zu numbers",
                                file, self->coordinates, self->parameters);
    }
    weft_cloth_destroy(cloth);
    (void)fclose(of.stream);
    return status;
}
