/* SPDX-License-Identifier: BSD-3-Clause */
/* multigrid.c -- the levels and the cycle.
 *
 * Smoother: Chebyshev's polynomials in D^-1 S, D the blocks of the diagonal. Its
 * eigenvalues are at most 2, as (a - b) A (a - b) <= 2 a A a + 2 b A b for each spring,
 * so that none need be estimated; without the negative pairs of bending S would be
 * larger, so that D goes without them, and coarse levels do. The coarse correction is
 * multiplied by 1.5: aggregates make the coarse operator too stiff (D. Braess,
 * Computing 55, 1995). */
#include "multigrid.h"

#include "aggregate.h"

enum {
    LEVELS = 16, /* at most */
    SMALL = 30,  /* particles that are no reason for a coarser level */
    DEGREE = 2,  /* of the smoother */
    LAST_DEGREE = 12,
};

#define HIGH       2.0 /* eigenvalues that are smoothed, */
#define LOW        0.4 /* from here; */
#define LAST_LOW   (1.0 / 30.0)
#define CORRECTION 1.5

typedef struct level {
    weft__network *net; /* own, but on the finest level */
    weft__network own;
    uint32_t *to, *target; /* to the next level: of particles, of springs */
    double *x, *b;         /* of coarse levels */
    double *r, *z, *step;
} level;

struct weft__multigrid {
    size_t count;
    level levels[LEVELS];
};

/* ---- creation -------------------------------------------------------------------- */

static void graph_of(const weft__network *net, weft__graph *out, weft__pile *scratch)
{
    *out = (weft__graph){ .n = (uint32_t)net->n, .m = (uint32_t)net->pair_count };
    weft__graph_take(out, scratch);
    for (size_t r = 0, e = 0; !scratch->failed && r < net->run_count; ++r) {
        for (size_t i = 0; i < net->runs[r].count; ++i, ++e) {
            out->a[e] = (uint32_t)(net->runs[r].p + i);
            out->b[e] = (uint32_t)(net->runs[r].q + i);
            out->weight[e] = 1;
        }
    }
}

/* Edges that follow one another along the particles are a run; runs NULL: only counts.
 */
static size_t find_runs(const weft__graph *g, weft_spring_run *runs)
{
    size_t count = 0;
    for (uint32_t e = 0; e < g->m; ++e) {
        const bool follows
            = e > 0 && g->a[e] == g->a[e - 1] + 1 && g->b[e] == g->b[e - 1] + 1;
        count += follows ? 0 : 1;
        if (runs != NULL) {
            weft_spring_run *run = &runs[count - 1];
            *run = follows ? (weft_spring_run){ run->p, run->q, run->count + 1 }
                           : (weft_spring_run){ g->a[e], g->b[e], 1 };
        }
    }
    return count;
}

static void take_vectors(level *self, bool coarse, weft__pile *pile)
{
    double **vectors[] = { &self->r, &self->z, &self->step, &self->x, &self->b };
    for (size_t i = 0; i < (coarse ? 5 : 3); ++i) {
        *vectors[i] = weft__pile_take(pile, self->net->n, 3 * sizeof(double));
    }
}

/* The level below, of graph g. */
static void begin_level(level *self, const weft__graph *g, weft__pile *pile)
{
    weft_spring_run *runs = weft__pile_take(pile, find_runs(g, NULL), sizeof *runs);
    self->net = &self->own;
    self->own = (weft__network){ .n = g->n, .pair_count = g->m, .runs = runs };
    if (runs != NULL) {
        self->own.run_count = find_runs(g, runs);
    }
    weft__network_take(self->net, pile);
    take_vectors(self, true, pile);
}

/* Adds a level; false if there is nothing to gain. */
static bool coarsen(weft__multigrid *self, weft__graph *g, weft__pile *pile,
                    weft__pile *scratch)
{
    level *fine = &self->levels[self->count - 1];
    weft__graph coarse = { 0 };
    if (self->count == LEVELS || g->n <= SMALL || pile->failed) {
        return false;
    }
    fine->to = weft__pile_take(pile, g->n, sizeof *fine->to);
    fine->target = weft__pile_take(pile, g->m, sizeof *fine->target);
    if (pile->failed || !weft__aggregate(g, fine->to, fine->target, &coarse, scratch)
        || coarse.n > g->n - g->n / 5) {
        return false;
    }
    begin_level(&self->levels[self->count++], &coarse, pile);
    *g = coarse;
    return true;
}

weft__multigrid *weft__multigrid_create(weft__network *finest, weft__pile *pile)
{
    weft__pile scratch = { .memory = pile->memory };
    weft__graph g;
    weft__multigrid *self = weft__pile_take(pile, 1, sizeof *self);
    if (self == NULL) {
        return NULL;
    }
    *self = (weft__multigrid){ .count = 1 };
    self->levels[0].net = finest;
    take_vectors(&self->levels[0], false, pile);
    graph_of(finest, &g, &scratch);
    while (!scratch.failed && coarsen(self, &g, pile, &scratch)) {
    }
    const bool failed = scratch.failed || pile->failed;
    weft__pile_free(&scratch);
    return failed ? NULL : self;
}

/* ---- coarse matrices ------------------------------------------------------------- */

static void add_block(double *to, size_t to_stride, size_t j, const double *from,
                      size_t stride, size_t i)
{
    for (size_t plane = 0; plane < 6; ++plane) {
        to[plane * to_stride + j] += from[plane * stride + i];
    }
}

/* A spring to a held particle becomes part of the other's block. Negative ones are left
 * out: a coarse level is too stiff rather than indefinite. */
static void add_springs(const level *self, const double *mass, weft__network *coarse)
{
    const weft__network *fine = self->net;
    for (size_t r = 0, e = 0; r < fine->run_count; ++r) {
        const weft_spring_run *run = &fine->runs[r];
        for (size_t i = 0; i < run->count; ++i, ++e) {
            const size_t p = run->p + i, q = run->q + i;
            const bool free_p = mass == NULL || mass[p] > 0.0;
            const bool free_q = mass == NULL || mass[q] > 0.0;
            if (fine->spring_entries[e] < 0.0) { /* xx */
                continue;
            }
            if (free_p != free_q) {
                add_block(coarse->point, coarse->n, self->to[free_p ? p : q],
                          fine->spring_entries, fine->pair_count, e);
            } else if (free_p && self->target[e] != WEFT__WITHIN) {
                add_block(coarse->spring_entries, coarse->pair_count, self->target[e],
                          fine->spring_entries, fine->pair_count, e);
            }
        }
    }
}

static void galerkin(const level *self, const double *mass, weft__network *coarse)
{
    const weft__network *fine = self->net;
    memset(coarse->point, 0, 6 * coarse->n * sizeof *coarse->point);
    memset(coarse->spring_entries, 0,
           6 * coarse->pair_count * sizeof *coarse->spring_entries);
    for (size_t i = 0; i < fine->n; ++i) {
        if (mass == NULL || mass[i] > 0.0) {
            add_block(coarse->point, coarse->n, self->to[i], fine->point, fine->n, i);
        }
    }
    add_springs(self, mass, coarse);
}

void weft__multigrid_prepare(weft__multigrid *self, const double *mass)
{
    for (size_t k = 0; k + 1 < self->count; ++k) {
        weft__network *coarse = self->levels[k + 1].net;
        galerkin(&self->levels[k], k == 0 ? mass : NULL, coarse);
        (void)weft__network_invert(coarse, NULL);
    }
}

/* ---- the cycle ------------------------------------------------------------------- */

static void residual(level *self, const double *b, const double *x)
{
    weft__network_times(self->net, x, self->r);
    weft__vector_mix(3 * self->net->n, 1.0, b, -1.0, self->r);
}

/* Chebyshev's iteration for S x = b (Saad, Iterative methods for sparse linear systems,
 * 2nd ed., algorithm 12.1). */
static void smooth(level *self, const double *b, double *x, bool from_zero, bool last)
{
    const size_t size = 3 * self->net->n;
    const double low = last ? LAST_LOW : LOW;
    const double middle = 0.5 * (HIGH + low), radius = 0.5 * (HIGH - low);
    double rho = radius / middle;
    if (from_zero) {
        weft__network_precondition(self->net, b, self->z);
    } else {
        residual(self, b, x);
        weft__network_precondition(self->net, self->r, self->z);
    }
    weft__vector_scale(size, 1.0 / middle, self->z, self->step);
    if (from_zero) {
        memcpy(x, self->step, size * sizeof *x);
    } else {
        weft__vector_mix(size, 1.0, self->step, 1.0, x);
    }
    for (int k = 1; k < (last ? LAST_DEGREE : DEGREE); ++k) {
        const double next = 1.0 / (2.0 * middle / radius - rho);
        residual(self, b, x);
        weft__network_precondition(self->net, self->r, self->z);
        weft__vector_mix(size, 2.0 * next / radius, self->z, next * rho, self->step);
        weft__vector_mix(size, 1.0, self->step, 1.0, x);
        rho = next;
    }
}

/* b of the next level: sums over its aggregates. */
static void restrict_residual(const level *self, level *next)
{
    const size_t n = self->net->n, m = next->net->n;
    memset(next->b, 0, 3 * m * sizeof *next->b);
    for (size_t plane = 0; plane < 3; ++plane) {
        double *b = next->b + plane * m;
        const double *r = self->r + plane * n;
        for (size_t i = 0; i < n; ++i) {
            b[self->to[i]] += r[i];
        }
    }
}

static void correct(const level *self, const level *next, double *x)
{
    const size_t n = self->net->n, m = next->net->n;
    for (size_t plane = 0; plane < 3; ++plane) {
        const double *from = next->x + plane * m;
        double *to = x + plane * n;
        for (size_t i = 0; i < n; ++i) {
            to[i] += CORRECTION * from[self->to[i]];
        }
    }
    for (size_t k = 0; k < self->net->held_count; ++k) {
        const size_t i = self->net->held[k];
        x[i] = x[n + i] = x[2 * n + i] = 0.0;
    }
}

void weft__multigrid_apply(weft__multigrid *self, const double *r, double *z)
{
    const size_t last = self->count - 1;
    for (size_t k = 0; k < last; ++k) {
        level *at = &self->levels[k];
        const double *b = k == 0 ? r : at->b;
        double *x = k == 0 ? z : at->x;
        smooth(at, b, x, true, false);
        residual(at, b, x);
        restrict_residual(at, &self->levels[k + 1]);
    }
    level *end = &self->levels[last];
    smooth(end, last == 0 ? r : end->b, last == 0 ? z : end->x, true, true);
    for (size_t k = last; k-- > 0;) {
        level *at = &self->levels[k];
        const double *b = k == 0 ? r : at->b;
        double *x = k == 0 ? z : at->x;
        correct(at, &self->levels[k + 1], x);
        smooth(at, b, x, false, false);
    }
}
