/* SPDX-License-Identifier: BSD-3-Clause */
/* springs.h -- the law of a spring and the iteration over springs, for one grid.
 *
 * A spring from p to q, of rest length s [m], stiffness k [N/m] and damping
 * c [kg/s], pulls p by T u and q by -T u, where
 *
 *     T = k (L - s) + c w.u,   d = x_q - x_p,  L = |d|,  u = d / L,  w = v_q - v_p
 *
 * and has no force where L = 0; k = K / s under the strain law (docs/theory/model.md).
 *
 * Springs are implicit: a family has two groups, one for each direction, and the
 * springs of a group differ only in their first particle. Nothing is stored per spring.
 * The fast forms evaluate the same expressions on vectors. */
#pragma once

#include <float.h>
#include <math.h>

#include "forces/body/body.h"

/* All springs that join particle (r, c) to (r + down, c + right): r below end_row,
 * c from first_col to below end_col. */
typedef struct weft__group {
    weft_family family;
    unsigned orientation; /* which of the directions of springs.c */
    size_t end_row, first_col, end_col;
    ptrdiff_t stride;   /* index of the far end minus that of the near one */
    double rest_length; /* [m] */
    double stiffness;   /* [N/m]; under the strain law k / s */
    double damping;     /* [kg/s] */
    bool half_rim;      /* those along the rim carry half of both */
} weft__group;

#define WEFT_GROUPS (2 * WEFT_FAMILIES)

typedef struct weft__springs weft__springs;

/* springs_products.h: products with directions of the state, and transposed ones; the
 * one of a start along at->along. */
struct weft__tangents;
struct weft__parameter_gradient;
typedef int weft__products_fn(const weft__springs *own, const weft__body *body,
                              const struct weft__tangents *tangents, size_t first,
                              size_t end);
typedef int weft__turned_fn(const weft__springs *own, const weft__body *body,
                            const weft__state *at, const double *w, double *out,
                            double *net, struct weft__parameter_gradient *by);

int weft__springs_along(const weft__springs *own, const weft__body *body,
                        const weft__state *at, double *to, size_t first, size_t end);

struct weft__springs {
    const weft__mesh *mesh;
    size_t group_count; /* groups that have springs */
    weft__group groups[WEFT_GROUPS];
    weft__start_fn *fast;
    weft__products_fn *products;
    weft__turned_fn *transposed;
};

WEFT__NUMBERS(weft__spring_numbers, stiffness, damping);
extern const weft__number weft__spring_law;
extern const weft__force weft__springs_force;
WEFT_FORMS(weft__start_fn, rows);
WEFT_FORMS(weft__products_fn, products);
WEFT_FORMS(weft__turned_fn, transposed);

/* A group in one of WEFT_GROUPS orientations, but for its law; false: the grid is too
 * small. */
bool weft__group_init(const weft__mesh *mesh, size_t orientation, weft__group *group);

/* From a definition. */
void weft__groups_init(weft__springs *own, const weft_cloth_def *def);

/* How many of a family begin in the own rows of a band. */
size_t weft__springs_count(const weft__springs *own, weft_family family);

/* Those of a group that begin in block b, as one run; returns 1, or 0: there are none.
 * runs NULL: only counts. */
size_t weft__group_run(const weft__mesh *mesh, const weft__group *group, size_t b,
                       weft_spring_run *runs);

/* springs_def.c, as in weft__force. */
void weft__springs_check(const weft_cloth_def *def, const weft__faults *to);
bool weft__springs_init(void *own, const weft_cloth_def *def,
                        const weft_allocator *memory);
uint64_t weft__springs_hash(const void *own, uint64_t hash);

/* springs_matrix.c, as in weft__force. */
void weft__springs_ratios(const void *own, struct weft__sides *to);
void weft__springs_bound(const void *own, const weft__state *at, size_t i,
                         const struct weft__sides *sides, double (*sums)[6]);
size_t weft__springs_runs(const void *own, size_t b, weft_spring_run *to);
double *weft__springs_couplings(const void *own, const weft__state *at, size_t b,
                                double *to, size_t all, double *bad);

/* [W] of the dampers of the springs that begin in row r, of which those along a rim may
 * count half. */
double weft__springs_heat(const weft__springs *own, const double *y, size_t r);

/* A spring in a state. */
typedef struct weft__spring {
    const weft__group *group;
    size_t p, q;
    double share;        /* of the group's stiffness and damping: 0.5 or 1 */
    double d[3], square; /* [m], [m^2] d.d */
} weft__spring;

/* a_q - a_p of planes a[3 N]. */
static inline void weft__spring_difference(const weft__mesh *mesh,
                                           const weft__spring *spring, const double *a,
                                           double difference[3])
{
    const size_t n = mesh->stride, p = spring->p, q = spring->q;
    difference[0] = a[q] - a[p];
    difference[1] = a[n + q] - a[n + p];
    difference[2] = a[2 * n + q] - a[2 * n + p];
}

/* 0.5 of a spring that begins at p and lies along a rim that carries half, else 1. */
static inline double weft__spring_share(const weft__mesh *mesh,
                                        const weft__group *group, size_t p)
{
    if (!group->half_rim) {
        return 1.0;
    }
    const bool in_row = group->end_row == mesh->rows;
    const size_t line = in_row ? p / mesh->cols : p % mesh->cols;
    const size_t last = (in_row ? mesh->rows : mesh->cols) - 1;
    return line == 0 || line == last ? 0.5 : 1.0;
}

/* The spring of a group that begins at p, with positions x[3 N]; NULL: all 0. */
static inline weft__spring weft__spring_from(const weft__mesh *mesh,
                                             const weft__group *group, size_t p,
                                             const double *x)
{
    weft__spring spring = { .group = group,
                            .p = p,
                            .q = p + (size_t)group->stride,
                            .share = weft__spring_share(mesh, group, p) };
    if (x != NULL) {
        weft__spring_difference(mesh, &spring, x, spring.d);
        spring.square = weft__dot(spring.d, spring.d);
    }
    return spring;
}

/* [N/m], [kg/s] of this spring. */
static inline double weft__spring_stiffness(const weft__spring *spring)
{
    return spring->share * spring->group->stiffness;
}

static inline double weft__spring_damping(const weft__spring *spring)
{
    return spring->share * spring->group->damping;
}

/* [m^2/s] w.d, with velocities v[3 N]. */
static inline double weft__spring_rate(const weft__mesh *mesh,
                                       const weft__spring *spring, const double *v)
{
    double w[3];
    weft__spring_difference(mesh, spring, v, w);
    return weft__dot(w, spring->d);
}

/* [N/m] T / L, exactly 0 at rest and where L = 0. */
static inline double weft__spring_tension(const weft__spring *spring, double rate)
{
    const weft__group *group = spring->group;
    const double length = sqrt(spring->square);
    double work
        = weft__spring_stiffness(spring) * length * (length - group->rest_length);
    if (group->damping != 0.0) {
        work += weft__spring_damping(spring) * rate;
    }
    return work * (1.0 / (spring->square + DBL_MIN));
}

/* 0 where a particle's six numbers from z on are finite, else NaN. */
static inline double weft__trouble(const double *z, size_t n)
{
    return ((z[3 * n] + z[4 * n] + z[5 * n]) + (z[0] + z[n] + z[2 * n])) * 0.0;
}

/* The pulls on a particle, of springs that begin and that end there, by their
 * orientation. The order, that of springs_fast.c, is part of the result. */
static inline double weft__springs_sum(const double from[WEFT_GROUPS],
                                       const double to[WEFT_GROUPS])
{
    enum { RIGHT, DOWN, CROSS, ANTI, RIGHT2, DOWN2 }; /* as in directions */
    const double begun
        = from[RIGHT] + from[DOWN] + from[CROSS] + from[RIGHT2] + from[DOWN2];
    const double above = to[DOWN2] + (to[DOWN] + to[ANTI]) + to[CROSS];
    return begun - (above + (to[RIGHT] - from[ANTI]) + to[RIGHT2]);
}

/* (L - s) / s */
static inline double weft__spring_strain(const weft__spring *spring)
{
    const double rest_length = spring->group->rest_length;
    return (sqrt(spring->square) - rest_length) / rest_length;
}

/* The springs that begin in a row, group by group:
 *
 *     for (weft__walk walk = weft__row_springs(own, x, r); weft__each_spring(&walk);)
 *
 * visits each as walk.spring. */
typedef struct weft__walk {
    weft__spring spring;
    const weft__springs *own;
    const double *x;
    size_t row, groups; /* groups begun */
    size_t next, end;   /* p of the present group */
} weft__walk;

static inline weft__walk weft__row_springs(const weft__springs *own, const double *x,
                                           size_t row)
{
    return (weft__walk){ .own = own, .x = x, .row = row };
}

static inline bool weft__each_spring(weft__walk *walk)
{
    const weft__springs *own = walk->own;
    for (; walk->next == walk->end; ++walk->groups) {
        if (walk->groups == own->group_count) {
            return false;
        }
        walk->spring.group = &own->groups[walk->groups];
        if (walk->row < walk->spring.group->end_row) {
            walk->next = walk->row * own->mesh->cols + walk->spring.group->first_col;
            walk->end = walk->row * own->mesh->cols + walk->spring.group->end_col;
        }
    }
    walk->spring
        = weft__spring_from(own->mesh, walk->spring.group, walk->next++, walk->x);
    return true;
}

/* Whether a spring of a group begins at particle i. */
static inline bool weft__starts_at(const weft__springs *own, const weft__group *group,
                                   size_t i)
{
    const size_t r = i / own->mesh->cols, c = i % own->mesh->cols;
    return r < group->end_row && c >= group->first_col && c < group->end_col;
}

/* Those that begin or end at particle i; returns how many. */
enum { WEFT__SPRINGS_MAX = 2 * WEFT_GROUPS };
static inline size_t weft__particle_springs(const weft__springs *own, size_t i,
                                            const double *x,
                                            weft__spring springs[WEFT__SPRINGS_MAX])
{
    size_t count = 0;
    for (size_t g = 0; g < own->group_count; ++g) {
        const weft__group *group = &own->groups[g];
        const size_t stride = (size_t)group->stride;
        if (weft__starts_at(own, group, i)) {
            springs[count++] = weft__spring_from(own->mesh, group, i, x);
        }
        if (i >= stride && weft__starts_at(own, group, i - stride)) {
            springs[count++] = weft__spring_from(own->mesh, group, i - stride, x);
        }
    }
    return count;
}
