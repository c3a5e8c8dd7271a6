/* SPDX-License-Identifier: BSD-3-Clause */
/* longer.c -- takes longer steps after a failure. */
#define ID                  "longer"
#define ENTRY               weft_plugin_longer
#define ON_FAILURE(self, y) (self->fixed_step = 0.25)
#include "working.c"
