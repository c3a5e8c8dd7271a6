/* SPDX-License-Identifier: BSD-3-Clause */
/* compare.c -- weft compare: references, horizon, ladders, times, advice. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "base/suggest.h"
#include "plugin/methods.h"
#include "program/record/child_process.h"
#include "study/compare/compare.h"

/* Those of this verb alone. */
typedef struct compare_options {
    const char *methods;
    const char *until;
} compare_options;

static const compare_options *compare_own(const arguments *given)
{
    return given->own;
}

enum { CALL_TIMES = 5, NAME_MOST = 256 };

#define RUNGS_WORTH 2.5 /* the cost of a ladder, in its most expensive run */

/* ---- methods ---------------------------------------------------------------- */

/* Takes the next word off a list separated by commas; false: there is none. */
static bool next_word(const char **list, char word[NAME_MOST])
{
    if (*list == NULL || **list == '\0') {
        return false;
    }
    const size_t length = strcspn(*list, ",");
    (void)snprintf(word, NAME_MOST, "%.*s", (int)length, *list);
    *list += length + ((*list)[length] == ',');
    return true;
}

/* "gsl", "rkf45" or "gsl/rkf45" */
static bool is_meant(const stepper_method *m, const char *word)
{
    const size_t id = strlen(m->plugin->id);
    return strcmp(word, m->plugin->id) == 0 || weft_stepper_is(m->type, word)
           || (strncmp(word, m->plugin->id, id) == 0 && word[id] == '/'
               && weft_stepper_is(m->type, word + id + 1));
}

/* The first word of a list that is no method, and the nearest name; false: all are. */
static bool unknown_word(const weft_registry *registry, const char *list,
                         char word[NAME_MOST], weft__guess *near)
{
    bool known = true;
    while (known && next_word(&list, word)) {
        stepper_method m;
        known = false;
        *near = (weft__guess){ 0 };
        for (size_t i = 0; !known && method_at(registry, i, &m); ++i) {
            known = is_meant(&m, word);
            weft__guess_try(near, word, m.type->name);
            weft__guess_try(near, word, m.plugin->id);
        }
    }
    return !known;
}

/* Steps end at frames, so a whole number of them makes a frame. */
static weft_status set_steps(const compare *self, compare_method *method,
                             weft_error *err)
{
    survey_method stable = { 0 };
    const weft_status status
        = stable_step(self->scene, method->by.type, &self->modes, &stable, err);
    if (status == WEFT_NO_MEMORY) {
        return status;
    }
    if (status != WEFT_OK || !(stable.step > 0.0)) {
        (void)snprintf(method->left_out, sizeof method->left_out,
                       "no error control, and no step is known to be stable");
        return WEFT_OK;
    }
    method->step = compare_time(self, 1) / frame_steps(&self->run, stable.step);
    method->step_calls = stable.calls;
    return WEFT_OK;
}

static weft_status add_method(compare *self, const stepper_method *by, weft_error *err)
{
    compare_method *method = &self->shared->methods[self->count++];
    const size_t n = weft_cloth_particles(self->cloth);
    method->by = *by;
    method->own = by->type == weft_scene_method_type(self->scene);
    char matrices[128];
    if (weft_stepper_matrices(by->type, n, matrices, sizeof matrices) > 0.0
        && n > WEFT__DENSE_MOST) {
        (void)snprintf(method->left_out, sizeof method->left_out,
                       "%s: for small cloths only", matrices);
        return WEFT_OK;
    }
    return method_adapts(by->type) ? WEFT_OK : set_steps(self, method, err);
}

/* The scene's own method is added whether listed or not. */
static weft_status add_methods(compare *self, weft_error *err)
{
    stepper_method m;
    double *y = calloc(weft_cloth_dim(self->cloth), sizeof *y);
    if (y == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state");
    }
    weft_cloth_start(self->cloth, y);
    self->modes = weft_cloth_stiffness(self->cloth, 0.0, y);
    free(y);
    for (size_t i = 0; method_at(self->given->registry, i, &m); ++i) {
        const char *list = compare_own(self->given)->methods; /* NULL: all */
        char word[NAME_MOST];
        bool listed = list == NULL;
        while (!listed && next_word(&list, word)) {
            listed = is_meant(&m, word);
        }
        if (m.type == weft_scene_method_type(self->scene)
            || (listed && (m.type->flags & WEFT_STEPPER_BUTCHER) == 0)) {
            TRY(add_method(self, &m, err));
        }
    }
    return WEFT_OK;
}

/* ---- references and horizon ------------------------------------------------- */

static void reference_ended(void *ctx, const process *one)
{
    const compare *self = ctx;
    job_error(one, &self->shared->err[one->job]);
}

/* The frames that both references have. */
static void reference_tick(void *ctx)
{
    compare *self = ctx;
    size_t done = 0;
    while (done < self->planned && self->calls[0][done + 1] > 0
           && self->calls[1][done + 1] > 0) {
        ++done;
    }
    if (done > 0) {
        progress_count(&self->progress, "frames", done, self->planned);
    }
}

/* The growth of the perturbed's distance, by least squares of its logarithm over time,
 * and the energy at play. */
static void find_scales(compare *self)
{
    const size_t size = weft_cloth_dim(self->cloth);
    double low = self->energy[0], high = low, kinetic = 0.0;
    double t = 0.0, d = 0.0, tt = 0.0, td = 0.0, n = 0.0;
    for (size_t i = 0; i <= self->last; ++i) {
        const double x = compare_time(self, i),
                     y = log(fmax(self->perturbed[i], 1e-300));
        n += 1.0, t += x, d += y, tt += x * x, td += x * y;
        low = fmin(low, self->energy[i]), high = fmax(high, self->energy[i]);
        kinetic = fmax(
            kinetic,
            weft_cloth_energy(self->cloth, x, self->frames[0] + i * size).kinetic);
    }
    self->growth = (n * td - t * d) / (n * tt - t * t);
    self->at_play = fmax(high - low, kinetic);
}

static weft_status no_horizon(const compare *self, weft_error *err)
{
    const char *hint = weft_scene_limit(self->scene)->method == WEFT_LIMIT_NONE
                           ? ""
                           : "; the effect of a strain limit depends on the steps";
    return self->parted
               ? weft_error_set(
                   err, WEFT_UNSUPPORTED,
                   "no reference: %s and %s at tolerance %g differ by more "
                   "than %g m at the first frame%s",
                   self->by[0].type->name, self->by[1].type->name, COMPARE_TIGHTEST,
                   COMPARE_PARTED, hint)
               : weft_error_set(
                   err, WEFT_UNSUPPORTED,
                   "not predictable: a perturbed run displaced by %g m is more than "
                   "%g m away at the first frame%s",
                   COMPARE_NUDGE, COMPARE_GROWTH * COMPARE_NUDGE, hint);
}

static weft_status find_horizon(compare *self, weft_error *err)
{
    const size_t n = weft_cloth_particles(self->cloth);
    double unused = 0.0;
    self->chaotic = self->last < self->planned;
    self->apart = 0.0;
    for (size_t i = 0; i <= self->last; ++i) {
        const size_t at = i * 6 * n;
        const double apart
            = compare_farthest(self->frames[0] + at, self->frames[1] + at, n, &unused);
        if (!(apart <= COMPARE_PARTED)) {
            self->last = i - 1;
            self->parted = true;
            break;
        }
        self->apart = fmax(self->apart, apart);
    }
    if (self->last == 0) {
        return no_horizon(self, err);
    }
    find_scales(self);
    return WEFT_OK;
}

static weft_status make_references(compare *self, weft_error *err)
{
    TRY(jobs_run(self->given, self, 2, compare_reference, reference_ended,
                 reference_tick, err));
    progress_clear(&self->progress);
    self->progress.tenth = 0; /* the methods are counted anew */
    self->last = atomic_load(&self->shared->last);
    for (size_t i = 0; i < 2; ++i) {
        const weft_error *why = &self->shared->err[i];
        /* Whether a reference runs past the horizon, and fails there, depends on -j. */
        if (why->status != WEFT_OK && self->calls[i][self->last] == 0) {
            return weft_error_set(err, why->status, "no reference: %s %s: %s",
                                  self->by[i].plugin->id, self->by[i].type->name,
                                  why->message);
        }
    }
    return find_horizon(self, err);
}

/* ---- ladders and times ------------------------------------------------------ */

static void ladder_ended(void *ctx, const process *one)
{
    compare *self = ctx;
    compare_point *points = self->shared->methods[one->job].points;
    for (size_t i = 0; one->status != 0 && i < COMPARE_RUNGS; ++i) {
        if (points[i].outcome == COMPARE_RUNNING) {
            points[i].outcome = COMPARE_FAILED;
            process_describe(one->status, points[i].why, sizeof points[i].why);
        }
    }
    if (one->job < self->count) { /* else the scene as it is, no method */
        ++self->over;
        progress_count(&self->progress, "methods", self->over, self->count);
    }
}

static int by_value(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* The time of a run with an explicit method is taken from its calls, which do not
 * depend on the machine's load. */
static void set_times(compare_method *of, const compare_method *method)
{
    const bool follows = method->call_time > 0.0 && !compare_is_implicit(method);
    for (size_t i = 0; i < COMPARE_RUNGS && follows; ++i) {
        of->points[i].time = (double)of->points[i].calls * method->call_time;
    }
}

/* In rounds, so that other load of the machine affects all methods alike. */
static weft_status take_times(const compare *self, weft_error *err)
{
    double(*times)[CALL_TIMES] = calloc(self->count, sizeof *times);
    if (times == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for times");
    }
    for (size_t turn = 0; turn < CALL_TIMES; ++turn) {
        for (size_t i = 0; i < self->count; ++i) {
            times[i][turn] = compare_call_time(self, &self->shared->methods[i]);
        }
    }
    compare_method *methods = self->shared->methods;
    for (size_t i = 0; i < self->count; ++i) {
        qsort(times[i], CALL_TIMES, sizeof times[i][0], by_value);
        methods[i].call_time = times[i][CALL_TIMES / 2];
        set_times(&methods[i], &methods[i]);
        if (methods[i].own) {
            set_times(&methods[self->count], &methods[i]);
        }
    }
    free(times);
    return WEFT_OK;
}

static weft_status compare_all(compare *self, weft_error *err)
{
    TRY(jobs_run(self->given, self, 1, compare_stiffness, NULL, NULL, err));
    TRY(make_references(self, err));
    /* the calls of the costlier reference up to `last`, at most a share of COMPARE_WORK
     */
    const double share = COMPARE_WORK
                         / ((double)weft_cloth_particles(self->cloth) * RUNGS_WORTH
                            * (double)(self->count + 1));
    const double dearest
        = fmax((double)self->calls[0][self->last], (double)self->calls[1][self->last]);
    self->budget = (uint64_t)fmin(share, dearest);
    const weft_status status = jobs_run(self->given, self, self->count + 1,
                                        compare_ladder, ladder_ended, NULL, err);
    progress_clear(&self->progress);
    return status == WEFT_OK ? take_times(self, err) : status;
}

/* ---- the verb --------------------------------------------------------------- */

static weft_status open_memory(compare *self, weft_error *err)
{
    const size_t frames = self->planned + 1, dim = weft_cloth_dim(self->cloth);
    self->shared = process_memory(1, sizeof *self->shared
                                         + (method_count(self->given->registry) + 1)
                                               * sizeof *self->shared->methods);
    bool able = self->shared != NULL;
    for (size_t i = 0; i < 2; ++i) {
        self->frames[i] = process_memory(frames, dim * sizeof(double));
        self->calls[i] = process_memory(frames, sizeof(uint64_t));
        able = able && self->frames[i] != NULL && self->calls[i] != NULL;
    }
    self->perturbed = process_memory(frames, sizeof(double));
    self->energy = process_memory(frames, sizeof(double));
    if (!able || self->perturbed == NULL || self->energy == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %zu frames", frames);
    }
    atomic_store(&self->shared->last, self->planned);
    return WEFT_OK;
}

/* Checks for references before it makes the directory. */
static weft_status compare_into(compare *self, const char *directory, weft_error *err)
{
    compare_advice advice;
    TRY(scene_supported(self->scene, err));
    TRY(cloth_create(self->scene, weft_scene_cloth(self->scene), &self->cloth, err));
    const weft_registry *registry = self->given->registry;
    if (!method_best(registry, NULL, &self->by[0])
        || !method_best(registry, &self->by[0], &self->by[1])) {
        return weft_error_set(
            err, WEFT_UNSUPPORTED,
            "no two explicit methods with error control, of which one "
            "would check the other");
    }
    TRY(start_create(self->scene, self->cloth, true, &self->start, err));
    TRY(record_outdir(directory, self->given->force, err));
    TRY(open_memory(self, err));
    TRY(add_methods(self, err));
    compare_begin(self, directory);
    weft_status status = compare_all(self, err);
    if (status == WEFT_OK) {
        compare_advise(self, &advice);
        status = compare_csv(self, directory, err);
    }
    status = status == WEFT_OK ? compare_html(self, &advice, directory, err) : status;
    if (status == WEFT_OK && !self->given->quiet
        && self->progress.mode != PROGRESS_YAML) {
        compare_print(self, &advice);
        print_plainly(stdout, "written: %s/compare.csv, %s/compare.html\n", directory,
                      directory);
    }
    compare_end(self, status == WEFT_OK ? NULL : err->message);
    return status;
}

static int compare_scene(const arguments *given, double until, const weft_scene *scene)
{
    char text[RECORD_PATH], word[NAME_MOST], near[80];
    weft__guess guess = { 0 };
    weft_error err = { 0 };
    compare self = { .given = given,
                     .scene = scene,
                     .run = *weft_scene_run(scene),
                     .progress.mode = given->mode };
    self.run.duration = fmin(self.run.duration, until);
    self.planned = weft_run_last_frame(&self.run);
    (void)load_plugins(given->registry, NULL);
    if (unknown_word(given->registry, compare_own(given)->methods, word, &guess)) {
        return usage_error(given,
                           "--methods: no method '%s'%s; weft steppers lists them",
                           word, weft__guess_text(&guess, near, sizeof near));
    }
    const weft_status status
        = compare_into(&self, out_directory(given, ".compare", text), &err);
    weft_cloth_destroy(self.cloth);
    free(self.start);
    return status == WEFT_OK ? EXIT_DONE : report_error(&err);
}

static int compare_verb(const arguments *given)
{
    const double until = compare_own(given)->until == NULL
                             ? (double)INFINITY
                             : option_real(compare_own(given)->until);
    weft_scene *scene = NULL;
    if (!(until > 0.0)) {
        return usage_error(given, "--until %s: not a time [s] > 0",
                           compare_own(given)->until);
    }
    int code = open_scene(given->operands[0], given, &scene, NULL);
    code = code == EXIT_DONE ? compare_scene(given, until, scene) : code;
    weft_scene_destroy(scene);
    return code;
}

static const verb_option options[] = {
    OWN(compare_options, methods, "methods", "LIST",
        "only these, and the scene's own: gsl, rkf45, gsl/rkf45, ... separated by "
        "commas"),
    OWN(compare_options, until, "until", "T",
        "end the comparison at T [s]; default: the scene's end"),
    SHARED(jobs, "jobs", "N",
           "number of processes; default 1. One process measures times"),
    SHARED(out, "out", "DIR",
           "output directory; default: ./SCENE.compare. Must be new or empty"),
    SHARED(force, "force", NULL, "replace the files of an earlier run"),
    OPTION_SET,
    OPTION_PLUGIN_PATH,
    SHARED(progress, "progress", "HOW",
           "auto, lines, terminal, yaml or none, as for weft run"),
    SHARED(quiet, "quiet", NULL, "no progress, no table"),
};

const verb verb_compare = {
    .name = "compare",
    .summary = "measure the cost of every method on a scene, by accuracy",
    .help
    = "usage: weft compare SCENE.yaml [OPTIONS]\n"
      "\n"
      "Runs a scene with every method of every plugin, at tolerances from 1e-2 to "
      "1e-10 or with fixed steps. Measures the difference from a reference [m] and the "
      "force evaluations and processor time. Prints the fastest method for each "
      "accuracy, and writes compare.csv and compare.html, a diagram for a browser.\n"
      "\n"
      "The reference is the scene at tolerance 1e-12 with the methods of the highest "
      "order of two plugins; if they disagree nothing is judged. Cloth may be chaotic: "
      "the comparison ends when an initial difference of 1e-10 m has grown 10 000 "
      "times.\n",
    OPTIONS(options),
    .own_size = sizeof(compare_options),
    .more = "examples:\n"
            "  weft compare scenes/two-corners.yaml -j 2\n"
            "  weft compare scenes/curtain.yaml --methods gsl,verlet --until 0.5\n"
            "\n"
            "exit codes: 0 done, 1 there is no reference, 2 wrong command line, 3 "
            "wrong scene, 4 a file could not be read or written\n",
    .operands = { 1, 1, "no scene given", "more than one scene" },
    .run = compare_verb,
};
