/* SPDX-License-Identifier: BSD-3-Clause */
/* twicename.c -- to be refused: two methods of one name. */
#define ID    "twicename"
#define ENTRY weft_plugin_twicename
#define NAME  "first"
#include "good.c"
