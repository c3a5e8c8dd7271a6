/* SPDX-License-Identifier: BSD-3-Clause */
/* open.c -- plugins, scenes and simulations for the verbs, with their errors printed.
 */
#define _GNU_SOURCE /* dladdr, in POSIX since 2024 */

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "program/cli.h"
#include "program/cut/cut.h"
#include "program/record/child_process.h"
#include "program/record/yaml_out.h"
#include "program/run/interrupt.h"

/* The build tree has its plugins beside libweft; "" if it is none. */
static void tree_plugins(char *directory, size_t size)
{
    const char *(*const function)(void) = weft_version;
    char library[PATH_MAX];
    const void *address; /* POSIX has functions and data of one size */
    Dl_info info;
    memcpy(&address, &function, sizeof address);
    directory[0] = '\0';
    if (dladdr(address, &info) != 0 && strchr(info.dli_fname, '/') != NULL
        && realpath(info.dli_fname, library) != NULL) {
        *strrchr(library, '/') = '\0';
        (void)snprintf(directory, size, "%s/plugins", library);
        if (access(directory, F_OK) != 0) {
            directory[0] = '\0';
        }
    }
}

/* ---- plugins: each is loaded in a child first, as it may end or block its process
 * ---- */

enum { LOAD_SECONDS = 10 }; /* ours take some milliseconds */

/* Shared with the child: an exit code could be the plugin's. */
typedef enum trial_end { NEVER_RETURNED, STREAMS_CLOSED, RETURNED } trial_end;

typedef struct trial_load {
    const char *file;
    trial_end *end;
} trial_load;

/* Refused plugins return as well; the parent then finds the reason. */
static int load(void *ctx, size_t job)
{
    const trial_load *self = ctx;
    const weft_registry_def def = { .struct_size = sizeof def };
    weft_registry *registry = NULL;
    (void)job;
    if (weft_registry_create(&def, &registry, NULL) == WEFT_OK) {
        (void)weft_registry_load(registry, self->file, NULL);
    }
    weft_registry_destroy(registry);
    const bool open = fcntl(STDIN_FILENO, F_GETFD) >= 0
                      && fcntl(STDOUT_FILENO, F_GETFD) >= 0
                      && fcntl(STDERR_FILENO, F_GETFD) >= 0;
    *self->end = open ? RETURNED : STREAMS_CLOSED;
    return 0;
}

/* weft_registry_def.admit. If no process can be made, plugins are trusted. */
static weft_status admit_plugin(void *ctx, const char *file, weft_error *err)
{
    char why[128];
    process child;
    trial_load self = { file, process_memory(1, sizeof *self.end) };
    const process_def def = { .work = load,
                              .ctx = &self,
                              .end_signal = SIGKILL,
                              .seconds = LOAD_SECONDS,
                              .untrusted = true };
    (void)ctx;
    if (self.end == NULL || !process_run(&def, 0, &child) || *self.end == RETURNED) {
        return WEFT_OK;
    }
    process_describe(child.status, why, sizeof why);
    if (*self.end == STREAMS_CLOSED) {
        (void)snprintf(why, sizeof why, "it closes standard streams");
    } else if (child.late) {
        (void)snprintf(why, sizeof why, "it takes longer than %d s", LOAD_SECONDS);
    }
    return weft_error_set(err, WEFT_BAD_PLUGIN, "loading it: %s", why);
}

weft_registry *open_registry(const char *plugin_path, bool trial)
{
    char fallback[PATH_MAX + 16];
    tree_plugins(fallback, sizeof fallback);
    weft_error err;
    weft_registry *registry = NULL;
    weft_registry_def def = weft_registry_def_default();
    def.path = plugin_path;
    def.fallback = fallback;
    def.admit = trial ? admit_plugin : NULL;
    if (weft_registry_create(&def, &registry, &err) != WEFT_OK) {
        (void)report_error(&err);
    }
    return registry;
}

static void warn_of_refused(void *ctx, const weft_error *why)
{
    (void)ctx;
    print_line(stderr, "weft: warning: %s", why->message);
}

weft_status load_plugins(weft_registry *registry, weft_error *err)
{
    static bool done; /* a program has one registry */
    const weft_status status
        = done ? WEFT_OK : weft_registry_load_all(registry, warn_of_refused, NULL, err);
    done = true;
    return status;
}

static const weft_plugin *find_plugin(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)weft_registry_find(ctx, id, &plugin, err);
    return plugin;
}

/* ---- scenes and simulations ---------------------------------------------------- */

static void print_found(const weft_diagnostics *found)
{
    for (size_t i = 0; i < found->count; ++i) {
        char text[2048];
        (void)weft_diagnostic_format(&found->items[i], text, sizeof text);
        print_plain(stderr, text, "\t\n");
        fputc('\n', stderr);
    }
    if (found->errors + found->warnings > found->count) {
        fprintf(stderr, "... and %zu more\n",
                found->errors + found->warnings - found->count);
    }
}

/* Progress before a run has begun, once a second; ctx: the mode. */
static void write_progress(void *ctx, weft_log_level level, const char *text)
{
    const progress_mode *mode = ctx;
    yaml_out out;
    if (level == WEFT_LOG_INFO && *mode == PROGRESS_YAML) {
        yaml_out_begin_event(&out, "prepare");
        yaml_out_write(&out, "message: \"%s\"", text);
        yaml_out_end_event(&out);
    } else if (level == WEFT_LOG_INFO) {
        fprintf(stderr, "%s\n", text);
    }
}

/* The scene outlives the command line that it was read by. */
static weft_log progress_log(progress_mode mode)
{
    static const progress_mode modes[]
        = { PROGRESS_NONE, PROGRESS_LINES, PROGRESS_TERMINAL, PROGRESS_YAML };
    return mode == PROGRESS_NONE ? (weft_log){ NULL, NULL }
                                 : (weft_log){ write_progress, (void *)&modes[mode] };
}

/* What is loaded by the options. */
static weft_scene_def scene_def(const arguments *given)
{
    weft_scene_def def = weft_scene_def_default();
    def.find_plugin = find_plugin;
    def.find_ctx = given->registry;
    def.refine = given->finer;
    def.log = progress_log(given->mode);
    def.stop = given->comm == NULL ? interrupt_pending : NULL;
#ifdef WEFT_QHULL
    def.mesh_cut = cut_mesh;
#endif
    return def;
}

weft_status perturbed_create(const arguments *given, const weft_scene *scene,
                             weft_scene_perturbed **out, weft_error *err)
{
    const weft_scene_def def = scene_def(given);
    *out = NULL;
    return weft_scene_sensitivities(scene)->count == 0
               ? WEFT_OK
               : weft_scene_perturbed_create(scene, &def, out, err);
}

static int load_scene(const char *file, const arguments *given, weft_scene **scene,
                      weft_sweep **sweep, const char *text)
{
    weft_error err = { 0 };
    weft_scene_def def = scene_def(given);
    weft_diagnostics *found = calloc(1, sizeof *found);
    if (found == NULL) {
        return report_status(WEFT_NO_MEMORY, "out of memory");
    }
    def.file = file;
    def.text = text;
    def.length = text == NULL ? 0 : strlen(text);
    def.sets = given->sets.at;
    def.set_count = text == NULL ? given->sets.count : 0;
    if (given->comm != NULL) {
        def.bands = (size_t)given->comm->size;
    }
    const weft_status status = sweep == NULL
                                   ? weft_scene_load(&def, scene, found, &err)
                                   : weft_sweep_load(&def, sweep, found, &err);
    if (!given->silent) {
        print_found(found);
    }
    const bool printed = found->errors > 0;
    free(found);
    return status == WEFT_OK ? EXIT_DONE : printed ? EXIT_SCENE : report_error(&err);
}

/* In bands, rank 0 reads the file, and all others the scene as it runs. */
int open_scene(const char *file, const arguments *given, weft_scene **scene,
               weft_sweep **sweep)
{
    const bool first = ranks_first(given->comm);
    int code = first ? load_scene(file, given, scene, sweep, NULL) : EXIT_DONE;
    code = ranks_share(given->comm, code);
    if (given->comm == NULL || code != EXIT_DONE) {
        return code;
    }
    char *text = ranks_share_text(given->comm, first ? weft_scene_text(*scene) : NULL);
    if (!first) {
        code = load_scene(file, given, scene, sweep, text);
    }
    free(text);
    if (given->comm->max(given->comm->self, code) > 0.0 && code == EXIT_DONE) {
        print_line(stderr,
                   "weft: error: another rank cannot read this scene: are weft and its "
                   "plugins the same on all nodes?");
        code = EXIT_SCENE;
    }
    return code;
}

int open_run(const char *directory, const arguments *given, weft_scene **scene)
{
    char path[RECORD_PATH];
    weft_error err = { 0 };
    return record_path(directory, "scene.yaml", path, &err) == WEFT_OK
               ? open_scene(path, given, scene, NULL)
               : report_error(&err);
}

const char *out_directory(const arguments *given, const char *suffix,
                          char text[RECORD_PATH])
{
    const char *slash = strrchr(given->operands[0], '/');
    const char *name = slash == NULL ? given->operands[0] : slash + 1;
    const char *dot = strstr(name, ".yaml");
    const size_t length
        = dot == NULL || dot == name ? strlen(name) : (size_t)(dot - name);
    (void)snprintf(text, RECORD_PATH, "%.*s%s", (int)length, name, suffix);
    return given->out != NULL ? given->out : text;
}

weft_status jobs_run(const arguments *given, void *ctx, size_t jobs,
                     int (*work)(void *ctx, size_t job),
                     void (*ended)(void *ctx, const process *one),
                     void (*tick)(void *ctx), weft_error *err)
{
    process_pool pool
        = { .def = { .work = work, .ctx = ctx, .tick = tick, .end_signal = SIGKILL },
            .jobs = jobs,
            .at_once = given->jobs > 0 ? given->jobs : 1,
            .ended = ended };
    return process_pool_run(&pool)
               ? WEFT_OK
               : weft_error_set(err, WEFT_SOLVER, "no process for a run: %s",
                                strerror(errno));
}

void job_error(const process *one, weft_error *err)
{
    if (one->status != 0) {
        err->status = WEFT_SOLVER;
        process_describe(one->status, err->message, sizeof err->message);
    }
}

weft_status scene_supported(const weft_scene *scene, weft_error *err)
{
    return weft_scene_method_type(scene) != NULL
               ? WEFT_OK
               : weft_error_set(err, WEFT_UNSUPPORTED,
                                "stepper.butcher: tables of one's own are read, but "
                                "the plugin arkode that runs them is not there");
}

/* A lower bound: the arrays of the cloth, two states, and one for each stage. Most
 * methods have some three states more. */
static weft_status check_memory(const weft_scene *scene, const weft_cloth_def *cloth,
                                weft_error *err)
{
    const weft_stepper_type *type = weft_scene_method_type(scene);
    const double states = 2.0 + (type == NULL ? 0.0 : type->stages);
    const weft_mesh_def *mesh = cloth->mesh;
    const size_t rows = cloth->band_rows > 0 ? cloth->band_rows : cloth->rows;
    const size_t across = mesh == NULL ? cloth->cols : 1;
    const size_t down = mesh == NULL ? rows : mesh->vertices;
    const double bytes
        = (double)down * (double)across * (20.0 + states * 6.0 * sizeof(double));
    struct rlimit limit = { .rlim_cur = RLIM_INFINITY };
    double room = INFINITY;
#ifdef _SC_PHYS_PAGES
    room = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
#endif
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        room = fmin(room, (double)limit.rlim_cur);
    }
    return bytes <= room
               ? WEFT_OK
               : weft_error_set(err, WEFT_NO_MEMORY,
                                "%zu x %zu particles need at least %.4g GB of memory; "
                                "this process can have %.4g GB",
                                down, across, 1e-9 * bytes, 1e-9 * room);
}

weft_status cloth_create(const weft_scene *scene, const weft_cloth_def *def,
                         weft_cloth **cloth, weft_error *err)
{
    *cloth = NULL;
    TRY(check_memory(scene, def, err));
    return weft_cloth_create(def, cloth, err);
}

static weft_sim_def define(const weft_scene *scene, const weft_comm *comm,
                           const weft_cloth *cloth)
{
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = weft_scene_method_type(scene);
    def.config = *weft_scene_config(scene);
    def.ledger = weft_scene_record(scene)->ledger;
    def.limit = *weft_scene_limit(scene);
    def.stop = comm == NULL ? interrupt_pending : NULL; /* bands stop after a step */
    def.comm = comm;
    return def;
}

weft_status sim_create(const weft_scene *scene, const weft_cloth *cloth, weft_sim **sim,
                       weft_error *err)
{
    const weft_sim_def def = define(scene, NULL, cloth);
    return weft_sim_create(&def, sim, err);
}

weft_status band_create(const weft_scene *scene, const weft_comm *comm,
                        weft_cloth **cloth, weft_error *err)
{
    weft_cloth_def band = *weft_scene_cloth(scene);
    *cloth = NULL;
    if (comm != NULL) { /* the scene was checked for bands */
        (void)weft_comm_band(weft_cloth_def_blocks(&band), (size_t)comm->rank,
                             (size_t)comm->size, &band.band_first, &band.band_rows);
    }
    TRY(scene_supported(scene, err));
    return cloth_create(scene, &band, cloth, err);
}

/* The end of a run by its stop. What happens within long steps of implicit methods is
 * seen less well (docs/theory/model.md): none is longer than a frame then. */
static void define_stop(const weft_run_def *run, weft_sim_def *def)
{
    def->event = run->stop.quantity != WEFT_STOP_NEVER ? weft_stop_event : NULL;
    def->event_ctx = (void *)&run->stop; /* which reads it alone */
    def->event_hold = run->stop.hold;
    if (def->event != NULL && (def->method->flags & WEFT_STEPPER_IMPLICIT) != 0) {
        const double frame = fmax(1.0 / run->fps, def->config.min_step);
        def->config.max_step = fmin(def->config.max_step, frame);
    }
}

weft_status start_create(const weft_scene *scene, const weft_cloth *cloth, bool relax,
                         double **y, weft_error *err)
{
    *y = NULL;
    if (weft_scene_cloth(scene)->untangle == 0.0) {
        return WEFT_OK;
    }
    *y = malloc(weft_cloth_dim(cloth) * sizeof **y);
    if (*y == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state");
    }
    weft_cloth_start(cloth, *y);
    return relax ? weft_cloth_untangle(cloth, *y, err) : WEFT_OK;
}

weft_status band_sim_create(const weft_scene *scene, const weft_comm *comm,
                            const weft_sensitivity_def *sensitivity, weft_log log,
                            const weft_cloth *cloth, const double *start,
                            weft_sim **sim, weft_error *err)
{
    weft_sim_def def = define(scene, comm, cloth);
    const weft_run_def *run = weft_scene_run(scene);
    def.log = log;
    def.sensitivity = sensitivity;
    def.interpolate = run->interpolate;
    define_stop(run, &def);
    def.start = start;
    return weft_sim_create(&def, sim, err);
}

weft_status simulation_create(const weft_scene *scene,
                              const weft_sensitivity_def *sensitivity,
                              weft_cloth **cloth, weft_sim **sim, weft_error *err)
{
    *sim = NULL;
    weft_status status = band_create(scene, NULL, cloth, err);
    status = status == WEFT_OK
                 ? band_sim_create(scene, NULL, sensitivity, (weft_log){ NULL, NULL },
                                   *cloth, NULL, sim, err)
                 : status;
    if (status != WEFT_OK) {
        weft_cloth_destroy(*cloth);
        *cloth = NULL;
    }
    return status;
}

int scene_accepted(const weft_scene *scene)
{
    weft_error err = { 0 };
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    double *start = NULL;
    const weft_stepper_type *type = weft_scene_method_type(scene);
    if (type == NULL || (type->flags & WEFT_STEPPER_STRUCTURE) == 0) {
        return EXIT_DONE;
    }
    weft_status status = band_create(scene, NULL, &cloth, &err);
    status
        = status == WEFT_OK ? start_create(scene, cloth, false, &start, &err) : status;
    status = status == WEFT_OK ? band_sim_create(
                 scene, NULL, NULL, (weft_log){ NULL, NULL }, cloth, start, &sim, &err)
                               : status;
    free(start);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    if (status != WEFT_INVALID && status != WEFT_UNSUPPORTED) {
        return EXIT_DONE; /* what else is wrong is told later */
    }
    weft_diagnostics found = { .count = 1, .errors = 1 };
    weft_scene_refusal(scene, &err, &found.items[0]);
    print_found(&found);
    return EXIT_SCENE;
}
