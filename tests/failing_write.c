/* SPDX-License-Identifier: BSD-3-Clause */
/* failing_write.c -- writes to be preloaded: FAIL_PWRITE=n fails the n-th pwrite of the
 * process, FAIL_PIPE=n the n-th write to a pipe (test_record_ends.c). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#pragma GCC visibility push(default)

static int fails(const char *which, int *count)
{
    const char *wanted = getenv(which);
    ++*count;
    errno = EIO;
    return wanted != NULL && atoi(wanted) == *count;
}

static ssize_t put_at(const char *name, int file, const void *bytes, size_t size,
                      off_t at)
{
    static int count;
    ssize_t (*real)(int, const void *, size_t, off_t);
    void *found = dlsym(RTLD_NEXT, name);
    memcpy(&real, &found, sizeof real);
    return fails("FAIL_PWRITE", &count) ? -1 : real(file, bytes, size, at);
}

ssize_t pwrite(int file, const void *bytes, size_t size, off_t at)
{
    return put_at("pwrite", file, bytes, size, at);
}

ssize_t pwrite64(int file, const void *bytes, size_t size, off64_t at)
{
    return put_at("pwrite64", file, bytes, size, at);
}

ssize_t write(int file, const void *bytes, size_t size)
{
    static int count;
    struct stat status;
    ssize_t (*real)(int, const void *, size_t);
    void *found = dlsym(RTLD_NEXT, "write");
    memcpy(&real, &found, sizeof real);
    const int pipe = fstat(file, &status) == 0 && S_ISFIFO(status.st_mode);
    return pipe && fails("FAIL_PIPE", &count) ? -1 : real(file, bytes, size);
}
