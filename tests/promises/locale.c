/* SPDX-License-Identifier: BSD-3-Clause */
/* locale.c -- wants points in its numbers. */
#define ID    "locale"
#define ENTRY weft_plugin_locale
#include <locale.h>
#define ON_CREATE(self, config) ((void)(config), (void)setlocale(LC_ALL, "C.UTF-8"))
#include "working.c"
