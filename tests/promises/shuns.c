/* SPDX-License-Identifier: BSD-3-Clause */
/* shuns.c -- works only where no structure is known. */
#define ID    "shuns"
#define ENTRY weft_plugin_shuns
#define REFUSES(config)                                                                \
    (!((config)->fixed_step > 0.0) || !isfinite((config)->fixed_step)                  \
     || weft_stepper_structure(config) != NULL)
#include "working.c"
