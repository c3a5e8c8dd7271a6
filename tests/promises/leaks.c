/* SPDX-License-Identifier: BSD-3-Clause */
/* leaks.c -- allocates in every step. */
#define ID            "leaks"
#define ENTRY         weft_plugin_leaks
#define ON_STEP(self) (kept = malloc(sizeof(double) * 16))
static void *volatile kept;
#include "working.c"
