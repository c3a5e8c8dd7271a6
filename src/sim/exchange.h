/* SPDX-License-Identifier: BSD-3-Clause */
/* exchange.h -- what bands tell each other in an evaluation: v' of particles of
 * triangles; and, with contact of the cloth with itself, all their states. */
#pragma once

#include "cloth/model.h"
#include "weft/sim.h"

/* Of a cloth in bands with contact with itself: each band knows the whole cloth and
 * state, but lists only the pairs that its own particles may be in. */
typedef struct weft__gather {
    const weft_cloth *cloth; /* the whole; NULL: none */
    bool part;               /* not all pairs are listed */
    size_t first, own, here; /* own particles: the first of the whole, and here */
    double *y[2], *room;     /* states of the whole; what is sent, then received */
    weft_parcel *parcels;    /* one for each other band */
} weft__gather;

typedef struct weft__exchange {
    weft_parcel *parcels; /* by rank; NULL: a grid, or a whole cloth */
    size_t count, before; /* parcels; those of bands before this one */
    uint32_t *sent; /* own particles that are ghosts elsewhere, parcel by parcel */
    double *room;   /* what is sent, then what is received */
    size_t missing; /* particles for which the first ghost stands */
    bool *edge;     /* own blocks with particles that are sent */
    weft__gather gather;
} weft__exchange;

/* ---- gather.c: all of these also do without a gathering, as the cloth is then whole,
 * or has no such contact
 * ------------------------------------------------------------------ */

struct weft__forces;

/* Makes the gathering of a cloth in bands that needs one, and the list. `all`: its list
 * has all pairs, because powers, or events, are measured in each step. False: no
 * memory. */
bool weft__gather_create(struct weft__forces *forces, bool all);

static inline const weft_cloth *weft__gather_cloth(const weft__gather *of,
                                                   const weft_cloth *other)
{
    return of->cloth != NULL ? of->cloth : other;
}

/* The state of the whole that was gathered last as number k, for y. */
static inline const double *weft__gather_last(const weft__gather *of, const double *y,
                                              size_t k)
{
    return of->cloth != NULL ? of->y[k] : y;
}

/* Whether a state is finite, gathered as number 0 if it can be. */
bool weft__gather_finite(const struct weft__forces *forces, const double *y);

/* Collective: begins to gather the states of all bands; ends it, as number k. */
void weft__gather_begin(const struct weft__forces *forces, const double *y);
const double *weft__gather_end(const struct weft__forces *forces, const double *y,
                               size_t k);

/* Adds contact of the own particles with all, in the state gathered last as number 0.
 * Returns 1 if a number is not finite. */
int weft__gather_add(const struct weft__forces *forces, double *dvdt);

/* Collective: weft__measure_all of the whole. */
void weft__gather_measure(const struct weft__forces *forces, const weft__state *at,
                          weft_measures *sum);

/* Collective: weft__stiffness_sides of the own particles. */
void weft__gather_sides(const struct weft__forces *forces, double t, const double *y,
                        double most[WEFT__SIDES]);
