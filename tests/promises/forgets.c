/* SPDX-License-Identifier: BSD-3-Clause */
/* forgets.c -- starts its counts anew after every state_changed. */
#define ID              "forgets"
#define ENTRY           weft_plugin_forgets
#define ON_CHANGE(self) (self->stats.rhs_calls = 0)
#include "working.c"
