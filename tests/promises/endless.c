/* SPDX-License-Identifier: BSD-3-Clause */
/* endless.c -- its step after the 100th never ends, and never calls the rhs. */
#define ID            "endless"
#define ENTRY         weft_plugin_endless
#define ON_STEP(self) endless((self)->stats.steps)
static inline void endless(unsigned long long steps)
{
    volatile unsigned long long turns = 0;
    while (steps == 100 || turns > 0) {
        turns = turns + 1;
    }
}
#include "working.c"
