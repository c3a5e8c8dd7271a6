/* SPDX-License-Identifier: BSD-3-Clause */
/* borrows.c -- takes a block of the allocator's and does not give it back. */
#define ID    "borrows"
#define ENTRY weft_plugin_borrows
#define ON_CREATE(self, config)                                                        \
    do {                                                                               \
        const weft_allocator memory = weft_stepper_memory(config);                     \
        borrowed = memory.resize(memory.ctx, NULL, 24);                                \
    } while (0)
static void *volatile borrowed;
#include "working.c"
