/* SPDX-License-Identifier: BSD-3-Clause */
/* alone.c -- says that it agrees with the steppers of other parts, and asks nobody. */
#define ID         "alone"
#define ENTRY      weft_plugin_alone
#define MORE_FLAGS WEFT_STEPPER_DISTRIBUTED
#include "working.c"
