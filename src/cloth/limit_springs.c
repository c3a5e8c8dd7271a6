/* SPDX-License-Identifier: BSD-3-Clause */
/* limit_springs.c -- springs that may not be longer than (1 + strain) rest lengths.
 *
 * Provot 1995: a spring that is too long is shortened along itself. With shares
 * w_p / (w_p + w_q) of inverse masses w the centre of mass stays where it is, and the
 * correction is the smallest in the norm sum m dx^2: the projection onto the convex set
 * of all states in which this spring is short enough. */
#include "cloth/limit_springs.h"

#include <float.h>
#include <math.h>

#include "cloth/model.h"

/* Shares of the correction that p and q take. */
static void shares(const weft_cloth *cloth, size_t p, size_t q, double share[2])
{
    const double m_p = cloth->mass[p], m_q = cloth->mass[q];
    const bool held_p = cloth->pin[p] != 0, held_q = cloth->pin[q] != 0;
    share[0] = held_p ? 0.0 : held_q ? 1.0 : m_q / (m_p + m_q);
    share[1] = held_q ? 0.0 : held_p ? 1.0 : m_p / (m_p + m_q);
}

static void shorten(const weft_cloth *cloth, size_t p, size_t q, double allowed,
                    double *x)
{
    const size_t n = cloth->particles;
    const double d[3]
        = { x[q] - x[p], x[n + q] - x[n + p], x[2 * n + q] - x[2 * n + p] };
    const double length2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (!(length2 > allowed * allowed && length2 <= DBL_MAX)) {
        return;
    }
    double share[2];
    const double length = sqrt(length2);
    const double excess = (length - allowed) / length;
    shares(cloth, p, q, share);
    for (size_t k = 0; k < 3; ++k) {
        x[k * n + p] += share[0] * excess * d[k];
        x[k * n + q] -= share[1] * excess * d[k];
    }
}

/* The limited groups of a family, which follow one another. */
static size_t groups_of(const weft__limited *limited, size_t family,
                        const weft__group *groups[2])
{
    const weft_cloth *cloth = limited->cloth;
    size_t count = 0;
    for (size_t g = 0; limited->families[family] && g < cloth->group_count; ++g) {
        if (cloth->groups[g].family == family) {
            groups[count++] = &cloth->groups[g];
        }
    }
    return count;
}

static void sweep_family(const weft__limited *limited, const weft__group *groups[2],
                         size_t count, double *x)
{
    const weft_cloth *cloth = limited->cloth;
    for (size_t r = 0; r < cloth->rows; ++r) {
        for (size_t c = 0; c < cloth->cols; ++c) {
            for (size_t g = 0; g < count; ++g) {
                const weft__group *group = groups[g];
                const size_t from = c + group->first_col;
                if (r < group->end_row && from < group->end_col) {
                    const size_t p = r * cloth->cols + from;
                    shorten(cloth, p, p + (size_t)group->stride,
                            limited->stretch * group->rest_length, x);
                }
            }
        }
    }
}

void weft__limited_sweep(const weft__limited *limited, double *x)
{
    for (size_t family = 0; family < WEFT_FAMILIES; ++family) {
        const weft__group *groups[2];
        const size_t count = groups_of(limited, family, groups);
        if (count > 0) {
            sweep_family(limited, groups, count, x);
        }
    }
}

/* Counts springs of a group that exceed the tolerance, up to `most`: those with both
 * ends pinned, or the others. */
static size_t too_long(const weft__limited *limited, const weft__group *group,
                       bool held, size_t most, const double *x)
{
    const weft_cloth *cloth = limited->cloth;
    const size_t n = cloth->particles;
    const double allowed
        = limited->stretch * (1.0 + limited->tolerance) * group->rest_length;
    size_t count = 0;
    for (size_t r = 0; r < group->end_row; ++r) {
        const size_t first = r * cloth->cols;
        for (size_t p = first + group->first_col; p < first + group->end_col; ++p) {
            const size_t q = p + (size_t)group->stride;
            const double dx = x[q] - x[p], dy = x[n + q] - x[n + p];
            const double dz = x[2 * n + q] - x[2 * n + p];
            if (!(dx * dx + dy * dy + dz * dz <= allowed * allowed)
                && held == (cloth->pin[p] != 0 && cloth->pin[q] != 0)
                && ++count == most) {
                return count;
            }
        }
    }
    return count;
}

bool weft__limited_met(const weft__limited *limited, const double *x)
{
    const weft_cloth *cloth = limited->cloth;
    for (size_t g = 0; g < cloth->group_count; ++g) {
        const weft__group *group = &cloth->groups[g];
        if (limited->families[group->family]
            && too_long(limited, group, false, 1, x) > 0) {
            return false;
        }
    }
    return true;
}

size_t weft__limited_held(const weft__limited *limited, const double *x)
{
    const weft_cloth *cloth = limited->cloth;
    size_t count = 0;
    for (size_t g = 0; g < cloth->group_count; ++g) {
        const weft__group *group = &cloth->groups[g];
        if (limited->families[group->family]) {
            count += too_long(limited, group, true, SIZE_MAX, x);
        }
    }
    return count;
}
