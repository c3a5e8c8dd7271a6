/* SPDX-License-Identifier: BSD-3-Clause */
/* departs.c -- ends the program before it is asked for its methods. */
#include <stdlib.h>

__attribute__((constructor)) static void depart(void)
{
    exit(0);
}

#define ID    "departs"
#define ENTRY weft_plugin_departs
#include "working.c"
