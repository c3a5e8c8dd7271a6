/* SPDX-License-Identifier: BSD-3-Clause */
/* smoothed.c -- the levels and the cycle.
 *
 * Of particle i at x_i: B_i = [I, -(x_i - c)^x], its six rigid motions about the mean c
 * of all. The B_i of an aggregate are orthonormalised, B = Q R; R is what the next
 * level has for B. Prolongations are smoothed once,
 *
 *     P = Q - w D^-1 A' Q,   w = 2.5 / (the bound of D^-1 A),
 *
 * with A' the part of A along strong edges on the finest level, A on others; the next
 * matrix is P^T A P. w would be 4 / 3 / lambda_max; the bound is about twice that.
 *
 * Smoother: Chebyshev's polynomial in D^-1 A, D the blocks of the diagonal, up to a
 * bound that holds whatever the matrix: max_i (k d)_i / d_i, k_ij >= |D_i^-1/2 A_ij
 * D_j^-1/2|, for any d > 0 (L. Collatz, Math. Z. 48, 1942). */
#include "smoothed.h"

#include "dense.h"
#include "rows.h"

enum {
    LEVELS = 12, /* at most */
    SMALL = 40,  /* nodes that are solved directly */
    SIX = 6,     /* unknowns of a node but on the finest stage */
    DEGREE = 2,
    SHARPEN = 3, /* iterations of a bound */
};

#define LOW   0.1  /* of the bound: eigenvalues that are smoothed, from here */
#define OMEGA 2.5  /* by the bound */
#define DROP  1e-8 /* of a column's length: a motion that an aggregate has not */

typedef struct stage {
    size_t n, size;      /* nodes, unknowns of a node */
    weft__rows a, p, ap; /* to the next level: P, A P; ap.block has one row */
    uint32_t *slot;      /* of each (P_i's, (A P)_i's) block: its place in the next a */
    uint32_t *aggregate;
    double *mode;      /* n x size x SIX: B */
    double *tentative; /* Q; before that the roots of D^-1 */
    double *inverse;   /* n x size x size: D^-1 */
    double high;       /* the bound */
    double *x, *b, *r, *z, *step;
} stage;

struct weft__smoothed {
    weft__network *net;
    size_t strong, count;
    size_t *first;  /* of the edges of each particle, */
    uint32_t *edge; /* 2 times their number, odd at q, */
    uint32_t *end;  /* and where they lead */
    const double *mass;
    double *weight, *next; /* d of bounds */
    double *norm;          /* k, */
    uint32_t *column;      /* their columns, */
    size_t *row;           /* and where each row begins */
    double *factor;        /* of the last stage */
    stage levels[LEVELS];
};

/* ---- creation -------------------------------------------------------------------- */

static void list_edges(weft__smoothed *self, weft__pile *pile, weft__pile *scratch)
{
    weft__rows halves = { .n = 2 * weft__network_edges(self->net, NULL) };
    weft__rows of = { .n = self->net->n };
    halves.start = weft__pile_take(scratch, halves.n + 1, sizeof *halves.start);
    halves.column = weft__pile_take(scratch, halves.n, sizeof *halves.column);
    self->end = weft__pile_take(pile, halves.n, sizeof *self->end);
    if (pile->failed || scratch->failed) {
        return;
    }
    uint32_t(*ends)[2] = (uint32_t(*)[2])halves.column;
    (void)weft__network_edges(self->net, ends);
    for (size_t h = 0; h <= halves.n; ++h) {
        halves.start[h] = h;
    }
    weft__transpose(&halves, &of, pile);
    self->first = of.start, self->edge = of.column;
    for (size_t k = 0; !pile->failed && k < halves.n; ++k) {
        self->end[k] = ends[self->edge[k] / 2][1 - self->edge[k] % 2];
    }
}

typedef struct neighbours {
    const weft__smoothed *of;
    size_t most; /* edges below it */
} neighbours;

static void list_neighbours(const void *ctx, size_t i, weft__pattern *to)
{
    const neighbours *at = ctx;
    for (size_t k = at->of->first[i]; k < at->of->first[i + 1]; ++k) {
        if (at->of->edge[k] / 2 < at->most) {
            weft__add_column(to, at->of->end[k]);
        }
    }
}

/* Where the products of P_i and (A P)_i go in the next matrix, for all i in turn. */
static void set_slots(stage *at, weft__pile *pile)
{
    const weft__rows *next = &at[1].a;
    size_t count = 0;
    for (size_t i = 0; i < at->n; ++i) {
        count += (at->p.start[i + 1] - at->p.start[i])
                 * (at->ap.start[i + 1] - at->ap.start[i]);
    }
    uint32_t *slot = at->slot = weft__pile_take(pile, count, sizeof *at->slot);
    for (size_t i = 0; slot != NULL && i < at->n; ++i) {
        for (size_t e = at->p.start[i]; e < at->p.start[i + 1]; ++e) {
            for (size_t k = at->ap.start[i]; k < at->ap.start[i + 1]; ++k) {
                *slot++
                    = (uint32_t)weft__place_of(next, at->p.column[e], at->ap.column[k]);
            }
        }
    }
}

static void take_blocks(weft__rows *of, size_t size, weft__pile *pile)
{
    of->block = weft__pile_take(pile, pile->failed ? 0 : of->start[of->n],
                                size * sizeof(double));
}

static void take_level(stage *at, weft__pile *pile)
{
    const size_t count = at->n * at->size;
    double **vectors[] = { &at->x, &at->b, &at->r, &at->z, &at->step };
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; ++i) {
        *vectors[i] = weft__pile_take(pile, count, sizeof(double));
    }
    at->mode = weft__pile_take(pile, count, SIX * sizeof(double));
    at->tentative = weft__pile_take(pile, count, SIX * sizeof(double));
    at->inverse = weft__pile_take(pile, count, at->size * sizeof(double));
}

/* The patterns from one level to the next; graph becomes the next one's. */
static void join_levels(stage *at, weft__rows *graph, weft__pile *pile,
                        weft__pile *scratch)
{
    stage *next = at + 1;
    weft__rows alone = { .n = at->n, .column = at->aggregate };
    weft__rows members = { .n = next->n }, holders = members, near = { .n = at->n };
    alone.start = weft__pile_take(scratch, at->n + 1, sizeof *alone.start);
    for (size_t i = 0; alone.start != NULL && i <= at->n; ++i) {
        alone.start[i] = i;
    }
    weft__make_pattern(&near, next->n, weft__list_product,
                       &(weft__product){ graph, &alone, true }, scratch, scratch);
    const weft__rows *smooth = at->size == SIX ? &at->a : graph;
    weft__make_pattern(&at->p, next->n, weft__list_product,
                       &(weft__product){ smooth, &alone, true }, pile, scratch);
    weft__make_pattern(&at->ap, next->n, weft__list_product,
                       &(weft__product){ &at->a, &at->p, true }, pile, scratch);
    if (!pile->failed && !scratch->failed) {
        weft__transpose(&at->p, &holders, scratch);
        weft__transpose(&alone, &members, scratch);
    }
    weft__make_pattern(&next->a, next->n, weft__list_product,
                       &(weft__product){ &holders, &at->ap, false }, pile, scratch);
    graph->n = next->n;
    weft__make_pattern(graph, next->n, weft__list_product,
                       &(weft__product){ &members, &near, false }, scratch, scratch);
    if (!pile->failed && !scratch->failed) {
        set_slots(at, pile);
    }
}

/* Adds a level; false if there is nothing to gain. */
static bool coarsen(weft__smoothed *self, weft__rows *graph, weft__pile *pile,
                    weft__pile *scratch)
{
    stage *at = &self->levels[self->count - 1], *next = at + 1;
    at->aggregate = weft__pile_take(pile, at->n, sizeof *at->aggregate);
    uint32_t *late = weft__pile_take(scratch, at->n, sizeof *late);
    if (pile->failed || scratch->failed || self->count == LEVELS || at->n <= SMALL) {
        return false;
    }
    const size_t count = weft__gather(graph, at->aggregate, late);
    if (count > at->n - at->n / 5) {
        return false;
    }
    at->p.n = at->ap.n = at->n;
    *next = (stage){ .n = count, .size = SIX, .a = { .n = count } };
    join_levels(at, graph, pile, scratch);
    take_blocks(&at->p, at->size * SIX, pile);
    take_blocks(&next->a, SIX * SIX, pile);
    take_level(next, pile);
    ++self->count;
    return true;
}

/* The longest row of A P, and the factor of the last level. */
static void take_rest(weft__smoothed *self, weft__pile *pile)
{
    const stage *last = &self->levels[self->count - 1];
    const size_t n = self->net->n, size = last->n * last->size;
    size_t most = 1, norms_most = 2 * weft__network_edges(self->net, NULL) + n;
    for (stage *at = self->levels; at < last; ++at) {
        norms_most = at->size == SIX && at->a.start[at->n] > norms_most
                         ? at->a.start[at->n]
                         : norms_most;
        for (size_t i = 0; i < at->n; ++i) {
            const size_t length = at->ap.start[i + 1] - at->ap.start[i];
            most = length > most ? length : most;
        }
    }
    double *row = weft__pile_take(pile, most, SIX * SIX * sizeof *row);
    for (stage *at = self->levels; at < last; ++at) {
        at->ap.block = row;
    }
    self->factor = weft__pile_take(pile, size, size * sizeof *self->factor);
    self->weight = weft__pile_take(pile, n, sizeof *self->weight);
    self->next = weft__pile_take(pile, n, sizeof *self->next);
    self->norm = weft__pile_take(pile, norms_most, sizeof *self->norm);
    self->column = weft__pile_take(pile, norms_most, sizeof *self->column);
    self->row = weft__pile_take(pile, n + 1, sizeof *self->row);
}

weft__smoothed *weft__smoothed_create(weft__network *finest, size_t strong,
                                      weft__pile *pile)
{
    weft__pile scratch = { .memory = pile->memory };
    weft__smoothed *self = weft__pile_take(pile, 1, sizeof *self);
    if (self == NULL) {
        return NULL;
    }
    *self = (weft__smoothed){ .net = finest, .strong = strong, .count = 1 };
    stage *first = &self->levels[0];
    *first = (stage){ .n = finest->n, .size = 3, .a = { .n = finest->n } };
    weft__rows graph = { .n = finest->n };
    list_edges(self, pile, &scratch);
    weft__make_pattern(&graph, finest->n, list_neighbours,
                       &(neighbours){ self, strong }, &scratch, &scratch);
    weft__make_pattern(&first->a, finest->n, list_neighbours,
                       &(neighbours){ self, SIZE_MAX }, pile, &scratch);
    take_level(first, pile);
    while (coarsen(self, &graph, pile, &scratch)) {
    }
    const bool failed = scratch.failed || pile->failed;
    weft__pile_free(&scratch);
    if (!failed) {
        take_rest(self, pile);
    }
    return pile->failed || failed ? NULL : self;
}

/* ---- the matrix by its rows ------------------------------------------------------ */

/* Takes A_ij of row i. */
typedef void visit_fn(void *ctx, size_t j, const double *block);

/* Visits all of a row; of a particle's along edges below `most`. */
static void visit_row(const weft__smoothed *self, const stage *at, size_t i,
                      size_t most, visit_fn *visit, void *ctx)
{
    if (at->size == SIX) {
        for (size_t e = at->a.start[i]; e < at->a.start[i + 1]; ++e) {
            visit(ctx, at->a.column[e], at->a.block + e * SIX * SIX);
        }
        return;
    }
    double own[9] = { 0.0 };
    weft__network_point(self->net, i, own);
    for (size_t k = self->first[i]; k < self->first[i + 1]; ++k) {
        if (self->edge[k] / 2 < most) {
            double block[9] = { 0.0 };
            weft__network_block(self->net, self->edge[k], block);
            for (size_t l = 0; l < 9; ++l) {
                own[l] += block[l];
                block[l] = -block[l];
            }
            visit(ctx, self->end[k], block);
        }
    }
    visit(ctx, i, own);
}

static bool held(const weft__smoothed *self, const stage *at, size_t i)
{
    return at->size < SIX && !(self->mass[i] > 0.0);
}

/* Roots R of D^-1 = R R^T, and D^-1 of coarse levels. */
static void set_inverses(const weft__smoothed *self, stage *at)
{
    const size_t size = at->size, each = size * size;
    double *roots = at->tentative;
    memset(at->inverse, 0, at->n * each * sizeof *at->inverse);
    memset(roots, 0, at->n * each * sizeof *roots);
    for (size_t i = 0; i < at->n; ++i) {
        double *root = roots + i * each, *inverse = at->inverse + i * each;
        if (size < SIX) {
            weft__network_inverse(self->net, i, inverse);
            memcpy(root, inverse, each * sizeof *root);
            if (!held(self, at, i)) {
                weft__dense_factorise(size, root);
            }
            continue;
        }
        double l[SIX * SIX];
        memcpy(l, at->a.block + weft__place_of(&at->a, i, (uint32_t)i) * each,
               sizeof l);
        weft__dense_factorise(size, l);
        for (size_t k = 0; k < size; ++k) { /* R = L^-T */
            double unit[SIX] = { 0.0 };
            unit[k] = 1.0;
            weft__dense_solve_lower(size, l, unit, root + k * size);
        }
        for (size_t k = 0; k < each; ++k) {
            for (size_t j = 0; j < size; ++j) {
                inverse[k] += root[k / size * size + j] * root[k % size * size + j];
            }
        }
    }
}

/* ---- the bound ------------------------------------------------------------------- */

/* k of all rows, one after the other. */
typedef struct norms {
    const stage *at;
    const double *own; /* R of the present row */
    double *norm;
    uint32_t *column;
    size_t count;
} norms;

/* |R_i^T A R_j| from above: the root of the largest sums of its rows and columns. */
static void add_norm(void *ctx, size_t j, const double *block)
{
    norms *of = ctx;
    const size_t n = of->at->size;
    double half[SIX * SIX] = { 0.0 }, all[SIX * SIX] = { 0.0 };
    double most[2] = { 0.0, 0.0 };
    weft__dense_add_turned(n, n, n, of->own, block, half);
    weft__dense_add(n, n, n, 1.0, half, of->at->tentative + j * n * n, all);
    for (size_t k = 0; k < n; ++k) {
        double row = 0.0, column = 0.0;
        for (size_t l = 0; l < n; ++l) {
            row += fabs(all[k * n + l]);
            column += fabs(all[l * n + k]);
        }
        most[0] = fmax(most[0], row);
        most[1] = fmax(most[1], column);
    }
    of->norm[of->count] = sqrt(most[0] * most[1]);
    of->column[of->count++] = (uint32_t)j;
}

static double bound_of(const weft__smoothed *self, const stage *at)
{
    double *weight = self->weight, *next = self->next, best = (double)INFINITY;
    norms of = { at, NULL, self->norm, self->column, 0 };
    for (size_t i = 0; i < at->n; ++i) {
        self->row[i] = of.count;
        of.own = at->tentative + i * at->size * at->size;
        visit_row(self, at, i, SIZE_MAX, add_norm, &of);
        weight[i] = 1.0;
    }
    self->row[at->n] = of.count;
    for (int k = 0; k <= SHARPEN; ++k) {
        double most = 0.0;
        for (size_t i = 0; i < at->n; ++i) {
            next[i] = 0.0;
            for (size_t e = self->row[i]; e < self->row[i + 1]; ++e) {
                next[i] += of.norm[e] * weight[of.column[e]];
            }
            most = fmax(most, next[i] / weight[i]);
        }
        best = fmin(best, most);
        for (size_t i = 0; i < at->n; ++i) {
            weight[i] = next[i] / most + 1e-3 * weight[i];
        }
    }
    return best > 0.0 ? best : 1.0; /* all are held */
}

/* ---- prolongation ---------------------------------------------------------------- */

static void set_modes(const weft__smoothed *self, const double *x)
{
    const stage *at = &self->levels[0];
    const size_t n = at->n;
    double centre[3] = { 0.0 };
    for (size_t k = 0; k < 3 * n; ++k) {
        centre[k / n] += x[k] / (double)n;
    }
    for (size_t i = 0; i < n; ++i) {
        const double d[3]
            = { x[i] - centre[0], x[n + i] - centre[1], x[2 * n + i] - centre[2] };
        const double modes[3][SIX] = { { 1.0, 0.0, 0.0, 0.0, d[2], -d[1] },
                                       { 0.0, 1.0, 0.0, -d[2], 0.0, d[0] },
                                       { 0.0, 0.0, 1.0, d[1], -d[0], 0.0 } };
        double *to = at->mode + 3 * SIX * i;
        memset(to, 0, sizeof modes);
        if (!held(self, at, i)) {
            memcpy(to, modes, sizeof modes);
        }
    }
}

/* Writes the products of columns a and b of Q, one of each aggregate, to sums. */
static void multiply_columns(const stage *at, size_t a, size_t b, double *sums)
{
    memset(sums, 0, at[1].n * sizeof *sums);
    for (size_t j = 0; j < at->n * at->size; ++j) {
        const double *row = at->tentative + j * SIX;
        sums[at->aggregate[j / at->size]] += row[a] * row[b];
    }
}

/* Takes from column c of Q what it has of the columns before, twice, and keeps it in R
 * (modified Gram-Schmidt). */
static void part_column(stage *at, size_t c, double *sums)
{
    for (size_t k = 0; k < 2 * c; ++k) {
        const size_t by = k % c;
        multiply_columns(at, by, c, sums);
        for (size_t g = 0; g < at[1].n; ++g) {
            at[1].mode[(g * SIX + by) * SIX + c] += sums[g];
        }
        for (size_t j = 0; j < at->n * at->size; ++j) {
            double *row = at->tentative + j * SIX;
            row[c] -= sums[at->aggregate[j / at->size]] * row[by];
        }
    }
}

/* Q and R of all aggregates, column by column. A column that is nothing but what the
 * others are is 0. */
static void orthonormalise(stage *at, double *sums)
{
    stage *next = at + 1;
    memcpy(at->tentative, at->mode, at->n * at->size * SIX * sizeof *at->mode);
    memset(next->mode, 0, next->n * SIX * SIX * sizeof *next->mode);
    for (size_t c = 0; c < SIX; ++c) {
        part_column(at, c, sums);
        multiply_columns(at, c, c, sums);
        for (size_t g = 0; g < next->n; ++g) {
            double *r = next->mode + g * SIX * SIX, whole = sums[g];
            for (size_t k = 0; k < c; ++k) {
                whole += r[k * SIX + c] * r[k * SIX + c];
            }
            r[c * SIX + c] = sums[g] > DROP * DROP * whole ? sqrt(sums[g]) : 0.0;
            sums[g] = r[c * SIX + c] > 0.0 ? 1.0 / r[c * SIX + c] : 0.0;
        }
        for (size_t j = 0; j < at->n * at->size; ++j) {
            at->tentative[j * SIX + c] *= sums[at->aggregate[j / at->size]];
        }
    }
}

typedef struct row_sum {
    const stage *at;
    size_t row;
    const uint32_t *place; /* of columns in a row of A P */
    double *to;
} row_sum;

/* A'_ij Q_j */
static void add_smoothed(void *ctx, size_t j, const double *block)
{
    const row_sum *of = ctx;
    const stage *at = of->at;
    const size_t e
        = weft__place_of(&at->p, of->row, at->aggregate[j]) - at->p.start[of->row];
    weft__dense_add(at->size, at->size, SIX, 1.0, block,
                    at->tentative + j * at->size * SIX, of->to + e * at->size * SIX);
}

static void prolong(weft__smoothed *self, stage *at)
{
    const size_t size = at->size, each = size * SIX;
    const size_t most = size == SIX ? SIZE_MAX : self->strong;
    for (size_t i = 0; i < at->n; ++i) {
        const size_t first = at->p.start[i], count = at->p.start[i + 1] - first;
        double *to = at->p.block + first * each, *sum = at->ap.block;
        memset(to, 0, count * each * sizeof *to);
        if (held(self, at, i)) {
            continue;
        }
        memset(sum, 0, count * each * sizeof *sum);
        visit_row(self, at, i, most, add_smoothed, &(row_sum){ at, i, NULL, sum });
        memcpy(to + (weft__place_of(&at->p, i, at->aggregate[i]) - first) * each,
               at->tentative + i * each, each * sizeof *to);
        for (size_t e = 0; e < count; ++e) {
            weft__dense_add(size, size, SIX, -OMEGA / at->high,
                            at->inverse + i * size * size, sum + e * each,
                            to + e * each);
        }
    }
}

/* A_ij P_j */
static void add_product(void *ctx, size_t j, const double *block)
{
    const row_sum *of = ctx;
    const stage *at = of->at;
    const size_t each = at->size * SIX;
    for (size_t e = at->p.start[j]; e < at->p.start[j + 1]; ++e) {
        weft__dense_add(at->size, at->size, SIX, 1.0, block, at->p.block + e * each,
                        of->to + of->place[at->p.column[e]] * each);
    }
}

/* P^T A P, row by row of A; place: of every column. */
static void galerkin(weft__smoothed *self, stage *at, uint32_t *place)
{
    const weft__rows *next = &at[1].a;
    const size_t each = at->size * SIX;
    const uint32_t *slot = at->slot;
    memset(next->block, 0, next->start[next->n] * SIX * SIX * sizeof *next->block);
    for (size_t i = 0; i < at->n; ++i) {
        const size_t first = at->ap.start[i], count = at->ap.start[i + 1] - first;
        double *sum = at->ap.block;
        for (size_t k = 0; k < count; ++k) {
            place[at->ap.column[first + k]] = (uint32_t)k;
        }
        memset(sum, 0, count * each * sizeof *sum);
        if (!held(self, at, i)) { /* else P_i is 0 */
            visit_row(self, at, i, SIZE_MAX, add_product,
                      &(row_sum){ at, i, place, sum });
        }
        for (size_t e = at->p.start[i]; e < at->p.start[i + 1]; ++e) {
            for (size_t k = 0; k < count; ++k) {
                weft__dense_add_turned(at->size, SIX, SIX, at->p.block + e * each,
                                       sum + k * each,
                                       next->block + *slot++ * SIX * SIX);
            }
        }
    }
}

/* ---- levels ---------------------------------------------------------------------- */

typedef struct dense_row {
    double *row;
    size_t size, all;
} dense_row;

static void copy_block(void *ctx, size_t j, const double *block)
{
    const dense_row *of = ctx;
    for (size_t k = 0; k < of->size * of->size; ++k) {
        of->row[k / of->size * of->all + j * of->size + k % of->size] += block[k];
    }
}

static void factorise_last(weft__smoothed *self)
{
    const stage *last = &self->levels[self->count - 1];
    const size_t size = last->size, all = last->n * size;
    memset(self->factor, 0, all * all * sizeof *self->factor);
    for (size_t i = 0; i < last->n; ++i) {
        visit_row(self, last, i, SIZE_MAX, copy_block,
                  &(dense_row){ self->factor + i * size * all, size, all });
    }
    for (size_t i = 0; i < last->n; ++i) {
        for (size_t k = 0; held(self, last, i) && k < size * all; ++k) {
            self->factor[i * size * all + k] = 0.0;
            self->factor[k / size * all + i * size + k % size] = 0.0;
        }
    }
    weft__dense_factorise(all, self->factor);
}

void weft__smoothed_prepare(weft__smoothed *self, const double *mass, const double *x)
{
    stage *last = &self->levels[self->count - 1];
    self->mass = mass;
    set_modes(self, x);
    for (stage *at = self->levels; at < last; ++at) {
        set_inverses(self, at);
        at->high = bound_of(self, at);
        orthonormalise(at, at[1].x);
        prolong(self, at);
        galerkin(self, at, (uint32_t *)(void *)at[1].z);
    }
    factorise_last(self);
}

/* ---- the cycle ------------------------------------------------------------------- */

/* y += A x by rows, of coarse levels. */
typedef struct times_row {
    const double *x;
    double *y;
} times_row;

static void add_times(void *ctx, size_t j, const double *block)
{
    const times_row *of = ctx;
    weft__dense_add(SIX, SIX, 1, 1.0, block, of->x + SIX * j, of->y);
}

/* r = b - A x */
static void residual(const weft__smoothed *self, stage *at, const double *b,
                     const double *x)
{
    if (at->size < SIX) {
        weft__network_times(self->net, x, at->r);
    } else {
        memset(at->r, 0, at->n * SIX * sizeof *at->r);
        for (size_t i = 0; i < at->n; ++i) {
            visit_row(self, at, i, SIZE_MAX, add_times,
                      &(times_row){ x, at->r + SIX * i });
        }
    }
    weft__vector_mix(at->n * at->size, 1.0, b, -1.0, at->r);
}

/* z = D^-1 r */
static void divide(const weft__smoothed *self, stage *at, const double *r)
{
    if (at->size < SIX) {
        weft__network_precondition(self->net, r, at->z);
        return;
    }
    memset(at->z, 0, at->n * SIX * sizeof *at->z);
    for (size_t i = 0; i < at->n; ++i) {
        weft__dense_add(SIX, SIX, 1, 1.0, at->inverse + i * SIX * SIX, r + SIX * i,
                        at->z + SIX * i);
    }
}

/* Chebyshev's iteration (Saad, Iterative methods for sparse linear systems, 2nd ed.,
 * algorithm 12.1). */
static void smooth(const weft__smoothed *self, stage *at, const double *b, double *x,
                   bool from_zero)
{
    const size_t size = at->n * at->size;
    const double middle = 0.5 * at->high * (1.0 + LOW);
    const double radius = 0.5 * at->high * (1.0 - LOW);
    double rho = radius / middle;
    if (from_zero) {
        memset(x, 0, size * sizeof *x);
        divide(self, at, b);
    } else {
        residual(self, at, b, x);
        divide(self, at, at->r);
    }
    weft__vector_scale(size, 1.0 / middle, at->z, at->step);
    weft__vector_mix(size, 1.0, at->step, 1.0, x);
    for (int k = 1; k < DEGREE; ++k) {
        const double next = 1.0 / (2.0 * middle / radius - rho);
        residual(self, at, b, x);
        divide(self, at, at->r);
        weft__vector_mix(size, 2.0 * next / radius, at->z, next * rho, at->step);
        weft__vector_mix(size, 1.0, at->step, 1.0, x);
        rho = next;
    }
}

/* Unknown k of node i: those of particles are in planes. */
static size_t place_in(const stage *at, size_t i, size_t k)
{
    return at->size < SIX ? k * at->n + i : i * at->size + k;
}

/* b of the next level: P^T r. */
static void restrict_residual(const stage *at)
{
    memset(at[1].b, 0, at[1].n * SIX * sizeof *at[1].b);
    for (size_t i = 0; i < at->n; ++i) {
        for (size_t e = at->p.start[i]; e < at->p.start[i + 1]; ++e) {
            double *b = at[1].b + SIX * (size_t)at->p.column[e];
            for (size_t k = 0; k < at->size; ++k) {
                const double r = at->r[place_in(at, i, k)];
                const double *p = at->p.block + (e * at->size + k) * SIX;
                for (size_t j = 0; j < SIX; ++j) {
                    b[j] += p[j] * r;
                }
            }
        }
    }
}

/* x += P times x of the next level. */
static void correct(const stage *at, double *x)
{
    for (size_t i = 0; i < at->n; ++i) {
        for (size_t e = at->p.start[i]; e < at->p.start[i + 1]; ++e) {
            const double *from = at[1].x + SIX * (size_t)at->p.column[e];
            for (size_t k = 0; k < at->size; ++k) {
                const double *p = at->p.block + (e * at->size + k) * SIX;
                double sum = 0.0;
                for (size_t j = 0; j < SIX; ++j) {
                    sum += p[j] * from[j];
                }
                x[place_in(at, i, k)] += sum;
            }
        }
    }
}

/* The last level, whose unknowns are in the order of the factor. */
static void solve(const weft__smoothed *self, const stage *at, const double *b,
                  double *x)
{
    const size_t count = at->n * at->size;
    for (size_t j = 0; j < count; ++j) {
        at->step[j] = b[place_in(at, j / at->size, j % at->size)];
    }
    weft__dense_solve(count, self->factor, at->step, at->step);
    for (size_t j = 0; j < count; ++j) {
        x[place_in(at, j / at->size, j % at->size)] = at->step[j];
    }
}

/* From the second level on twice (a W-cycle): they are small, and folds need it. */
static void cycle(const weft__smoothed *self, stage *at, const double *b, double *x)
{
    if (at == &self->levels[self->count - 1]) {
        solve(self, at, b, x);
        return;
    }
    for (int turn = 0; turn < (at->size < SIX ? 1 : 2); ++turn) {
        smooth(self, at, b, x, turn == 0);
        residual(self, at, b, x);
        restrict_residual(at);
        cycle(self, at + 1, at[1].b, at[1].x);
        correct(at, x);
    }
    smooth(self, at, b, x, false);
}

void weft__smoothed_apply(weft__smoothed *self, const double *r, double *z)
{
    cycle(self, self->levels, r, z);
}
