/* SPDX-License-Identifier: BSD-3-Clause */
/* rounding.c -- rounds upwards from then on. */
#define ID    "rounding"
#define ENTRY weft_plugin_rounding
#include <fenv.h>
#define ON_STEP(self) (void)fesetround(FE_UPWARD)
#include "working.c"
