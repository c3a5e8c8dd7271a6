/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_state.c -- what is in the directory of a run. */
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "cli/batch/batch.h"
#include "record/result_read.h"

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

/* Whether a file holds a text and nothing else; *missing if there is no such file. */
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

static batch_status result_status(const char *directory)
{
    static const batch_status over[]
        = { BATCH_DONE, BATCH_FAILED, BATCH_IO_ERROR, BATCH_CRASHED, BATCH_TIMEOUT };
    yaml_document_t result;
    batch_status status = BATCH_PARTIAL;
    if (!record_result_open(directory, &result)) {
        return status;
    }
    const char *said = record_result_value(&result, "status");
    for (size_t i = 0; said != NULL && i < sizeof over / sizeof over[0]; ++i) {
        status = strcmp(said, names[over[i]]) == 0 ? over[i] : status;
    }
    yaml_document_delete(&result);
    return status;
}

batch_status batch_look(const batch *self, const batch_run *run,
                        const weft_scene *scene)
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
    if (!holds(path, weft_scene_text(scene), &missing)) {
        return missing ? BATCH_NEW : BATCH_CHANGED;
    }
    return result_status(directory);
}

bool batch_warned(const batch *self, const batch_run *run)
{
    char directory[RECORD_PATH];
    yaml_document_t result;
    if (run->status != BATCH_DONE
        || batch_directory(self, run, directory, NULL) != WEFT_OK
        || !record_result_open(directory, &result)) {
        return false;
    }
    const char *said = record_result_value(&result, "warnings");
    const bool warned = said != NULL && strcmp(said, "0") != 0;
    yaml_document_delete(&result);
    return warned;
}
