/* SPDX-License-Identifier: BSD-3-Clause */
/* noentry.c -- to be refused: its entry function has another name. */
#define ID    "noentry"
#define ENTRY weft_plugin_entry
#include "good.c"
