/* SPDX-License-Identifier: BSD-3-Clause */
/* checks.c -- what must hold between the keys of cloth, limit and run. */
#include "cloth/model.h"
#include "scene/read.h"

void weft__check_root(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_scene *scene = base;
    const weft__node *version = weft__value_in(match, "weft");
    if (version != NULL && scene->version > 1) {
        weft__report_error(reader->report, version->at,
                           "version %zu of the scene format is not known: this is a "
                           "reader of version 1",
                           scene->version);
    }
}

/* ---- grid ------------------------------------------------------------------- */

/* Of larger ones weft_cloth_create compares the neighbours: it takes time. */
#define MAX_COMPARED ((size_t)1 << 24)

typedef struct grid_check {
    weft__reader *reader;
    const weft__match *match;
} grid_check;

/* The key that fills a field of the grid; its count if none does. */
static size_t key_of(const weft__section *section, size_t field)
{
    size_t i = 0;
    while (i < section->count && section->keys[i].at != field) {
        ++i;
    }
    return i;
}

/* Reports a fault of a field at its key's value, where that is a default at the other
 * one. A value that was refused before is not at fault again. */
static void report_fault(void *ctx, size_t field, size_t other, const char *message)
{
    const grid_check *self = ctx;
    const weft__match *match = self->match;
    const size_t i = key_of(match->section, field), j = key_of(match->section, other);
    const weft__node *node
        = match->value[i] == NULL ? match->value[j] : match->value[i];
    if (node != NULL && !match->wrong[i] && !match->wrong[j]) {
        weft__report_error(self->reader->report, node->at, "%s", message);
    }
}

void weft__check_grid(weft__reader *reader, const weft__match *match, void *base)
{
    weft_cloth_def *cloth = base;
    grid_check self = { reader, match };
    const weft__faults to = { report_fault, &self };
    if (!weft__grid_check(cloth, MAX_COMPARED, &to)) {
        cloth->rows = cloth->cols = 0; /* nothing more is checked against the grid */
    }
}

/* ---- cloth ------------------------------------------------------------------ */

void weft__check_springs(weft__reader *reader, const weft__match *match, void *base)
{
    weft_cloth_def *cloth = base;
    const bool sized = cloth->rows > 0;
    const bool none[WEFT_FAMILIES] = {
        [WEFT_SHEAR] = sized && (cloth->rows < 2 || cloth->cols < 2),
        [WEFT_BEND] = sized && cloth->rows < 3 && cloth->cols < 3,
    };
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        const char *name = weft_family_name((weft_family)i);
        const weft__node *key = weft__key_in(match, name);
        cloth->springs[i].present = key != NULL;
        if (key != NULL && none[i]) {
            weft__report_warning(reader->report, key->at,
                                 "a grid of %zu x %zu has no %s springs", cloth->rows,
                                 cloth->cols, name);
        }
    }
}

static void check_mass(weft__reader *reader, const weft__match *match)
{
    const weft__node *mass = weft__key_in(match, "mass");
    const weft__node *density = weft__key_in(match, "density");
    if (mass != NULL && density != NULL) {
        weft__report_exclusive(reader->report, mass, density);
    } else if (mass == NULL && density == NULL && !weft__misspelt(match, "mass")
               && !weft__misspelt(match, "density")) {
        weft__report_error(reader->report, match->map->at,
                           "cloth lacks 'mass' [kg] or 'density' [kg/m^2]: exactly one "
                           "is required");
    }
}

static size_t resolve(ptrdiff_t index, size_t count)
{
    return (size_t)(index < 0 ? index + (ptrdiff_t)count : index);
}

/* Particles that no pin holds, counted by a sum over the corners of the pins' ranges;
 * 1 if that would take too much memory. */
static size_t count_free(weft__reader *reader, const weft_cloth_def *cloth)
{
    const size_t width = cloth->cols + 1;
    if (cloth->rows * cloth->cols > (size_t)1 << 24) {
        return 1;
    }
    int *steps = weft__zeroed(reader->report->memory, (cloth->rows + 1) * width,
                              sizeof *steps);
    if (steps == NULL) {
        reader->report->no_memory = true;
        return 1;
    }
    for (size_t i = 0; i < cloth->pin_count; ++i) {
        const weft_pin *pin = &cloth->pins[i];
        const size_t top = resolve(pin->rows.first, cloth->rows);
        const size_t bottom = resolve(pin->rows.last, cloth->rows) + 1;
        const size_t left = resolve(pin->cols.first, cloth->cols);
        const size_t right = resolve(pin->cols.last, cloth->cols) + 1;
        ++steps[top * width + left];
        --steps[top * width + right];
        --steps[bottom * width + left];
        ++steps[bottom * width + right];
    }
    size_t free_ones = 0;
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (size_t c = 0; c < cloth->cols; ++c) {
            int *here = &steps[r * width + c];
            *here += (r > 0 ? here[-(ptrdiff_t)width] : 0) + (c > 0 ? here[-1] : 0)
                     - (r > 0 && c > 0 ? here[-(ptrdiff_t)width - 1] : 0);
            free_ones += *here == 0;
        }
    }
    weft__free(reader->report->memory, steps);
    return free_ones;
}

/* Only where the pins might hold all: the count takes time. */
static bool may_hold_all(const weft_cloth_def *cloth)
{
    double held = 0.0;
    for (size_t i = 0; i < cloth->pin_count; ++i) {
        const weft_pin *pin = &cloth->pins[i];
        held += ((double)resolve(pin->rows.last, cloth->rows)
                 - (double)resolve(pin->rows.first, cloth->rows) + 1.0)
                * ((double)resolve(pin->cols.last, cloth->cols)
                   - (double)resolve(pin->cols.first, cloth->cols) + 1.0);
    }
    return held >= (double)cloth->rows * (double)cloth->cols;
}

void weft__check_cloth(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_cloth_def *cloth = base;
    check_mass(reader, match);
    if (cloth->pin_count > 0 && reader->report->found->errors == 0
        && may_hold_all(cloth) && count_free(reader, cloth) == 0) {
        weft__report_warning(reader->report, weft__key_in(match, "pins")->at,
                             "all %zu particles are pinned: nothing will move freely",
                             cloth->rows * cloth->cols);
    }
}

/* ---- limit, run ------------------------------------------------------------- */

void weft__check_limit(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_limit_def *limit = base;
    const weft__node *velocity = weft__value_in(match, "velocity");
    bool limits = false;
    if (limit->method == WEFT_LIMIT_BRIDSON && limit->keep_velocity) {
        weft__report_error(reader->report, velocity->at,
                           "method bridson would not use 'keep': it works on "
                           "velocities");
    }
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        limits
            = limits || (limit->families[i] && reader->scene->cloth.springs[i].present);
    }
    if (!limits && reader->report->found->errors == 0) {
        weft__report_warning(
            reader->report, match->map->at,
            "limit has no effect: cloth has no springs of the families "
            "it limits");
    }
}

/* No step crosses a frame. Told where the cure is: the stepper has been read before. */
static void check_frame(weft__reader *reader, const weft__match *match,
                        const weft_run_def *run)
{
    const double h = reader->scene->config.fixed_step;
    const weft__node *fps = weft__key_in(match, "fps");
    if (h * run->fps > 1.0 + 1e-6) {
        weft__report_warning(reader->report, (fps == NULL ? match->map : fps)->at,
                             "fixed_step %g s is longer than a frame (%.4g s): every "
                             "step will be %.4g s; run.fps=%.7g makes frames of %g s",
                             h, 1.0 / run->fps, 1.0 / run->fps, 1.0 / h, h);
    }
}

void weft__check_run(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_run_def *run = base;
    if (run->duration * run->fps > 0x1p53) {
        const weft__node *node = weft__value_in(match, "fps");
        node = node == NULL ? weft__value_in(match, "duration") : node;
        weft__report_error(reader->report, node->at,
                           "%g s at %g frames per second are more frames than can be "
                           "counted (2^53)",
                           run->duration, run->fps);
    }
    check_frame(reader, match, run);
}
