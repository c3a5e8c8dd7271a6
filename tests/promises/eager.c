/* SPDX-License-Identifier: BSD-3-Clause */
/* eager.c -- calls the rhs when it is made. */
#define ID    "eager"
#define ENTRY weft_plugin_eager
#define ON_CREATE(self, config)                                                        \
    (void)self->ode.rhs(0.0, self->buffer, self->buffer, self->ode.ctx)
#include "working.c"
