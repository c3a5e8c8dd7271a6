/* SPDX-License-Identifier: BSD-3-Clause */
/* file.h -- files opened without blocking. */
#pragma once

#include "weft/base.h"

/* A regular file, opened as by fopen with mode "r", "r+" or "w". NULL and WEFT_IO,
 * "path: reason", also for a FIFO or a device, which could block for ever. */
FILE *weft__file_open(const char *path, const char *mode, weft_error *err);
