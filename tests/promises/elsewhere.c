/* SPDX-License-Identifier: BSD-3-Clause */
/* elsewhere.c -- says that it looks first where it starts, and looks a little later. */
#define ID            "elsewhere"
#define ENTRY         weft_plugin_elsewhere
#define T_FIRST(t, h) ((t) + 1e-9 * (h))
#include "working.c"
