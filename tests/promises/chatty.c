/* SPDX-License-Identifier: BSD-3-Clause */
/* chatty.c -- reports its successes as errors. */

#define ID    "chatty"
#define ENTRY weft_plugin_chatty
#define ON_CREATE(self, config)                                                        \
    ((void)(config), (void)weft_error_set(err, WEFT_OK, "all is well"))
#include "working.c"
