/* SPDX-License-Identifier: BSD-3-Clause */
/* outdir.c -- the directory of a run: new, empty, or reused on request. */
#define _DEFAULT_SOURCE /* flock, which takes a directory */
#include "record/record.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
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
    "scene.yaml", "manifest.yaml",   "series.csv",  "shapes.csv", "run.vtkhdf",
    "final.csv",  "checkpoint.weft", "result.yaml", "frames",     "run.mdd",
    "run.pc2",    "run.pvd",         "rest.obj",    "final.obj",  "final.ply",
    "run.html",   "compare.html",    "compare.csv", RECORD_MESH,  NULL,
};

/* Whether a name is in the list, or is the temporary name of one that is. */
static bool is_listed(const char *name, const char *const *list)
{
    for (; *list != NULL; ++list) {
        const size_t known = strlen(*list);
        if (strncmp(name, *list, known) == 0
            && (name[known] == '\0' || strcmp(name + known, ".tmp") == 0)) {
            return true;
        }
    }
    return false;
}

/* Whether it is a file of frames/: frame-000012.obj and the like. */
static bool is_frame(const char *name)
{
    static const char *const endings[] = { ".obj", ".ply", ".csv", ".vtp", NULL };
    const size_t digits
        = strncmp(name, "frame-", 6) == 0 ? strspn(name + 6, "0123456789") : 0;
    return (digits == 6 || (digits > 6 && name[6] != '0'))
           && is_listed(name + 6 + digits, endings);
}

/* The file of the cloth beside which that of a shape was exported: final.obj for
 * final-shape-0.obj. Other names are returned as they are. */
static const char *cloth_name(const char *name, char out[NAME_MAX + 1])
{
    static const char *const endings[]
        = { ".obj", ".ply", ".vtp", ".mdd", ".pc2", NULL };
    const char *mark = strstr(name, "-shape-");
    const size_t digits = mark == NULL ? 0 : strspn(mark + 7, "0123456789");
    if (digits == 0 || !is_listed(mark + 7 + digits, endings)) {
        return name;
    }
    (void)snprintf(out, NAME_MAX + 1, "%.*s%s", (int)(mark - name), name,
                   mark + 7 + digits);
    return out;
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
        char path[RECORD_PATH], cloth[NAME_MAX + 1];
        if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0) {
            continue;
        }
        ++found;
        const char *of = cloth_name(name, cloth);
        const bool ours
            = what == SWEEP_FRAMES ? is_frame(of) : is_listed(of, record_names);
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
        return found < 0 ? record_failed(directory, err) : WEFT_OK;
    }
    const bool unfinished = record_unfinished(directory);
    return weft_error_set(
        err, WEFT_IO, "%s: %s%s%schoose another --out, or --force to replace it",
        directory,
        unfinished ? "holds an unfinished run: 'weft resume " : "not empty; ",
        unfinished ? directory : "", unfinished ? "' continues it; or " : "");
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

/* A run does without the lock where the file system has none. */
weft_status record_outdir_lock(const char *directory, double patience, int *lock,
                               weft_error *err)
{
    *lock = make_directories(directory)
                ? open(directory, O_DIRECTORY | O_RDONLY | O_CLOEXEC)
                : -1;
    if (*lock < 0) {
        return record_failed(directory, err);
    }
    if (!taken(*lock, patience)) {
        return WEFT_OK;
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
