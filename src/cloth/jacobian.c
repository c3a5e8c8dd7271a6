/* SPDX-License-Identifier: BSD-3-Clause */
/* jacobian.c -- the derivative of the equations of motion (rhs.c) along a direction dy
 * of the state: J dy, J = [0 I; -M^-1 K -M^-1 C]. */
#include "cloth/levels.h"
#include "cloth/springs.h"

int weft__reference_products(const weft__subject *of, double *out, size_t first_row,
                             size_t end_row)
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles, end = end_row * cloth->cols;
    double bad = 0.0;
    for (size_t i = first_row * cloth->cols; i < end; ++i) {
        double springs[3];
        weft__springs_force(cloth, i, of->y, of->along, springs);
        for (size_t k = 0; k < 3; ++k) {
            const double v = out[k * n + i] = of->along[(k + 3) * n + i];
            const double force = springs[k] - cloth->drag * v;
            const double a = out[(k + 3) * n + i]
                = 0.0 + cloth->inverse_mass[i] * force;
            bad += (a + v) * 0.0;
        }
    }
    return bad == 0.0 ? 0 : 1;
}

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
