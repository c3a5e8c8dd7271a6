/* SPDX-License-Identifier: BSD-3-Clause */
/* self_sum.c -- adds the forces of pairs that push to those of their particles: in a
 * file of its own, so that bench/self can count its cycles. */
#include "forces/contact/self/self_law.h"

/* One function for each kind, so that the loop over its particles is unrolled. */
static inline void add_kind(weft__pair_kind kind, const weft__self_sums *of,
                            const weft__pushes *pushes, size_t count)
{
    const size_t n = of->stride, all = of->end - of->first;
    const double *inverse_mass = of->own->mesh->inverse_mass + of->first;
    for (size_t i = 0; i < count; ++i) {
        const weft__pushes *from = &pushes[i / WEFT__BLOCK];
        const size_t lane = i % WEFT__BLOCK;
        for (size_t k = 0; k < weft__kind_particles(kind); ++k) {
            const size_t at = (size_t)from->particle[k][lane] - of->first;
            if (at >= all) { /* a body's, or of another band */
                continue;
            }
            const double scale = of->unit == WEFT__FORCE ? 1.0 : inverse_mass[at];
            if (scale > 0.0) {
                of->to[at] += scale * from->force[k][0][lane];
                of->to[n + at] += scale * from->force[k][1][lane];
                of->to[2 * n + at] += scale * from->force[k][2][lane];
            }
        }
    }
}

void weft__self_sum(void *ctx, weft__pair_kind kind, const weft__pushes *pushes,
                    size_t count)
{
    const weft__self_sums *of = ctx;
    BY_KIND(kind, add_kind, of, pushes, count);
}
