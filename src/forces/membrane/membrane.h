/* SPDX-License-Identifier: BSD-3-Clause */
/* membrane.h -- the membrane of a mesh of triangles: orthotropic St. Venant-Kirchhoff
 * elasticity with constant strain in each triangle, damping in proportion, and a
 * barrier against its collapse (docs/theory/model.md). With the edge vectors d_i,
 * opposite corner i, and their squares q_i less those at rest, the strain is linear in
 * q, and
 *
 *     U = q.K q / 4,   s = K (q + damping dq/dt),   edge i pulls at its ends with s_i
 * d_i
 *
 * K is 3 x 3 and constant. The barrier adds to s while the area is below 0.6 of that at
 * rest.
 *
 * Each block computes all triangles with a corner in it and keeps the force on its own
 * particles. It takes them in batches of WEFT__WIDTH, none of which has a particle
 * twice: in this order forces are added, whatever the width of vectors. */
#pragma once

#include "forces/bending/plate.h"

enum {
    WEFT__WIDTH = 8, /* triangles of a batch */
    WEFT__NEAR = 768 /* particles that one block may touch in the fast form */
};

/* Constants of a triangle. */
enum {
    WEFT__STIFF = 0,  /* [N/m^3] K: 00, 11, 22, 01, 02, 12 */
    WEFT__SQUARE = 6, /* [m^2] squares of the edges at rest */
    WEFT__LEAST = 9,  /* [m^4] 16 area^2 below which the barrier begins */
    WEFT__LAG,        /* [s] twice the damping */
    WEFT__GUARD,      /* [J] energy of the barrier as a function of phi */
    WEFT__CONSTANTS
};

/* One plane for each constant. A lane without a triangle has zeros. */
typedef struct weft__batch {
    double of[WEFT__CONSTANTS][WEFT__WIDTH];
} weft__batch;

/* Which triangles and particles a batch has. In `near` a block's own particles come
 * first, then those of its halo, then one that stands for a missing triangle. */
typedef struct weft__batch_corners {
    uint16_t near[3][WEFT__WIDTH];
    uint32_t triangle[WEFT__WIDTH]; /* WEFT__NONE: missing */
} weft__batch_corners;

/* Where a block begins in the arrays; one more block ends them. */
typedef struct weft__membrane_block {
    size_t batch, halo;
} weft__membrane_block;

/* membrane_arc.c: edges measured along the cloth's arc (docs/theory/model.md): the
 * square of each has |h|^2 more, where h = sum of share x is L^2 / sqrt(12) times the
 * second derivative along it (forces/bending/plate.h). With z = |h|^2 + damping
 * d|h|^2/dt and sums over the triangles of an edge d,
 *
 *     F = -share (S h) on its parts,           S = sum of K (q + damping dq/dt + z)
 *     F = +(E d) and -(E d) at its ends,       E = sum of K z
 *
 * beside the forces of membrane.h. Terms alternate between two partial
 * sums. The barrier takes chords, not arcs. The fast form takes
 * groups of particles of a block, with copies of what is near them. */
enum { WEFT__ARC_EDGES = 2560, WEFT__ARC_NEAR = 1536 }; /* of a group, at most */

/* What a particle is to an edge: a part of its h, or an end of its d, share -1 or 1. */
typedef struct weft__arc_part {
    double share;
    uint32_t item;  /* 2 e: h of edge e; 2 e + 1: d */
    uint32_t local; /* the same by the list of the group */
} weft__arc_part;

typedef struct weft__arc_edge {
    uint32_t edge, row; /* where its parts begin; those of the next edge end them */
    uint16_t end[2];    /* in the list of particles near */
} weft__arc_edge;

typedef struct weft__arc_triangle {
    uint32_t triangle;               /* first, for weft__ascending */
    uint16_t edge[3];                /* in the list */
    double stiff[6], square[3], lag; /* as weft__batch has them */
} weft__arc_triangle;

/* Where a group begins in the lists; one more ends them. Without edges: too large. */
typedef struct weft__arc_group {
    size_t particle, near, edge, triangle;
} weft__arc_group;

/* All NULL of chords. */
typedef struct weft__arc {
    weft__edge_slopes rows; /* h of each edge */
    size_t *begin;          /* of each particle, and their number: */
    weft__arc_part *part;
    double *bow;        /* [m^2] |h|^2 of each edge at rest in space; NULL: all 0 */
    double *weight_sum; /* of an edge: the sum of |share| weight */
    size_t *block;      /* the first group of each block, and their number: */
    weft__arc_group *group;
    uint32_t *near;
    weft__arc_edge *edge;
    weft__arc_triangle *triangle;
    uint16_t *row; /* near */
    double *share;
    size_t groups, nears, edges, triangles, rows_near; /* in these lists */
    weft__add_fn *fast;
} weft__arc;

WEFT_FORMS(weft__add_fn, arc);

/* All 0 on a grid. */
typedef struct weft__membrane {
    const weft__mesh *mesh;
    weft__membrane_block *blocks;
    weft__batch *batches; /* aligned to cache lines, in `room` */
    weft__batch_corners *corners;
    uint32_t *halo;         /* particles, ascending in each block */
    size_t *coupling_first; /* of each particle, and their number: */
    uint32_t *coupling;     /* the other ends of its couplings, above it, ascending */
    double *weight;         /* of bounds: d of each particle, > 0 */
    void *room;
    weft__arc arc; /* where lengths follow the arc */
    bool damped;   /* any triangle */
    bool shared;   /* with the cloth that this one is a copy of */
    weft__add_fn *fast;
} weft__membrane;

extern const weft__force weft__membrane_force;
WEFT_FORMS(weft__add_fn, membrane);

/* membrane_init.c */
void weft__membrane_check(const weft_cloth_def *def, const weft__faults *to);
bool weft__membrane_init(void *own, const weft_cloth_def *def,
                         const weft_allocator *memory);
bool weft__membrane_slice(void *own, const weft__slice *slice);
bool weft__membrane_copy(void *own, const weft_allocator *memory);
void weft__membrane_free(void *own, const weft_allocator *memory);

/* [N/m] S11, S22, S12 of a strain. */
static inline void weft__membrane_stress(const weft_fabric *of, const double strain[3],
                                         double stress[3])
{
    stress[0] = of->stretch[1] * strain[0] + of->coupling * strain[1];
    stress[1] = of->stretch[0] * strain[1] + of->coupling * strain[0];
    stress[2] = 2.0 * of->shear * strain[2];
}

void weft__membrane_constants(const weft__triangles *of, size_t t,
                              double to[WEFT__CONSTANTS]);

/* Green's strain E11, E22, E12 that the square of each edge adds by 1 m^2 [1/m^2]; and
 * the constants, where that is there already. */
void weft__membrane_shape(const weft__triangles *of, size_t t, double shape[3][3]);
void weft__membrane_shaped(const weft__triangles *of, size_t t,
                           const double shape[3][3], double to[WEFT__CONSTANTS]);

/* The barrier's energy [J] as a function of r = 16 area^2 / least: less its slope, its
 * curvature, and the slopes [1/m^2] of r in the squares of the edges. */
typedef struct weft__barrier {
    double push, bend, rate[3];
} weft__barrier;

/* Of a triangle with these constants; false: it does not act, and all are 0. */
bool weft__membrane_barrier(const double *of, const double square[3],
                            weft__barrier *out);

/* membrane_bounds.c */
bool weft__membrane_weigh(weft__membrane *own, const weft_allocator *memory);
bool weft__membrane_list_couplings(weft__membrane *own, const weft_allocator *memory);
size_t weft__membrane_couplings(const void *own, weft_block_coupling *to);
int weft__membrane_coupling_numbers(const void *own, const weft__state *at,
                                    double *numbers);
void weft__membrane_ratios(const void *own, struct weft__sides *to);
void weft__membrane_bound(const void *own, const weft__state *at, size_t i,
                          const struct weft__sides *sides, double (*sums)[6]);

/* ---- membrane_loops.c: the triangles, one by one ----------------------------------
 */

/* A triangle in a state, or in a direction of it. */
typedef struct weft__sides3 {
    double d[3][3]; /* [m] edges: d[i] is opposite corner i */
    double w[3][3]; /* [m/s] their rates */
} weft__sides3;

/* One triangle of a batch. */
typedef struct weft__triangle {
    double of[WEFT__CONSTANTS];
    const uint32_t *corner; /* its particles */
    size_t number;
} weft__triangle;

void weft__membrane_sides(const weft__mesh *mesh, const uint32_t corner[3],
                          const double *y, weft__sides3 *out);

/* [m^2] */
void weft__membrane_squares(const weft__sides3 *at, double square[3]);

/* Finds those of block b, one after the other; false: no more. *next is 0 before the
 * first. */
bool weft__membrane_each(const weft__membrane *of, size_t b, size_t *next,
                         weft__triangle *out);

/* The same, of those whose lowest particle is in the block: each triangle once. */
bool weft__membrane_each_own(const weft__membrane *of, size_t b, size_t *next,
                             weft__triangle *out);

/* [N] on the own particles of block b, or its change along at->along. */
void weft__membrane_forces(const weft__membrane *own, const weft__state *at, size_t b,
                           double force[WEFT__MESH_BLOCK][3]);

/* [N/m] s of a triangle; and adds to s the change of the barrier's, s_i = -2 push
 * rate_i, for that of q. */
void weft__membrane_pulls(const weft__membrane *own, const weft__triangle *tri,
                          const weft__sides3 *at, double s[3]);
void weft__membrane_barrier_change(const double *of, const double square[3],
                                   const double more[3], double s[3]);

weft__transposed_fn weft__membrane_transposed; /* membrane_transposed.c */

/* ---- membrane_bounds.c: a triangle at rest and in a state --------------------------
 */

/* What a triangle is at rest. */
typedef struct weft__rest {
    const weft_fabric *fabric;
    double area, grad[3][2]; /* [m^2], [1/m] */
} weft__rest;

weft__rest weft__rest_of(const weft__triangles *of, size_t t);

/* What a state makes of a triangle; S by its parts above and below 0, as 11, 22, 12. */
typedef struct weft__load {
    double square;            /* of the largest stretch */
    double taut[3], slack[3]; /* [N/m] */
    double d[3][3], q[3];     /* [m], [m^2] edges and their squares */
    double arc[3];            /* [m^2] |h|^2 of the arcs */
    double compression;       /* [N/m] above the stress of any slack, without a state */
    weft__barrier barrier;
    double of[WEFT__CONSTANTS];
} weft__load;

void weft__load_of(const weft__membrane *own, size_t t, const weft__rest *of,
                   const double *y, weft__load *out);

/* [N/m^3] g_a.S g_b of a part S of the stress */
static inline double weft__geometric(const weft__rest *of, const double s[3], size_t a,
                                     size_t b)
{
    const double *g = of->grad[a], *h = of->grad[b];
    return g[0] * s[0] * h[0] + g[1] * s[1] * h[1] + s[2] * (g[0] * h[1] + g[1] * h[0]);
}

/* ---- membrane_arc.c -----------------------------------------------------------------
 */

/* membrane_arc_init.c: the rows of h and what they are at rest, then the other tables.
 * False: no memory; free it in either case. */
bool weft__arc_measure(weft__membrane *own, weft__stop *stop,
                       const weft_allocator *memory);
bool weft__arc_create(weft__membrane *own, const weft_allocator *memory);
void weft__arc_free(weft__arc *of, const weft_allocator *memory);
size_t weft__arc_bytes(const weft__membrane *own);

/* [m^2] |h|^2 at rest of edge i of triangle t. */
static inline double weft__arc_bow(const weft__membrane *own, size_t t, size_t i)
{
    return own->arc.bow != NULL ? own->arc.bow[own->mesh->triangles->edge[t][i]] : 0.0;
}

/* |h|^2 of an edge [m^2], and its rate [m^2/s]; 0 of chords. */
void weft__arc_square(const weft__membrane *own, const double *y, size_t edge,
                      double square[2]);

/* h of an edge in three planes [m]. */
void weft__arc_row(const weft__membrane *own, const double *x, size_t edge,
                   double h[3]);

/* [N] on particle i, or its change along at->along. */
void weft__arc_force(const weft__membrane *own, const weft__state *at, size_t i,
                     double force[3]);

/* Adds to three planes, of particles [first, end); returns 0 or NaN. */
double weft__arc_particles(const weft__membrane *own, const weft__state *at,
                           weft__unit unit, double *to, size_t first, size_t end);

/* Of a state or of its change: squares of edges less those at rest, and |h|^2, with
 * their rates / 2. */
typedef struct weft__bent {
    double chord, chord_rate, arc, arc_rate; /* [m^2], [m^2/s] */
} weft__bent;
