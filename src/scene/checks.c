/* SPDX-License-Identifier: BSD-3-Clause */
/* checks.c -- rules between the keys of cloth, limit and run. */
#include <stdio.h>

#include "base/finite.h"
#include "base/thread_pool.h"
#include "cloth/model.h"
#include "mesh/grid_def.h"
#include "scene/checks.h"

void weft__check_root(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_scene *scene = base;
    const weft__node *version = weft__value_in(match, "weft");
    if (version != NULL && scene->version > 1) {
        ERROR_AT(reader, version,
                 "version %zu of the scene format is not known: this is a "
                 "reader of version 1",
                 scene->version);
    }
    weft__check_stop(reader, match);
    if (reader->report->found->errors == 0 && reader->def->bands > 1) {
        weft__check_bands(reader, match);
    }
    if (reader->report->found->errors == 0 && scene->sensitivity.count > 0) {
        weft__check_smooth(reader, match);
    }
    for (size_t i = 0; i < match->section->count; ++i) {
        const weft__section *section = match->section->keys[i].section;
        if (section != NULL && section->late != NULL
            && reader->report->found->errors == 0 && !reader->report->no_memory) {
            section->late(reader, match, base);
        }
    }
}

/* [particles] Larger grids take time: weft_cloth_create compares their neighbours. */
#define MAX_COMPARED ((size_t)1 << 24)

void weft__check_grid(weft__reader *reader, const weft__match *match, void *base)
{
    weft_cloth_def *cloth = base;
    (void)reader;
    if (!weft__grid_check(cloth, MAX_COMPARED, &match->faults)) {
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
        weft_spring_def *springs = &cloth->springs[i], *across = &cloth->across[i];
        springs->present = key != NULL && (i != WEFT_BEND || springs->present);
        across->present = i != WEFT_SHEAR
                          && (across->stiffness != springs->stiffness
                              || across->damping != springs->damping);
        if (springs->present && none[i]) {
            WARNING_AT(reader, key, "a grid of %zu x %zu has no %s springs",
                       cloth->rows, cloth->cols, name);
        }
    }
}

/* Comparisons of a particle with a pin: beyond so many there is no warning. */
#define MAX_COVERED ((double)(1 << 26))

/* Whether pins hold every particle. */
static bool holds_all(const weft_scene *scene)
{
    const weft_cloth_def *cloth = &scene->cloth;
    const size_t particles = weft__particles_in(scene);
    bool all = (double)particles * (double)cloth->pin_count < MAX_COVERED;
    for (size_t i = 0; i < particles && all; ++i) {
        all = weft__pin_of(cloth, i) > 0;
    }
    return all;
}

void weft__warn_of_held(weft__reader *reader, const weft__node *at)
{
    if (reader->report->found->errors == 0 && holds_all(reader->scene)) {
        WARNING_AT(reader, at, "all %zu particles are pinned: nothing will move freely",
                   weft__particles_in(reader->scene));
    }
}

/* Products of numbers in range may be out of range: masses are told at their key, what
 * depends on lengths at the spacing. */
static void report_product(void *ctx, size_t field, size_t other, const char *message)
{
    const weft__match *match = ctx;
    const weft__node *at = weft__value_of(weft__value_in(match, "grid"), "spacing");
    if (field != offsetof(weft_cloth_def, spacing)) {
        const bool massive = field == offsetof(weft_cloth_def, density);
        const weft__node *fabric = weft__value_in(match, "fabric");
        const weft__node *mass = weft__value_in(match, "mass");
        mass = mass == NULL ? weft__value_in(match, "density") : mass;
        at = massive ? mass : weft__value_in(match, "springs");
        at = fabric == NULL ? at : fabric;
    }
    (void)other;
    weft__report_error(match->reader->report, at->at, "%s", message);
}

static void check_sheet(weft__reader *reader, const weft__match *match,
                        const weft_cloth_def *cloth)
{
    weft__check_grid_cloth(reader, match);
    if (weft__key_in(match, "fabric") != NULL) {
        weft__make_fabric(reader, match);
    } else {
        weft__check_one(reader, match,
                        (const char *const[]){ "mass", "density", NULL });
    }
    if (reader->report->found->errors == 0) {
        weft__sheet_check(cloth, &(weft__faults){ report_product, (void *)match });
        weft__warn_of_grid(reader, match);
    }
}

void weft__check_cloth(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_cloth_def *cloth = base;
    if (reader->scene->meshed) {
        weft__check_mesh_cloth(reader, match);
    } else if (weft__key_in(match, "grid") != NULL) {
        check_sheet(reader, match, cloth);
    }
    if (reader->scene->part == 0) { /* of several cloths all together */
        weft__warn_of_held(reader, weft__key_in(match, "pins"));
    }
}

/* ---- limit, run ------------------------------------------------------------- */

void weft__check_limit(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_limit_def *limit = base;
    bool limits = false;
    weft__limit_check(limit, &match->faults);
    if (reader->scene->meshed) {
        ERROR_AT(reader, match->map,
                 "a strain limit needs a grid: it shortens springs");
        return;
    }
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        limits
            = limits || (limit->families[i] && reader->scene->cloth.springs[i].present);
    }
    if (!limits && reader->report->found->errors == 0) {
        WARNING_AT(
            reader, match->map,
            "limit has no effect: cloth has no springs of the families it limits");
    }
}

/* No step crosses a frame, or the end. The warning stands at the key to change; the
 * stepper has been read before. */
static void check_frame(weft__reader *reader, const weft__match *match,
                        const weft_run_def *run)
{
    const double h = reader->scene->config.fixed_step;
    const bool one = run->duration * run->fps < 1.0;
    const double frame = one ? run->duration : 1.0 / run->fps;
    const weft__node *at = weft__key_in(match, one ? "duration" : "fps");
    char advice[80] = "";
    if (run->duration >= h) {
        (void)snprintf(advice, sizeof advice, "; run.fps=%.7g makes frames of %g s",
                       1.0 / h, h);
    }
    if (h * run->fps > 1.0 + 1e-6) {
        WARNING_AT(reader, (at == NULL ? match->map : at),
                   "fixed_step %g s is longer than %s (%.4g s): every step "
                   "will be %.4g s%s",
                   h, one ? "the run" : "a frame", frame, frame, advice);
    }
}

/* Room for all frames is made in run.vtkhdf: a copy of that file may fill a disk. */
#define MAX_FRAMES 1e7

void weft__check_run(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_run_def *run = base;
    if (run->duration * run->fps > MAX_FRAMES) {
        const weft__node *node = weft__value_in(match, "fps");
        node = node == NULL ? weft__value_in(match, "duration") : node;
        ERROR_AT(reader, node,
                 "%g s at %g frames per second are %.3g frames; a run has at most %g",
                 run->duration, run->fps, run->duration * run->fps, MAX_FRAMES);
    }
    const char *refusal = weft__pool_refusal(run->threads);
    if (refusal != NULL) {
        weft__report_error(reader->report, weft__value_in(match, "threads")->at,
                           "threads is %zu: %s", run->threads, refusal);
    }
    if (!run->interpolate) {
        check_frame(reader, match, run);
    }
    reader->scene->step = reader->scene->config.fixed_step;
    if (reader->scene->step > 0.0 && weft__positive(run->duration)
        && weft__positive(run->fps)) {
        reader->scene->config.fixed_step = weft_run_step(run, reader->scene->step);
    }
}
