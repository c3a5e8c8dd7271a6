/* SPDX-License-Identifier: BSD-3-Clause */
/* repin.h -- a cloth whose pins may change, for one simulation. */
#ifndef WEFT_CLOTH_REPIN_H
#define WEFT_CLOTH_REPIN_H

#include "weft/cloth.h"

/* A cloth with pins of its own; all else it shares with *from, which outlives it. NULL:
 * no memory. */
weft_cloth *weft__cloth_borrow(const weft_cloth *from, const weft_allocator *memory);
void weft__cloth_return(weft_cloth *borrowed); /* NULL is allowed */

/* Of a borrowed cloth. Pinned at x(t) = now + velocity t; false: no memory, and nothing
 * is changed. */
bool weft__cloth_pin(weft_cloth *borrowed, size_t i, const double velocity[3]);
void weft__cloth_unpin(weft_cloth *borrowed, size_t i); /* one that is pinned */

/* [m/s] of a pin that `from` does not have; NULL: i is as it is there, or free. */
const double *weft__cloth_own_pin(const weft_cloth *borrowed, size_t i);
/* Trade pins with one that was borrowed from the same cloth. */
void weft__cloth_trade(weft_cloth *one, weft_cloth *other);

#endif
