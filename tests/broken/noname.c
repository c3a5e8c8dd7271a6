/* SPDX-License-Identifier: BSD-3-Clause */
/* noname.c -- to be refused: a method without a name. */
#define ID    "noname"
#define ENTRY weft_plugin_noname
#define NAME  ""
#include "good.c"
