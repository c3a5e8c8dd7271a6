/* SPDX-License-Identifier: BSD-3-Clause */
/* shorttype.c -- to be refused: its record of a method ends too early. */
#define ID        "shorttype"
#define ENTRY     weft_plugin_shorttype
#define TYPE_SIZE 64
#include "good.c"
