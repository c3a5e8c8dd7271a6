/* SPDX-License-Identifier: BSD-3-Clause */
/* spaces.h -- the workspaces of forces between any two particles. */
#pragma once

#include "sim/forces.h"

/* Makes those of the forces of a cloth, which may be the whole of a band, unless they
 * are there; `part` as of weft__force_space. False: no memory. */
bool weft__spaces_make(weft__forces *forces, const weft_cloth *cloth,
                       const size_t part[2]);

/* Whether there are any. */
bool weft__spaces_any(const weft__forces *forces);

/* Between steps: makes room for what was too much for them. */
weft_status weft__spaces_grow(const weft__forces *forces, weft_error *err);
void weft__spaces_destroy(const weft__forces *forces);
