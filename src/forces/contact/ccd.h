/* SPDX-License-Identifier: BSD-3-Clause */
/* ccd.h -- continuous collision detection: whether a step leads a free particle into a
 * shape or through it.
 *
 * A step of h from gap d0 to d1 is clear if, for every free particle and shape,
 *
 *     d1 > 0  and  h (max(|v0 - V0|, |v1 - V1|) + w), |r1 - r0| < d0 + d1
 *
 * with r the place beside the shape's, so that a particle that is slow at both ends and
 * fast between them is seen, V the velocity of the surface, with or without its spin,
 * whichever gives the larger speed, and w the speed that an oscillation adds between
 * the ends; docs/physics.md. */
#ifndef WEFT_FORCES_CONTACT_CCD_H
#define WEFT_FORCES_CONTACT_CCD_H

#include "forces/contact/shapes.h"

/* From one state to another. */
typedef struct weft__path {
    double t0, t1; /* [s] */
    const double *y0, *y1;
} weft__path;

/* A shape at both ends of a path. */
typedef struct weft__ccd {
    double h;       /* [s] */
    double between; /* [m/s] beyond what its velocity is at the ends */
    double fastest; /* [m/s] of its velocity, without spin */
    double shift;   /* [m] its way */
    bool spins;
    weft__pose pose[2];
} weft__ccd;

weft__ccd weft__ccd_of(const weft__shape *shape, const weft__path *path);

/* Of particle i of n; gap: [m] at the end. */
bool weft__ccd_clear(const weft__ccd *of, const weft__path *path, size_t n, size_t i,
                     double *gap);

/* Whether a path of blocks [first, end) is clear of all shapes. */
struct weft__contact;
typedef bool weft__clear_fn(const struct weft__contact *own, const weft__path *path,
                            size_t first, size_t end);
WEFT_FORMS(weft__clear_fn, clear);

typedef struct weft__contact {
    const weft__mesh *mesh;
    weft_contact_def law; /* as defined, without the shapes */
    weft__shape *shapes;  /* shape_count of them; a copy has its own */
    size_t shape_count;
    weft__add_fn *fast;
    weft__clear_fn *clear;
} weft__contact;

#endif
