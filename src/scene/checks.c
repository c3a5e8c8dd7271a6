/* SPDX-License-Identifier: BSD-3-Clause */
/* checks.c -- what must hold between the keys of cloth, limit and run. */
#include <string.h>

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

/* Particles that pins may name in all: to mark them takes time. */
#define MAX_NAMED ((size_t)1 << 30)

/* The first and the last row and column of a pin. */
typedef struct pinned {
    size_t top, bottom, left, right;
} pinned;

static pinned range_of(const weft_pin *pin, const weft_cloth_def *cloth)
{
    pinned of;
    (void)weft__range_resolve(pin->rows, cloth->rows, &of.top, &of.bottom);
    (void)weft__range_resolve(pin->cols, cloth->cols, &of.left, &of.right);
    return of;
}

/* Whether pins hold every particle. */
static bool holds_all(weft__reader *reader, const weft_cloth_def *cloth)
{
    const size_t count = cloth->rows * cloth->cols;
    size_t named = 0, held = 0;
    for (size_t i = 0; i < cloth->pin_count && named <= MAX_NAMED; ++i) {
        const pinned of = range_of(&cloth->pins[i], cloth);
        named += (of.bottom - of.top + 1) * (of.right - of.left + 1);
    }
    if (named < count || named > MAX_NAMED || count > MAX_COMPARED) {
        return false;
    }
    bool *marks = weft__zeroed(reader->report->memory, count, sizeof *marks);
    reader->report->no_memory = reader->report->no_memory || marks == NULL;
    for (size_t i = 0; marks != NULL && i < cloth->pin_count; ++i) {
        const pinned of = range_of(&cloth->pins[i], cloth);
        for (size_t r = of.top; r <= of.bottom; ++r) {
            memset(&marks[r * cloth->cols + of.left], true, of.right - of.left + 1);
        }
    }
    for (size_t i = 0; marks != NULL && i < count; ++i) {
        held += marks[i];
    }
    weft__free(reader->report->memory, marks);
    return held == count;
}

void weft__check_cloth(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_cloth_def *cloth = base;
    check_mass(reader, match);
    if (cloth->pin_count > 0 && reader->report->found->errors == 0
        && holds_all(reader, cloth)) {
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
