/* SPDX-License-Identifier: BSD-3-Clause */
/* needless.c -- takes a shorter step after every state_changed. */
#define ID              "needless"
#define ENTRY           weft_plugin_needless
#define ON_CHANGE(self) (self->fixed_step *= 0.875)
#include "working.c"
