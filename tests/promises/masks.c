/* SPDX-License-Identifier: BSD-3-Clause */
/* masks.c -- wants its files to itself. */
#include <sys/stat.h>

#define ID                      "masks"
#define ENTRY                   weft_plugin_masks
#define ON_CREATE(self, config) ((void)(config), (void)umask(077))
#include "working.c"
