/* SPDX-License-Identifier: BSD-3-Clause */
/* springs_sweep.h -- the sweep over the rows of a grid that the fast forms of springs
 * share: LANES columns at a time, each spring once. Each form has its own `visit`,
 * which finds the springs of a block of columns and writes what it makes of them.
 *
 * A block of columns takes the springs that start there, one of each group:
 *
 *     (r,c)---right---(r,c+1)            right2: (r,c)-(r,c+2)
 *       |  \        /                    down2:  (r,c)-(r+2,c)
 *     down   cross / anti
 *       |      \ /
 *     (r+1,c)  (r+1,c+1)
 *
 * Only anti, from (r,c+1) to (r+1,c), does not start at (r,c), so that all springs that
 * end in another column end to the right: in lanes of this block, or of the next one,
 * which they reach in registers. Pulls on a later row are summed in a buffer of that
 * row.
 *
 * A rim may carry half: then rows and columns on it have laws of their own.
 *
 * The sum of a particle is the same expression whatever the width, the tile of columns
 * or the span of rows. Springs pass three stages, each group one stage behind the
 * one before, because root and division are slow: meanwhile the next spring begins.
 *
 * A file that includes this defines before:
 *
 *     TILE     the columns that are swept together: with the rows that a block reads,
 *              they stay in the first cache
 *     STREAMS  the sums of pulls at most: of the state, and of directions */
#pragma once

#include "forces/lanes.h"
#include "forces/springs/springs_products.h"

#include <float.h>
#include <string.h>

/* The groups, in the order of springs.c, and whether any is damped: bits of a set. */
enum { RIGHT, DOWN, CROSS, ANTI, RIGHT2, DOWN2, DAMPED };
#define BIT(group) (1u << (group))

enum { SPAN = LANES + TILE + 2 * LANES, EDGE = LANES + 2 };

typedef struct law {
    vec stiffness, rest_length, damping;
    vec share; /* of the group's */
} law;

/* Pulls that end in a row. */
typedef struct landing {
    double ended[3 * SPAN];  /* [N] from rows above */
    double ended2[3 * SPAN]; /* [N] of down2 in the row above */
} landing;

/* Which lanes of a block at the end of a row are columns, and have a column 1 and 2
 * to their right. */
typedef struct edge {
    mask inside, right, right2;
} edge;

/* Of a block in its row; the last two are those of `edges`. */
enum { FIRST, INNER, END, PLACES = END + 2 };

typedef struct sweep {
    landing of[STREAMS];
    law laws[WEFT_GROUPS];
    /* `laws`, or with a rim that carries half those of a row inside or on the rim */
    const law *by[2][PLACES];
    law half[2][PLACES][WEFT_GROUPS];
    edge edges[2];
    vec3 gravity;
    vec drag;
    vec bad; /* 0 or NaN */
    const double *y, *inverse_mass;
    double *dydt;   /* NULL: not wanted */
    size_t n, down; /* from plane to plane, from row to row */
    size_t particles, rows, cols;
    size_t inner;     /* columns in blocks with all their neighbours on the right */
    size_t streams;   /* of `of` that are in use */
    double *aside;    /* [6 SPAN] NULL, or where x' and v' of a row are put first */
    const void *form; /* for visit */
} sweep;

/* Where the particles of a block are, of planes n and rows `down` apart. */
typedef struct place {
    const double *p;
    size_t n, down;
} place;

/* LANES columns of a row, from column c of row r on. */
typedef struct columns {
    place from;
    size_t r, c;
    size_t i;     /* its first particle */
    size_t at;    /* in a landing */
    size_t count; /* columns */
    unsigned has; /* the set of its springs */
    bool emits;   /* false: only its pulls on others are wanted */
    const law *laws;
    const edge *rim; /* NULL: all neighbours are there */
    double *out;     /* x' and v' from the tile's first column on, planes m apart */
    size_t m;
} columns;

/* A spring between its stages. */
typedef struct spring {
    vec3 d;             /* [m] */
    vec length;         /* [m] */
    vec inverse;        /* [1/m^2] of the square of the length */
    vec wd;             /* [m^2/s] w.d */
    vec pull_by_length; /* [N/m] T / L */
    vec3 w;             /* [m/s] */
    /* For derivatives; where nobody reads them, the compiler leaves them out. */
    vec3 z;   /* as in weft__spring_change */
    vec part; /* [N/m] of z */
    vec rate; /* c / L^2 */
} spring;

/* The pulls of a block on the next one to the right. */
typedef struct carry {
    vec3 beside, beside2, below;
} carry;

/* What a form does with a block; left[k] are the pulls of stream k on it, and then
 * those on the next block. */
typedef void visit_fn(sweep *self, const columns *of, carry *left);

/* From p to q, of planes n apart. */
INLINE void begin(spring *springs, unsigned has, int group, const double *p,
                  const double *q, size_t n)
{
    spring *at = &springs[group];
    *at = (spring){ 0 };
    if ((has & BIT(group)) == 0) {
        return;
    }
    at->d = minus(load3(q, n), load3(p, n));
    const vec dd = dot(at->d, at->d);
    at->length = root(dd);
    at->inverse = 1.0 / (dd + DBL_MIN);
    if ((has & BIT(DAMPED)) != 0) {
        const double *vp = p + 3 * n, *vq = q + 3 * n;
        at->w = minus(load3(vq, n), load3(vp, n));
        at->wd = dot(at->w, at->d);
    }
}

/* T / L = (k L (L - s) + c w.d) / L^2, exactly 0 at rest and where L = 0. */
INLINE void find_tension(spring *springs, unsigned has, int group, const law *laws)
{
    spring *at = &springs[group];
    const law *by = &laws[group];
    if ((has & BIT(group)) == 0) {
        return;
    }
    vec work = (by->stiffness * at->length) * (at->length - by->rest_length);
    if ((has & BIT(DAMPED)) != 0) {
        work += by->damping * at->wd;
    }
    at->pull_by_length = work * at->inverse;
    const vec turn = at->wd * at->inverse;
    at->part = by->stiffness - (at->pull_by_length + by->damping * turn);
    at->z = scaled(at->inverse,
                   plus(scaled(at->part, at->d), scaled(by->damping, at->w)));
    at->rate = by->damping * at->inverse;
}

/* On p. */
INLINE vec3 pull(const spring *springs, unsigned has, int group, const mask *where)
{
    const spring *at = &springs[group];
    if ((has & BIT(group)) == 0) {
        return (vec3){ 0 };
    }
    const vec3 force = scaled(at->pull_by_length, at->d);
    return where != NULL ? only3(force, *where) : force;
}

/* The springs of a block. */
INLINE void find_springs(spring *s, const columns *of)
{
    const unsigned has = of->has;
    const law *laws = of->laws;
    const size_t n = of->from.n;
    const double *p = of->from.p, *below = p + of->from.down;
    begin(s, has, RIGHT, p, p + 1, n);
    begin(s, has, DOWN, p, below, n);
    find_tension(s, has, RIGHT, laws);
    begin(s, has, ANTI, p + 1, below, n);
    find_tension(s, has, DOWN, laws);
    begin(s, has, CROSS, p, below + 1, n);
    find_tension(s, has, ANTI, laws);
    begin(s, has, RIGHT2, p, p + 2, n);
    find_tension(s, has, CROSS, laws);
    begin(s, has, DOWN2, p, below + of->from.down, n);
    find_tension(s, has, RIGHT2, laws);
    find_tension(s, has, DOWN2, laws);
}

/* What the springs of a block give it in stream k; the rest goes to their other ends.
 */
INLINE vec3 land(sweep *self, size_t k, size_t at, vec3 right, vec3 fall, vec3 anti,
                 vec3 cross, vec3 right2, vec3 fall2, carry *left)
{
    landing *to = &self->of[k];
    const vec3 beside = minus(right, anti);
    vec3 ended = load3(to->ended + at, SPAN), next = load3(to->ended2 + at, SPAN);
    next = plus(plus(next, plus(fall, anti)), shift_1(left[k].below, cross));
    ended = plus(plus(ended, shift_1(left[k].beside, beside)),
                 shift_2(left[k].beside2, right2));
    left[k] = (carry){ beside, right2, cross };
    store3(to->ended + at, SPAN, next);
    store3(to->ended2 + at, SPAN, fall2);
    return minus(plus(plus(plus(plus(right, fall), cross), right2), fall2), ended);
}

/* The pulls of springs s on their block; those on others land in stream 0. */
INLINE vec3 land_springs(sweep *self, const spring *s, const columns *of, carry *left)
{
    const unsigned has = of->has;
    const mask *in_1 = of->rim != NULL ? &of->rim->right : NULL;
    const mask *in_2 = of->rim != NULL ? &of->rim->right2 : NULL;
    return land(self, 0, of->at, pull(s, has, RIGHT, in_1), pull(s, has, DOWN, NULL),
                pull(s, has, ANTI, in_1), pull(s, has, CROSS, in_1),
                pull(s, has, RIGHT2, in_2), pull(s, has, DOWN2, NULL), left);
}

INLINE void store_rates(sweep *self, vec3 v, vec3 a, const edge *rim, size_t count,
                        double *to, size_t m)
{
    const vec bad = trouble(a, v);
    self->bad += rim != NULL ? only(bad, rim->inside) : bad;
    store3_some(to, m, v, count);
    store3_some(to + 3 * m, m, a, count);
}

/* The force of springs on a block, and that of drag. */
INLINE vec3 dragged(const sweep *self, const columns *of, vec3 force)
{
    return minus(force,
                 scaled(self->drag, load3(of->from.p + 3 * of->from.n, of->from.n)));
}

/* x' and v' of a block under a net force. */
INLINE void emit(sweep *self, const columns *of, vec3 net)
{
    const double *of_mass = self->inverse_mass + of->i;
    const vec3 v = load3(of->from.p + 3 * of->from.n, of->from.n);
    const vec3 a = plus(self->gravity, scaled(load(of_mass), net));
    store_rates(self, v, a, of->rim, of->count, of->out + (of->at - LANES), of->m);
}

static void leave_aside(const sweep *self, size_t i, size_t count)
{
    for (size_t k = 0; k < 6; ++k) {
        memcpy(self->dydt + k * self->n + i, self->aside + k * SPAN,
               count * sizeof *self->dydt);
    }
}

/* The columns from c on of rows r, r + 1 and r + 2, where a block would read beyond the
 * end of y. */
static void copy_end(const sweep *self, const double *y, size_t r, size_t c,
                     double copy[6][3][EDGE])
{
    memset(copy, 0, 6 * sizeof *copy);
    for (size_t k = 0; k < 6; ++k) {
        const double *plane = y + k * self->n;
        for (size_t j = 0; j < 3 && r + j < self->rows; ++j) {
            const double *from = plane + (r + j) * self->down;
            for (size_t l = 0; l < EDGE && c + l < self->cols; ++l) {
                copy[k][j][l] = from[c + l];
            }
        }
    }
}

/* The block of row r at column c of a state y. */
INLINE place place_at(const sweep *self, const double *y, size_t r, size_t c,
                      double copy[6][3][EDGE])
{
    const size_t i = r * self->cols + c;
    if (i + 2 * self->cols + EDGE <= self->particles) {
        return (place){ y + r * self->down + c, self->n, self->down };
    }
    copy_end(self, y, r, c, copy);
    return (place){ copy[0][0], 3 * EDGE, EDGE };
}

/* The place of a block in another vector of as many planes. */
INLINE place place_in(const sweep *self, const columns *of, const double *y,
                      double copy[6][3][EDGE])
{
    return of->rim != NULL ? place_at(self, y, of->r, of->c, copy)
                           : (place){ y + (of->from.p - self->y), self->n, self->down };
}

/* 1: yes, 0: no */
INLINE size_t on_rim(const sweep *self, size_t r)
{
    return r == 0 || r + 1 == self->rows;
}

/* The last columns of a row. Lanes without a particle read others and are masked. */
INLINE void row_end(sweep *self, columns of, carry *left, visit_fn *visit)
{
    double copy[6][3][EDGE];
    const law *const *by = self->by[on_rim(self, of.r)];
    of.c = self->inner;
    for (size_t e = 0; of.c < self->cols; of.c += LANES, of.at += LANES, ++e) {
        of.from = place_at(self, self->y, of.r, of.c, copy);
        of.i = of.r * self->cols + of.c;
        of.count = self->cols - of.c < LANES ? self->cols - of.c : LANES;
        of.laws = by[END + e];
        of.rim = &self->edges[e];
        visit(self, &of, left);
    }
}

/* Columns [first, end) of row r; of the block on their left only its carry. */
INLINE void row(sweep *self, size_t r, size_t first, size_t end, unsigned has,
                bool emits, visit_fn *visit)
{
    const size_t n = self->n, down = self->down, m = self->aside != NULL ? SPAN : n;
    const size_t i = r * down + first, b = r * self->cols + first;
    double *const out = self->aside != NULL  ? self->aside
                        : self->dydt != NULL ? self->dydt + i
                                             : NULL;
    const double *p = self->y + i;
    const ptrdiff_t count = (ptrdiff_t)(end - first);
    const law *const *by = self->by[on_rim(self, r)];
    const law *laws = by[first == 0 ? FIRST : INNER];
    carry left[STREAMS];
    left[0] = (carry){ 0 };
    for (size_t k = 1; k < STREAMS && k < self->streams; ++k) {
        left[k] = (carry){ 0 };
    }
    for (ptrdiff_t j = first > 0 ? -LANES : 0; j < count; j += LANES) {
        const columns of = { .from = { p + j, n, down },
                             .r = r,
                             .c = first + (size_t)j,
                             .i = b + (size_t)j,
                             .at = (size_t)(LANES + j),
                             .count = LANES,
                             .has = has,
                             .emits = emits && j >= 0,
                             .laws = laws,
                             .out = out,
                             .m = m };
        visit(self, &of, left);
        laws = by[INNER];
    }
    if (end == self->inner) {
        row_end(self,
                (columns){ .r = r,
                           .at = LANES + (size_t)count,
                           .has = has,
                           .emits = emits,
                           .out = out,
                           .m = m },
                left, visit);
    }
    if (emits && self->aside != NULL) {
        leave_aside(self, i, (end == self->inner ? self->cols : end) - first);
    }
}

enum {
    STRETCH = BIT(RIGHT) | BIT(DOWN),
    WOVEN = STRETCH | BIT(CROSS) | BIT(ANTI),
    FULL = WOVEN | BIT(RIGHT2) | BIT(DOWN2)
};

/* The springs of row r among `all` of the cloth. */
static unsigned of_row(const sweep *self, size_t r, unsigned all)
{
    if (r + 1 >= self->rows) {
        all &= ~(BIT(DOWN) | BIT(CROSS) | BIT(ANTI));
    }
    return r + 2 >= self->rows ? all & ~BIT(DOWN2) : all;
}

/* The sets that most rows of most cloths have are compiled without branches. */
INLINE void any_row(sweep *self, size_t r, size_t first, size_t end, unsigned has,
                    bool emits, visit_fn *visit)
{
    switch (emits ? has : 0u) {
#define CASE(springs)                                                                  \
    case springs:                                                                      \
        row(self, r, first, end, springs, true, visit);                                \
        break;
        CASE(STRETCH)
        CASE(WOVEN)
        CASE(FULL)
        CASE(STRETCH | BIT(DAMPED))
        CASE(WOVEN | BIT(DAMPED))
        CASE(FULL | BIT(DAMPED))
#undef CASE
    default:
        row(self, r, first, end, has, emits, visit);
    }
}

/* any_row with the visit of a form. */
typedef void row_fn(sweep *self, size_t r, size_t first, size_t end, unsigned has,
                    bool emits);

/* Columns [first, end). The two rows above first_row add their pulls on the others;
 * `pulls` has them, unless it is NULL. */
static void tile(sweep *self, size_t first, size_t end, unsigned all, size_t first_row,
                 size_t end_row, const double *pulls, row_fn *sweep_row)
{
    const size_t above = pulls != NULL ? 0 : first_row < 2 ? first_row : 2;
    if (pulls != NULL) {
        memcpy(self->of, pulls, sizeof(landing));
    } else {
        memset(self->of, 0, self->streams * sizeof *self->of);
    }
    for (size_t r = first_row - above; r < end_row; ++r) {
        unsigned has = of_row(self, r, all);
        if (r < first_row) {
            has &= r + 1 < first_row ? BIT(DOWN2) | BIT(DAMPED)
                                     : ~(BIT(RIGHT) | BIT(RIGHT2));
        }
        sweep_row(self, r, first, end, has, r >= first_row);
    }
}

/* The laws of a group in lanes from column c on: half along the rim. */
static law halved(law of, bool row_rim, const weft__group *group, size_t c, size_t cols)
{
    const bool in_row = group->orientation == RIGHT || group->orientation == RIGHT2;
    for (size_t l = 0; l < LANES && group->half_rim; ++l) {
        if (in_row ? row_rim : c + l == 0 || c + l + 1 == cols) {
            of.stiffness[l] *= 0.5;
            of.damping[l] *= 0.5;
            of.share[l] *= 0.5;
        }
    }
    return of;
}

/* The laws of all rows and blocks, if a rim carries half. */
static void start_half(sweep *self, const weft__springs *own)
{
    const size_t from[PLACES]
        = { 0, LANES, self->inner, self->inner + LANES }; /* any inside for INNER */
    for (size_t i = 0; i < 2 * PLACES * own->group_count; ++i) {
        const size_t at = i / 2 % PLACES;
        const weft__group *group = &own->groups[i / (2 * PLACES)];
        self->half[i % 2][at][group->orientation]
            = halved(self->laws[group->orientation], i % 2 == 1, group, from[at],
                     at == INNER ? SIZE_MAX : own->mesh->cols);
        self->by[i % 2][at] = self->half[i % 2][at];
    }
}

/* Returns the set of its springs. */
static unsigned start(sweep *self, const weft__springs *own, const weft__body *body,
                      const double *y, size_t stride, size_t down, size_t streams)
{
    const weft__mesh *mesh = own->mesh;
    const double *g = body->gravity;
    unsigned all = 0;
    self->y = y;
    self->inverse_mass = mesh->inverse_mass;
    self->n = stride, self->down = down, self->particles = mesh->particles;
    self->rows = mesh->rows, self->cols = mesh->cols;
    self->inner = inner_columns(mesh->cols);
    self->streams = streams;
    self->gravity = (vec3){ splat(g[0]), splat(g[1]), splat(g[2]) };
    self->drag = splat(body->drag);
    self->bad = splat(0.0);
    self->aside = NULL;
    for (size_t e = 0; e < 2; ++e) {
        const size_t c = self->inner + e * LANES;
        self->edges[e]
            = (edge){ have_column(c, 0, mesh->cols), have_column(c, 1, mesh->cols),
                      have_column(c, 2, mesh->cols) };
    }
    bool half = false;
    for (size_t i = 0; i < own->group_count; ++i) {
        const weft__group *group = &own->groups[i];
        self->laws[group->orientation]
            = (law){ .stiffness = splat(group->stiffness),
                     .rest_length = splat(group->rest_length),
                     .damping = splat(group->damping),
                     .share = splat(1.0) };
        all |= BIT(group->orientation) | (group->damping != 0.0 ? BIT(DAMPED) : 0u);
        half = half || group->half_rim;
    }
    for (size_t i = 0; i < 2 * PLACES; ++i) {
        self->by[i / PLACES][i % PLACES] = self->laws;
    }
    if (half) {
        start_half(self, own);
    }
    return all;
}

/* Rows [first, end) with the springs of the set `all`; carried: as of weft__start_fn.
 */
static int sweep_tiles(sweep *self, unsigned all, size_t first, size_t end,
                       const weft__carry *carried, row_fn *sweep_row)
{
    double *rows = carried != NULL ? carried->rows : NULL;
    const bool continues = carried != NULL && carried->continues;
    for (size_t c = 0; c == 0 || c < self->inner; c += TILE) {
        const size_t stop = self->inner - c < TILE ? self->inner : c + TILE;
        tile(self, c, stop, all, first, end, continues ? rows : NULL, sweep_row);
        if (rows != NULL) {
            memcpy(rows, self->of, sizeof(landing));
            rows += sizeof(landing) / sizeof *rows;
        }
    }
    return sum(self->bad) == 0.0 ? 0 : 1;
}
