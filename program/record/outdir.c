/* SPDX-License-Identifier: BSD-3-Clause */
/* outdir.c -- the directory of a run: new, empty, or reused on request. */
#define _DEFAULT_SOURCE /* flock, which takes a directory */
#include "program/record/record.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <regex.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* mkdir -p */
static bool make_directories(const char *directory)
{
    char path[RECORD_PATH];
    const size_t length = strlen(directory);
    if (length == 0 || length >= sizeof path) {
        errno = length == 0 ? ENOENT : ENAMETOOLONG;
        return false;
    }
    memcpy(path, directory, length + 1);
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(path, 0777) != 0 && errno != EEXIST) {
            return false;
        }
        *slash = '/';
    }
    struct stat status;
    return mkdir(path, 0777) == 0
           || (errno == EEXIST && stat(path, &status) == 0 && S_ISDIR(status.st_mode));
}

const char *const record_names[] = {
    "scene.yaml",       "manifest.yaml",
    "series.csv",       "shapes.csv",
    "run.vtkhdf",       "final.csv",
    "checkpoint.weft",  "result.yaml",
    "frames",           "run.mdd",
    "run.pc2",          "run.pvd",
    "rest.obj",         "final.obj",
    "final.ply",        "run.html",
    "compare.html",     "compare.csv",
    RECORD_MESH,        RECORD_CROSSINGS,
    RECORD_SENSITIVITY, NULL,
};

/* Meshes of several cloths, and what exports add beside the names above, and the files
 * of frames/. A shape has files of its own beside those of the cloth. */
#define EXPORTED                                                                       \
    "^(scene-[0-9]+[.]obj|(final|rest)-shape-[0-9]+[.]obj|final-shape-[0-9]+[.]ply"    \
    "|run-shape-[0-9]+[.](mdd|pc2)|scene-shape[0-9]+(-[0-9]+)?[.]obj)([.]tmp)?$"
#define FRAME                                                                          \
    "^frame-([0-9]{6}|[1-9][0-9]{6,})(-shape-[0-9]+)?[.](obj|ply|csv|vtp)([.]tmp)?$"

static bool matches(const char *name, const char *pattern)
{
    regex_t compiled;
    const bool able = regcomp(&compiled, pattern, REG_EXTENDED | REG_NOSUB) == 0;
    const bool found = able && regexec(&compiled, name, 0, NULL, 0) == 0;
    if (able) {
        regfree(&compiled);
    }
    return found;
}

/* Whether weft made a file of a run's directory, be it under its temporary name. */
static bool is_ours(const char *name)
{
    for (const char *const *known = record_names; *known != NULL; ++known) {
        const size_t length = strlen(*known);
        if (strncmp(name, *known, length) == 0
            && (name[length] == '\0' || strcmp(name + length, ".tmp") == 0)) {
            return true;
        }
    }
    return matches(name, EXPORTED);
}

typedef enum sweep { KEEP_ALL, SWEEP_RUN, SWEEP_FRAMES } sweep;

/* Counts the files of a directory and removes those that weft made in a run's directory
 * or in its frames/. Returns a negative number if the directory cannot be read. */
static long look_through(const char *directory, sweep what)
{
    DIR *open = opendir(directory);
    if (open == NULL) {
        return -1;
    }
    long found = 0;
    for (struct dirent *item; (item = readdir(open)) != NULL;) {
        const char *name = item->d_name;
        char path[RECORD_PATH];
        if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0) {
            continue;
        }
        found += strcmp(name, RECORD_CROSSINGS) != 0;
        const bool ours = what == SWEEP_FRAMES ? matches(name, FRAME) : is_ours(name);
        if (what != KEEP_ALL && ours
            && record_path(directory, name, path, NULL) == WEFT_OK) {
            const bool frames = strcmp(name, "frames") == 0;
            struct stat status = { 0 }; /* of a link itself: its target stays */
            (void)lstat(path, &status);
            if (frames && S_ISDIR(status.st_mode)) {
                (void)look_through(path, SWEEP_FRAMES);
                (void)rmdir(path);
            } else if (!frames || S_ISLNK(status.st_mode)) {
                (void)unlink(path);
            }
        }
    }
    closedir(open);
    return found;
}

weft_status record_directory(const char *directory, weft_error *err)
{
    return make_directories(directory) ? WEFT_OK : record_failed(directory, err);
}

weft_status record_outdir(const char *directory, bool force, weft_error *err)
{
    TRY(record_directory(directory, err));
    const long found = look_through(directory, force ? SWEEP_RUN : KEEP_ALL);
    if (found <= 0 || force) {
        char path[RECORD_PATH];
        if (record_path(directory, RECORD_CROSSINGS, path, NULL) == WEFT_OK) {
            (void)unlink(path);
        }
        return found < 0 ? record_failed(directory, err) : WEFT_OK;
    }
    const bool unfinished = record_unfinished(directory);
    return weft_error_set(
        err, WEFT_IO, "%s: %s%s%schoose another --out, or --force to replace it",
        directory,
        unfinished ? "holds an unfinished run: 'weft resume " : "not empty; ",
        unfinished ? directory : "", unfinished ? "' continues it; or " : "");
}

/* A run does without the lock where the file system has none. */
weft_status record_outdir_lock(const char *directory, double patience, int *lock,
                               weft_error *err)
{
    static const double pause = 0.02; /* [s] */
    const struct timespec rest = { .tv_nsec = (long)(1e9 * pause) };
    *lock = make_directories(directory)
                ? open(directory, O_DIRECTORY | O_RDONLY | O_CLOEXEC)
                : -1;
    if (*lock < 0) {
        return record_failed(directory, err);
    }
    for (int tries = 1 + (int)(patience / pause); tries > 0; --tries) {
        if (flock(*lock, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) {
            return WEFT_OK;
        }
        (void)nanosleep(&rest, NULL);
    }
    (void)close(*lock);
    *lock = -1;
    return weft_error_set(err, WEFT_IO, "%s: another weft is running there", directory);
}

bool record_outdir_locked(const char *directory)
{
    const int file = open(directory, O_DIRECTORY | O_RDONLY | O_CLOEXEC);
    const bool locked
        = file >= 0 && flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (file >= 0) {
        (void)close(file);
    }
    return locked;
}
