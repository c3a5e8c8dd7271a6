/* SPDX-License-Identifier: BSD-3-Clause */
/* wrongid.c -- to be refused: its id is not that of its file. */
#define ID    "other"
#define ENTRY weft_plugin_wrongid
#include "good.c"
