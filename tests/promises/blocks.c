/* SPDX-License-Identifier: BSD-3-Clause */
/* blocks.c -- never returns when it is asked for its methods. */
#include <unistd.h>

#define ID         "blocks"
#define ENTRY      weft_plugin_blocks
#define ON_ENTRY() (void)pause()
#include "working.c"
