/* SPDX-License-Identifier: BSD-3-Clause */
/* resume.c -- weft resume: continues runs that were killed or interrupted from their
 * last checkpoint. It checks all files before it writes any. */
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

#include "program/run/run.h"

/* Those of this verb alone. */
typedef struct resume_options {
    const char *until;
} resume_options;

/* The checkpoint, if it is one of this scene and this program. */
static weft_status read_checkpoint(const char *directory, const weft_scene *scene,
                                   weft_registry *registry, record_checkpoint *from,
                                   weft_error *err)
{
    record_checkpoint own = { 0 };
    char name[64];
    TRY(record_checkpoint_read(directory, from, err));
    TRY(record_checkpoint_identify(&own, scene, registry, err));
    if (from->scene != own.scene) {
        const bool parts = weft_scene_mesh_file(scene) != NULL
                           && weft_scene_cloth(scene)->mesh->part_count > 0;
        const bool copied = weft_scene_body_file(scene, 0, name, sizeof name) != NULL;
        return weft_error_set(err, WEFT_BAD_SCENE,
                              "%s/scene.yaml%s is not the scene that " RECORD_CHECKPOINT
                              " is of: it was changed since",
                              directory,
                              parts || copied ? " with its meshes"
                              : weft_scene_mesh_file(scene) != NULL
                                  ? " with its " RECORD_MESH
                                  : "");
    }
    if (strcmp(from->program, own.program) != 0) {
        return weft_error_set(err, WEFT_IO,
                              "%s/" RECORD_CHECKPOINT ": of %s; this is %s", directory,
                              from->program, own.program);
    }
    return WEFT_OK;
}

/* ---- one directory ------------------------------------------------------------ */

/* Whether its result.yaml says so. */
static bool ended_as(const char *directory, const char *status)
{
    char said[RECORD_RESULT_TEXT];
    return strcmp(record_result_get(directory, "status", said), status) == 0;
}

/* The scene with the duration `until`; NULL without. */
static int open_longer(const arguments *given, const char *until, const char *directory,
                       const weft_scene *scene, weft_scene **out)
{
    char set[64];
    const char *sets[] = { set };
    arguments longer = *given;
    const double now = weft_scene_run(scene)->duration;
    *out = NULL;
    if (until == NULL) {
        return EXIT_DONE;
    }
    if (!(option_real(until) > now)) {
        return usage_error(given, "--until %s: not a time beyond %.9g s, where %s ends",
                           until, now, directory);
    }
    (void)snprintf(set, sizeof set, "run.duration=%s", until);
    longer.sets.at = sets;
    longer.sets.count = 1;
    return open_run(directory, &longer, out);
}

int resume_scene(const arguments *given, const char *until, const char *directory,
                 const weft_scene *scene)
{
    weft_scene *longer;
    weft_error err = { 0 };
    record_checkpoint from = { 0 };
    arguments own = *given;
    own.frames = record_exists(directory, "frames/frame-000000.obj") ? "obj" : NULL;
    const bool begun
        = ranks_share(given->comm, record_exists(directory, RECORD_CHECKPOINT));
    const weft_status status
        = begun ? read_checkpoint(directory, scene, given->registry, &from, &err)
                : WEFT_OK;
    from.last = weft_run_last_frame(weft_scene_run(scene));
    int code = weft_comm_agree(given->comm, status, &err) == WEFT_OK
                   ? open_longer(given, until, directory, scene, &longer)
                   : report_error(&err);
    if (code != EXIT_DONE) {
        record_checkpoint_close(&from);
        return code;
    }
    scene = longer == NULL ? scene : longer;
    if (!given->quiet && begun) {
        print_plainly(stderr, "%s: continues after frame %" PRIu64 " of %zu\n",
                      directory, from.frame,
                      weft_run_last_frame(weft_scene_run(scene)));
    } else if (!given->quiet) {
        print_plainly(stderr, "%s: no checkpoint%s: runs from the beginning\n",
                      directory, until == NULL ? " yet" : " (run.keep_checkpoint)");
    }
    code = run_scene(&own, directory, scene, true, begun ? &from : NULL);
    record_checkpoint_close(&from);
    weft_scene_destroy(longer);
    return code;
}

/* In a directory that is claimed. */
static int resume_claimed(const arguments *given, const char *directory)
{
    const char *until = ((const resume_options *)given->own)->until;
    weft_scene *scene = NULL;
    if (until == NULL && ranks_share(given->comm, ended_as(directory, "done"))) {
        if (!given->quiet) {
            print_plainly(stderr, "%s: is already done\n", directory);
        }
        return EXIT_DONE;
    }
    if (ranks_share(given->comm, !given->force && ended_as(directory, "failed"))) {
        print_plainly(stderr,
                      "weft: error: %s: this run failed, and would again: see its "
                      "result.yaml; --force runs it again\n",
                      directory);
        return EXIT_SIMULATION;
    }
    int code = open_run(directory, given, &scene);
    if (code == EXIT_DONE) {
        code = resume_scene(given, until, directory, scene);
    }
    weft_scene_destroy(scene);
    return code;
}

static int resume_directory(const arguments *given, const char *directory)
{
    int lock = -1;
    weft_error err = { 0 };
    weft_status status = WEFT_OK;
    if (ranks_first(given->comm)) {
        status = record_is_run(directory, &err);
        status = status == WEFT_OK
                     ? record_outdir_lock(directory, RECORD_PATIENCE, &lock, &err)
                     : status;
    }
    const int code = weft_comm_agree(given->comm, status, &err) == WEFT_OK
                         ? resume_claimed(given, directory)
                         : report_error(&err);
    if (lock >= 0) {
        (void)close(lock);
    }
    return code;
}

/* ---- the verb ----------------------------------------------------------------- */

/* Runs that fail do not keep the next ones from running; a signal does. Returns the
 * first code that is not 0. */
static int resume_verb(const arguments *given)
{
    const resume_options *own = given->own;
    int code = EXIT_DONE;
    if (own->until != NULL && given->comm != NULL) {
        return usage_error(given, "--until excludes --bands: first the one");
    }
    for (int i = 0; i < given->operand_count; ++i) {
        const int one
            = ranks_share(given->comm, resume_directory(given, given->operands[i]));
        if (one == EXIT_SIGINT || one == EXIT_SIGTERM) {
            return one;
        }
        code = code == EXIT_DONE ? one : code;
    }
    return code;
}

static const verb_option options[] = {
    OWN(resume_options, until, "until", "T",
        "go on to T [s], beyond run.duration, also if the run is done: the files "
        "become those of a run with that duration; from the beginning if the run kept "
        "no checkpoint (run.keep_checkpoint)"),
    SHARED(force, "force", NULL, "also repeat runs that failed"),
    SHARED(bands, "bands", "N",
           "in N bands, whatever their number was before: mpirun -n N weft resume DIR "
           "--bands N"),
    OPTION_PLUGIN_PATH,
    SHARED(progress, "progress", "HOW",
           "auto, lines, terminal, yaml or none, as for weft run"),
    SHARED(quiet, "quiet", NULL, "no progress, no summary"),
};

const verb verb_resume = {
    .name = "resume",
    .summary = "continue runs that were killed or interrupted",
    .help = "usage: weft resume DIR... [OPTIONS]\n"
            "\n"
            "Continues each run from its last checkpoint (run.checkpoint in its "
            "scene), to the same files, byte for byte, as an uninterrupted run. A run "
            "without a checkpoint starts again; a finished run is left alone.\n",
    OPTIONS(options),
    .own_size = sizeof(resume_options),
    .more = "examples:\n"
            "  weft resume flag\n"
            "  weft resume sweep/*\n"
            "\n"
            "exit codes: 0 done, 1 the simulation failed, 2 wrong command line, 3 "
            "wrong scene, or one that differs from that of the checkpoint, 4 a file "
            "could not be read or written, or is damaged, 130 SIGINT, 143 SIGTERM; "
            "with several runs the first code that is not 0\n",
    .operands = { 1, ANY_NUMBER, "no directory given", NULL },
    .run = resume_verb,
};
