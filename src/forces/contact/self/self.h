/* SPDX-License-Identifier: BSD-3-Clause */
/* self.h -- the primitives of a cloth for contact with itself, and pairs of them.
 *
 * A node is a point with the edges and triangles that it owns (mesh/mesh.h,
 * contact_surface.h): each pair of primitives has one pair of nodes. A point is a
 * particle, or beyond the particles a vertex of a body. States are planes of `points`
 * numbers. The formulas are in docs/theory/contact.md. */
#pragma once

#include "forces/contact/contact.h"
#include "forces/contact/self/orientation.h"
#include "forces/contact/self/self_tree.h"

typedef struct weft__self_list weft__self_list; /* self_list.h */

static inline size_t weft__pair_particles(const weft__pair *pair)
{
    return weft__kind_particles((weft__pair_kind)pair->kind);
}

void weft__pair_primitives(const weft__pair *pair, weft_primitive out[2]);

/* Of a surface: the same for either order of its primitives. */
static inline void weft__pair_key(const weft__pair *pair, uint64_t key[2])
{
    const bool alike = pair->kind == WEFT__VERTICES || pair->kind == WEFT__EDGES;
    const uint32_t a = pair->item[0], b = pair->item[1];
    key[0] = (uint64_t)pair->kind << 32 | (alike && b < a ? b : a);
    key[1] = alike && b < a ? a : b;
}

/* ---- self_pairs.c: which pairs are near ------------------------------------------ */

/* [m] Of the nearest points of both, in planes y of n. */
double weft__pair_distance(const weft__pair *pair, const double *y, size_t n);

/* Calls visit for each pair nearer than range, and for some others: kind by kind, in
 * the order of weft__tree_pairs; those of a smaller range come in the same order.
 * Returns false if a visit did. The state must be finite. */
bool weft__each_pair(const weft__quadtree *tree, double range, weft__pair_fn *visit,
                     void *ctx);

/* Takes a pair that has been found to its windows; false: it is one of slit edges. */
bool weft__pair_admit(const weft__self *own, weft__pair *pair);

/* The same as weft__each_pair between two tiles, each kind in that order. */
bool weft__each_pair_between(const weft__quadtree *tree, const uint32_t tiles[2],
                             double range, weft__pair_fn *visit, void *ctx);

/* A step is clear of a pair if no particle of one side can have met one of the other on
 * the straight path between both states, nor, h times the speed long, by its speeds:
 *
 *     max |(x1_a - x0_a) - (x1_b - x0_b)|, h max |v_a - v_b| < d0 + d1,  d1 > 0
 *
 * over the particles a of one side, b of the other, at both ends of the step. The first
 * alone proves that a cloth that does not pass through itself does not afterwards. */
typedef struct weft__stride {
    const weft__self *own;
    const double *y0, *y1; /* states at both ends */
    double h; /* [s]; 0: the straight path alone, whatever the velocities */
} weft__stride;

/* gap: [m] at the end. Vertex-triangle and edge-edge pairs suffice; others are clear.
 */
bool weft__stride_clear(const weft__stride *of, const weft__pair *pair, double *gap);

/* The bounds of displacements. */
typedef struct weft__drift {
    double low[3], high[3]; /* [m] */
} weft__drift;

/* Sets the bounds of displacements from one state to another, from NULL: from 0, of
 * patches [first, end) of a level of a grid; infinite ones where a number is not
 * finite. */
typedef void weft__drift_fn(const weft__self *own, const double *from, const double *to,
                            size_t level, size_t first, size_t end, weft__drift *of);

/* The same of points run[0], run[0] + 1, ... before run[1], and of `count` further
 * ones, a multiple of WEFT__SURFACE_RUN, in three planes that are so far apart. */
typedef struct weft__range {
    const double *from, *to;
    size_t from_plane, to_plane, run[2];
    const int32_t *more;
    size_t count;
} weft__range;
typedef void weft__range_fn(const weft__range *range, weft__drift *of);

/* [m] No two particles are displaced by more against each other; INFINITY if a number
 * is not finite. */
double weft__extent(const weft__self *own, const double *from, const double *to);

/* [m] Of the bounds of two tiles together, which may be the same. */
static inline double weft__drift_extent(const weft__drift *a, const weft__drift *b)
{
    double square = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const double low = a->low[k] < b->low[k] ? a->low[k] : b->low[k];
        const double high = a->high[k] > b->high[k] ? a->high[k] : b->high[k];
        square += (high - low) * (high - low);
    }
    return sqrt(square);
}

static inline void weft__drift_add(weft__drift *sum, const weft__drift *of)
{
    for (size_t k = 0; k < 3; ++k) {
        sum->low[k] = of->low[k] < sum->low[k] ? of->low[k] : sum->low[k];
        sum->high[k] = of->high[k] > sum->high[k] ? of->high[k] : sum->high[k];
    }
}

/* ---- self.c: how they push ------------------------------------------------------- */

/* What the law takes from a cloth. */
typedef struct weft__self_law {
    const weft__self *own;
    double share;           /* of the energy of a pair, unless its mass is negative */
    double window;          /* of a grid: 1 / x0 of the weights */
    double square[3];       /* [m^2] of its rest lengths: down, right, diagonal */
    const double *along;    /* a direction of a state of particles, the derivative along
                               which is wanted in place of forces; or NULL */
    const weft__self *base; /* of a perturbed copy, which has other parameters: only
                               pairs that push */
    const double *base_y; /* in this state count, so that any list has them; or NULL */
} weft__self_law;

weft__self_law weft__self_law_of(const weft__self *own);

/* 1 / the product of the squares of both edges' rest lengths, or 0 of other pairs; the
 * mass M [kg] of a pair, 0 without free particles, -M of a grid among several cloths
 * with itself, whose pairs have WEFT__GRID_SHARE. */
#define WEFT__GRID_SHARE 0.25 /* a particle between two layers has some four pairs */
double weft__pair_rest(const weft__self_law *law, const weft__pair *pair);
double weft__pair_mass(const weft__self *own, const weft__pair *pair);

static inline double weft__pair_share(const weft__self_law *law, double mass)
{
    return mass < 0.0 ? WEFT__GRID_SHARE : law->share;
}

/* 1 / x0 as law_weigh takes it. */
void weft__pair_windows(const weft__self_law *law, const weft__pair *pair,
                        double window[3]);

/* Its mass if it pushes, else 0. */
double weft__pair_pushes(const weft__self *own, const weft__pair *pair,
                         const double *y);

/* Pairs of one kind, their numbers by particles. WEFT__BLOCK numbers beyond the end may
 * be read. */
enum { WEFT__BLOCK = 8 };
enum { WEFT__NEAR_PLANES = 6 };
typedef struct weft__near {
    int32_t *particle[WEFT__NEAR_PLANES]; /* [4] and [5]: of a surface, item */
    double *slack;                        /* [m] of weft__slack_fn */
    double *mass, *rest; /* as of weft__pair_mass and weft__pair_rest */
} weft__near;

static inline weft__pair weft__near_pair(weft__pair_kind which, const weft__near *of,
                                         size_t i)
{
    weft__pair out = { .kind = which };
    for (size_t k = 0; k < weft__kind_particles(which); ++k) {
        out.particle[k] = (uint32_t)of->particle[k][i];
    }
    out.item[0] = (uint32_t)of->particle[4][i],
    out.item[1] = (uint32_t)of->particle[5][i];
    return out;
}

/* Successive pairs up to `end` of each kind: those that have to wait longer do not
 * push. */
typedef struct weft__pair_subset {
    double moved; /* [m] since their slack was found */
    size_t end[WEFT__EDGES + 1];
} weft__pair_subset;

/* WEFT__BLOCK pairs of a kind that push; push i of an array of them is lane
 * i % WEFT__BLOCK of number i / WEFT__BLOCK. */
typedef struct weft__pushes {
    double force[4][3][WEFT__BLOCK]; /* [N] */
    double gap[WEFT__BLOCK];         /* [m] */
    double energy[WEFT__BLOCK];      /* [J] */
    double heat[WEFT__BLOCK];        /* [W] of its damping */
    double friction[WEFT__BLOCK];    /* [W] heat, too */
    int32_t particle[4][WEFT__BLOCK];
} weft__pushes;

/* Writes a pair to a lane; false: it does not push in state y[6 N]. The forces are NaN
 * where two are at the same place; *bad as below. */
typedef bool weft__push_fn(const weft__self_law *law, const weft__pair *pair,
                           const double *y, weft__pushes *out, size_t lane,
                           double *bad);
weft__push_fn weft__pair_push;

/* self_derivatives.c: of the derivative of the forces alone, along law->along. */
weft__push_fn weft__pair_derivative;

/* Writes the pushes of pairs in their order, and returns their number; adds 0 to *bad,
 * or NaN if a force is not finite. Has room for all pairs. Slack becomes negative where
 * pairs push, and 0 where they no longer do. */
typedef size_t weft__pushes_fn(const weft__self_law *law, weft__pair_kind kind,
                               const weft__near *near, const weft__pair_subset *subsets,
                               size_t subset_count, const double *y, weft__pushes *out,
                               double *bad);

/* Of pairs [first, end) of a kind: distances as of weft__pair_distance, and what
 * differences between their particles have to change by, at least, before they push: up
 * to `most` [m] where the feet decide. Sets distances[i] and near->slack[i] of pair i.
 */
typedef void weft__slack_fn(const weft__self *own, weft__pair_kind kind,
                            const weft__near *near, size_t first, size_t end,
                            const double *y, double most, double *distances);

/* Sets gaps[i] [m] to weft__pair_distance of pair which[i] of a kind. */
typedef void weft__gaps_fn(const weft__self *own, weft__pair_kind kind,
                           const weft__near *near, const uint32_t *which, size_t count,
                           const double *y, double *gaps);

/* Sets out[0], out[1], ... to those of pairs `which` that push but for their mass,
 * which may be 0, in their order; returns how many. */
typedef size_t weft__meets_fn(const weft__self *own, weft__pair_kind kind,
                              const weft__near *near, const uint32_t *which,
                              size_t count, const double *y, uint32_t *out);

/* Sets `which` to those of first, first + 1, ... before end whose numbers are at most
 * `most` or NaN, and returns how many. WEFT__BLOCK more may be written, and as many
 * numbers read. */
typedef size_t weft__within_fn(const double *numbers, size_t first, size_t end,
                               double most, uint32_t *which);

/* As many numbers are looked at in turn, where their room is on the stack. */
enum { WEFT__STRIP = 256 };

WEFT_FORMS(weft__pushes_fn, pushes);
weft__pushes_fn weft__pushes_derivatives,
    weft__pushes_perturbed; /* with law->along; ->base */
WEFT_FORMS(weft__slack_fn, slack);
WEFT_FORMS(weft__gaps_fn, gaps);
WEFT_FORMS(weft__within_fn, within);
WEFT_FORMS(weft__meets_fn, meets);
WEFT_FORMS(weft__drift_fn, drift);
WEFT_FORMS(weft__range_fn, range);

struct weft__self {
    const weft__mesh *mesh;
    weft_contact_def law; /* law.self: whether there is any */
    bool asked;           /* by the definition: a band has it in its whole cloth */
    weft__contact_surface *surface; /* NULL: a grid by itself */
    size_t points;
    bool shared;  /* the surface is another's */
    bool between; /* points of bodies with those of the cloth alone */
    const double
        *friction;       /* of a body's points, and room for others; NULL: the law's */
    double max_friction; /* the largest */
    weft__pushes_fn *pushes;
    weft__slack_fn *slack;
    weft__gaps_fn *gaps;
    weft__within_fn *within;
    weft__meets_fn *meets;
    weft__drift_fn *drift;
    weft__range_fn *range;
    const weft__seeker *seeker; /* NULL: pairs are sought by the tree */
};

/* Whether a point does not move by forces. */
static inline bool weft__self_held(const weft__self *own, size_t i)
{
    return i >= own->mesh->particles || own->mesh->pin[i] != 0;
}

/* The grid among several cloths that both primitives of a pair are of; NULL: none. */
static inline const weft__part *weft__pair_grid(const weft__self *own,
                                                const weft__pair *pair)
{
    const size_t last = pair->particle[weft__pair_particles(pair) - 1];
    const weft__part *of = own->surface != NULL && own->surface->grids
                               ? weft__grid_at(own->mesh, pair->particle[0])
                               : NULL;
    return of != NULL && last >= of->first && last - of->first < of->count ? of : NULL;
}

/* Bodies have the higher points. */
static inline double weft__pair_friction(const weft__self *own, const weft__pair *pair)
{
    const uint32_t a = pair->particle[0],
                   b = pair->particle[weft__pair_particles(pair) - 1];
    return own->friction != NULL ? own->friction[a > b ? a : b] : own->law.friction;
}

/* The same before: b_i, and the touch of the feet, with push, stiffness and
 * friction_rate not per unit mass. */
bool weft__pair_meets(const weft__self_law *law, const weft__pair *pair,
                      const double *y, double arm[4], weft__touch *touch);

/* Visits the pairs that may push in a state; false if that is not finite, or ended.
 * knots: room for those of a tree, which save time; or NULL. */
bool weft__self_seek(const weft__self *own, weft__knot *knots, const double *y,
                     weft__pair_fn *visit, void *ctx);

typedef void weft__pushed_fn(void *ctx, weft__pair_kind kind,
                             const weft__pushes *pushes, size_t count);
typedef struct weft__self_pass {
    weft__self_law law;
    const double *y; /* of all points */
    weft__pushed_fn *each;
    void *ctx;
    double bad; /* 0 or NaN */
} weft__self_pass;

/* Calls `each` with all that push in a state, which are sought, kind by kind in the
 * order of weft__each_pair. Returns 1 if a number is not finite. Nothing without
 * law.self. */
int weft__self_each(weft__self_pass *pass, weft__knot *knots);

/* The same with a list, which has the pairs near in its state y; the pass may be of a
 * perturbed copy, of the same points with other parameters. */
int weft__self_list_each(weft__self_list *list, const double *y, weft__self_pass *pass);

/* A weft__pushed_fn that adds their forces on particles [first, end) to three planes,
 * which begin with particle `first` and are `stride` apart. */
typedef struct weft__self_sums {
    const weft__self *own;
    weft__unit unit;
    double *to;
    size_t first, end, stride;
} weft__self_sums;
void weft__self_sum(void *ctx, weft__pair_kind kind, const weft__pushes *pushes,
                    size_t count);

/* As whole.add of a weft__force; space, a list, NULL: pairs are sought. */
int weft__self_add(const void *own, void *space, const weft__state *at, weft__unit unit,
                   double *to);

/* As measure_all of a weft__force; list NULL: they are sought. */
void weft__self_measure(const void *own, void *list, const weft__state *at,
                        weft_measures *sum);

/* As transposed_all of a weft__force; y: of all points. */
int weft__self_transposed(const weft__self *own, weft__self_list *list, const double *y,
                          const double *along, double *out);

/* ---- self_bounds.c: stiffness and damping ---------------------------------------- */

/* For weft__force. Particles get what bounds the pairs in a state: sum b_i F_i of a
 * pair is at most diag(2 |b_i|) of it; without a state, what layers that meet at no
 * more than stopping_speed add. The slopes of the weights are left out, so that bounds
 * are estimates. */
void weft__self_range_stiffness(const void *own, void *list, const weft__state *at,
                                size_t first, size_t count,
                                weft__range_stiffness *range_stiffness);
void weft__self_multiply(const void *own, const weft__state *at, double a, double b,
                         const double *x, double *out);

/* What majorises the pairs' part of J: each block is symmetric and not negative. */
int weft__self_blocks(const void *own, void *space, const weft__state *at,
                      double *blocks);

/* That the thickness suits contact of the cloth with itself, if it has that; of a mesh
 * without notches. */
void weft__self_check(const weft_cloth_def *def, const weft__faults *to);

/* The same of notches. */
weft_status weft__notch_error(const weft__self *own, weft_error *err);

extern const weft__force weft__self_force;

/* Of a weft__force that begins with a weft__self. */
bool weft__self_copy(void *own, const weft_allocator *memory);
void weft__self_choose(void *own, weft__isa isa);

/* Makes the surface of a mesh, with its slit edges; false: no memory. */
bool weft__self_cover(weft__self *of, const weft_allocator *memory);

/* slit_edges.c: finds the slit edges of a mesh, and the notch; false: no memory. */
bool weft__find_slit_edges(weft__contact_surface *surface, const weft__mesh *mesh,
                           double thickness, const weft_allocator *memory);

/* Whether an edge and a triangle have primitives that are. */
bool weft__at_slit(const weft__contact_surface *surface, size_t edge, size_t triangle);
