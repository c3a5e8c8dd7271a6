/* SPDX-License-Identifier: BSD-3-Clause */
/* suggest.h -- the nearest name to a mistyped one. */
#pragma once

#include <stddef.h>

/* A candidate so far; start from { 0 }. */
typedef struct weft__guess {
    const char *name; /* NULL: none is near */
    size_t distance;
} weft__guess;

/* Make `name` the guess for `typed` if it is near enough and nearer than the last; of
 * two that are equally near the longer one, because people shorten names:
 * rk45 is rkf45, not rk4. Farther than these is the first name of which `typed` is a
 * word between hyphens. */
void weft__guess_try(weft__guess *guess, const char *typed, const char *name);

/* " (did you mean 'name'?)", or "" without a guess, into out[size]. */
const char *weft__guess_text(const weft__guess *guess, char *out, size_t size);
