/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_state.c -- the state of the directory of a run. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "cli/batch/batch.h"
#include "record/result.h"

static const char *const names[BATCH_STATUSES] = {
    [BATCH_NEW] = "missing",       [BATCH_PARTIAL] = "interrupted",
    [BATCH_DONE] = "done",         [BATCH_FAILED] = "failed",
    [BATCH_IO_ERROR] = "io_error", [BATCH_CRASHED] = "crashed",
    [BATCH_TIMEOUT] = "timeout",   [BATCH_CHANGED] = "changed",
    [BATCH_BUSY] = "busy",         [BATCH_UNREADABLE] = "unreadable",
};

const char *batch_status_name(batch_status status)
{
    return names[status];
}

weft_status batch_directory(const batch *self, const batch_run *run,
                            char path[RECORD_PATH], weft_error *err)
{
    return record_path(self->out, run->name, path, err);
}

/* Whether a file consists of a text; *missing: there is no such file. */
static bool holds(const char *path, const char *text, bool *missing)
{
    FILE *stream = weft__file_open(path, "r", NULL);
    *missing = stream == NULL && errno == ENOENT;
    if (stream == NULL) {
        return false;
    }
    int c = getc(stream);
    for (; c != EOF && *text != '\0' && c == (unsigned char)*text; ++text) {
        c = getc(stream);
    }
    const bool same = c == EOF && *text == '\0' && !ferror(stream);
    (void)fclose(stream);
    return same;
}

bool batch_is_over(batch_status status)
{
    return status >= BATCH_DONE && status <= BATCH_TIMEOUT;
}

static batch_status result_status(const char *directory)
{
    char said[RECORD_RESULT_TEXT];
    batch_status status = BATCH_DONE;
    (void)record_result_get(directory, "status", said);
    while (batch_is_over(status) && strcmp(said, names[status]) != 0) {
        ++status;
    }
    return batch_is_over(status) ? status : BATCH_PARTIAL;
}

/* Whether scene.yaml at `path` is the scene of a run; *missing: there is none. */
static bool is_same_scene(const batch_run *run, const char *path, bool *missing)
{
    weft_scene *scene = NULL;
    *missing = false;
    const bool same
        = weft_sweep_scene(run->scene->sweep, run->number, &scene, NULL) == WEFT_OK
          && holds(path, weft_scene_text(scene), missing);
    weft_scene_destroy(scene);
    return same;
}

batch_status batch_look(const batch *self, const batch_run *run)
{
    char directory[RECORD_PATH], path[RECORD_PATH];
    struct stat there;
    bool missing;
    if (batch_directory(self, run, directory, NULL) != WEFT_OK
        || record_path(directory, "scene.yaml", path, NULL) != WEFT_OK) {
        return BATCH_UNREADABLE;
    }
    if (lstat(directory, &there) != 0) {
        return errno == ENOENT ? BATCH_NEW : BATCH_UNREADABLE;
    }
    /* A link would lead out of the batch. */
    if (!S_ISDIR(there.st_mode)) {
        return BATCH_UNREADABLE;
    }
    if (!is_same_scene(run, path, &missing)) {
        return missing ? BATCH_NEW : BATCH_CHANGED;
    }
    return result_status(directory);
}

bool batch_warned(const batch *self, const batch_run *run)
{
    char directory[RECORD_PATH], said[RECORD_RESULT_TEXT];
    return run->status == BATCH_DONE
           && batch_directory(self, run, directory, NULL) == WEFT_OK
           && atoi(record_result_get(directory, "warnings", said)) > 0;
}
