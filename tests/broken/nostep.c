/* SPDX-License-Identifier: BSD-3-Clause */
/* nostep.c -- to be refused: a method cannot step. */
#define ID    "nostep"
#define ENTRY weft_plugin_nostep
#define STEP  NULL
#include "good.c"
