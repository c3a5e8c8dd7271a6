/* SPDX-License-Identifier: BSD-3-Clause */
/* structured.h -- the Jacobian that a weft_structure describes. */
#ifndef WEFT_CONFORMANCE_STRUCTURED_H
#define WEFT_CONFORMANCE_STRUCTURED_H

#include "weft/stepper.h"

/* out[6 N] = J dy, from the structure and y alone. `room` holds the planes and blocks
 * of linearise and the numbers of linearise_links, WEFT_BOND_PLANES bond_count
 * + WEFT_BLOCK_PLANES N + WEFT_LINK_NUMBERS link_count. Returns as linearise. */
int weft__structure_product(const weft_structure *of, double t, const double *y,
                            const double *dy, double *room, double *out);

#endif
