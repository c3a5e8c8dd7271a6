/* SPDX-License-Identifier: BSD-3-Clause */
/* closes.c -- closes the program's standard streams while it is loaded. */
#include <unistd.h>

__attribute__((constructor)) static void close_streams(void)
{
    for (int i = 0; i < 3; ++i) {
        (void)close(i);
    }
}

#define ID    "closes"
#define ENTRY weft_plugin_closes
#include "working.c"
