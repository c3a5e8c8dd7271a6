/* SPDX-License-Identifier: BSD-3-Clause */
/* spoils.c -- leaves a y that failed. */
#define ID                  "spoils"
#define ENTRY               weft_plugin_spoils
#define ON_FAILURE(self, y) memcpy(y, BUFFER(self), self->ode.dim * sizeof *y)
#include "working.c"
