/* SPDX-License-Identifier: BSD-3-Clause */
/* aborts.c -- aborts when it is asked for its methods. */
#include <stdlib.h>

#define ID         "aborts"
#define ENTRY      weft_plugin_aborts
#define ON_ENTRY() abort()
#include "working.c"
