/* SPDX-License-Identifier: BSD-3-Clause */
/* jacobian.c -- the derivative of the equations of motion (rhs.c) along a direction dy
 * of the state: J dy, J = [0 I; -M^-1 K -M^-1 C]. */
#include "cloth/levels.h"

int weft_cloth_jacobian_product(const weft_cloth *cloth, double t, const double *y,
                                const double *dy, double *out)
{
    const weft__subject of = { .cloth = cloth, .t = t, .y = y, .along = dy };
    int failed = cloth->level->products(&of, out, 0, cloth->rows);
    for (size_t a = 0; a < WEFT__ADDED; ++a) {
        failed |= weft__added_forces[a]->change(&of, out, 0, cloth->rows);
    }
    for (size_t j = 0; j < cloth->pinned; ++j) {
        for (size_t k = 0; k < 6; ++k) {
            out[k * cloth->particles + cloth->pins[j]] = 0.0;
        }
    }
    return failed;
}
