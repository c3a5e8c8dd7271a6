/* SPDX-License-Identifier: BSD-3-Clause */
/* roundoff.c -- ends where t + h does, an ulp from t_end. */
#define ID                         "roundoff"
#define ENTRY                      weft_plugin_roundoff
#define T_AFTER(t, h, last, t_end) ((void)(last), (void)(t_end), (t) + (h))
#include "working.c"
