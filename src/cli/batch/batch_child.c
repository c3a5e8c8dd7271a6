/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_child.c -- one run, in a process of its own. */
#include <fcntl.h>
#include <unistd.h>

#include "cli/batch/batch.h"
#include "cli/run/run.h"

/* What a run prints goes into its directory. */
static bool open_log(const char *directory, bool goes_on)
{
    char path[RECORD_PATH];
    const int start = O_NONBLOCK | (goes_on ? O_APPEND : O_TRUNC);
    const int log = record_path(directory, "log.txt", path, NULL) == WEFT_OK
                        ? open(path, O_WRONLY | O_CREAT | O_NOFOLLOW | start, 0666)
                        : -1;
    return log >= 0 && dup2(log, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0;
}

/* Between a look of the batch and the claim somebody else may have run it. */
static int run_claimed(const batch *self, const batch_run *one, const char *directory)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    if (weft_sweep_scene(one->scene->sweep, one->number, &scene, &err) != WEFT_OK) {
        return report_error(&err);
    }
    const batch_status status = batch_look(self, one, scene);
    const bool goes_on = status == BATCH_PARTIAL || status == BATCH_IO_ERROR
                         || status == BATCH_TIMEOUT;
    if (status == BATCH_DONE) {
        return EXIT_DONE;
    }
    if (!open_log(directory, goes_on)) {
        return EXIT_FILE;
    }
    options given = *self->given;
    given.quiet = true;
    if (goes_on) {
        return resume_scene(&given, directory, scene);
    }
    /* from the start, over what an earlier attempt has left */
    return record_outdir(directory, true, &err) == WEFT_OK
               ? run_scene(&given, directory, scene, true, NULL)
               : report_error(&err);
}

int batch_child(const batch *self, const batch_run *one)
{
    char directory[RECORD_PATH];
    weft_error err = { 0 };
    if (batch_directory(self, one, directory, &err) != WEFT_OK
        || record_directory(directory, &err) != WEFT_OK) {
        return report_error(&err);
    }
    int lock; /* goes when the process ends, however it ends */
    return record_outdir_lock(directory, BATCH_PATIENCE, &lock, NULL) == WEFT_OK
               ? run_claimed(self, one, directory)
               : BATCH_EXIT_BUSY;
}
