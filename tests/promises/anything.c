/* SPDX-License-Identifier: BSD-3-Clause */
/* anything.c -- accepts any step size. */
#define ID              "anything"
#define ENTRY           weft_plugin_anything
#define REFUSES(config) ((config)->fixed_step == 0.0)
#include "working.c"
