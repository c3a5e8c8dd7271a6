/* SPDX-License-Identifier: BSD-3-Clause */
/* converge.c -- weft converge: the sizes and their runs. Each run has its own process,
 * which writes its results to shared memory. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <string.h>

#include "program/record/child_process.h"
#include "program/record/series.h"
#include "program/survey/survey.h"
#include "study/converge/converge.h"

/* ---- sizes ------------------------------------------------------------------ */

static int read_sizes(converge *self, const char *list)
{
    const char *at = list == NULL ? "" : list;
    size_t size, before = !self->mesh;
    bool able = true;
    while (able && *at != '\0') {
        const size_t length = strcspn(at, ",");
        able = self->count < CONVERGE_SIZES && option_count(at, at[length], &size)
               && size > before && size <= CONVERGE_LARGEST;
        if (able) {
            self->sizes[self->count++].size = before = size;
        }
        at += length + (at[length] == ',');
    }
    return able && self->count > 1
               ? EXIT_DONE
               : usage_error(
                   self->given,
                   "--sizes needs 2 to %d increasing numbers from %d to %d, as "
                   "--sizes %s",
                   CONVERGE_SIZES, self->mesh ? 1 : 2, CONVERGE_LARGEST,
                   self->mesh ? "1,2,4" : "9,17,33");
}

/* WEFT_INVALID: something has no place on the grid of that size. */
static weft_status refine(converge *self, converge_size *to, weft_error *err)
{
    const refine_axis *axis = self->grid.axis;
    TRY(refine_to(&self->grid, to->size, err));
    to->spacing = self->grid.cloth.spacing[self->grid.along];
    for (size_t i = 0; i < self->quantity_count; ++i) {
        const converge_quantity *one = &self->quantities[i];
        size_t row = 0, col = 0;
        if (one->particle
            && !(refine_line(&axis[0], one->place[0], &row)
                 && refine_line(&axis[1], one->place[1], &col))) {
            return weft_error_set(err, WEFT_INVALID,
                                  "%zu does not keep the particle %.*s", to->size,
                                  (int)strcspn(one->name, "."), one->name);
        }
        to->probes[i]
            = (converge_probe){ { row * axis[1].refined + col }, { 1.0, 0.0, 0.0 } };
    }
    return WEFT_OK;
}

static bool is_given(const converge *self, size_t size)
{
    size_t i = 0;
    while (i < self->count && self->sizes[i].size != size) {
        ++i;
    }
    return i < self->count;
}

/* The least sizes that would do, and those of the command line that do. */
static int refuse_size(converge *self, const weft_error *why)
{
    enum { SHOWN = 4 };
    sentence list = { "" };
    const size_t most = 4 * self->grid.axis[self->grid.along].count;
    const size_t last = self->sizes[self->count - 1].size;
    for (size_t n = 2, shown = 0; n <= most || n <= last; ++n) {
        converge_size one = { .size = n };
        if (((n <= most && shown < SHOWN) || is_given(self, n))
            && refine(self, &one, NULL) == WEFT_OK) {
            say(&list, "%s%zu", shown++ == 0 ? "" : ", ", n);
        }
    }
    return usage_error(self->given, "--sizes: %s; %s%s", why->message,
                       list.text[0] == '\0' ? "no size does" : "these do: ", list.text);
}

static int report_size(size_t size, const weft_error *why)
{
    return report_status(why->status, "size %zu: %s", size, why->message);
}

/* The cloths exist before the first run starts, which may take hours. */
static int open_size(converge *self, converge_size *to)
{
    weft_error err = { 0 };
    if (self->mesh) {
        return converge_open_mesh(self, to);
    }
    if (refine(self, to, &err) != WEFT_OK) {
        return refuse_size(self, &err);
    }
    if (cloth_create(self->scene, &self->grid.cloth, &to->cloth, &err)
        == WEFT_INVALID) {
        err.status = WEFT_BAD_SCENE;
    }
    return err.status == WEFT_OK ? EXIT_DONE : report_size(to->size, &err);
}

/* ---- runs, in processes of their own ---------------------------------------- */

/* weft_play.frame */
static weft_status ignore_frame(void *ctx, size_t index, weft_error *err)
{
    (void)ctx;
    (void)index;
    (void)err;
    return WEFT_OK;
}

static weft_status take_values(const converge *self, size_t i, const weft_sim *sim,
                               size_t frame, weft_error *err)
{
    const double *y = weft_sim_state(sim);
    const size_t n = weft_cloth_particles(weft_sim_cloth(sim));
    const record_frame last = { .index = frame,
                                .sim = sim,
                                .limit_sweeps = weft_sim_limit_stats(sim).sweeps };
    record_series series = { 0 }; /* without a file */
    record_series_begin(&series, series_columns(self->scene), NULL);
    TRY(record_series_add(&series, &last, err));
    for (size_t k = 0; k < self->quantity_count; ++k) {
        const converge_quantity *one = &self->quantities[k];
        const converge_probe *at = &self->sizes[i].probes[k];
        const double *x = &y[one->particle ? one->which * n : 0];
        self->results[i].values[k] = !one->particle ? series.row[one->which]
                                     : at->share[0] == 1.0
                                         ? x[at->particle[0]]
                                         : at->share[0] * x[at->particle[0]]
                                               + at->share[1] * x[at->particle[1]]
                                               + at->share[2] * x[at->particle[2]];
    }
    return WEFT_OK;
}

/* process_def.work */
static int run_size(void *ctx, size_t i)
{
    const converge *self = ctx;
    const weft_run_def *run = weft_scene_run(self->scene);
    const weft_play frames
        = { .run = run, .last = weft_run_last_frame(run), .frame = ignore_frame };
    weft_error *err = &self->results[i].err;
    weft_sim *sim = NULL;
    weft_status status = sim_create(self->scene, self->sizes[i].cloth, &sim, err);
    if (status == WEFT_OK && stability_warn(self->scene, sim, true)) {
        fprintf(stderr,
                "weft: warning: size %zu: stepper.fixed_step is beyond the largest "
                "stable step\n",
                self->sizes[i].size);
    }
    status = status == WEFT_OK ? weft_sim_play(sim, &frames, err) : status;
    err->status
        = status == WEFT_OK ? take_values(self, i, sim, frames.last, err) : status;
    weft_sim_destroy(sim);
    return EXIT_DONE;
}

static void size_ended(void *ctx, const process *one)
{
    converge *self = ctx;
    converge_result *result = &self->results[one->job];
    job_error(one, &result->err);
    if (result->err.status != WEFT_OK) {
        progress_clear(&self->progress);
        self->code = report_size(self->sizes[one->job].size, &result->err);
        for (size_t i = 0; i < self->quantity_count; ++i) {
            result->values[i] = (double)NAN;
        }
    }
    progress_count(&self->progress, "sizes", ++self->over, self->count);
}

static int run_sizes(converge *self)
{
    weft_error err;
    self->results = process_memory(self->count, sizeof *self->results);
    if (self->results == NULL) {
        return report_status(WEFT_NO_MEMORY, "no memory for the results");
    }
    const weft_status status
        = jobs_run(self->given, self, self->count, run_size, size_ended, NULL, &err);
    progress_clear(&self->progress);
    if (status != WEFT_OK) {
        return report_error(&err);
    }
    converge_print(self, converge_own(self->given)->csv);
    return self->code;
}

/* ---- the verb --------------------------------------------------------------- */

static void warn_of_particles(const converge *self)
{
    const weft_cloth_def *cloth = weft_scene_cloth(self->scene);
    const weft_spring_def *bend = &cloth->springs[WEFT_BEND];
    const bool chain = cloth->rows == 1 || cloth->cols == 1;
    const bool fabric = weft_scene_fabric(self->scene) != NULL;
    bool spread = false;
    for (size_t i = 0; i < cloth->load_count; ++i) {
        const weft_load *load = &cloth->loads[i];
        spread = spread || load->rows.first != load->rows.last
                 || load->cols.first != load->cols.last || load->vertex_count > 1;
    }
    const struct {
        bool used;
        const char *key, *each;
    } keys[]
        = { { cloth->mass > 0.0 && !self->mesh, "cloth.mass", "particle" },
            { cloth->damping > 0.0, "forces.damping", "particle" },
            { spread, "the mass of cloth.loads", "particle" },
            { bend->present && bend->stiffness > 0.0, "cloth.springs.bend", "spring" },
            { chain && cloth->law == WEFT_LAW_HOOKE && !fabric,
              "cloth.springs.stretch of a chain with law: hooke", "spring" },
            { !chain && !self->mesh && cloth->law == WEFT_LAW_STRAIN,
              "cloth.springs of a sheet with law: strain", "spring" } };
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        if (keys[i].used) {
            fprintf(stderr,
                    "weft: warning: %s is the same for each %s, so its effect depends "
                    "on the size\n",
                    keys[i].key, keys[i].each);
        }
    }
}

static int prepare(converge *self, const arguments *given)
{
    weft_error err = { 0 };
    self->mesh = weft_scene_cloth(self->scene)->mesh != NULL;
    if (scene_supported(self->scene, &err) != WEFT_OK
        || (!self->mesh && refine_begin(&self->grid, self->scene, &err) != WEFT_OK)) {
        return report_error(&err);
    }
    if (converge_own(given)->clamp_midway
        && (self->mesh || !refine_clamp(&self->grid))) {
        return usage_error(self->given, "--clamp-midway: no pins hold exactly the "
                                        "first two rows or columns");
    }
    int code = converge_add_quantities(self);
    code = code == EXIT_DONE ? read_sizes(self, converge_own(given)->sizes) : code;
    for (size_t i = 0; i < self->count && code == EXIT_DONE; ++i) {
        code = open_size(self, &self->sizes[i]);
    }
    return code;
}

static int converge_verb(const arguments *given)
{
    converge self = { .given = given, .progress.mode = given->mode };
    weft_scene *scene = NULL;
    int code = open_scene(given->operands[0], given, &scene, NULL);
    if (code == EXIT_DONE) {
        self.scene = scene;
        code = prepare(&self, given);
    }
    if (code == EXIT_DONE) {
        warn_of_particles(&self);
        code = run_sizes(&self);
    }
    for (size_t i = 0; i < self.count; ++i) {
        weft_cloth_destroy(self.sizes[i].cloth);
        weft_scene_destroy(self.sizes[i].scene);
    }
    refine_end(&self.grid);
    weft_scene_destroy(scene);
    return code;
}

static const verb_option options[] = {
    OWN(converge_options, sizes, "sizes", "N1,N2,...",
        "numbers of particles, increasing, 2 to 16 of them"),
    OWN(converge_options, ats, "at", "WHAT",
        "a column of series.csv, or a particle of the scene as ROW,COL (a number, "
        "negative from the end, or middle), or of a mesh as VERTEX, of several cloths "
        "CLOTH:VERTEX, or tip (the middle of the last row, or the end of a single "
        "row), middle, top-left, top-right, bottom-left, bottom-right; .x, .y or .z "
        "after it selects a coordinate; default: tip, of a mesh elastic; may be "
        "repeated"),
    OWN(converge_options, clamp_midway, "clamp-midway", NULL,
        "two pinned rows or columns at the beginning stay two, and the extent counts "
        "from midway between them, where they clamp cloth that resists bending"),
    OWN(converge_options, csv, "csv", NULL, "print the table as CSV, all digits"),
    SHARED(jobs, "jobs", "N", "number of processes; default 1"),
    OPTION_SET,
    OPTION_PLUGIN_PATH,
    SHARED(quiet, "quiet", NULL, "no progress"),
};

const verb verb_converge = {
    .name = "converge",
    .summary = "refine a cloth, print the order at which results converge",
    .help
    = "usage: weft converge SCENE.yaml --sizes N1,N2,... [OPTIONS]\n"
      "\n"
      "Runs a scene with N1, N2, ... particles along its larger extent, writes "
      "nothing, and compares quantities at the end of the runs. The extents of the "
      "cloth do not change, nor do the places of pins and loads on it: row 3 of 9 is "
      "row 6 of 17. A size on whose grid one of these has no particle is refused.\n"
      "\n"
      "Of a mesh the numbers divide its edges: 1 is the scene's own, 2 has the spacing "
      "of a cut halved, or each triangle of a file in four (powers of 2).\n"
      "\n"
      "Prints for each size the spacing [m], the value, its difference from the size "
      "before, and from the third size on the observed order p, at which value + c "
      "spacing^p passes through the last three values, and the limit that it "
      "extrapolates (Richardson). '-': the differences change their sign or vanish, or "
      "the value does not converge. The error of the steps must be far smaller than "
      "the differences: choose small tolerances.\n"
      "\n"
      "Density, fabrics, bending rigidity, wind and contact do not depend on the size. "
      "What is given for each particle or spring does; a warning names it.\n",
    OPTIONS(options),
    .own_size = sizeof(converge_options),
    .more = "examples:\n"
            "  weft converge scenes/pennant.yaml --sizes 7,13,25 --at elastic -j 2\n"
            "  weft converge strip.yaml --sizes 9,17,33,65 --clamp-midway --at tip\n"
            "\n"
            "exit codes: 0 done, 1 a run failed, 2 wrong command line, 3 wrong scene, "
            "4 a file could not be read\n",
    .operands = { 1, 1, "no scene given", "more than one scene" },
    .run = converge_verb,
};
