/* SPDX-License-Identifier: BSD-3-Clause */
/* claim.c -- claims an order it does not have. */
#define ID    "claim"
#define ENTRY weft_plugin_claim
#define ORDER 3
#include "working.c"
