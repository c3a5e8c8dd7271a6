/* SPDX-License-Identifier: BSD-3-Clause */
/* run.c -- weft run: a scene from t = 0 to its end, into a directory. */
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "program/record/export/export.h"
#include "program/run/run.h"
#include "program/survey/survey.h"
#include "program/watch/watch.h"

/* What the simulation warns of, in bands all of the same, also when quiet. */
static void on_log(void *ctx, weft_log_level level, const char *text)
{
    run *self = ctx;
    if (level == WEFT_LOG_WARNING && ranks_first(self->comm)) {
        progress_clear(&self->progress);
        fprintf(stderr, "weft: warning: %s\n", text);
    }
}

/* At most once per run, even with --quiet. */
static void warn_of_held(run *self)
{
    char spring[SPRING];
    const weft_spring worst = weft_sim_limit_worst(self->sim);
    (void)weft_spring_text(self->cloth, &worst, spring, sizeof spring);
    const size_t held = weft_sim_limit_held(self->sim);
    if (held > 0 && !self->warned_held) {
        self->warned_held = true;
        progress_clear(&self->progress);
        fprintf(stderr,
                "weft: warning: limit: %zu springs with both ends pinned are too long "
                "at t = %.6g s and cannot be corrected; %s is at %.3g %%\n",
                held, weft_sim_time(self->sim), spring, 100.0 * worst.strain);
    }
}

static weft_status write_planes(const run *self, const char *name,
                                record_write_fn *write, const double *y,
                                weft_error *err)
{
    record_surface surface = { .doubles = true };
    const weft_cloth *cloth = self->whole != NULL ? self->whole : self->cloth;
    weft_status status = record_faces_of(cloth, &surface.faces, err);
    const size_t n = surface.faces.particles;
    double *values = malloc(6 * n * sizeof *values);
    if (status == WEFT_OK && values == NULL) {
        status = weft_error_set(err, WEFT_NO_MEMORY, "no memory for %s", name);
    }
    for (size_t i = 0; status == WEFT_OK && i < n; ++i) { /* a band has n here */
        const size_t at = surface.faces.cols > 0 ? i : weft_cloth_index(cloth, i);
        for (size_t k = 0; k < 6; ++k) {
            values[k / 3 * 3 * n + 3 * i + k % 3] = y[k * n + at];
        }
    }
    surface.position = values;
    surface.velocity = values + 3 * n;
    if (status == WEFT_OK) {
        status = record_surface_write(self->out, name, write, &surface, err);
    }
    record_faces_free(&surface.faces);
    free(values);
    return status;
}

static weft_status write_state(const run *self, const char *name,
                               record_write_fn *write, weft_error *err)
{
    const double *y;
    double *gathered;
    weft_status status = run_state(self, &y, &gathered, err);
    if (status == WEFT_OK && ranks_first(self->comm)) {
        status = write_planes(self, name, write, y, err);
    }
    free(gathered);
    return run_agree(self, status, err);
}

/* Whether this frame ends the run, by `stop` of the scene. */
static bool is_stopped(const run *self)
{
    return weft_sim_event(self->sim) && !weft_sim_is_between(self->sim);
}

/* ---- the frame loop; each callback takes the records from the watch ----------- */

static weft_status add_frame(run *self, size_t index, weft_error *err)
{
    const weft_limit_stats limit = weft_sim_limit_stats(self->sim);
    const record_frame frame = { .index = index,
                                 .sim = self->sim,
                                 .limit_sweeps = limit.sweeps - self->limit_sweeps,
                                 .is_end = is_stopped(self) };
    self->limit_sweeps = limit.sweeps;
    warn_of_held(self);
    /* The rows first: every frame of run.vtkhdf has its row in the series. */
    TRY(run_agree(self, record_series_add(&self->series, &frame, err), err));
    TRY(run_agree(self, record_shapes_add(&self->shapes, &frame, err), err));
    TRY(record_vtkhdf_add(self->frames, &frame, err));
    if (weft_cloth_cols(self->cloth) > 0) { /* the first frame alone needed it */
        weft_cloth_destroy(self->whole);
        self->whole = NULL;
    }
    if (self->given->frames != NULL) {
        char name[64];
        (void)snprintf(name, sizeof name, "frames/frame-%06zu.obj", index);
        TRY(run_in_place(self, err));
        TRY(write_state(self, name, record_obj, err));
    }
    self->result.frames = index + 1;
    summary_frame(self);
    progress_show(&self->progress, index);
    return WEFT_OK;
}

static weft_status on_frame(void *ctx, size_t index, weft_error *err)
{
    run *self = ctx;
    (void)pthread_mutex_lock(&self->watch.records);
    const weft_status status = add_frame(self, index, err);
    (void)pthread_mutex_unlock(&self->watch.records);
    return status;
}

static weft_status on_checkpoint(void *ctx, size_t index, weft_error *err)
{
    run *self = ctx;
    (void)pthread_mutex_lock(&self->watch.records);
    const weft_status status = run_checkpoint(self, index, err);
    (void)pthread_mutex_unlock(&self->watch.records);
    return status;
}

static bool on_step(void *ctx)
{
    run *self = ctx;
    (void)pthread_mutex_lock(&self->watch.records);
    summary_step(self);
    if (self->given->mode >= PROGRESS_TERMINAL) { /* lines come with frames */
        progress_show(&self->progress, self->result.frames - 1);
    }
    (void)pthread_mutex_unlock(&self->watch.records);
    return interrupt_agreed(self->comm) == 0;
}

static const char *signal_name(void)
{
    return interrupt_signal() == SIGINT ? "SIGINT" : "SIGTERM";
}

/* Stopped before the files of the run were opened. Those of an earlier attempt stay as
 * they are: a checkpoint goes on from there. Returns the exit code. */
static int stopped_early(run *self)
{
    weft_error err = { 0 };
    weft_status status = run_in_place(self, &err);
    say(&self->reason, "%s before the first step", signal_name());
    self->result.status = "interrupted";
    self->result.reason = self->reason.text;
    self->result.wall_time = weft__wall_clock() - self->began;
    if (status == WEFT_OK && self->from == NULL) {
        status = record_scene_text(self->out, "scene.yaml", self->scene, &err);
    }
    if (status == WEFT_OK
        && (self->from == NULL || !record_exists(self->out, "result.yaml"))) {
        status = record_result_write(self->out, &self->result, &err);
    }
    if (status != WEFT_OK) {
        return report_error(&err);
    }
    if (self->given->mode == PROGRESS_YAML) {
        summary_yaml_end(self);
    } else if (!self->given->quiet) {
        print_plainly(stderr, "%s: interrupted by %s\n", self->out, self->reason.text);
    }
    return interrupt_code(interrupt_signal());
}

/* The step under way does not end. Nothing is known of the simulation but the frames
 * before: the thread that steps may be changing it. */
static void give_up(void *ctx)
{
    run *self = ctx;
    weft_error err = { 0 };
    if (!self->open) {
        const int early = stopped_early(self);
        (void)fflush(stdout);
        _exit(early);
    }
    progress_clear(&self->progress);
    weft_status status = run_close(self, WEFT_OK, &err);
    say(&self->reason, "%s within a step", signal_name());
    self->result.status = "interrupted";
    self->result.reason = self->reason.text;
    self->result.wall_time = weft__wall_clock() - self->began;
    status = status == WEFT_OK ? run_in_place(self, &err) : status;
    if (status == WEFT_OK) {
        status = record_result_write(self->out, &self->result, &err);
    }
    if (status == WEFT_OK && self->given->mode == PROGRESS_YAML) {
        summary_yaml_end(self);
    } else if (status == WEFT_OK && !self->given->quiet) {
        summary_print_frames(self);
    }
    const int code
        = status == WEFT_OK ? interrupt_code(interrupt_signal()) : report_error(&err);
    (void)fflush(stdout);
    _exit(code);
}

static weft_status simulate(run *self, weft_error *err)
{
    const weft_play frames = { .run = weft_scene_run(self->scene),
                               .first = self->result.frames,
                               .last = self->result.planned - 1,
                               .frame = on_frame,
                               .checkpoint = on_checkpoint,
                               .step = on_step,
                               .ctx = self };
    if (self->given->mode == PROGRESS_YAML) {
        summary_yaml_begin(self);
    }
    progress_begin(&self->progress, self->given->mode, self->sim, frames.run);
    (void)pthread_mutex_unlock(&self->watch.records);
    weft_status status = weft_sim_play(self->sim, &frames, err);
    (void)pthread_mutex_lock(&self->watch.records);
    interrupt_end(&self->watch);
    if (status == WEFT_STOPPED && interrupt_signal() != 0) {
        status = WEFT_OK;
    }
    progress_clear(&self->progress);
    return run_agree(self, run_close(self, status, err), err);
}

/* Another attempt may well succeed after an I/O error, not after another failure. */
static void note_failure(run *self, const weft_error *why)
{
    self->result.status = why->status == WEFT_IO ? "io_error" : "failed";
    self->result.reason = self->reason.text;
    say(&self->reason, "%s", why->message);
}

static int report_failure(run *self, const weft_error *why)
{
    weft_failure failure;
    note_failure(self, why);
    if (why->status == WEFT_IO || !weft_sim_failure(self->sim, &failure)) {
        return report_error(why);
    }
    failure_report(self->scene, self->comm, self->sim, &failure, &self->reason);
    return EXIT_SIMULATION;
}

/* The final state, then the result; the first error is returned. */
static weft_status write_ends(run *self, bool failed, weft_error *err)
{
    TRY(run_in_place(self, err));
    weft_status written = weft_scene_record(self->scene)->final
                              ? write_state(self, "final.csv", record_csv, err)
                              : WEFT_OK;
    if (written == WEFT_OK && self->perturbed != NULL) {
        written = record_sensitivities(self->out, self->scene, self->sim, err);
    }
    if (written != WEFT_OK && !failed) {
        note_failure(self, err);
    }
    const weft_status result
        = ranks_first(self->comm) ? record_result_write(self->out, &self->result,
                                                        written == WEFT_OK ? err : NULL)
                                  : WEFT_OK;
    return run_agree(self, written == WEFT_OK ? result : written, err);
}

/* What the result has of the simulation. */
static void take_results(run *self)
{
    self->result.wall_time = weft__wall_clock() - self->began;
    self->result.sim = self->sim;
    self->result.measures = weft_sim_measure(self->sim);
    self->result.ledger = weft_sim_ledger(self->sim);
    /* by what a checkpoint keeps, so that a run that was resumed has as many */
    self->result.warnings
        = (size_t)self->beyond
          + (size_t)(weft_sim_limit_stats(self->sim).unconverged > 0)
          + (size_t)(weft_sim_limit_held(self->sim) > 0)
          + (size_t)weft_sim_passed(self->sim)
          + (size_t)(weft_sim_vetoed(self->sim) > weft_sim_stats(self->sim).steps)
          + (size_t)(record_sensitivity_growth(self->scene, self->sim, NULL) > 1.0);
}

/* A signal that came after the last frame has changed nothing. */
static bool is_interrupted(const run *self)
{
    return interrupt_signal() != 0 && self->result.frames < self->result.planned
           && !is_stopped(self);
}

/* Why the run ended, as status and reason of the result. Returns the exit code. */
static int take_reason(run *self, weft_status status, const weft_error *why)
{
    if (status != WEFT_OK) {
        return report_failure(self, why);
    }
    if (is_interrupted(self)) {
        self->result.status = "interrupted";
        self->result.reason = signal_name();
        return interrupt_code(interrupt_signal());
    }
    if (is_stopped(self)) {
        const weft_stop_def *stop = &weft_scene_run(self->scene)->stop;
        say(&self->reason, "stop: %s %c %.9g", weft_stop_name(stop->quantity),
            stop->quantity == WEFT_STOP_STRAIN ? '>' : '<', stop->bound);
        if (stop->hold > 0.0) {
            say(&self->reason, " for %.9g s", stop->hold);
        }
        self->result.reason = self->reason.text;
    }
    return EXIT_DONE;
}

/* Finds, writes and prints the results after the loop. */
static int conclude(run *self, weft_status status, const weft_error *why)
{
    weft_error err = { 0 };
    take_results(self);
    const int code = take_reason(self, status, why);
    if (write_ends(self, status != WEFT_OK, &err) != WEFT_OK) {
        return report_error(&err);
    }
    if (strcmp(self->result.status, "done") == 0
        && !weft_scene_run(self->scene)->keep_checkpoint) {
        run_remove(self, RECORD_CHECKPOINT);
    }
    if (self->given->mode == PROGRESS_YAML) {
        summary_yaml_end(self);
    } else if (!self->given->quiet) {
        summary_print(self);
    }
    return code;
}

/* Reports that a valid scene cannot be run, in result.yaml too. */
static int refuse(run *self, const weft_error *why)
{
    weft_error err = { .status = WEFT_UNSUPPORTED };
    const record_result result = { .status = "failed",
                                   .reason = why->message,
                                   .planned = self->result.planned };
    if (why->status == WEFT_STOPPED && interrupt_signal() != 0) {
        return stopped_early(self);
    }
    (void)report_error(why);
    if (self->from == NULL && ranks_first(self->comm)
        && (record_scene_text(self->out, "scene.yaml", self->scene, &err) != WEFT_OK
            || (why->status == WEFT_SOLVER && self->start != NULL
                && record_crossings(self->out, self->cloth, self->start, &err)
                       != WEFT_OK)
            || record_result_write(self->out, &result, &err) != WEFT_OK)) {
        return report_error(&err);
    }
    return EXIT_SIMULATION;
}

/* The watch is ended where the run is over before its first step. */
static int run_prepared(run *self)
{
    weft_error err = { 0 };
    weft_status status
        = run_agree(self,
                    record_checkpoint_identify(&self->checkpoint, self->scene,
                                               self->given->registry, &err),
                    &err);
    self->beyond = stability_warn(self->scene, self->sim, self->from != NULL);
    self->result.energy_start = weft_energy_total(weft_sim_measure(self->sim).energy);
    (void)pthread_mutex_lock(&self->watch.records);
    self->open = true;
    if (status == WEFT_OK && self->from != NULL) {
        if (run_take_up(self, &err) != WEFT_OK) {
            interrupt_end(&self->watch);
            return report_error(&err);
        }
    } else if (status == WEFT_OK) {
        status = run_begin(self, &err);
    }
    if (status == WEFT_OK) {
        status = simulate(self, &err);
    } else {
        interrupt_end(&self->watch);
    }
    return conclude(self, status, &err);
}

/* The cloth, its first state and the simulation. What a checkpoint restores needs no
 * relaxing. */
static weft_status create(run *self, weft_error *err)
{
    weft_status status = WEFT_OK;
    if (self->comm != NULL && self->comm->rank == 0) {
        status = weft_cloth_create(weft_scene_cloth(self->scene), &self->whole, err);
    }
    TRY(run_agree(self, status, err));
    TRY(perturbed_create(self->given, self->scene, &self->perturbed, err));
    TRY(run_agree(self, band_create(self->scene, self->comm, &self->cloth, err), err));
    TRY(start_create(self->scene, self->cloth, self->from == NULL, &self->start, err));
    return band_sim_create(
        self->scene, self->comm, weft_scene_perturbed_def(self->perturbed),
        (weft_log){ on_log, self }, self->cloth, self->start, &self->sim, err);
}

static int run_simulation(run *self)
{
    weft_error err = { 0 };
    int code;
    self->began = weft__wall_clock();
    interrupt_begin(&self->watch, self->comm == NULL ? give_up : NULL, self);
    (void)pthread_mutex_unlock(&self->watch.records);
    if (create(self, &err) == WEFT_OK) {
        code = run_prepared(self);
    } else {
        (void)pthread_mutex_lock(&self->watch.records);
        interrupt_end(&self->watch);
        code = refuse(self, &err);
    }
    weft_sim_destroy(self->sim);
    weft_scene_perturbed_destroy(self->perturbed);
    weft_cloth_destroy(self->cloth);
    weft_cloth_destroy(self->whole);
    free(self->start);
    return code;
}

/* A new directory, or one that may be taken over; claimed. */
static weft_status open_directory(const run *self, int *lock, weft_error *err)
{
    if (!ranks_first(self->comm)) {
        return WEFT_OK;
    }
    TRY(record_outdir_lock(self->out, RECORD_PATIENCE, lock, err));
    TRY(record_outdir(self->out, self->given->force, err));
    if (self->given->frames != NULL) {
        char frames[RECORD_PATH];
        TRY(record_path(self->out, "frames", frames, err));
        TRY(record_directory(frames, err));
    }
    return WEFT_OK;
}

int run_scene(const arguments *given, const char *out, const weft_scene *scene,
              bool claimed, record_checkpoint *from)
{
    weft_error err = { 0 };
    int lock = -1, code = EXIT_DONE;
    run self = {
        .given = given,
        .out = out,
        .again = claimed,
        .from = from,
        .scene = scene,
        .comm = given->comm,
        .result = { .status = "done",
                    .reason = "",
                    .planned = weft_run_last_frame(weft_scene_run(scene)) + 1 },
    };
    watch_process watching = { .lock = -1 };
    watch_def def
        = { .directory = out, .yaml = given->mode == PROGRESS_YAML, .writes = true };
    if (!claimed && given->comm == NULL && scene_accepted(scene) != EXIT_DONE) {
        return EXIT_SCENE;
    }
    interrupt_catch(true);
    ranks_warn(self.comm, weft_scene_config(scene)->threads);
    weft_status status = frames_have_room(scene, &err);
    if (status == WEFT_OK && !claimed) {
        status = open_directory(&self, &lock, &err);
    }
    if (run_agree(&self, status, &err) != WEFT_OK) {
        code = report_error(&err);
    } else {
        (void)stat(out, &self.place);
        if (given->watch) {
            (void)watch_check(given, &def.port);
            watch_begin(&watching, &def, lock);
        }
        code = run_simulation(&self);
        watch_end(&watching);
    }
    if (lock >= 0) {
        (void)close(lock);
    }
    if ((given->view || given->watch) && code != EXIT_FILE) {
        interrupt_catch(false);
        const int viewed = view_runs(&out, 1, NULL, given->mode == PROGRESS_YAML);
        return code == EXIT_DONE ? viewed : code;
    }
    return code;
}

static int run_verb(const arguments *given)
{
    char out[RECORD_PATH];
    weft_scene *scene = NULL;
    size_t only;
    if (given->frames != NULL
        && choose(given, "frames", given->frames, (const char *const[]){ "obj", NULL },
                  &only)
               != EXIT_DONE) {
        return EXIT_USAGE;
    }
    uint16_t port;
    int code = watch_check(given, &port);
    if (code == EXIT_DONE) {
        code = open_scene(given->operands[0], given, &scene, NULL);
    }
    if (code == EXIT_DONE) {
        code = run_scene(given, out_directory(given, ".run", out), scene, false, NULL);
    } else if (code == EXIT_SCENE) {
        crossings_of_mistake(given, out_directory(given, ".run", out));
    }
    weft_scene_destroy(scene);
    return code;
}

static const verb_option options[] = {
    SHARED(out, "out", "DIR",
           "the directory; default: ./SCENE.run. Must be new or empty"),
    SHARED(force, "force", NULL, "replace the files of an earlier run"),
    OPTION_SET,
    SHARED(frames, "frames", "obj", "also write frames/frame-000000.obj ..."),
    SHARED(bands, "bands", "N",
           "one cloth in N bands, a process each: mpirun -n N weft run SCENE.yaml "
           "--bands N (docs/guides/cluster.md)"),
    SHARED(view, "view", NULL,
           "also write run.html, a page that plays the run, and print its URL"),
    SHARED(watch, "watch", NULL,
           "the same, and serve the page with its growing frames on 127.0.0.1 while "
           "the run goes on"),
    SHARED(port, "port", "N", "of --watch, from 1024 to 65535; default: a free one"),
    OPTION_PLUGIN_PATH,
    SHARED(progress, "progress", "HOW",
           "terminal: one line on stderr that is redrawn; lines: one line per tenth of "
           "the frames; auto (default): one of these two; yaml: only YAML documents on "
           "stdout, one line each: begin, progress, end; none"),
    SHARED(quiet, "quiet", NULL, "no progress, no summary"),
};

const verb verb_run = {
    .name = "run",
    .summary = "run a scene into a directory",
    .help
    = "usage: weft run SCENE.yaml [OPTIONS]\n"
      "\n"
      "Runs a scene and writes to a directory: scene.yaml (as run), manifest.yaml "
      "(versions and options), series.csv (one row per frame), shapes.csv (with "
      "shapes: the forces on them), run.vtkhdf (the frames), final.csv (the final "
      "state) and, last of all, result.yaml. Ends with a summary. A start that passes "
      "through itself or a body is an error, with the pairs in start-crossings.obj.\n",
    OPTIONS(options),
    .more
    = "examples:\n"
      "  weft run scenes/flag.yaml --out flag\n"
      "  weft run scenes/flag.yaml --watch\n"
      "  weft run scenes/flag.yaml --set stepper.rtol=1e-8 --set run.fps=60\n"
      "\n"
      "exit codes: 0 done, 1 the simulation failed, 2 wrong command line, 3 wrong "
      "scene, 4 a file could not be read or written, 130 SIGINT, 143 SIGTERM\n",
    .operands = { 1, 1, "no scene given", "more than one scene" },
    .run = run_verb,
};
