/* SPDX-License-Identifier: BSD-3-Clause */
/* converge.c -- weft converge: the sizes and their runs. Each run has its own process,
 * which writes its results to shared memory. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "cli/check/stable_steps.h"
#include "cli/converge/converge.h"
#include "cli/human.h"
#include "record/child_process.h"

/* ---- sizes ------------------------------------------------------------------ */

static bool fits(const converge *self, refinement *grid, size_t size,
                 char what[REFINE_PLACE])
{
    size_t particle;
    bool fit = refine_to(grid, size, what);
    for (size_t i = 0; i < self->quantity_count && fit; ++i) {
        const converge_quantity *one = &self->quantities[i];
        fit = !one->particle || converge_particle(grid, one, &particle);
        if (!fit) {
            (void)snprintf(what, REFINE_PLACE, "the particle of %s", one->name);
        }
    }
    return fit;
}

static int refuse_size(const converge *self, size_t size, const char *what)
{
    enum { SHOWN = 4 };
    sentence list = { "" };
    char unused[REFINE_PLACE];
    refinement grid = self->grid;
    const size_t most = 4 * self->grid.axis[self->grid.along].count;
    for (size_t n = 2, shown = 0; n <= most && shown < SHOWN; ++n) {
        if (fits(self, &grid, n, unused)) {
            say(&list, "%s%zu", shown++ == 0 ? "" : ", ", n);
        }
    }
    return usage_error(&verb_converge, "--sizes: %zu does not keep %s; %s%s", size,
                       what,
                       list.text[0] == '\0' ? "no size does" : "these do: ", list.text);
}

static int read_sizes(converge *self, const char *list)
{
    char what[REFINE_PLACE];
    size_t before = 1;
    while (list != NULL && *list != '\0') {
        size_t size;
        const size_t length = strcspn(list, ",");
        if (!option_count(list, list[length], &size) || size <= before
            || size > CONVERGE_LARGEST || self->count == CONVERGE_SIZES) {
            return usage_error(&verb_converge,
                               "--sizes: '%.*s': not a number from 2 to %d above the "
                               "one before, or more than %d of them",
                               (int)length, list, CONVERGE_LARGEST, CONVERGE_SIZES);
        }
        self->size[self->count++] = before = size;
        list += length + (list[length] == ',');
    }
    if (self->count < 2) {
        return usage_error(&verb_converge,
                           "--sizes needs two sizes or more, as --sizes 9,17,33");
    }
    for (size_t i = 0; i < self->count; ++i) {
        self->grids[i] = self->grid;
        if (!fits(self, &self->grids[i], self->size[i], what)) {
            return refuse_size(self, self->size[i], what);
        }
    }
    return EXIT_DONE;
}

/* The scene on the grid of a size. Its own mistakes follow from the grid. */
static int open_size(converge *self, const options *given, size_t i)
{
    char *text = refine_sets(&self->grids[i]);
    const char **sets = calloc(given->set_count + REFINE_SETS, sizeof *sets);
    options refined = *given;
    int code = EXIT_SIMULATION;
    if (text != NULL && sets != NULL) {
        const char *set = text;
        memcpy(sets, given->sets, given->set_count * sizeof *sets);
        refined.sets = sets;
        for (size_t k = 0; k < REFINE_SETS; ++k, set += strlen(set) + 1) {
            sets[refined.set_count++] = set;
        }
        code = open_scene(given->operands[0], &refined, &self->scenes[i], NULL);
    }
    if (code != EXIT_DONE) {
        fprintf(stderr, "weft: error: no scene of size %zu\n", self->size[i]);
    }
    free(sets);
    free(text);
    return code;
}

/* ---- runs, in processes of their own ---------------------------------------- */

typedef struct size_run {
    record_series series; /* without a file */
    size_t last;          /* frame */
    uint64_t limit_sweeps;
    weft_sim *sim;
} size_run;

static weft_status on_frame(void *ctx, size_t index, weft_error *err)
{
    size_run *self = ctx;
    const uint64_t sweeps = weft_sim_limit_stats(self->sim).sweeps;
    const record_frame frame = { index, self->sim, sweeps - self->limit_sweeps };
    self->limit_sweeps = sweeps;
    return index < self->last ? WEFT_OK : record_series_add(&self->series, &frame, err);
}

static void take_values(const converge *self, size_t i, const size_run *run)
{
    const double *y = weft_sim_state(run->sim);
    const size_t n = weft_cloth_particles(weft_sim_cloth(run->sim));
    for (size_t k = 0; k < self->quantity_count; ++k) {
        const converge_quantity *one = &self->quantities[k];
        size_t particle;
        (void)converge_particle(&self->grids[i], one, &particle);
        self->results[i].values[k] = one->particle ? y[one->which * n + particle]
                                                   : run->series.row[one->which];
    }
}

static void warn_of_step(const converge *self, size_t i, const weft_sim *sim)
{
    if (stability_warn(self->scenes[i], sim, true)) {
        fprintf(stderr,
                "weft: warning: size %zu: stepper.fixed_step is beyond the largest "
                "stable step\n",
                self->size[i]);
    }
}

/* process_def.work */
static int run_size(void *ctx, size_t i)
{
    const converge *self = ctx;
    const weft_scene *scene = self->scenes[i];
    weft_error *err = &self->results[i].err;
    weft_cloth *cloth;
    size_run run = { .last = weft_run_last_frame(weft_scene_run(scene)) };
    const weft_play frames = {
        .run = weft_scene_run(scene), .last = run.last, .frame = on_frame, .ctx = &run
    };
    record_series_begin(&run.series, series_columns(scene));
    weft_status status = simulation_create(scene, &cloth, &run.sim, err);
    if (status == WEFT_OK) {
        warn_of_step(self, i, run.sim);
        status = weft_sim_play(run.sim, &frames, err);
    }
    if (status == WEFT_OK) {
        take_values(self, i, &run);
        self->results[i].done = true;
    }
    weft_sim_destroy(run.sim);
    weft_cloth_destroy(cloth);
    return EXIT_DONE;
}

static void size_ended(void *ctx, const process *one)
{
    converge *self = ctx;
    weft_error *err = &self->results[one->job].err;
    if (one->status != 0) {
        err->status = WEFT_SOLVER;
        process_describe(one->status, err->message, sizeof err->message);
    }
    progress_count(&self->progress, "sizes", ++self->over, self->count);
}

/* Reports the sizes that failed; the others have their values. */
static int report_failures(const converge *self)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < self->count; ++i) {
        const char *message = self->results[i].err.message;
        weft_error why = self->results[i].err;
        if (!self->results[i].done) {
            (void)snprintf(why.message, sizeof why.message, "size %zu: %.*s",
                           self->size[i], (int)sizeof why.message - 40, message);
            code = report_error(&why);
        }
    }
    return code;
}

static int run_sizes(converge *self, size_t jobs)
{
    process_pool pool
        = { .def = { .work = run_size, .ctx = self, .end_signal = SIGKILL },
            .jobs = self->count,
            .at_once = jobs,
            .ended = size_ended };
    weft_error err = { 0 };
    self->results = process_memory(self->count, sizeof *self->results);
    if (self->results == NULL) {
        weft_error_set(&err, WEFT_NO_MEMORY, "no memory for the results");
        return report_error(&err);
    }
    const bool able = process_pool_run(&pool);
    progress_clear(&self->progress);
    if (!able) {
        weft_error_set(&err, WEFT_SOLVER, "no process for a run: %s", strerror(errno));
        return report_error(&err);
    }
    return report_failures(self);
}

/* ---- the verb --------------------------------------------------------------- */

/* Whether a load lies on several particles. */
static bool is_spread(const weft_cloth_def *cloth)
{
    bool spread = false;
    for (size_t i = 0; i < cloth->load_count; ++i) {
        const weft_load *load = &cloth->loads[i];
        spread = spread || (cloth->rows > 1 && load->rows.first != load->rows.last)
                 || (cloth->cols > 1 && load->cols.first != load->cols.last);
    }
    return spread;
}

static void warn_of_particles(const weft_cloth_def *cloth)
{
    const weft_spring_def *bend = &cloth->springs[WEFT_BEND];
    const struct {
        bool used;
        const char *key;
    } keys[] = { { cloth->mass > 0.0, "cloth.mass" },
                 { cloth->drag > 0.0, "forces.damping" },
                 { is_spread(cloth), "the mass of cloth.loads" },
                 { bend->present && bend->stiffness > 0.0, "cloth.springs.bend" } };
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        if (keys[i].used) {
            fprintf(stderr,
                    "weft: warning: %s is the same for each %s, so its effect depends "
                    "on the size\n",
                    keys[i].key, i < 3 ? "particle" : "spring");
        }
    }
}

static int prepare(converge *self, const options *given)
{
    refine_begin(&self->grid, weft_scene_cloth(self->scene));
    if (given->clamp_midway && !refine_clamp(&self->grid)) {
        return usage_error(&verb_converge,
                           "--clamp-midway: no pins hold exactly the first two or the "
                           "last two rows or columns");
    }
    int code = converge_add_quantities(self, given);
    code = code == EXIT_DONE ? read_sizes(self, given->sizes) : code;
    for (size_t i = 0; i < self->count && code == EXIT_DONE; ++i) {
        code = open_size(self, given, i);
    }
    return code;
}

static int converge_verb(const options *given)
{
    converge self = { .progress.mode = given->mode };
    weft_scene *scene = NULL;
    int code = open_scene(given->operands[0], given, &scene, NULL);
    self.scene = scene;
    code = code == EXIT_DONE ? prepare(&self, given) : code;
    if (code == EXIT_DONE) {
        warn_of_particles(weft_scene_cloth(scene));
        code = run_sizes(&self, given->jobs > 0 ? given->jobs : 1);
        if (self.results != NULL) {
            (given->csv ? converge_csv : converge_print)(&self);
        }
    }
    for (size_t i = 0; i < self.count; ++i) {
        weft_scene_destroy(self.scenes[i]);
    }
    weft_scene_destroy(scene);
    return code;
}

const verb verb_converge = {
    .name = "converge",
    .summary = "refine a cloth, print the order at which its results converge",
    .help
    = "usage: weft converge SCENE.yaml --sizes N1,N2,... [OPTIONS]\n\n"
      "Runs a scene with N1, N2, ... particles along its larger extent, writes "
      "nothing, "
      "and compares quantities at the end of the runs. The extents (rows - 1) * "
      "spacing "
      "and (cols - 1) * spacing and their ratio in intervals do not change, nor do the "
      "places of pins and loads on the cloth: row 3 of 9 is row 6 of 17. A size on "
      "whose "
      "grid one of these has no particle is refused.\n\n"
      "Prints for each size the spacing [m], the value, its difference from the "
      "size before, and from the third size on the observed order p, at which value + "
      "c spacing^p passes through the last three values, and the limit that it "
      "extrapolates (Richardson). '-': the differences change their sign or vanish, or "
      "the value does not converge. The error of the steps must be far smaller than "
      "the "
      "differences: choose small tolerances.\n\n"
      "Density, fabrics, bending rigidity, wind and contact do not depend on the size. "
      "What is given for each particle or spring does: mass, forces.damping, loads of "
      "several particles, bend springs, and in a chain all springs of law hooke.\n\n"
      "  --sizes N1,N2,...    numbers of particles, increasing, 2 to 16 of them\n"
      "  --at WHAT            a column of series.csv, or a particle of the scene as "
      "ROW,COL (negative: from the end), or tip (the middle of the last row, or the "
      "end "
      "of a single row), middle, top, bottom, left, right (of the cloth, of an edge), "
      "top-left, ...; .x, .y or .z after it selects a coordinate; default: tip; may be "
      "repeated\n"
      "  --clamp-midway       two pinned rows or columns at an end stay two, and the "
      "extent counts from midway between them, where they clamp cloth that resists "
      "bending\n"
      "  --csv                print the table as CSV, all digits\n"
      "  -j, --jobs N         number of processes; default 1\n"
      "  --set KEY.PATH=VALUE override a key of the scene; may be repeated\n"
      "  --plugin-path DIRS   search stepper plugins there first ('a:b')\n"
      "  --quiet              no progress\n\n"
      "examples:\n"
      "  weft converge scenes/hammock.yaml --sizes 9,17,33 --at middle.y -j 2\n"
      "  weft converge strip.yaml --sizes 9,17,33,65 --clamp-midway --at tip\n\n"
      "exit codes: 0 done, 1 a run failed, 2 wrong command line, 3 wrong scene, 4 a "
      "file could not be read\n",
    .options
    = OPTIONS(OPTION_VALUE("sizes", sizes), OPTION_VALUE("at", ats),
              OPTION_FLAG("clamp-midway", clamp_midway), OPTION_FLAG("csv", csv),
              OPTION_VALUE("jobs", jobs), OPTION_VALUE("set", sets),
              OPTION_VALUE("plugin-path", plugin_path), OPTION_FLAG("quiet", quiet)),
    .operands = { 1, 1, "no scene given", "more than one scene" },
    .run = converge_verb,
};
