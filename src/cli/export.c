/* SPDX-License-Identifier: BSD-3-Clause */
/* export.c -- weft export: frames of a run as files that other programs read.
 *
 * The state at the end is in final.csv. Any other frame is computed anew from the
 * run's own scene.yaml, which gives the same bits, and is checked against the hash in
 * its row of series.csv. */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/cli.h"
#include "record/record.h"

typedef weft_status writer(const char *directory, const char *name,
                           const weft_cloth *cloth, const double *y, weft_error *err);

typedef struct export_job {
    const char *directory, *suffix;
    writer *write;
    bool all;
    size_t frame; /* that one, or the last of all */
    const weft_scene *scene;
    weft_cloth *cloth;
    weft_sim *sim;
} export_job;

static weft_status write_state(const export_job *job, const char *stem, const double *y,
                               weft_error *err)
{
    char name[64];
    (void)snprintf(name, sizeof name, "%s.%s", stem, job->suffix);
    const weft_status status = job->write(job->directory, name, job->cloth, y, err);
    if (status == WEFT_OK) {
        printf("%s/%s\n", job->directory, name);
    }
    return status;
}

static weft_status on_frame(void *ctx, size_t index, weft_error *err)
{
    const export_job *job = ctx;
    if (!job->all && index != job->frame) {
        return WEFT_OK;
    }
    const double *y = weft_sim_state(job->sim);
    const uint64_t hash = weft_state_hash(y, weft_cloth_dim(job->cloth));
    uint64_t recorded;
    const weft_status status
        = record_series_hash(job->directory, index, &recorded, err);
    if (status != WEFT_OK) {
        return status;
    }
    if (hash != recorded) {
        return weft_error_set(err, WEFT_SOLVER,
                              "frame %zu computed anew has hash %016" PRIx64
                              ", the run had %016" PRIx64
                              ": other versions? see manifest.yaml",
                              index, hash, recorded);
    }
    char stem[48];
    (void)snprintf(stem, sizeof stem, "frames/frame-%06zu", index);
    return write_state(job, stem, y, err);
}

static weft_status make_frames_folder(const export_job *job, weft_error *err)
{
    char path[RECORD_PATH];
    const weft_status status = record_path(job->directory, "frames", path, err);
    if (status == WEFT_OK && mkdir(path, 0777) != 0 && errno != EEXIST) {
        return weft_error_set(err, WEFT_IO, "%s: %s", path, strerror(errno));
    }
    return status;
}

static weft_status export_frames(export_job *job, weft_error *err)
{
    player show = {
        .sim = job->sim,
        .run = weft_scene_run(job->scene),
        .last = job->frame,
        .frame = on_frame,
        .ctx = job,
    };
    const weft_status status = make_frames_folder(job, err);
    return status == WEFT_OK ? play(&show, err) : status;
}

static weft_status export_final(const export_job *job, weft_error *err)
{
    double *y = malloc(weft_cloth_dim(job->cloth) * sizeof *y);
    if (y == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a state");
    }
    weft_status status
        = record_csv_read(job->directory, "final.csv", job->cloth, y, err);
    if (status == WEFT_OK && job->write == record_csv) {
        printf("%s/final.csv\n", job->directory); /* it is there already */
    } else if (status == WEFT_OK) {
        status = write_state(job, "final", y, err);
    }
    free(y);
    return status;
}

/* "last", "all" or a number up to `last`. Returns false for anything else. */
static bool parse_frame(const char *text, size_t last, bool *final, export_job *job)
{
    char *end;
    *final = text == NULL || strcmp(text, "last") == 0;
    job->all = text != NULL && strcmp(text, "all") == 0;
    job->frame = last;
    if (*final || job->all) {
        return true;
    }
    errno = 0;
    const unsigned long long number = strtoull(text, &end, 10);
    job->frame = (size_t)number;
    return text[0] >= '0' && text[0] <= '9' && *end == '\0' && errno == 0
           && number <= last;
}

static int export_scene(const options *given, export_job *job)
{
    weft_error err = { 0 };
    bool final;
    size_t last = 0;
    if (record_series_last(job->directory, &last, &err) != WEFT_OK) {
        return report_error(&err);
    }
    if (!parse_frame(given->frame, last, &final, job)) {
        return usage_error(&verb_export, "--frame %s: last, all or 0 to %zu",
                           given->frame, last);
    }
    weft_status status = simulation_create(job->scene, &job->cloth, &job->sim, &err);
    if (status == WEFT_OK) {
        status = final ? export_final(job, &err) : export_frames(job, &err);
    }
    weft_sim_destroy(job->sim);
    weft_cloth_destroy(job->cloth);
    return status == WEFT_OK ? EXIT_DONE : report_error(&err);
}

static int export_run(const options *given, export_job *job)
{
    char path[RECORD_PATH];
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    if (record_path(job->directory, "scene.yaml", path, &err) != WEFT_OK) {
        return report_error(&err);
    }
    weft_registry *registry = open_registry(given->plugin_path);
    int code = registry == NULL ? EXIT_SIMULATION
                                : open_scene(path, given, registry, &scene);
    if (code == EXIT_DONE) {
        job->scene = scene;
        code = export_scene(given, job);
    }
    weft_scene_destroy(scene);
    weft_registry_destroy(registry);
    return code;
}

static int export_verb(int argc, char **argv)
{
    options given;
    int code = options_parse(&verb_export, "tip", argc, argv, &given);
    if (code >= 0) {
        return code;
    }
    export_job job = { .suffix = given.format };
    job.write = given.format == NULL               ? NULL
                : strcmp(given.format, "obj") == 0 ? record_obj
                : strcmp(given.format, "csv") == 0 ? record_csv
                                                   : NULL;
    if (given.operand_count != 1) {
        code = usage_error(&verb_export, "needs the directory of one run");
    } else if (job.write == NULL) {
        code = usage_error(&verb_export, "--format obj or --format csv is needed");
    } else {
        job.directory = given.operands[0];
        code = export_run(&given, &job);
    }
    options_free(&given);
    return code;
}

const verb verb_export = {
    .name = "export",
    .summary = "write frames of a run as OBJ or CSV",
    .help
    = "usage: weft export DIR --format obj|csv [OPTIONS]\n\n"
      "Writes frames of a run into its directory and prints their names: "
      "DIR/final.obj\n"
      "for the last state, DIR/frames/frame-000012.obj for frame 12. Frames but the "
      "last\n"
      "are computed anew from DIR/scene.yaml and must match the hash in series.csv.\n\n"
      "  --format obj|csv     Wavefront OBJ (quads, texture coordinates), or\n"
      "                       row,col,x,y,z,vx,vy,vz\n"
      "  --frame last|all|N   default: last\n"
      "  --plugin-path DIRS   look for stepper plugins there first ('a:b')\n\n"
      "example: weft export flag --format obj --frame all\n",
    .run = export_verb,
};
