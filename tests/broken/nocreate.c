/* SPDX-License-Identifier: BSD-3-Clause */
/* nocreate.c -- to be refused: a method cannot be created. */
#define ID     "nocreate"
#define ENTRY  weft_plugin_nocreate
#define CREATE NULL
#include "good.c"
