/* SPDX-License-Identifier: BSD-3-Clause */
/* springs_fast.c -- springs, gravity and drag in one sweep over the rows, LANES columns
 * at a time, each spring once.
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
 * or the band of rows. Springs pass three stages, each group one stage behind the
 * one before, because root and division are slow: meanwhile the next spring begins. */
#include "forces/lanes.h"
#include "forces/springs/springs.h"

#include <float.h>
#include <string.h>

/* 1: and the derivatives of all that in several directions; compiled by
 * products_fast.c.
 */
#ifndef PRODUCT
#define PRODUCT 0
#endif

/* The groups, in the order of springs.c, and whether any is damped: bits of a set. */
enum { RIGHT, DOWN, CROSS, ANTI, RIGHT2, DOWN2, DAMPED };
#define BIT(group) (1u << (group))

/* TILE columns, with the rows that a block reads, stay in the first cache. */
enum {
    TILE = PRODUCT ? WEFT__TILE : WEFT__TRAIL_TILE,
    SPAN = LANES + TILE + 2 * LANES,
    EDGE = LANES + 2,
    STREAMS = PRODUCT ? 1 + WEFT__WAYS : 1 /* the state, then its directions */
};

typedef struct law {
    vec stiffness, rest_length, damping;
#if PRODUCT
    vec share; /* of the group's */
#endif
} law;

/* Pulls that end in a row. */
typedef struct landing {
    double ended[3 * SPAN];  /* [N] from rows above */
    double ended2[3 * SPAN]; /* [N] of down2 in the row above */
} landing;

_Static_assert(PRODUCT || sizeof(landing) <= 6 * (TILE + 3 * WEFT__TRAIL_LANES) * 8,
               "a trail has room for it");

/* Which lanes of a block at the end of a row are columns, and have a column 1 and 2
 * to their right. */
typedef struct edge {
    mask inside, right, right2;
} edge;

/* Of a block in its row; the last two are those of `edges`. */
enum { FIRST, INNER, END, PLACES = END + 2 };

typedef struct sweep {
    landing of[STREAMS];
    double aside[PRODUCT ? 1 : 6 * SPAN]; /* x' and v' of the row, not yet in dydt */
    law laws[WEFT_GROUPS];
    /* `laws`, or with a rim that carries half those of a row inside or on the rim */
    const law *by[2][PLACES];
    law half[2][PLACES][WEFT_GROUPS];
    edge edges[2];
    vec3 gravity;
    vec drag;
    vec bad; /* 0 or NaN */
    const double *y, *inverse_mass;
    double *dydt; /* NULL: not wanted */
    const weft__ways *ways;
    size_t n, down; /* from plane to plane, from row to row */
    size_t particles, rows, cols;
    bool detour;  /* by aside */
    bool wanted;  /* the state's own forces */
    size_t inner; /* columns in blocks with all their neighbours on the right */
} sweep;

/* A spring between its stages. */
typedef struct spring {
    vec3 d;             /* [m] */
    vec length;         /* [m] */
    vec inverse;        /* [1/m^2] of the square of the length */
    vec wd;             /* [m^2/s] w.d */
    vec pull_by_length; /* [N/m] T / L */
    vec3 w;             /* [m/s] */
#if PRODUCT
    vec3 z;   /* as in weft__spring_change */
    vec part; /* [N/m] of z */
    vec rate; /* c / L^2 */
#endif
} spring;

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
#if PRODUCT
    const vec turn = at->wd * at->inverse;
    at->part = by->stiffness - (at->pull_by_length + by->damping * turn);
    at->z = scaled(at->inverse,
                   plus(scaled(at->part, at->d), scaled(by->damping, at->w)));
    at->rate = by->damping * at->inverse;
#endif
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

/* The pulls of a block on the next one to the right. */
typedef struct carry {
    vec3 beside, beside2, below;
} carry;

#if PRODUCT
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

/* As below; 0 if nobody wants it. */
INLINE vec3 block(sweep *self, spring *s, const law *laws, const double *p, size_t n,
                  size_t down, size_t at, unsigned has, carry *left, const edge *rim)
{
    const double *below = p + down;
    const mask *in_1 = rim != NULL ? &rim->right : NULL;
    const mask *in_2 = rim != NULL ? &rim->right2 : NULL;
    begin(s, has, RIGHT, p, p + 1, n);
    begin(s, has, DOWN, p, below, n);
    find_tension(s, has, RIGHT, laws);
    begin(s, has, ANTI, p + 1, below, n);
    find_tension(s, has, DOWN, laws);
    begin(s, has, CROSS, p, below + 1, n);
    find_tension(s, has, ANTI, laws);
    begin(s, has, RIGHT2, p, p + 2, n);
    find_tension(s, has, CROSS, laws);
    begin(s, has, DOWN2, p, below + down, n);
    find_tension(s, has, RIGHT2, laws);
    find_tension(s, has, DOWN2, laws);
    if (!self->wanted) {
        return (vec3){ 0 };
    }
    return land(self, 0, at, pull(s, has, RIGHT, in_1), pull(s, has, DOWN, NULL),
                pull(s, has, ANTI, in_1), pull(s, has, CROSS, in_1),
                pull(s, has, RIGHT2, in_2), pull(s, has, DOWN2, NULL), left);
}
#else
/* Forces of springs on the block at p, of planes n and rows `down` apart; `at` in the
 * buffers; rim NULL: all neighbours are there. Leaves the springs in s. */
INLINE vec3 block(sweep *self, spring *s, const law *laws, const double *p, size_t n,
                  size_t down, size_t at, unsigned has, carry *left, const edge *rim)
{
    landing *to = &self->of[0];
    const double *below = p + down;
    const mask *in_1 = rim != NULL ? &rim->right : NULL;
    const mask *in_2 = rim != NULL ? &rim->right2 : NULL;
    vec3 ended = load3(to->ended + at, SPAN), next = load3(to->ended2 + at, SPAN);
    begin(s, has, RIGHT, p, p + 1, n);
    begin(s, has, DOWN, p, below, n);
    find_tension(s, has, RIGHT, laws);
    begin(s, has, ANTI, p + 1, below, n);
    find_tension(s, has, DOWN, laws);
    const vec3 right = pull(s, has, RIGHT, in_1);
    begin(s, has, CROSS, p, below + 1, n);
    find_tension(s, has, ANTI, laws);
    const vec3 fall = pull(s, has, DOWN, NULL);
    begin(s, has, RIGHT2, p, p + 2, n);
    find_tension(s, has, CROSS, laws);
    const vec3 anti = pull(s, has, ANTI, in_1), beside = minus(right, anti);
    next = plus(next, plus(fall, anti));
    ended = plus(ended, shift_1(left->beside, beside));
    left->beside = beside;
    begin(s, has, DOWN2, p, below + down, n);
    find_tension(s, has, RIGHT2, laws);
    const vec3 cross = pull(s, has, CROSS, in_1);
    next = plus(next, shift_1(left->below, cross));
    left->below = cross;
    store3(to->ended + at, SPAN, next);
    find_tension(s, has, DOWN2, laws);
    const vec3 right2 = pull(s, has, RIGHT2, in_2);
    ended = plus(ended, shift_2(left->beside2, right2));
    left->beside2 = right2;
    const vec3 fall2 = pull(s, has, DOWN2, NULL);
    store3(to->ended2 + at, SPAN, fall2);
    const vec3 own = plus(plus(plus(plus(right, fall), cross), right2), fall2);
    return minus(own, ended);
}

#endif

INLINE void store_rates(sweep *self, vec3 v, vec3 a, const edge *rim, size_t count,
                        double *to, size_t m)
{
    const vec bad = trouble(a, v);
    self->bad += rim != NULL ? only(bad, rim->inside) : bad;
    store3_some(to, m, v, count);
    store3_some(to + 3 * m, m, a, count);
}

/* to + i; of products NULL: the state itself is not wanted. */
INLINE double *from(double *to, size_t i)
{
    return PRODUCT && to == NULL ? NULL : to + i;
}

/* x' and v' of the block at p, which is that of particle i, to planes m apart. Returns
 * its force. */
INLINE vec3 emit(sweep *self, const double *p, size_t n, size_t i, vec3 force,
                 const edge *rim, size_t count, double *to, size_t m)
{
    const vec3 v = load3(p + 3 * n, n);
    const vec3 net = minus(force, scaled(self->drag, v));
    if (!PRODUCT || to != NULL) {
        const vec3 a = plus(self->gravity, scaled(load(self->inverse_mass + i), net));
        store_rates(self, v, a, rim, count, to, m);
    }
    return net;
}

static void leave_aside(const sweep *self, size_t i, size_t count)
{
    for (size_t k = 0; !PRODUCT && k < 6; ++k) {
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

/* The block of row r at column c, of planes n and rows `down` apart. */
typedef struct place {
    const double *p;
    size_t n, down;
} place;

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

#if PRODUCT
/* products_fast.c, transposed_fast.c: the directions of the block of row r at column c.
 */
INLINE void along(sweep *self, const spring *s, const place *of, size_t r, size_t c,
                  size_t at, unsigned has, bool emits, carry *left, const law *laws,
                  const edge *rim, size_t count, vec3 net);
#else
#define along(self, s, of, r, c, at, has, emits, left, laws, rim, count, net)          \
    ((void)(of), (void)(net))
#endif

/* 1: yes, 0: no */
INLINE size_t on_rim(const sweep *self, size_t r)
{
    return r == 0 || r + 1 == self->rows;
}

/* The last columns of a row. Lanes without a particle read others and are masked. */
INLINE void row_end(sweep *self, size_t r, size_t at, unsigned has, bool emits,
                    carry *left, double *to, size_t m)
{
    double copy[6][3][EDGE];
    for (size_t c = self->inner, e = 0; c < self->cols; c += LANES, ++e) {
        spring s[WEFT_GROUPS];
        const size_t i = r * self->cols + c, b = e * LANES;
        const size_t count = self->cols - c < LANES ? self->cols - c : LANES;
        const place of = place_at(self, self->y, r, c, copy);
        const edge *rim = &self->edges[e];
        const law *laws = self->by[on_rim(self, r)][END + e];
        vec3 force = block(self, s, laws, of.p, of.n, of.down, at + b, has, left, rim);
        if (emits) {
            force = emit(self, of.p, of.n, i, force, rim, count, from(to, b), m);
        }
        along(self, s, &of, r, c, at + b, has, emits, left, laws, rim, count, force);
    }
}

INLINE size_t streams(const sweep *self)
{
    return PRODUCT ? 1 + self->ways->count : 1;
}

/* Columns [first, end) of row r; of the block on their left only its carry. */
INLINE void row(sweep *self, size_t r, size_t first, size_t end, unsigned has,
                bool emits)
{
    const size_t n = self->n, cols = self->cols;
    const size_t down = PRODUCT ? self->down : cols, i = r * down + first;
    const size_t m = self->detour ? SPAN : n;
    double *const to = self->detour ? self->aside : from(self->dydt, i);
    const double *p = self->y + i;
    const ptrdiff_t count = (ptrdiff_t)(end - first);
    const law *const *by = self->by[on_rim(self, r)];
    const law *laws = by[first == 0 ? FIRST : INNER];
    carry left[STREAMS];
    for (size_t k = 0; k < streams(self); ++k) {
        left[k] = (carry){ 0 };
    }
    for (ptrdiff_t j = first > 0 ? -LANES : 0; j < count; j += LANES) {
        spring s[WEFT_GROUPS];
        const size_t at = (size_t)(LANES + j), b = r * cols + first + (size_t)j;
        vec3 force = block(self, s, laws, p + j, n, down, at, has, left, NULL);
        if (emits && j >= 0) {
            force = emit(self, p + j, n, b, force, NULL, LANES, from(to, (size_t)j), m);
        }
        const place of = { p + j, n, down };
        along(self, s, &of, r, first + (size_t)j, at, has, emits && j >= 0, left, laws,
              NULL, LANES, force);
        laws = by[INNER];
    }
    if (end == self->inner) {
        row_end(self, r, LANES + (size_t)count, has, emits, left,
                from(to, (size_t)count), m);
    }
    if (emits && self->detour) {
        leave_aside(self, i, (end == self->inner ? cols : end) - first);
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
static void any_row(sweep *self, size_t r, size_t first, size_t end, unsigned has,
                    bool emits)
{
    switch (emits ? has : 0u) {
#define CASE(springs)                                                                  \
    case springs:                                                                      \
        row(self, r, first, end, springs, true);                                       \
        break;
#if PRODUCT < 2 /* the transposed rate always has them */
        CASE(STRETCH)
        CASE(WOVEN)
        CASE(FULL)
#endif
        CASE(STRETCH | BIT(DAMPED))
        CASE(WOVEN | BIT(DAMPED))
        CASE(FULL | BIT(DAMPED))
#undef CASE
    default:
        row(self, r, first, end, has, emits);
    }
}

/* Columns [first, end). The two rows above first_row add their pulls on the others;
 * `pulls` has them, unless it is NULL. */
static void tile(sweep *self, size_t first, size_t end, unsigned all, size_t first_row,
                 size_t end_row, const double *pulls)
{
    const size_t above = pulls != NULL ? 0 : first_row < 2 ? first_row : 2;
    if (pulls != NULL) {
        memcpy(self->of, pulls, sizeof(landing));
    } else {
        memset(self->of, 0, streams(self) * sizeof *self->of);
    }
    for (size_t r = first_row - above; r < end_row; ++r) {
        unsigned has = of_row(self, r, all);
        if (r < first_row) {
            has &= r + 1 < first_row ? BIT(DOWN2) | BIT(DAMPED)
                                     : ~(BIT(RIGHT) | BIT(RIGHT2));
        }
        any_row(self, r, first, end, has, r >= first_row);
    }
}

/* A load waits for a store before it whose address has the same low twelve bits. Where
 * planes are a multiple of 4096 bytes apart, but for a few columns, stores meet the
 * loads of the next blocks in every row if dydt is that little ahead of y. */
static bool stores_delay_loads(const sweep *self)
{
    if (PRODUCT || (8 * self->n + 256) % 4096 >= 512) {
        return false;
    }
    const size_t ahead = ((uintptr_t)self->dydt - (uintptr_t)self->y) % 4096;
    return ahead < 256 && (ahead > 0 || (uintptr_t)self->y % 64 != 0);
}

/* The laws of a group in lanes from column c on: half along the rim. */
static law halved(law of, bool row_rim, const weft__group *group, size_t c, size_t cols)
{
    const bool in_row = group->way == RIGHT || group->way == RIGHT2;
    for (size_t l = 0; l < LANES && group->half_rim; ++l) {
        if (in_row ? row_rim : c + l == 0 || c + l + 1 == cols) {
            of.stiffness[l] *= 0.5;
            of.damping[l] *= 0.5;
#if PRODUCT
            of.share[l] *= 0.5;
#endif
        }
    }
    return of;
}

/* The laws of all rows and blocks, if a rim carries half. */
static void start_half(sweep *self, const weft__springs *own)
{
    const size_t columns[PLACES]
        = { 0, LANES, self->inner, self->inner + LANES }; /* any inside for INNER */
    for (size_t i = 0; i < 2 * PLACES * own->group_count; ++i) {
        const size_t at = i / 2 % PLACES;
        const weft__group *group = &own->groups[i / (2 * PLACES)];
        self->half[i % 2][at][group->way]
            = halved(self->laws[group->way], i % 2 == 1, group, columns[at],
                     at == INNER ? SIZE_MAX : own->mesh->cols);
        self->by[i % 2][at] = self->half[i % 2][at];
    }
}

/* Returns the set of its springs. */
static unsigned start(sweep *self, const weft__springs *own, const weft__body *body,
                      const double *y, size_t stride, size_t down)
{
    const weft__mesh *mesh = own->mesh;
    const double *g = body->gravity;
    unsigned all = 0;
    self->y = y;
    self->inverse_mass = mesh->inverse_mass;
    self->n = stride, self->down = down, self->particles = mesh->particles;
    self->rows = mesh->rows, self->cols = mesh->cols;
    self->inner = inner_columns(mesh->cols);
    self->gravity = (vec3){ splat(g[0]), splat(g[1]), splat(g[2]) };
    self->drag = splat(body->drag);
    self->bad = splat(0.0);
    for (size_t e = 0; e < 2; ++e) {
        const size_t c = self->inner + e * LANES;
        self->edges[e]
            = (edge){ have_column(c, 0, mesh->cols), have_column(c, 1, mesh->cols),
                      have_column(c, 2, mesh->cols) };
    }
    bool half = false;
    for (size_t i = 0; i < own->group_count; ++i) {
        const weft__group *group = &own->groups[i];
        self->laws[group->way] = (law){ .stiffness = splat(group->stiffness),
                                        .rest_length = splat(group->rest_length),
                                        .damping = splat(group->damping) };
#if PRODUCT
        self->laws[group->way].share = splat(1.0);
#endif
        all |= BIT(group->way) | (group->damping != 0.0 ? BIT(DAMPED) : 0u);
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

static int sweep_tiles(sweep *self, unsigned all, size_t first, size_t end,
                       double *trail, bool goes_on)
{
    self->detour = stores_delay_loads(self);
    for (size_t c = 0; c == 0 || c < self->inner; c += TILE) {
        const size_t stop = self->inner - c < TILE ? self->inner : c + TILE;
        tile(self, c, stop, all, first, end, goes_on ? trail : NULL);
        if (trail != NULL) {
            memcpy(trail, self->of, sizeof(landing));
            trail += sizeof(landing) / sizeof *trail;
        }
    }
    return sum(self->bad) == 0.0 ? 0 : 1;
}

#if !PRODUCT
/* Weight and air alone, of particles [first, end) of a cloth without springs. */
static vec bare(const sweep *self, size_t first, size_t end)
{
    const size_t n = self->n;
    const double *state = self->y + 3 * n;
    vec bad = splat(0.0);
    for (size_t i = first; i < end; i += LANES) {
        const size_t count = end - i < LANES ? end - i : LANES;
        const vec w = load(self->inverse_mass + i);
        const vec3 v = load3_some(state + i, n, count), g = self->gravity;
        const vec3 a
            = { g.x + w * (0.0 - self->drag * v.x), g.y + w * (0.0 - self->drag * v.y),
                g.z + w * (0.0 - self->drag * v.z) };
        store3_some(self->dydt + i, n, v, count);
        store3_some(self->dydt + 3 * n + i, n, a, count);
        bad += trouble(a, v);
    }
    return bad;
}

int NAME(rows, LEVEL)(const void *own, const weft__body *body, const weft__state *at,
                      weft__unit unit, double *dydt, size_t first, size_t end)
{
    const weft__springs *of = own;
    sweep self;
    (void)unit;
    const unsigned all
        = start(&self, of, body, at->y, of->mesh->stride, of->mesh->cols);
    self.dydt = dydt;
    if (of->group_count == 0) {
        return sum(bare(&self, weft__block(of->mesh, first),
                        weft__block(of->mesh, end)))
                       == 0.0
                   ? 0
                   : 1;
    }
    return sweep_tiles(&self, all, first, end, at->trail, at->goes_on);
}
#endif
