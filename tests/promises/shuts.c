/* SPDX-License-Identifier: BSD-3-Clause */
/* shuts.c -- closes a descriptor that it has not opened. */
#include <unistd.h>

#define ID                      "shuts"
#define ENTRY                   weft_plugin_shuts
#define ON_CREATE(self, config) ((void)(config), (void)close(0))
#include "working.c"
