/* SPDX-License-Identifier: BSD-3-Clause */
/* outdir.c -- the directory of a run: new, or empty, or taken over on request. */
#define _DEFAULT_SOURCE /* flock, which takes a directory */
#include "record/record.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
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
    return mkdir(path, 0777) == 0 || errno == EEXIST;
}

const char *const record_names[] = {
    "scene.yaml",      "manifest.yaml", "series.csv", "run.vtkhdf", "final.csv",
    "checkpoint.weft", "result.yaml",   "frames",     "run.mdd",    "run.pc2",
    "run.pvd",         "rest.obj",      "final.obj",  "final.ply",  "run.html",
    "compare.html",    "compare.csv",   NULL,
};

/* A frame is told by its name. */
static bool is_ours(const char *name)
{
    const size_t length = strlen(name);
    for (size_t i = 0; record_names[i] != NULL; ++i) {
        const size_t known = strlen(record_names[i]);
        if (strncmp(name, record_names[i], known) == 0
            && (length == known || strcmp(name + known, ".tmp") == 0)) {
            return true;
        }
    }
    return strncmp(name, "frame-", 6) == 0;
}

/* Count what is in a directory; with `clear`, remove what weft made instead and count
 * nothing. Returns a negative number if it cannot be read or cleared. */
static long look_through(const char *directory, bool clear)
{
    DIR *open = opendir(directory);
    if (open == NULL) {
        return -1;
    }
    long found = 0;
    for (struct dirent *item; (item = readdir(open)) != NULL;) {
        char path[RECORD_PATH];
        if (strcmp(item->d_name, ".") == 0 || strcmp(item->d_name, "..") == 0) {
            continue;
        }
        ++found;
        if (clear && is_ours(item->d_name)
            && record_path(directory, item->d_name, path, NULL) == WEFT_OK) {
            struct stat status; /* a link is removed, and what it leads to stays */
            if (lstat(path, &status) == 0 && S_ISDIR(status.st_mode)
                && strcmp(item->d_name, "frames") == 0) {
                (void)look_through(path, true);
            }
            (void)remove(path);
        }
    }
    closedir(open);
    return found;
}

weft_status record_directory(const char *directory, weft_error *err)
{
    if (!make_directories(directory)) {
        return weft_error_set(err, WEFT_IO, "%s: %s", directory, strerror(errno));
    }
    return WEFT_OK;
}

weft_status record_outdir(const char *directory, bool force, weft_error *err)
{
    const weft_status status = record_directory(directory, err);
    if (status != WEFT_OK) {
        return status;
    }
    const long found = look_through(directory, force);
    if (found < 0) {
        return weft_error_set(err, WEFT_IO, "%s: %s", directory, strerror(errno));
    }
    if (found > 0 && !force) {
        const bool unfinished = record_unfinished(directory);
        return weft_error_set(
            err, WEFT_IO, "%s: %s%s%schoose another --out, or --force to replace it",
            directory,
            unfinished ? "holds an unfinished run: 'weft resume " : "not empty; ",
            unfinished ? directory : "", unfinished ? "' goes on with it; or " : "");
    }
    return WEFT_OK;
}

static bool taken(int lock, double patience)
{
    static const double pause = 0.02; /* [s] */
    const struct timespec rest = { .tv_nsec = (long)(1e9 * pause) };
    for (double waited = 0.0;; waited += pause) {
        if (flock(lock, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) {
            return false;
        }
        if (waited >= patience) {
            return true;
        }
        (void)nanosleep(&rest, NULL);
    }
}

/* A file system that knows no locks is no reason not to run. */
weft_status record_outdir_lock(const char *directory, double patience, int *lock,
                               weft_error *err)
{
    *lock = make_directories(directory) ? open(directory, O_RDONLY | O_CLOEXEC) : -1;
    if (*lock < 0) {
        return weft_error_set(err, WEFT_IO, "%s: %s", directory, strerror(errno));
    }
    if (taken(*lock, patience)) {
        (void)close(*lock);
        *lock = -1;
        return weft_error_set(err, WEFT_IO, "%s: another weft is running there",
                              directory);
    }
    return WEFT_OK;
}
