/* SPDX-License-Identifier: BSD-3-Clause */
/* run.c -- weft run: a scene from t = 0 to its end, into a directory. */
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "cli/stability.h"
#include "record/export.h"

static volatile sig_atomic_t stop_signal;

static void on_signal(int number)
{
    stop_signal = number;
}

static void catch_signals(void)
{
    struct sigaction action = { .sa_handler = on_signal };
    (void)sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
}

typedef struct run {
    const char *out;
    bool obj; /* an OBJ a frame */
    const weft_scene *scene;
    weft_cloth *cloth;
    weft_sim *sim;
    record_series series;
    record_vtkhdf *frames;
    record_result result;
    progress progress;
    uint64_t limit_sweeps;            /* up to the last frame */
    bool told_unconverged, told_held; /* warnings of the strain limit */
    char reason[1024];
} run;

static void print_spring(const run *self, const weft_spring *spring)
{
    const size_t cols = weft_cloth_cols(self->cloth);
    fprintf(stderr, "%s spring (%zu, %zu)-(%zu, %zu) is at %.3g %%\n",
            weft_family_name(spring->family), spring->p / cols, spring->p % cols,
            spring->q / cols, spring->q % cols, 100.0 * spring->strain);
}

/* Each at most once a run, also when quiet. */
static void warn_of_limit(run *self)
{
    const weft_spring worst = weft_sim_limit_worst(self->sim);
    const weft_limit_stats stats = weft_sim_limit_stats(self->sim);
    const size_t held = weft_sim_limit_held(self->sim);
    if (stats.unconverged > 0 && !self->told_unconverged) {
        self->told_unconverged = true;
        fprintf(stderr,
                "weft: warning: limit: not met within limit.sweeps by t = %.6g s; ",
                weft_sim_time(self->sim));
        print_spring(self, &worst);
    }
    if (held > 0 && !self->told_held) {
        self->told_held = true;
        fprintf(stderr,
                "weft: warning: limit: %zu springs with both ends pinned are too long "
                "at t = %.6g s and cannot be corrected; ",
                held, weft_sim_time(self->sim));
        print_spring(self, &worst);
    }
}

static weft_status write_state(const run *self, const char *name,
                               record_write_fn *write, weft_error *err)
{
    const size_t n = weft_cloth_particles(self->cloth);
    double *values = malloc(6 * n * sizeof *values);
    if (values == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for %s", name);
    }
    const record_surface surface = {
        .rows = weft_cloth_rows(self->cloth),
        .cols = weft_cloth_cols(self->cloth),
        .position = values,
        .velocity = values + 3 * n,
        .doubles = true,
    };
    weft_sim_positions(self->sim, values);
    weft_sim_velocities(self->sim, values + 3 * n);
    const weft_status status = write(self->out, name, &surface, err);
    free(values);
    return status;
}

static weft_status write_frame_obj(const run *self, size_t index, weft_error *err)
{
    char name[64];
    (void)snprintf(name, sizeof name, "frames/frame-%06zu.obj", index);
    return write_state(self, name, record_obj, err);
}

static weft_status on_frame(void *ctx, size_t index, weft_error *err)
{
    run *self = ctx;
    const weft_limit_stats limit = weft_sim_limit_stats(self->sim);
    const record_frame frame = { .index = index,
                                 .sim = self->sim,
                                 .limit_sweeps = limit.sweeps - self->limit_sweeps };
    self->limit_sweeps = limit.sweeps;
    warn_of_limit(self);
    /* The row first: run.vtkhdf never has a frame that the series has not. */
    weft_status status = record_series_add(&self->series, &frame, err);
    if (status == WEFT_OK) {
        status = record_vtkhdf_add(self->frames, &frame, err);
    }
    if (status == WEFT_OK && self->obj) {
        status = write_frame_obj(self, index, err);
    }
    if (status == WEFT_OK) {
        self->result.frames = index + 1;
        progress_show(&self->progress, index, self->result.planned - 1, self->sim,
                      weft_scene_run(self->scene)->duration);
    }
    return status;
}

static bool on_step(void *ctx)
{
    run *self = ctx;
    if (self->progress.terminal) {
        progress_show(&self->progress, self->result.frames - 1,
                      self->result.planned - 1, self->sim,
                      weft_scene_run(self->scene)->duration);
    }
    return stop_signal == 0;
}

/* What can be known before the first step. */
static weft_status write_first_files(const run *self, weft_registry *registry,
                                     weft_error *err)
{
    const weft_plugin *plugin;
    weft_status status
        = weft_registry_find(registry, weft_scene_plugin(self->scene), &plugin, err);
    const char *file = "";
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        file = weft_registry_at(registry, i) == plugin ? weft_registry_file(registry, i)
                                                       : file;
    }
    if (status == WEFT_OK) {
        status
            = record_text(self->out, "scene.yaml", weft_scene_text(self->scene), err);
    }
    if (status == WEFT_OK) {
        status = record_manifest(self->out, self->scene, self->sim, plugin, file, err);
    }
    return status;
}

static weft_status open_records(run *self, weft_error *err)
{
    const record_vtkhdf_def frames = {
        .directory = self->out,
        .cloth = self->cloth,
        .record = weft_scene_record(self->scene),
        .last = self->result.planned - 1,
        .series = &self->series,
    };
    weft_status status = record_series_open(
        &self->series, self->out, weft_scene_record(self->scene)->ledger, err);
    if (status != WEFT_OK) {
        return status;
    }
    status = record_vtkhdf_create(&frames, &self->frames, err);
    if (status != WEFT_OK) {
        (void)record_series_close(&self->series, NULL);
    }
    return status;
}

/* The first thing that went wrong is told. */
static weft_status close_records(run *self, weft_status status, weft_error *err)
{
    const weft_status frames
        = record_vtkhdf_close(self->frames, status == WEFT_OK ? err : NULL);
    status = status == WEFT_OK ? frames : status;
    const weft_status series
        = record_series_close(&self->series, status == WEFT_OK ? err : NULL);
    return status == WEFT_OK ? series : status;
}

static weft_status simulate(run *self, weft_error *err)
{
    weft_status status = open_records(self, err);
    if (status != WEFT_OK) {
        return status;
    }
    player show = {
        .sim = self->sim,
        .run = weft_scene_run(self->scene),
        .last = self->result.planned - 1,
        .frame = on_frame,
        .step = on_step,
        .ctx = self,
    };
    progress_begin(&self->progress, self->progress.quiet);
    status = play(&show, err);
    progress_end(&self->progress);
    return close_records(self, status, err);
}

static void print_limit(const run *self)
{
    const weft_limit_stats stats = weft_sim_limit_stats(self->sim);
    if (weft_scene_limit(self->scene)->method != WEFT_LIMIT_NONE) {
        printf("  strain limit: %llu steps corrected in %llu sweeps, %llu not met; "
               "largest limited strain %.4g %%\n",
               (unsigned long long)stats.corrected, (unsigned long long)stats.sweeps,
               (unsigned long long)stats.unconverged,
               100.0 * weft_sim_limit_worst(self->sim).strain);
    }
}

static void print_summary(const run *self)
{
    const record_result *result = &self->result;
    const weft_stepper_stats stats = weft_sim_stats(self->sim);
    const double *y = weft_sim_state(self->sim);
    const weft_spring worst = weft_cloth_worst_spring(self->cloth, y);
    printf("%s: %s (%zu x %zu particles, %s %s)\n", result->status,
           weft_scene_name(self->scene), weft_cloth_rows(self->cloth),
           weft_cloth_cols(self->cloth), weft_scene_plugin(self->scene),
           weft_scene_method(self->scene));
    printf("  %zu of %zu frames, t = %.6g s, %.2f s of wall time\n", result->frames,
           result->planned, weft_sim_time(self->sim), result->wall_time);
    printf("  %llu steps, %llu rejected, %llu evaluations of the forces\n",
           (unsigned long long)stats.steps, (unsigned long long)stats.rejected,
           (unsigned long long)stats.rhs_calls);
    printf("  largest strain at the end %.3g %%, energy %.6g -> %.6g J\n",
           100.0 * worst.strain, result->energy_start,
           record_total_energy(self->cloth, y));
    const weft_ledger ledger = weft_sim_ledger(self->sim);
    if (ledger.kept) {
        printf("  energy ledger closes to %.3g J\n", ledger.residual);
    }
    print_limit(self);
    printf("  results in %s\n", self->out);
}

/* A simulation that failed in all its parts, anything else as ever. */
static int report_failure(const weft_error *why, const char *reason)
{
    if (why->status == WEFT_IO) {
        return report_error(why);
    }
    trouble_print(reason);
    return EXIT_SIMULATION;
}

/* Everything that is written once the loop has ended, whatever ended it. */
static int conclude(run *self, weft_status status, const weft_error *why, double began)
{
    weft_error err = { 0 };
    /* A signal that came after the last frame has changed nothing. */
    const bool interrupted
        = stop_signal != 0 && self->result.frames < self->result.planned;
    self->result.wall_time = wall_clock() - began;
    self->result.sim = self->sim;
    if (status != WEFT_OK) {
        self->result.status = "failed";
        trouble_describe(self->scene, self->sim, why, self->reason,
                         sizeof self->reason);
        self->result.reason = self->reason;
    } else if (interrupted) {
        self->result.status = "interrupted";
        self->result.reason = stop_signal == SIGINT ? "SIGINT" : "SIGTERM";
    }
    weft_status written = write_state(self, "final.csv", record_csv, &err);
    if (written == WEFT_OK) {
        written = record_result_write(self->out, &self->result, &err);
    }
    const int code = status == WEFT_OK ? EXIT_DONE : report_failure(why, self->reason);
    if (written != WEFT_OK) {
        return report_error(&err);
    }
    if (!self->progress.quiet) {
        print_summary(self);
    }
    if (interrupted && status == WEFT_OK) {
        return stop_signal == SIGINT ? EXIT_SIGINT : EXIT_SIGTERM;
    }
    return code;
}

/* A right scene that cannot be run: say so, leave a report. */
static int refuse(const run *self, const char *reason)
{
    weft_error err = { .status = WEFT_UNSUPPORTED };
    const record_result result
        = { .status = "failed", .reason = reason, .planned = self->result.planned };
    (void)snprintf(err.message, sizeof err.message, "%s", reason);
    (void)report_error(&err);
    if (record_text(self->out, "scene.yaml", weft_scene_text(self->scene), &err)
            != WEFT_OK
        || record_result_write(self->out, &result, &err) != WEFT_OK) {
        return report_error(&err);
    }
    return EXIT_SIMULATION;
}

static int run_simulation(run *self, weft_registry *registry)
{
    const double began = wall_clock();
    weft_error err = { 0 };
    weft_status status = simulation_create(self->scene, &self->cloth, &self->sim, &err);
    if (status != WEFT_OK) {
        return refuse(self, err.message);
    }
    self->result.energy_start
        = record_total_energy(self->cloth, weft_sim_state(self->sim));
    stability_warn(self->scene, self->sim);
    status = write_first_files(self, registry, &err);
    if (status == WEFT_OK) {
        status = simulate(self, &err);
    }
    const int code = conclude(self, status, &err, began);
    weft_sim_destroy(self->sim);
    weft_cloth_destroy(self->cloth);
    return code;
}

static int run_scene(const options *given, const char *out, const weft_scene *scene,
                     weft_registry *registry)
{
    weft_error err = { 0 };
    run self = {
        .out = out,
        .obj = given->frames != NULL,
        .scene = scene,
        .result = { .status = "done",
                    .reason = "",
                    .planned = frame_last(weft_scene_run(scene)) + 1 },
        .progress = { .quiet = given->quiet },
    };
    catch_signals();
    weft_status status = record_outdir(out, given->force, &err);
    if (status == WEFT_OK && self.obj) {
        char frames[RECORD_PATH];
        status = record_path(out, "frames", frames, &err);
        status = status == WEFT_OK ? record_outdir(frames, given->force, &err) : status;
    }
    if (status != WEFT_OK) {
        return report_error(&err);
    }
    const char *unsupported = scene_unsupported(scene);
    if (unsupported != NULL) {
        return refuse(&self, unsupported);
    }
    return run_simulation(&self, registry);
}

static int run_verb(int argc, char **argv)
{
    options given;
    int code = options_parse(&verb_run, "ospqFrv", argc, argv, &given);
    if (code >= 0) {
        return code;
    }
    if (given.operand_count != 1) {
        code = usage_error(&verb_run, given.operand_count == 0 ? "no scene given"
                                                               : "more than one scene");
    } else if (given.frames != NULL && strcmp(given.frames, "obj") != 0) {
        code = usage_error(&verb_run, "--frames %s: only obj is known", given.frames);
    } else {
        weft_registry *registry = open_registry(given.plugin_path);
        weft_scene *scene = NULL;
        char *out = default_directory(given.operands[0], ".run");
        code = registry == NULL || out == NULL
                   ? EXIT_SIMULATION
                   : open_scene(given.operands[0], &given, registry, &scene);
        if (code == EXIT_DONE) {
            const char *directory = given.out == NULL ? out : given.out;
            code = run_scene(&given, directory, scene, registry);
            if (given.view) {
                const int viewed = view_runs(&directory, 1, NULL);
                code = code == EXIT_DONE ? viewed : code;
            }
        }
        free(out);
        weft_scene_destroy(scene);
        weft_registry_destroy(registry);
    }
    options_free(&given);
    return code;
}

const verb verb_run = {
    .name = "run",
    .summary = "run a scene into a directory",
    .help
    = "usage: weft run SCENE.yaml [OPTIONS]\n\n"
      "Runs a scene and leaves in a directory: scene.yaml (as run), manifest.yaml "
      "(what\n"
      "ran), series.csv (a row a frame), final.csv (the state at the end) and, last "
      "of\n"
      "all, result.yaml.\n\n"
      "  --out DIR            the directory; default: SCENE.run here. Must be new or "
      "empty\n"
      "  --force              replace what an earlier run left there\n"
      "  --set KEY.PATH=VALUE override a key of the scene; may be repeated\n"
      "  --frames obj         write frames/frame-000000.obj ... as well\n"
      "  --view               make run.html as well, a page that plays the run, and "
      "print\n"
      "                       its URL\n"
      "  --plugin-path DIRS   look for stepper plugins there first ('a:b')\n"
      "  --quiet              no progress, no summary\n\n"
      "examples:\n"
      "  weft run scenes/flag.yaml --out flag\n"
      "  weft run scenes/flag.yaml --set stepper.rtol=1e-8 --set cloth.grid.rows=40\n\n"
      "exit codes: 0 done, 1 the simulation failed, 2 wrong command line, 3 wrong "
      "scene,\n"
      "4 a file could not be read or written, 130 SIGINT, 143 SIGTERM\n",
    .run = run_verb,
};
