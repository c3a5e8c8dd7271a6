/* SPDX-License-Identifier: BSD-3-Clause */
/* exports.c -- sets a variable of the environment. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>

#define ID    "exports"
#define ENTRY weft_plugin_exports
#define ON_CREATE(self, config)                                                        \
    ((void)(config), (void)setenv("OMP_NUM_THREADS", "7", 1))
#include "working.c"
