/* SPDX-License-Identifier: BSD-3-Clause */
/* exits.c -- ends the program. */
#define ID            "exits"
#define ENTRY         weft_plugin_exits
#define ON_STEP(self) _Exit(3)
#include "working.c"
