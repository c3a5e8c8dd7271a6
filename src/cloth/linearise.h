/* SPDX-License-Identifier: BSD-3-Clause */
/* linearise.h -- the derivatives of the forces, for src/sim. */
#ifndef WEFT_CLOTH_LINEARISE_H
#define WEFT_CLOTH_LINEARISE_H

#include "weft/cloth.h"

/* Writes the springs to planes[6 bonds], bonds being all springs of the cloth, in the
 * order of weft__row_springs row by row, and then all pairs of bending, in the order of
 * weft__bending_pairs; and unless NULL the contact to blocks[15 N], both as
 * weft_structure::linearise in weft/stepper.h. Returns 0, or 1 if a number is not
 * finite or a free particle is in a shape. */
int weft__linearise(const weft_cloth *cloth, double t, const double *y, double *planes,
                    size_t bonds, double *blocks);

#endif
