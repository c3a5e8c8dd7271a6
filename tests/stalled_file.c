/* SPDX-License-Identifier: BSD-3-Clause */
/* stalled_file.c -- to be preloaded: a file system that never answers libhdf5, and a
 * clock that runs a thousand times as fast (test_record.c). */
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#pragma GCC visibility push(default)

ssize_t pread(int file, void *to, size_t size, off_t at)
{
    (void)file;
    (void)to;
    (void)size;
    (void)at;
    for (;;) {
        (void)pause();
    }
}

#ifdef __GLIBC__
ssize_t pread64(int file, void *to, size_t size, off64_t at)
{
    return pread(file, to, size, at);
}
#endif

int clock_gettime(clockid_t clock, struct timespec *now)
{
    const int code = (int)syscall(SYS_clock_gettime, clock, now);
    now->tv_sec = 1000 * now->tv_sec + now->tv_nsec / 1000000;
    now->tv_nsec = 0;
    return code;
}
