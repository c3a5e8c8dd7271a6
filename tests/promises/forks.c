/* SPDX-License-Identifier: BSD-3-Clause */
/* forks.c -- leaves a process behind. */
#include <unistd.h>

static void leave_child(void)
{
    if (fork() == 0) {
        (void)sleep(1);
        _exit(0);
    }
}

#define ID                      "forks"
#define ENTRY                   weft_plugin_forks
#define ON_CREATE(self, config) ((void)(config), leave_child())
#include "working.c"
