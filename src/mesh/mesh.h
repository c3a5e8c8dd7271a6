/* SPDX-License-Identifier: BSD-3-Clause */
/* mesh.h -- what a cloth is made of, without any force: particles, where they rest,
 * what they weigh, how they are held, and the blocks in which they are taken. */
#pragma once

#include <float.h>
#include <math.h>

#include "base/faults.h"
#include "mesh/track.h"
#include "weft/cloth.h"

#define WEFT__TWO_PI 6.283185307179586 /* correctly rounded */

#if (SIZE_MAX < UINT64_MAX && !defined __wasm__) || DBL_MANT_DIG != 53                 \
    || FLT_EVAL_METHOD != 0 || __FINITE_MATH_ONLY__
#error "weft needs a 64-bit target or WebAssembly, with IEEE double arithmetic: \
no -m32, -mfpmath=387 or -ffast-math"
#elif defined __clang__ ? __clang_major__ < 11 : __GNUC__ < 10
#error "weft needs gcc 10, clang 11 or a later one"
#endif

/* How far beyond the last particle fast forms may read. */
#define WEFT_PAST 16

/* x(t) = x0 + velocity (t - since) + amplitude sin(2 pi frequency t) + path(t) -
 * path(0)
 */
typedef struct weft__motion {
    double velocity[3];  /* [m/s] */
    double amplitude[3]; /* [m] */
    double frequency;    /* [Hz] */
    double omega;        /* [rad/s] 2 pi frequency */
    double since;        /* [s] 0 as defined */
    weft__curve path;    /* [m] */
    bool moves;
    bool coasts; /* instead: each particle keeps its velocity in `coast` */
} weft__motion;

typedef struct weft__mesh {
    size_t particles, pinned;
    size_t stride;               /* of planes of a state: the particles of all cloths */
    size_t block;                /* particles of a block: blocks.h */
    size_t pin_changes;          /* how often `pinned` was counted */
    double *mass;                /* [kg] N of them */
    double *inverse_mass;        /* [1/kg] N, 0 of the pinned, and WEFT_PAST more */
    uint32_t *pin;               /* N: 0 free, else 1 + index into motions */
    size_t *pins;                /* the pinned, in order */
    const uint32_t *defined_pin; /* of a copy (pins.h): the model's pin */
    double *coast;               /* [m/s] of a copy: 3 N, x y z of each that coasts */
    weft__motion *motions;       /* motion_count of them, and one that coasts */
    size_t motion_count;
    weft_band band;     /* which blocks of the whole these are: rows of a grid */
    size_t whole;       /* of triangles: particles of the whole */
    uint32_t *whole_of; /* of a band of triangles (slice.h): what the whole calls
                           particle i, ascending; else NULL */
    double velocity[3];
    struct weft__triangles *triangles; /* triangles.h; NULL: a grid */
    /* grid.c; 0 of triangles */
    size_t rows, cols;
    double spacing[2], origin[3], right[3], down[3], scale; /* right, down: unit */
} weft__mesh;

static inline double weft__dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double weft__length(const double a[3])
{
    return sqrt(weft__dot(a, a));
}

/* ---- mesh.c ---------------------------------------------------------------------- */

/* The size and plain values of a definition, directions made unit; of a grid with
 * triangles NULL. */
void weft__mesh_init(weft__mesh *mesh, const weft_cloth_def *def,
                     struct weft__triangles *triangles);

/* Masses, loads and pins of a definition, for which there is room; of their paths at
 * `rows`, which are kept. Returns where those end. */
void weft__mesh_fill(weft__mesh *mesh, const weft_cloth_def *def, double *rows);

/* weft_cloth_rest */
void weft__rest_positions(const weft__mesh *mesh, double *xyz);

/* Of particle i: where it is at t = 0 [m], its lumped area [m^2]. */
void weft__start_position(const weft__mesh *mesh, size_t i, double x[3]);
/* [m/s] unless it is pinned */
const double *weft__start_velocity(const weft__mesh *mesh, size_t i);
double weft__area(const weft__mesh *mesh, size_t i);

/* Of a definition without faults: 1 + the number of the pin that holds a particle of
 * the whole cloth, 0: it is free; and what messages call the particle. */
size_t weft__pin_of(const weft_cloth_def *def, size_t particle);
const char *weft__particle_text(const weft_cloth_def *def, size_t particle, char *text,
                                size_t size);

/* ---- grid.c ---------------------------------------------------------------------- */

/* [m] The shortest edge at rest, diagonals aside. */
double weft__shortest_edge(const weft__mesh *mesh);

/* The edges and triangles that particle i owns: each has one owner. Both return their
 * number, 0 to 3 and 0 or 2. */
size_t weft__edges_of(const weft__mesh *mesh, size_t i, uint32_t edges[3][2]);
size_t weft__triangles_of(const weft__mesh *mesh, size_t i, uint32_t triangles[2][3]);

/* Particles of the whole cloth; its shape, with the number of blocks. */
static inline size_t weft__whole_particles(const weft__mesh *mesh)
{
    return mesh->triangles != NULL ? mesh->whole : mesh->band.rows * mesh->cols;
}
static inline size_t weft__width_of(const weft__mesh *mesh)
{
    return mesh->triangles != NULL ? mesh->whole : mesh->cols;
}

/* The number of particle i in the whole cloth. */
static inline size_t weft__whole_index(const weft__mesh *mesh, size_t i)
{
    return mesh->whole_of != NULL
               ? mesh->whole_of[i]
               : (mesh->band.first - mesh->band.above) * mesh->block + i;
}

/* ---- motion.c -------------------------------------------------------------------- */

weft__motion weft__motion_of(const double velocity[3], const double amplitude[3],
                             double frequency);

/* That of a pin without faults; rows: room for its path, WEFT__CURVE_WIDTH numbers for
 * each of its rows. */
weft__motion weft__pin_motion(const weft_pin *pin, double *rows);

/* Velocity [m/s], then acceleration [m/s^2]; `piece` of its path (track.h). */
void weft__motion_rate(const weft__motion *motion, double t, double piece,
                       double rate[6]);

/* x(t) - x0 [m] */
void weft__motion_offset(const weft__motion *motion, double t, double offset[3]);

/* Whether its numbers stay finite. */
bool weft__motion_usable(const weft__motion *motion);

/* After which a hash goes on. */
uint64_t weft__motion_hash(const weft__motion *motion, uint64_t hash);

/* Whether particle i is pinned, and its pin may move. */
static inline bool weft__pin_moves(const weft__mesh *mesh, size_t i)
{
    return mesh->pin[i] != 0 && mesh->motions[mesh->pin[i] - 1].moves;
}

/* The same as weft__motion_rate of pinned particle i. */
void weft__pin_rate(const weft__mesh *mesh, size_t i, double t, double piece,
                    double rate[6]);

/* Adds to three planes of velocities `factor` times what those of the pins jump by at t
 * from one piece to another: at the ends of natural splines. */
void weft__jump_pins(const weft__mesh *mesh, double t, const double piece[2],
                     double factor, double *v);

/* Whether the velocity of pinned particle i is set where a piece begins. */
static inline bool weft__pin_meets(const weft__mesh *mesh, size_t i)
{
    return mesh->motions[mesh->pin[i] - 1].path.count > 0;
}

/* Sets the velocities of the pins on tables, in three planes, to those of the piece
 * that begins at t: methods of order 1 and of several steps have the integral of an
 * acceleration that jumps with an error, which a rest would keep. */
void weft__meet_pins(const weft__mesh *mesh, double t, double piece, double *v);

/* Writes x' and v' of the pinned among particles [first, end) to six planes, which are
 * `stride` apart and begin with particle `first`. */
void weft__move_pins(const weft__mesh *mesh, double t, double piece, double *to,
                     size_t stride, size_t first, size_t end);
