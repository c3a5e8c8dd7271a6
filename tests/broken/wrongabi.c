/* SPDX-License-Identifier: BSD-3-Clause */
/* wrongabi.c -- to be refused: built for an ABI to come. */
#define ID    "wrongabi"
#define ENTRY weft_plugin_wrongabi
#define ABI   2
#include "good.c"
