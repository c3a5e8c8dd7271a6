/* SPDX-License-Identifier: BSD-3-Clause */
/* player_page.h -- the frames of one run, or of two side by side, as one HTML page that
 * a browser plays without a network. docs/player.md describes the page and its data. */
#ifndef WEFT_RECORD_PLAYER_PAGE_H
#define WEFT_RECORD_PLAYER_PAGE_H

#include "weft/weft.h"

/* Write `file` from the runs in directories[count], count 1 or 2, by rename. Two runs
 * are shown at the times that both have. Errors: WEFT_IO (a file), WEFT_INVALID (runs
 * of different grids or without a common time), WEFT_NO_MEMORY. */
weft_status record_player(const char *const *directories, size_t count,
                          const char *file, weft_error *err);

#endif
