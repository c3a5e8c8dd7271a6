/* SPDX-License-Identifier: BSD-3-Clause */
/* overrun.c -- writes statistics that the caller has no room for. */
#define ID                "overrun"
#define ENTRY             weft_plugin_overrun
#define STATS_BYTES(size) ((void)(size), sizeof(weft_stepper_stats))
#include "working.c"
