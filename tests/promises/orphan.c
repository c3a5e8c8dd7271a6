/* SPDX-License-Identifier: BSD-3-Clause */
/* orphan.c -- leaves the child of a child behind. */
#include <sys/wait.h>
#include <unistd.h>

static void leave_grandchild(void)
{
    const pid_t child = fork();
    if (child == 0) {
        if (fork() == 0) {
            (void)sleep(1);
        }
        _exit(0);
    }
    (void)waitpid(child, NULL, 0);
}

#define ID                      "orphan"
#define ENTRY                   weft_plugin_orphan
#define ON_CREATE(self, config) ((void)(config), leave_grandchild())
#include "working.c"
