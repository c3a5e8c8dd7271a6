/* SPDX-License-Identifier: BSD-3-Clause */
/* springs_matrix.c -- stiffness and damping of springs: their bounds, linearisation and
 * heat. */
#include "forces/bounds.h"
#include "forces/springs/springs.h"

/* u u^T, or I where there is no direction: no less than u u^T for any. */
static void outer(const weft__spring *at, double uu[6])
{
    static const size_t first[6] = { 0, 1, 2, 0, 0, 1 };
    static const size_t second[6] = { 0, 1, 2, 1, 2, 2 };
    const double length = sqrt(at->square);
    for (size_t k = 0; k < 6; ++k) {
        uu[k] = length == 0.0 ? (k < 3 ? 1.0 : 0.0)
                              : at->d[first[k]] / length * (at->d[second[k]] / length);
    }
}

/* Stiffness k and damping c of a group of springs are along the same directions:
 * a K + b C is at most (a k + b c)+ of them. */
typedef struct taken {
    double along[WEFT_GROUPS][6]; /* sum (1/m_i + 1/m_j) share u u^T of a group */
    double taut[6], slack[6];     /* sum (1/m_i + 1/m_j) (T/L)+- (I - u u^T) */
} taken;

static void add_spring(const weft__springs *own, const weft__spring *at, taken *sum)
{
    const double share
        = own->mesh->inverse_mass[at->p] + own->mesh->inverse_mass[at->q];
    const double pull = weft__spring_tension(at, 0.0);
    double uu[6], *along = sum->along[at->group - own->groups];
    double *across = pull > 0.0 ? sum->taut : sum->slack;
    outer(at, uu);
    for (size_t k = 0; k < 6; ++k) {
        along[k] += at->share * share * uu[k];
        across[k] += share * fabs(pull) * ((k < 3 ? 1.0 : 0.0) - uu[k]);
    }
}

void weft__springs_ratios(const void *own, weft__sides *to)
{
    const weft__springs *of = own;
    for (size_t g = 0; g < of->group_count; ++g) {
        weft__sides_add(to, of->groups[g].damping / of->groups[g].stiffness);
    }
}

static void bound_side(const weft__springs *own, const taken *of, double a, double b,
                       double sum[6])
{
    for (size_t g = 0; g < own->group_count; ++g) {
        const double stiff = a * own->groups[g].stiffness;
        const double damped = b * own->groups[g].damping;
        /* a sum that cancels is bounded by its roundoff */
        const double most = fmax(0.0, stiff + damped)
                            + (stiff * damped < 0.0 ? WEFT__ROUNDOFF * fabs(stiff) : 0);
        for (size_t k = 0; k < 6; ++k) {
            sum[k] += most * of->along[g][k];
        }
    }
    for (size_t k = 0; k < 6; ++k) {
        sum[k] += fmax(0.0, a) * of->taut[k] + fmax(0.0, -a) * of->slack[k];
    }
}

void weft__springs_bound(const void *own, const weft__state *at, size_t i,
                         const weft__sides *sides, double (*sums)[6])
{
    weft__spring springs[WEFT__SPRINGS_MAX];
    const size_t count = weft__particle_springs(own, i, at->y, springs);
    taken all = { .taut = { 0.0 } };
    for (size_t s = 0; s < count; ++s) {
        add_spring(own, &springs[s], &all);
    }
    for (size_t s = 0; s < sides->count; ++s) {
        bound_side(own, &all, sides->direction[s][0], sides->direction[s][1], sums[s]);
    }
}

/* ---- linearisation --------------------------------------------------------------- */

size_t weft__group_run(const weft__mesh *mesh, const weft__group *group, size_t b,
                       weft_spring_run *runs)
{
    const size_t p = b * mesh->cols + group->first_col;
    if (b < group->end_row && runs != NULL) {
        *runs = (weft_spring_run){ p, p + (size_t)group->stride,
                                   group->end_col - group->first_col };
    }
    return b < group->end_row;
}

size_t weft__springs_runs(const void *own, size_t b, weft_spring_run *to)
{
    const weft__springs *of = own;
    size_t count = 0;
    for (size_t g = 0; g < of->group_count; ++g) {
        count += weft__group_run(of->mesh, &of->groups[g], b, to + count);
    }
    return count;
}

/* Writes u, k - q, q = T / L and c, `spring_couplings` apart. Returns q. */
static double spring_planes(const weft__mesh *mesh, const weft__spring *at,
                            const double *v, double *planes, size_t spring_couplings)
{
    const double k = weft__spring_stiffness(at), length = sqrt(at->square);
    const double q = weft__spring_tension(at, weft__spring_rate(mesh, at, v));
    const double inverse = length > 0.0 ? 1.0 / length : 0.0;
    for (size_t j = 0; j < 3; ++j) {
        planes[j * spring_couplings] = at->d[j] * inverse;
    }
    planes[3 * spring_couplings] = length > 0.0 ? k - q : 0.0;
    planes[4 * spring_couplings] = q;
    planes[5 * spring_couplings] = length > 0.0 ? weft__spring_damping(at) : 0.0;
    return q;
}

double *weft__springs_couplings(const void *own, const weft__state *at, size_t b,
                                double *to, size_t all, double *bad)
{
    const weft__springs *of = own;
    for (weft__walk walk = weft__row_springs(of, at->y, b); weft__each_spring(&walk);
         ++to) {
        *bad += 0.0
                * spring_planes(of->mesh, &walk.spring, at->y + 3 * of->mesh->stride,
                                to, all);
    }
    return to;
}

/* ---- heat ------------------------------------------------------------------------ */

/* [m^2/s^2] (w.u)^2 = (w.d)^2 / d.d, 0 where d = 0, of a spring from p to q. */
static inline double square_rate(const double *p, const double *q, size_t n)
{
    const double *v = p + 3 * n, *u = q + 3 * n;
    const double d[3] = { q[0] - p[0], q[n] - p[n], q[2 * n] - p[2 * n] };
    const double w[3] = { u[0] - v[0], u[n] - v[n], u[2 * n] - v[2 * n] };
    const double wd = weft__dot(w, d);
    return wd * (wd / (weft__dot(d, d) + DBL_MIN));
}

/* The sum of that over `count` springs of a group from p on. The sums of every eighth
 * one, which compilers make vectors of, are part of the result. */
static double square_rates(const weft__springs *own, const weft__group *group,
                           const double *p, size_t count)
{
    enum { SUMS = 8 };
    const size_t n = own->mesh->stride;
    const double *q = p + group->stride;
    double sums[SUMS] = { 0.0 }, total = 0.0;
    size_t c = 0;
    for (; c + SUMS <= count; c += SUMS) {
        for (size_t k = 0; k < SUMS; ++k) {
            sums[k] += square_rate(p + c + k, q + c + k, n);
        }
    }
    for (; c < count; ++c) {
        sums[c % SUMS] += square_rate(p + c, q + c, n);
    }
    for (size_t k = 0; k < SUMS; ++k) {
        total += sums[k];
    }
    return total;
}

double weft__springs_heat(const weft__springs *own, const double *y, size_t r)
{
    double power = 0.0;
    for (size_t g = 0; g < own->group_count; ++g) {
        const weft__group *group = &own->groups[g];
        const size_t first = r * own->mesh->cols + group->first_col;
        const size_t count = group->end_col - group->first_col;
        const double *p = y + first, *last = p + count - 1;
        if (r >= group->end_row || group->damping == 0.0) {
            continue;
        }
        if (group->half_rim && group->end_row < own->mesh->rows) {
            const double rim
                = square_rates(own, group, p, 1) + square_rates(own, group, last, 1);
            power += group->damping
                     * (square_rates(own, group, p + 1, count - 2) + 0.5 * rim);
        } else {
            power += group->damping
                     * (weft__spring_share(own->mesh, group, first)
                        * square_rates(own, group, p, count));
        }
    }
    return power;
}
