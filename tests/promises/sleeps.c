/* SPDX-License-Identifier: BSD-3-Clause */
/* sleeps.c -- waits for ever in its sixth step. */
#include <unistd.h>

#define ID    "sleeps"
#define ENTRY weft_plugin_sleeps
#define ON_STEP(self)                                                                  \
    if ((self)->stats.steps == 5) {                                                    \
        (void)pause();                                                                 \
    }
#include "working.c"
