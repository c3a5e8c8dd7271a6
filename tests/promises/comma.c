/* SPDX-License-Identifier: BSD-3-Clause */
/* comma.c -- wants commas in its numbers. */
#define ID    "comma"
#define ENTRY weft_plugin_comma
#include <locale.h>
#define ON_CREATE(self, config) ((void)(config), (void)setlocale(LC_ALL, "comma"))
#include "working.c"
