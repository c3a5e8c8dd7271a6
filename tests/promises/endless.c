/* SPDX-License-Identifier: BSD-3-Clause */
/* endless.c -- its step after the 100th never ends, and never calls the rhs: it
 * computes and sleeps by turns. */
#include <time.h>

#define ID            "endless"
#define ENTRY         weft_plugin_endless
#define ON_STEP(self) endless((self)->stats.steps)
static inline void endless(unsigned long long steps)
{
    const struct timespec moment = { .tv_nsec = 10000000 };
    volatile unsigned long long turns = 0;
    while (steps == 100 || turns > 0) {
        turns = turns + 1;
        if (turns % 1000000 == 0) {
            (void)nanosleep(&moment, NULL);
        }
    }
}
#include "working.c"
