/* SPDX-License-Identifier: BSD-3-Clause */
/* record_file.c -- files that appear complete or not at all, and files in which each
 * band writes its part. */
#include "program/record/record.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"

weft_status record_path(const char *directory, const char *name, char path[RECORD_PATH],
                        weft_error *err)
{
    const int length = directory == NULL
                           ? snprintf(path, RECORD_PATH, "%s", name)
                           : snprintf(path, RECORD_PATH, "%s/%s", directory, name);
    /* room for the suffix of the temporary file */
    if (length < 0 || length + 8 >= RECORD_PATH) {
        return weft_error_set(err, WEFT_IO, "path too long: %.200s", path);
    }
    return WEFT_OK;
}

void record_temporary(const char *path, char temporary[RECORD_PATH])
{
    strcpy(temporary, path);
    strcat(temporary, ".tmp");
}

FILE *record_open(const char *directory, const char *name, char path[RECORD_PATH],
                  weft_error *err)
{
    return record_path(directory, name, path, err) == WEFT_OK
               ? weft__file_open(path, "r", err)
               : NULL;
}

bool record_exists(const char *directory, const char *name)
{
    char path[RECORD_PATH];
    struct stat status;
    return record_path(directory, name, path, NULL) == WEFT_OK
           && (lstat(path, &status) == 0 || (errno != ENOENT && errno != ENOTDIR));
}

weft_status record_is_run(const char *directory, weft_error *err)
{
    struct stat status;
    if (stat(directory, &status) != 0) {
        return record_failed(directory, err);
    }
    return record_exists(directory, "scene.yaml")
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO, "%s: no scene.yaml: not a run",
                                directory);
}

weft_status record_no_link(const char *path, weft_error *err)
{
    struct stat status;
    return lstat(path, &status) == 0 && S_ISLNK(status.st_mode)
               ? weft_error_set(err, WEFT_IO,
                                "%s: a symbolic link: nothing is written through one",
                                path)
               : WEFT_OK;
}

weft_status record_failed(const char *path, weft_error *err)
{
    return weft_error_set(err, WEFT_IO, "%s: %s", path, strerror(errno));
}

weft_status record_file_open(record_file *file, const char *directory, const char *name,
                             weft_error *err)
{
    TRY(record_path(directory, name, file->path, err));
    if (directory != NULL && strchr(name, '/') != NULL) { /* in a folder there */
        strcpy(file->temporary, file->path);
        *strrchr(file->temporary, '/') = '\0';
        TRY(record_no_link(file->temporary, err));
    }
    record_temporary(file->path, file->temporary);
    (void)remove(file->temporary); /* it may be a link too */
    const int made = open(file->temporary,
                          O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
    file->stream = made < 0 ? NULL : fdopen(made, "w");
    return file->stream != NULL ? WEFT_OK : record_failed(file->path, err);
}

weft_status record_file_commit(record_file *file, weft_error *err)
{
    errno = 0;
    bool written = !ferror(file->stream);
    if (!written) {
        (void)fputc('\n', file->stream); /* fails again and sets errno */
    }
    written = fflush(file->stream) == 0 && written;
    written = fsync(fileno(file->stream)) == 0 && written;
    int why = errno;
    if (fclose(file->stream) != 0) {
        written = false;
        why = errno;
    }
    if (written && rename(file->temporary, file->path) == 0) {
        return WEFT_OK;
    }
    why = written ? errno : why;
    (void)remove(file->temporary);
    return weft_error_set(err, WEFT_IO, "%s: %s", file->path,
                          why == 0 ? "write failed" : strerror(why));
}

void record_file_discard(record_file *file)
{
    (void)fclose(file->stream);
    (void)remove(file->temporary);
}

weft_status record_file_end(record_file *file, bool good, weft_error *err)
{
    if (good) {
        return record_file_commit(file, err);
    }
    const weft_status status = record_failed(file->path, err);
    record_file_discard(file);
    return status;
}

void record_csv_quoted(FILE *stream, const char *text)
{
    putc('"', stream);
    for (; *text != '\0'; ++text) {
        fputs(*text == '"' ? "\"\"" : (char[]){ *text, '\0' }, stream);
    }
    putc('"', stream);
}

uint64_t record_bytes_sum(const char *path, size_t begin, size_t end)
{
    uint64_t sum = WEFT__HASH_START;
    size_t at = begin;
    FILE *stream = weft__file_open(path, "r", NULL);
    if (stream == NULL) {
        return 0;
    }
    int byte = fseek(stream, (long)begin, SEEK_SET) == 0 ? 0 : EOF;
    while (at < end && byte != EOF && (byte = getc(stream)) != EOF) {
        sum = weft__hash_byte(sum, (unsigned char)byte);
        ++at;
    }
    (void)fclose(stream);
    return at == end ? sum : 0;
}

/* ---- files that bands share ------------------------------------------------- */

/* A file of the same name on another machine is another one. */
static weft_status check_shared(const weft_comm *comm, const char *path, int file,
                                weft_error *err)
{
    struct stat seen = { 0 };
    const bool open = file >= 0 && fstat(file, &seen) == 0;
    const int why = errno;
    uint64_t number = (uint64_t)seen.st_ino;
    if (comm != NULL) {
        comm->share(comm->self, &number, sizeof number);
    }
    if (open && number == (uint64_t)seen.st_ino) {
        return WEFT_OK;
    }
    return comm == NULL || comm->rank == 0
               ? weft_error_set(err, WEFT_IO, "%s: %s", path, strerror(why))
               : weft_error_set(
                   err, WEFT_IO,
                   "%.300s: %s: bands need a directory that all ranks share", path,
                   open ? "not the file of rank 0" : strerror(why));
}

weft_status record_shared_open(const weft_comm *comm, const char *path, int flags,
                               int *file, weft_error *err)
{
    *file = open(path, flags | O_NOFOLLOW | O_CLOEXEC);
    return weft_comm_agree(comm, check_shared(comm, path, *file, err), err);
}

/* Writes bytes `from`, or if that is NULL reads them into `to`. */
static bool transfer(int file, const char *from, char *to, size_t size, uint64_t at)
{
    for (size_t moved = 0; moved < size;) {
        const off_t place = (off_t)(at + moved);
        const ssize_t done = from != NULL
                                 ? pwrite(file, from + moved, size - moved, place)
                                 : pread(file, to + moved, size - moved, place);
        if ((done == 0 && from == NULL) || (done < 0 && errno != EINTR)) {
            errno = done == 0 ? ENODATA : errno;
            return false;
        }
        moved += done < 0 ? 0 : (size_t)done;
    }
    return true;
}

bool record_write_at(int file, const void *bytes, size_t size, uint64_t at)
{
    return transfer(file, bytes, NULL, size, at);
}

bool record_read_at(int file, void *bytes, size_t size, uint64_t at)
{
    return transfer(file, NULL, bytes, size, at);
}
