/* SPDX-License-Identifier: BSD-3-Clause */
/* crashes.c -- reads where nothing is. */
#define ID            "crashes"
#define ENTRY         weft_plugin_crashes
#define ON_STEP(self) ((void)*(volatile char *)NULL)
#include "working.c"
