/* SPDX-License-Identifier: BSD-3-Clause */
/* model.h -- the data of a cloth, for the files of src/cloth, and the checks of
 * definitions, for src/scene too.
 *
 * Springs are implicit: a family has two groups, one for each direction, and the
 * springs of a group differ only in their first particle. Nothing is stored per spring.
 */
#ifndef WEFT_CLOTH_MODEL_H
#define WEFT_CLOTH_MODEL_H

#include <float.h>
#include <math.h>

#include "base/faults.h"
#include "weft/cloth.h"

#if SIZE_MAX < UINT64_MAX || DBL_MANT_DIG != 53 || FLT_EVAL_METHOD != 0                \
    || __FINITE_MATH_ONLY__
#error "weft needs a 64-bit target with IEEE double arithmetic: \
no -m32, -mfpmath=387 or -ffast-math"
#elif defined __GNUC__ && !defined __clang__ && __GNUC__ < 12
#error "weft needs gcc 12 or later, or clang, for __builtin_shufflevector"
#endif

/* All springs that join particle (r, c) to (r + down, c + right): r below end_row,
 * c from first_col to below end_col. */
typedef struct weft__group {
    weft_family family;
    unsigned way; /* which of the directions of springs.c */
    size_t end_row, first_col, end_col;
    ptrdiff_t stride;   /* index of the far end minus that of the near one */
    double rest_length; /* [m] */
    double stiffness;   /* [N/m]; under the strain law k / s */
    double damping;     /* [kg/s] */
    bool half_rim;      /* those along the rim carry half of both */
} weft__group;

#define WEFT_GROUPS (2 * WEFT_FAMILIES)

/* Bending rigidity (bending.c), all 0 without. */
typedef struct weft__rigidity {
    double along, across; /* [N/m] of three particles along a column, along a row */
    double twist;         /* [N/m] of a cell */
    double damping;       /* [s] */
    bool present;
} weft__rigidity;

/* How far beyond the last particle kernels may read. */
#define WEFT_PAST 16

/* x(t) = x0 + velocity (t - since) + amplitude sin(2 pi frequency t) */
typedef struct weft__motion {
    double velocity[3];  /* [m/s] */
    double amplitude[3]; /* [m] */
    double frequency;    /* [Hz] */
    double omega;        /* [rad/s] 2 pi frequency */
    double since;        /* [s] 0 as defined */
    bool moves;
    bool coasts; /* instead: each particle keeps its velocity in `coast` */
} weft__motion;

/* A rigid shape: what is defined and what follows from it (shapes.h). */
typedef struct weft__shape {
    weft_shape def;
    weft__motion motion;
    double axis[3];  /* unit: a plane's normal, from end to end of a capsule */
    double spin[3];  /* [rad/s] of a plane and a capsule exactly along the axis */
    double length;   /* [m] of a capsule's axis */
    double friction; /* >= 0 */
} weft__shape;

typedef struct weft__level weft__level; /* levels.h */

struct weft_cloth {
    size_t rows, cols, particles, pinned;
    size_t pin_changes; /* how often `pinned` was counted */
    weft_band band;     /* which rows of the whole these are */
    double spacing[2], origin[3], right[3], down[3], scale; /* right, down: unit */
    double velocity[3];
    double gravity[3], drag, wind_velocity[3], wind_drag;
    size_t group_count; /* groups that have springs */
    weft__group groups[WEFT_GROUPS];
    weft__rigidity rigidity;
    double *mass;         /* [kg] N of them */
    double *inverse_mass; /* [1/kg] N, 0 of the pinned, and WEFT_PAST more */
    uint32_t *pin;        /* N: 0 free, else 1 + index into motions */
    size_t *pins;         /* the pinned, in order */
    const weft__level *level;
    const uint32_t *defined_pin; /* of a copy (pins.h): the model's pin */
    double *coast;               /* [m/s] of a copy: 3 N, x y z of each that coasts */
    weft__motion *motions;       /* motion_count of them, and one that coasts */
    size_t motion_count;
    weft_contact_def contact; /* as defined, without the shapes */
    weft__shape *shapes;      /* shape_count of them; a copy has its own */
    size_t shape_count;
    weft_allocator memory;
};

/* springs.c: a group in one of WEFT_GROUPS ways, but for its law; false: the grid is
 * too small. */
bool weft__group_init(const weft_cloth *cloth, size_t way, weft__group *group);

/* springs.c: fill cloth->groups from the definition. */
void weft__groups_init(weft_cloth *cloth, const weft_cloth_def *def);

/* cloth.c: the rows, columns and plain values of a definition, directions made unit. */
void weft__grid_init(weft_cloth *cloth, const weft_cloth_def *def);

/* validate.c: the numbers of definitions. */
WEFT__NUMBERS(weft__cloth_numbers, rows, cols, spacing, origin, scale, mass, density,
              velocity, gravity, drag, wind_velocity, wind_drag, law);
WEFT__NUMBERS(weft__spring_numbers, stiffness, damping);
WEFT__NUMBERS(weft__bending_numbers, rigidity, twist, damping);
WEFT__NUMBERS(weft__pin_numbers, velocity, amplitude, frequency);
WEFT__NUMBERS(weft__contact_numbers, thickness, stopping_speed, exponent, damping,
              friction, slip, law);
WEFT__NUMBERS(weft__shape_numbers, kind, at, velocity, amplitude, frequency, spin);
WEFT__NUMBERS(weft__limit_numbers, method, solver, strain, sweeps, tolerance);
WEFT__NUMBERS(weft__fabric_numbers, density, stretch, shear, bend, twist,
              damping); /* fabric.c */
extern const weft__number weft__load_mass;
extern const weft__number weft__shape_radius;   /* of a sphere or capsule */
extern const weft__number weft__shape_rounding; /* of a box */

/* Reports every fault of a definition; a field may be an offset in a part of it. */
void weft__cloth_def_check(const weft_cloth_def *def, const weft__faults *to);

/* The same for a strain limit that has a method. */
void weft__limit_check(const weft_limit_def *def, const weft__faults *to);

/* Checks the grid and all numbers of a cloth; compares neighbours in grids of up to
 * `most` particles. Returns false if the size is wrong. */
bool weft__grid_check(const weft_cloth_def *def, size_t most, const weft__faults *to);

/* Of contact, but not of its shapes. */
void weft__contact_check(const weft_contact_def *law, const weft__faults *to);

/* That the thickness suits contact of the cloth with itself, if it has that. */
void weft__self_check(const weft_cloth_def *def, const weft__faults *to);

/* Of one shape, number `index`: the fields are offsets in weft_shape. */
bool weft__shape_check(const weft_shape *shape, size_t index, const weft__faults *to);

/* Whether no free particle starts inside a shape without faults; else which one, and
 * how deep. */
bool weft__start_check(const weft_cloth_def *def, size_t shape, char *text,
                       size_t size);

/* cloth.c: WEFT_INVALID if a cloth with contact.self passes through itself at t = 0; or
 * WEFT_NO_MEMORY. */
weft_status weft__start_crossing_error(const weft_cloth *cloth, weft_error *err);

/* 1 + the number of the pin that holds particle (r, c); 0: it is free. */
size_t weft__pin_of(const weft_cloth_def *def, size_t r, size_t c);

/* A range of def with negative ends resolved; false if it leaves [0, count). */
bool weft__range_resolve(weft_range range, size_t count, size_t *first, size_t *last);

static inline double weft__dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double weft__length(const double a[3])
{
    return sqrt(weft__dot(a, a));
}

/* The number of particle i in the whole cloth. */
static inline size_t weft__whole_index(const weft_cloth *band, size_t i)
{
    return (band->band.first - band->band.above) * band->cols + i;
}

/* [m] The shorter side of a cell; of a chain its spacing. */
static inline double weft__smaller_spacing(size_t rows, size_t cols,
                                           const double spacing[2])
{
    return rows == 1   ? spacing[1]
           : cols == 1 ? spacing[0]
                       : fmin(spacing[0], spacing[1]);
}

/* Rest position [m] of particle (r, c). */
void weft__rest_position(const weft_cloth *cloth, size_t r, size_t c, double x[3]);

/* Position [m] at t = 0. */
void weft__start_position(const weft_cloth *cloth, size_t r, size_t c, double x[3]);

/* [m] `length` in a direction of `count` rows or columns; a single one counts as 1 m
 * wide. */
static inline double weft__width(size_t count, double length)
{
    return count > 1 ? length : 1.0;
}

/* Lumped area [m^2] of particle (r, c): halved on each edge it lies on. */
double weft__area(const weft_cloth *cloth, size_t r, size_t c);

/* bounds.c: weft_cloth_stiffness in two parts: bounds in several directions, each the
 * largest of the own particles; the polygon within them. */
enum { WEFT__SIDES = 3 + 3 * (WEFT_GROUPS + 1) };
void weft__stiffness_sides(const weft_cloth *cloth, double t, const double *y,
                           double most[WEFT__SIDES]);
weft_stiffness weft__stiffness_within(const weft_cloth *cloth, const double *y,
                                      const double most[WEFT__SIDES]);

/* cloth.c: [kg] of row r. */
double weft__row_mass(const weft_cloth *cloth, size_t r);

/* prescribed.c: the motion of pins and shapes. */
weft__motion weft__motion_of(const double velocity[3], const double amplitude[3],
                             double frequency);

/* Velocity [m/s], then acceleration [m/s^2]. */
void weft__motion_rate(const weft__motion *motion, double t, double rate[6]);

/* x(t) - x0 [m] */
void weft__motion_offset(const weft__motion *motion, double t, double offset[3]);

/* rhs.c: the same of pinned particle i. */
void weft__pin_rate(const weft_cloth *cloth, size_t i, double t, double rate[6]);

#endif
