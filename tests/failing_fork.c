/* SPDX-License-Identifier: BSD-3-Clause */
/* failing_fork.c -- a fork to be preloaded, which fails while an earlier child of the
 * same process runs or has not been waited for (test_batch_ends.c). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

#pragma GCC visibility push(default)

pid_t fork(void)
{
    static pid_t child;
    pid_t (*real)(void);
    void *found = dlsym(RTLD_NEXT, "fork");
    if (child > 0 && kill(child, 0) == 0) {
        errno = EAGAIN;
        return -1;
    }
    memcpy(&real, &found, sizeof real);
    child = real();
    return child;
}
