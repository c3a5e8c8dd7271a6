/* SPDX-License-Identifier: BSD-3-Clause */
/* timer.c -- leaves a timer that would end the program. */
#include <stddef.h>
#include <sys/time.h>

static void set_timer(void)
{
    const struct itimerval later = { .it_value.tv_sec = 100 };
    (void)setitimer(ITIMER_REAL, &later, NULL);
}

#define ID                      "timer"
#define ENTRY                   weft_plugin_timer
#define ON_CREATE(self, config) ((void)(config), set_timer())
#include "working.c"
