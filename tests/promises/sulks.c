/* SPDX-License-Identifier: BSD-3-Clause */
/* sulks.c -- a create that refuses keeps some bytes. */
#define ID                 "sulks"
#define ENTRY              weft_plugin_sulks
#define ON_REFUSAL(config) (kept = malloc(24))
static void *volatile kept;
#include "working.c"
