/* SPDX-License-Identifier: BSD-3-Clause */
/* exchange.h -- what bands tell each other in an evaluation: v' of particles of
 * triangles; and, with contact of the cloth with itself, all their states. */
#pragma once

#include "cloth/model.h"
#include "weft/sim.h"

/* Of a cloth in bands with contact with itself: each band knows the whole cloth and
 * state, but lists only the pairs that its own particles may be in. */
typedef struct weft__joint {
    const weft_cloth *cloth; /* the whole; NULL: none */
    bool part;               /* not all pairs are listed */
    size_t first, own, here; /* own particles: the first of the whole, and here */
    double *y[2], *room;     /* states of the whole; what is sent, then received */
    weft_parcel *parcels;    /* one for each other band */
} weft__joint;

typedef struct weft__exchange {
    weft_parcel *parcels; /* by rank; NULL: a grid, or a whole cloth */
    size_t count, before; /* parcels; those of bands before this one */
    uint32_t *sent; /* own particles that are ghosts elsewhere, parcel by parcel */
    double *room;   /* what is sent, then what is received */
    size_t missing; /* particles for which the first ghost stands */
    bool *edge;     /* own blocks with particles that are sent */
    weft__joint joint;
} weft__exchange;

/* ---- joint.c: all of these also do without a joint, as the cloth is then whole, or
 * has no such contact
 * ------------------------------------------------------------------ */

struct weft__forces;

/* Makes the joint of a cloth in bands that needs one, and the list. `all`: its list has
 * all pairs, because powers, or events, are measured in each step. False: no memory. */
bool weft__joint_create(struct weft__forces *forces, bool all);

static inline const weft_cloth *weft__joint_cloth(const weft__joint *of,
                                                  const weft_cloth *other)
{
    return of->cloth != NULL ? of->cloth : other;
}

/* The state of the whole that was joined last as number k, for y. */
static inline const double *weft__joint_last(const weft__joint *of, const double *y,
                                             size_t k)
{
    return of->cloth != NULL ? of->y[k] : y;
}

/* Whether a state is finite, joined as number 0 if it can be. */
bool weft__joint_finite(const struct weft__forces *forces, const double *y);

/* Collective: begins to join the states of all bands; ends it, as number k. */
void weft__joint_begin(const struct weft__forces *forces, const double *y);
const double *weft__joint_end(const struct weft__forces *forces, const double *y,
                              size_t k);

/* Adds contact of the own particles with all, in the state joined last as number 0.
 * Returns 1 if a number is not finite. */
int weft__joint_add(const struct weft__forces *forces, double *dvdt);

/* Collective: weft__measure_all of the whole. */
void weft__joint_measure(const struct weft__forces *forces, const weft__state *at,
                         weft_measures *sum);

/* Collective: weft__stiffness_sides of the own particles. */
void weft__joint_sides(const struct weft__forces *forces, double t, const double *y,
                       double most[WEFT__SIDES]);
