/* SPDX-License-Identifier: BSD-3-Clause */
/* linearise.c -- the derivatives of the forces of springs; docs/physics.md has the
 * derivation. */
#include "cloth/linearise.h"

#include <string.h>

#include "cloth/bending.h"
#include "cloth/contact.h"
#include "cloth/self.h"
#include "cloth/springs.h"

/* Writes u, k - q, q = T / L and c, `bonds` apart. Returns q. */
static double spring_planes(const weft_cloth *cloth, const weft__spring *at,
                            const double *v, double *planes, size_t bonds)
{
    const double k = weft__spring_stiffness(at), length = sqrt(at->square);
    const double q = weft__spring_tension(at, weft__spring_rate(cloth, at, v));
    const double inverse = length > 0.0 ? 1.0 / length : 0.0;
    for (size_t j = 0; j < 3; ++j) {
        planes[j * bonds] = at->d[j] * inverse;
    }
    planes[3 * bonds] = length > 0.0 ? k - q : 0.0;
    planes[4 * bonds] = q;
    planes[5 * bonds] = length > 0.0 ? weft__spring_damping(at) : 0.0;
    return q;
}

/* Those of bending in row r; returns where the next ones go. */
static double *bending_planes(const weft_cloth *cloth, size_t r, double *planes,
                              size_t bonds)
{
    for (size_t way = 0; way < WEFT_GROUPS; ++way) {
        size_t p, q;
        const size_t count = weft__bending_pairs(cloth, way, r, &p, &q);
        for (size_t i = 0; i < count; ++i, ++planes) {
            for (size_t k = 0; k < 6; ++k) {
                planes[k * bonds] = 0.0;
            }
            planes[4 * bonds] = weft__bending_pull(cloth, way, p + i);
        }
    }
    return planes;
}

int weft__linearise(const weft_cloth *cloth, double t, const double *y, double *planes,
                    size_t bonds, double *blocks)
{
    const size_t n = cloth->particles;
    double bad = 0.0;
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (weft__walk walk = weft__row_springs(cloth, y, r); weft__each_spring(&walk);
             ++planes) {
            bad += 0.0 * spring_planes(cloth, &walk.spring, y + 3 * n, planes, bonds);
        }
    }
    for (size_t r = 0; r < cloth->rows; ++r) {
        planes = bending_planes(cloth, r, planes, bonds);
    }
    if (blocks != NULL) {
        memset(blocks, 0, 15 * n * sizeof *blocks);
        bad += weft__contact_blocks(cloth, t, y, blocks)
               + weft__self_blocks(cloth, y, blocks);
    }
    return bad == 0.0 ? 0 : 1;
}
