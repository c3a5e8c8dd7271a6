/* SPDX-License-Identifier: BSD-3-Clause */
/* typeabi.c -- to be refused: one of its methods is of another ABI. */
#define ID       "typeabi"
#define ENTRY    weft_plugin_typeabi
#define TYPE_ABI 7
#include "good.c"
