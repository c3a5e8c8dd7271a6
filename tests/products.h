/* SPDX-License-Identifier: BSD-3-Clause */
/* products.h -- products with the derivatives of the right-hand side of a cloth,
 * against its differences and against one another. */
#pragma once

#include "support.h"

#include <math.h>
#include <stdlib.h>

#include "random.h"

/* J v is the difference of the fourth order in steps of `step` v to 1e-8 of its largest
 * number, and w.(J v) is v.(J^T w) to 1e-13 of its parts, for random v and w. */
static inline void expect_products(const weft_cloth *cloth, double t, const double *y,
                                   double step, uint64_t seed)
{
    static const double weights[4] = { 8.0, -8.0, -1.0, 1.0 };
    const size_t dim = weft_cloth_dim(cloth);
    double *v = calloc(6 * dim, sizeof *v), *w = v + dim, *at = v + 2 * dim;
    double *forth = v + 3 * dim, *back = v + 4 * dim, *slope = v + 5 * dim;
    double most = 0.0, error = 0.0, difference = 0.0, size = 0.0;
    for (size_t i = 0; i < 2 * dim; ++i) {
        v[i] = 2.0 * random_uniform(&seed) - 1.0;
    }
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, t, y, v, forth), 0);
    ck_assert_int_eq(weft_cloth_jacobian_product_transposed(cloth, t, y, w, back), 0);
    for (size_t i = 0; i < dim; ++i) {
        difference += w[i] * forth[i] - v[i] * back[i];
        size += fabs(w[i] * forth[i]);
    }
    ck_assert_msg(fabs(difference) <= 1e-13 * size, "transposed: %g of %g", difference,
                  size);
    for (size_t k = 0; k < 4; ++k) {
        const double way = (k % 2 == 0 ? 1.0 : -1.0) * (double)(1 + k / 2) * step;
        for (size_t i = 0; i < dim; ++i) {
            at[i] = y[i] + way * v[i];
        }
        ck_assert_int_eq(weft_cloth_rhs(cloth, t, at, back), 0);
        for (size_t i = 0; i < dim; ++i) {
            slope[i] += weights[k] * back[i] / (12.0 * step);
        }
    }
    for (size_t i = 0; i < dim; ++i) {
        const bool pinned
            = weft_cloth_pinned(cloth, weft_cloth_vertex(cloth, i % (dim / 6)));
        most = fmax(most, fabs(slope[i]));
        error = fmax(error, fabs(forth[i] - (pinned ? 0.0 : slope[i])));
    }
    ck_assert_msg(most > 0.0 && error <= 1e-8 * most, "product: %g of %g", error, most);
    free(v);
}
