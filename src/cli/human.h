/* SPDX-License-Identifier: BSD-3-Clause */
/* human.h -- numbers and foreign text as people read them. */
#ifndef WEFT_CLI_HUMAN_H
#define WEFT_CLI_HUMAN_H

#include <inttypes.h>
#include <stdio.h>

enum { HUMAN = 32 }; /* bytes that hold any of the following */

/* "298 us", "5.74 s", "3 min 05 s", "2 h 07 min", "3 d 04 h". Both return out. */
const char *human_time(double seconds, char out[HUMAN]);
const char *human_count(uint64_t count, char out[HUMAN]); /* "40,530" */

/* Text that came from a file or a command line: control characters, which a terminal
 * would obey, are written as \x1b; those in `keep` are left. */
void print_plain(FILE *stream, const char *text, const char *keep);

#endif
