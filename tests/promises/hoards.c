/* SPDX-License-Identifier: BSD-3-Clause */
/* hoards.c -- destroy frees nothing. */
#define ID               "hoards"
#define ENTRY            weft_plugin_hoards
#define ON_DESTROY(self) ((void)(self))
#include "working.c"
