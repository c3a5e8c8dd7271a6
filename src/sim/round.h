/* SPDX-License-Identifier: BSD-3-Clause */
/* round.h -- an evaluation of a grid block after block of rows, each with what a method
 * does before and after it (weft_round), so that what it reads is still in the caches.
 *
 * A row needs the two on either side of it. So evaluations follow what comes before
 * them by two rows, and what comes after follows them by two. Each thread takes spans
 * of rows; the rows at their seams are taken when all spans are done. */
#pragma once

#include "sim/forces.h"

/* Whether rounds are possible: on a whole grid whose forces act within two rows. */
bool weft__round_can(const weft__forces *forces);

/* Whether they are worthwhile: only where the state exceeds the caches. */
bool weft__round_pays(const weft__forces *forces);

/* As weft_pass.round; does not ask `stop`. */
int weft__round_run(const weft__forces *forces, weft_round *round);
