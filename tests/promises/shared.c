/* SPDX-License-Identifier: BSD-3-Clause */
/* shared.c -- works in memory that all instances share. */
#define ID           "shared"
#define ENTRY        weft_plugin_shared
#define BUFFER(self) ((void)(self), shared)
static double shared[3 * 16384];
#include "working.c"
