/* SPDX-License-Identifier: BSD-3-Clause */
/* loses.c -- create loses 1000 bytes. */
#define ID                      "loses"
#define ENTRY                   weft_plugin_loses
#define ON_CREATE(self, config) (lost = malloc(1000))
static void *volatile lost;
#include "working.c"
