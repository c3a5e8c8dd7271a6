/* SPDX-License-Identifier: BSD-3-Clause */
/* clock.c -- starts each step where its last one ended, not at the t that it is given.
 */
#define ID                 "clock"
#define ENTRY              weft_plugin_clock
#define STARTS_AT(self, t) ((self)->stats.steps == 0 ? (t) : (self)->clock)
#include "working.c"
