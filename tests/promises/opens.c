/* SPDX-License-Identifier: BSD-3-Clause */
/* opens.c -- leaves a file open. */
#include <fcntl.h>

static void open_null(void)
{
    (void)open("/dev/null", O_RDONLY);
}

#define ID                      "opens"
#define ENTRY                   weft_plugin_opens
#define ON_CREATE(self, config) ((void)(config), open_null())
#include "working.c"
