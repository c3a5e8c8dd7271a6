/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_child.c -- one run, in a process of its own. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#ifdef __linux__
#include <signal.h>
#include <sys/prctl.h>
#endif

#include "cli/batch.h"

/* The lock goes when the process ends, however it ends. A run whose batch was killed a
 * moment ago may still be writing what it has. */
static bool lock(int log)
{
    enum { TRIES = 50 };
    const struct timespec pause = { .tv_nsec = 100000000 };
    struct flock whole = { .l_type = F_WRLCK, .l_whence = SEEK_SET };
    for (int i = 0; i < TRIES; ++i) {
        if (fcntl(log, F_SETLK, &whole) == 0) {
            return true;
        }
        (void)nanosleep(&pause, NULL);
    }
    return false;
}

/* Directory and log of a run; what it prints goes there. Its descriptor stays open, as
 * closing it would end the lock. */
static int open_log(const char *directory, weft_error *err)
{
    char path[RECORD_PATH];
    if (record_path(directory, "log.txt", path, err) != WEFT_OK) {
        return -1;
    }
    int log = -1;
    if (mkdir(directory, 0777) == 0 || errno == EEXIST) {
        log = open(path, O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666);
    }
    if (log < 0) {
        (void)weft_error_set(err, WEFT_IO, "%s: %s", path, strerror(errno));
    }
    return log;
}

static int begin(const batch *self, const char *directory, const weft_scene *scene)
{
    options given = *self->given;
    given.quiet = given.force = true; /* the batch has looked into the directory */
    return run_scene(&given, directory, scene, self->registry);
}

/* Between a look of the batch and the lock somebody else may have run it. */
static int run_locked(const batch *self, const batch_run *run, const char *directory,
                      int log)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    if (weft_sweep_scene(run->scene->sweep, run->number, &scene, &err) != WEFT_OK) {
        return report_error(&err);
    }
    const batch_status status = batch_look(self, run, scene);
    if (status == BATCH_DONE || status == BATCH_UNREADABLE) {
        return status == BATCH_DONE ? EXIT_DONE : EXIT_FILE;
    }
    if (status != BATCH_PARTIAL && ftruncate(log, 0) != 0) {
        return EXIT_FILE;
    }
    return begin(self, directory, scene);
}

static int run_child(const batch *self, const batch_run *run)
{
    char directory[RECORD_PATH];
    weft_error err = { 0 };
    const int log = batch_directory(self, run, directory, &err) == WEFT_OK
                        ? open_log(directory, &err)
                        : -1;
    if (log < 0) {
        return report_error(&err);
    }
    if (!lock(log)) {
        return BATCH_EXIT_BUSY;
    }
    if (dup2(log, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0) {
        return EXIT_FILE;
    }
    return run_locked(self, run, directory, log);
}

void batch_child(const batch *self, const batch_run *run)
{
#ifdef __linux__
    (void)prctl(PR_SET_PDEATHSIG, SIGTERM); /* a killed batch leaves nobody behind */
#endif
    const int code = run_child(self, run);
    (void)fflush(NULL);
    _exit(code);
}
