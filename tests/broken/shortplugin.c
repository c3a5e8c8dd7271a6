/* SPDX-License-Identifier: BSD-3-Clause */
/* shortplugin.c -- to be refused: its record of the plugin ends too early. */
#define ID    "shortplugin"
#define ENTRY weft_plugin_shortplugin
#define SIZE  16
#include "good.c"
