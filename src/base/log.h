/* SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "weft/base.h"

/* base.c: passes a line to the log, if it has a writer. */
WEFT_PRINTF(3, 4)
void weft__log(const weft_log *log, weft_log_level level, const char *format, ...);
