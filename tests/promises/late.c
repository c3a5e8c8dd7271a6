/* SPDX-License-Identifier: BSD-3-Clause */
/* late.c -- goes past t_end by an ulp. */
#define ID                         "late"
#define ENTRY                      weft_plugin_late
#define T_AFTER(t, h, last, t_end) ((last) ? nextafter(t_end, INFINITY) : (t) + (h))
#include "working.c"
