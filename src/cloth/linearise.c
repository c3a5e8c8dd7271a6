/* SPDX-License-Identifier: BSD-3-Clause */
/* linearise.c -- the derivatives of the forces of springs; docs/physics.md has the
 * derivation. */
#include "cloth/linearise.h"

#include <string.h>

#include "cloth/contact.h"
#include "cloth/springs.h"

/* u, k - q, q = T / L, c. */
static void spring_slopes(const weft_cloth *cloth, const weft__spring *at,
                          const double *v, double slopes[6])
{
    const double k = at->group->stiffness, length = sqrt(at->square);
    const double q = weft__spring_tension(at, weft__spring_rate(cloth, at, v));
    for (size_t j = 0; j < 3; ++j) {
        slopes[j] = length > 0.0 ? at->d[j] / length : 0.0;
    }
    slopes[3] = length > 0.0 ? k - q : 0.0;
    slopes[4] = q;
    slopes[5] = length > 0.0 ? at->group->damping : 0.0;
}

int weft__linearise(const weft_cloth *cloth, double t, const double *y, double *planes,
                    size_t bonds, double *blocks)
{
    const size_t n = cloth->particles;
    double bad = 0.0;
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (weft__walk walk = weft__row_springs(cloth, y, r); weft__each_spring(&walk);
             ++planes) {
            double slopes[6];
            spring_slopes(cloth, &walk.spring, y + 3 * n, slopes);
            for (size_t j = 0; j < 6; ++j) {
                planes[j * bonds] = slopes[j];
                bad += slopes[j] * 0.0;
            }
        }
    }
    if (blocks != NULL) {
        memset(blocks, 0, 15 * n * sizeof *blocks);
        bad += weft__contact_blocks(cloth, t, y, blocks);
    }
    return bad == 0.0 ? 0 : 1;
}
