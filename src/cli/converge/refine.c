/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/converge/refine.h"

#include <math.h>
#include <stdio.h>

/* ---- lines of the grid ------------------------------------------------------ */

/* The extent of `count` lines in halves of a spacing, because two pinned lines at an
 * end clamp the cloth midway between them. */
static size_t halves(const refine_axis *axis, size_t count)
{
    return 2 * (count - 1) - axis->clamp[0] - axis->clamp[1];
}

bool refine_line(const refine_axis *axis, size_t i, bool half, size_t *out)
{
    const size_t from_end = axis->count - 1 - i;
    if (axis->count == 1 || (!half && axis->clamp[0] && i < 2)) {
        *out = i;
        return true;
    }
    if (!half && axis->clamp[1] && from_end < 2) {
        *out = axis->refined - 1 - from_end;
        return true;
    }
    const size_t part = half ? 1 : 2 * i - axis->clamp[0];
    const size_t whole = half ? 2 : halves(axis, axis->count);
    const size_t product = part * halves(axis, axis->refined);
    const size_t place = product / whole + axis->clamp[0];
    *out = place / 2;
    return product % whole == 0 && place % 2 == 0;
}

double refine_spacing(const refinement *self, size_t axis)
{
    const refine_axis *of = &self->axis[axis];
    return of->count == 1 ? self->cloth->spacing[axis]
                          : self->cloth->spacing[axis]
                                * ((double)halves(of, of->count)
                                   / (double)halves(of, of->refined));
}

static size_t resolve(ptrdiff_t index, size_t count)
{
    return (size_t)(index < 0 ? index + (ptrdiff_t)count : index);
}

static bool holds(weft_range range, size_t count, size_t first, size_t last)
{
    return resolve(range.first, count) <= first && resolve(range.last, count) >= last;
}

static bool scale_range(const refine_axis *axis, weft_range range, size_t out[2])
{
    return refine_line(axis, resolve(range.first, axis->count), false, &out[0])
           && refine_line(axis, resolve(range.last, axis->count), false, &out[1]);
}

/* ---- the refined grid ------------------------------------------------------- */

void refine_begin(refinement *self, const weft_cloth_def *cloth)
{
    const double down = (double)(cloth->rows - 1) * cloth->spacing[0];
    const double across = (double)(cloth->cols - 1) * cloth->spacing[1];
    *self
        = (refinement){ .cloth = cloth,
                        .axis = { { .count = cloth->rows }, { .count = cloth->cols } },
                        .along = across > down };
}

/* Whether a pin holds all of a row, or of a column. */
static bool is_pinned(const refinement *self, size_t axis, size_t line)
{
    bool pinned = false;
    for (size_t i = 0; i < self->cloth->pin_count; ++i) {
        const weft_pin *pin = &self->cloth->pins[i];
        const weft_range ranges[2] = { pin->rows, pin->cols };
        const size_t across = self->axis[1 - axis].count;
        pinned = pinned
                 || (holds(ranges[axis], self->axis[axis].count, line, line)
                     && holds(ranges[1 - axis], across, 0, across - 1));
    }
    return pinned;
}

bool refine_clamp(refinement *self)
{
    bool found = false;
    for (size_t k = 0; k < 2; ++k) {
        refine_axis *axis = &self->axis[k];
        for (size_t end = 0; end < 2 && axis->count > 3; ++end) {
            const size_t last = axis->count - 1;
            axis->clamp[end] = is_pinned(self, k, end == 0 ? 0 : last)
                               && is_pinned(self, k, end == 0 ? 1 : last - 1)
                               && !is_pinned(self, k, end == 0 ? 2 : last - 2);
            found = found || axis->clamp[end];
        }
    }
    return found;
}

/* Clamps must leave a free line. */
static bool scale_counts(refinement *self, size_t size)
{
    refine_axis *along = &self->axis[self->along], *across = &self->axis[!self->along];
    const size_t product = (size - 1) * (across->count - 1);
    along->refined = size;
    across->refined = product / (along->count - 1) + 1;
    return product % (along->count - 1) == 0
           && along->refined > 2 * ((size_t)along->clamp[0] + along->clamp[1])
           && across->refined > 2 * ((size_t)across->clamp[0] + across->clamp[1]);
}

static bool scale_place(const refinement *self, weft_range rows, weft_range cols,
                        size_t r[2], size_t c[2])
{
    return scale_range(&self->axis[0], rows, r) && scale_range(&self->axis[1], cols, c);
}

bool refine_to(refinement *self, size_t size, char what[REFINE_PLACE])
{
    const weft_cloth_def *cloth = self->cloth;
    size_t r[2], c[2];
    if (!scale_counts(self, size)) {
        (void)snprintf(what, REFINE_PLACE, "the ratio of rows to columns");
        return false;
    }
    for (size_t i = 0; i < cloth->pin_count; ++i) {
        if (!scale_place(self, cloth->pins[i].rows, cloth->pins[i].cols, r, c)) {
            (void)snprintf(what, REFINE_PLACE, "the place of cloth.pins.%zu", i);
            return false;
        }
    }
    for (size_t i = 0; i < cloth->load_count; ++i) {
        if (!scale_place(self, cloth->loads[i].rows, cloth->loads[i].cols, r, c)) {
            (void)snprintf(what, REFINE_PLACE, "the place of cloth.loads.%zu", i);
            return false;
        }
    }
    return true;
}

/* ---- overrides -------------------------------------------------------------- */

static void put_vector(FILE *out, const char *name, const double v[3])
{
    fprintf(out, "%s: [%.17g, %.17g, %.17g], ", name, v[0], v[1], v[2]);
}

static void put_place(const refinement *self, FILE *out, weft_range rows,
                      weft_range cols)
{
    size_t r[2] = { 0 }, c[2] = { 0 };
    (void)scale_place(self, rows, cols, r, c);
    fprintf(out, "at: {rows: [%zu, %zu], cols: [%zu, %zu]}", r[0], r[1], c[0], c[1]);
}

static void put_pins(const refinement *self, FILE *out)
{
    for (size_t i = 0; i < self->cloth->pin_count; ++i) {
        const weft_pin *pin = &self->cloth->pins[i];
        fputs(i == 0 ? "{" : ", {", out);
        put_vector(out, "velocity", pin->velocity);
        put_vector(out, "amplitude", pin->amplitude);
        fprintf(out, "frequency: %.17g, ", pin->frequency);
        put_place(self, out, pin->rows, pin->cols);
        fputc('}', out);
    }
}

static void put_loads(const refinement *self, FILE *out)
{
    for (size_t i = 0; i < self->cloth->load_count; ++i) {
        const weft_load *load = &self->cloth->loads[i];
        fprintf(out, "%s{mass: %.17g, ", i == 0 ? "" : ", ", load->mass);
        put_place(self, out, load->rows, load->cols);
        fputc('}', out);
    }
}

/* A clamp stays where it is, half a spacing behind the first line. */
static double moved_origin(const refinement *self, size_t component)
{
    const weft_cloth_def *cloth = self->cloth;
    const double *const directions[2] = { cloth->down, cloth->right };
    double origin = cloth->origin[component];
    for (size_t k = 0; k < 2; ++k) {
        const double *to = directions[k];
        const double length = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
        const double shift = cloth->spacing[k] - refine_spacing(self, k);
        if (self->axis[k].clamp[0]) {
            origin += 0.5 * cloth->scale * shift * to[component] / length;
        }
    }
    return origin;
}

char *refine_sets(const refinement *self)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    if (out == NULL) {
        return NULL;
    }
    fprintf(out, "cloth.grid.rows=%zu%c", self->axis[0].refined, '\0');
    fprintf(out, "cloth.grid.cols=%zu%c", self->axis[1].refined, '\0');
    fprintf(out, "cloth.grid.spacing=[%.17g, %.17g]%c", refine_spacing(self, 0),
            refine_spacing(self, 1), '\0');
    fprintf(out, "cloth.grid.origin=[%.17g, %.17g, %.17g]%c", moved_origin(self, 0),
            moved_origin(self, 1), moved_origin(self, 2), '\0');
    fputs("cloth.pins=[", out);
    put_pins(self, out);
    fprintf(out, "]%ccloth.loads=[", '\0');
    put_loads(self, out);
    fputs("]", out);
    return fclose(out) == 0 ? text : NULL;
}
