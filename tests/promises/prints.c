/* SPDX-License-Identifier: BSD-3-Clause */
/* prints.c -- tells what it does. */
#define ID    "prints"
#define ENTRY weft_plugin_prints
#include <stdio.h>
#define ON_STEP(self) printf("stepping by %g\n", self->fixed_step)
#include "working.c"
