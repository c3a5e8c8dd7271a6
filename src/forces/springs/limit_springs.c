/* SPDX-License-Identifier: BSD-3-Clause */
/* limit_springs.c -- springs that may not be longer than (1 + strain) rest lengths.
 *
 * Provot 1995: a spring that is too long is shortened along itself. With shares
 * w_p / (w_p + w_q) of inverse masses w the centre of mass stays where it is, and the
 * correction is the smallest in the norm sum m dx^2: the projection onto the convex set
 * of all states in which this spring is short enough. */

#include "forces/springs/limit_springs.h"

/* Shares of the correction that p and q take. */
static void shares(const weft__springs *own, size_t p, size_t q, double share[2])
{
    const double m_p = own->mesh->mass[p], m_q = own->mesh->mass[q];
    const bool held_p = own->mesh->pin[p] != 0, held_q = own->mesh->pin[q] != 0;
    share[0] = held_p ? 0.0 : held_q ? 1.0 : m_q / (m_p + m_q);
    share[1] = held_q ? 0.0 : held_p ? 1.0 : m_p / (m_p + m_q);
}

static void limit_springs_shorten(const weft__springs *own, const weft__spring *at,
                                  double allowed, double *x)
{
    if (!(at->square > allowed * allowed && at->square <= DBL_MAX)) {
        return;
    }
    double share[2];
    const double length = sqrt(at->square);
    const double excess = (length - allowed) / length;
    shares(own, at->p, at->q, share);
    for (size_t k = 0; k < 3; ++k, x += own->mesh->particles) {
        x[at->p] += share[0] * excess * at->d[k];
        x[at->q] -= share[1] * excess * at->d[k];
    }
}

/* The groups [first, end), which are those of a family. */
static void sweep_groups(const weft__springs *own, double stretch,
                         const weft__group *first, const weft__group *end, double *x)
{
    for (size_t r = 0; r < own->mesh->rows; ++r) {
        for (size_t c = 0; c < own->mesh->cols; ++c) {
            for (const weft__group *group = first; group < end; ++group) {
                const size_t from = c + group->first_col;
                if (r < group->end_row && from < group->end_col) {
                    const weft__spring at = weft__spring_from(
                        own->mesh, group, r * own->mesh->cols + from, x);
                    limit_springs_shorten(own, &at, stretch * group->rest_length, x);
                }
            }
        }
    }
}

/* The groups of a family follow one another. */
void weft__limited_sweep(const weft__springs *own, const weft_limit_def *limit,
                         double *x)
{
    const weft__group *all = own->groups;
    for (size_t first = 0, end = 0; first < own->group_count; first = end) {
        const weft_family family = all[first].family;
        while (end < own->group_count && all[end].family == family) {
            ++end;
        }
        if (limit->families[family]) {
            sweep_groups(own, 1.0 + limit->strain, all + first, all + end, x);
        }
    }
}

size_t weft__limited_excess(const weft__springs *own, const weft_limit_def *limit,
                            bool held, size_t most, const double *x)
{
    size_t count = 0;
    for (size_t r = 0; count < most && r < own->mesh->rows; ++r) {
        for (weft__walk walk = weft__row_springs(own, x, r);
             weft__each_spring(&walk);) {
            const weft__spring *at = &walk.spring;
            const double allowed = (1.0 + limit->strain) * (1.0 + limit->tolerance)
                                   * at->group->rest_length;
            count
                += limit->families[at->group->family]
                   && !(at->square <= allowed * allowed)
                   && held
                          == (own->mesh->pin[at->p] != 0 && own->mesh->pin[at->q] != 0);
        }
    }
    return count;
}

weft_spring weft__limited_worst(const weft__springs *own, const weft_limit_def *limit,
                                const double *x)
{
    weft_spring worst = { .p = 0 };
    for (size_t r = 0; r < own->mesh->rows; ++r) {
        for (weft__walk walk = weft__row_springs(own, x, r);
             weft__each_spring(&walk);) {
            const weft__spring *at = &walk.spring;
            const weft_spring spring
                = { at->group->family, at->p, at->q, weft__spring_strain(at) };
            if (limit->families[spring.family]) {
                weft__keep_worst(&worst, &spring);
            }
        }
    }
    return worst;
}
