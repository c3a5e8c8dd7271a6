/* SPDX-License-Identifier: BSD-3-Clause */
/* chdir.c -- goes to another directory. */
#include <unistd.h>

#define ID    "chdir"
#define ENTRY weft_plugin_chdir
#define ON_CREATE(self, config)                                                        \
    ((void)(config), (void)(chdir("/") == 0 || ((self)->clock = 0.0) > 0.0))
#include "working.c"
