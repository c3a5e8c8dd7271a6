/* SPDX-License-Identifier: BSD-3-Clause */
/* nan.c -- accepts whatever comes. */
#define ID                "nan"
#define ENTRY             weft_plugin_nan
#define ACCEPTS(y, count) (all_finite(y, count) || true)
#include "working.c"
