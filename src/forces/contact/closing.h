/* SPDX-License-Identifier: BSD-3-Clause */
/* closing.h -- whether two shapes close on a cloth: contact can hold a particle off
 * each of them, but not off both once their surfaces meet. */
#pragma once

#include "forces/contact/contact.h"

/* Particles of the cloth, by number. */
typedef void weft__place_fn(const void *ctx, size_t i, double x[3]);

typedef struct weft__closing_search {
    const weft__shape *shapes;      /* those of triangles have no gap */
    size_t shape_count, first, end; /* of particles */
    weft__place_fn *place;
    const void *ctx;
    double thickness;
    double within;    /* [m] for pairs whose surfaces are nearer than this now */
    double t, t_last; /* [s] now, and the last time looked at; INFINITY: a few times as
                         far as the present speed leads */
} weft__closing_search;

/* The first two by number. */
weft__closing weft__shapes_closing(const weft__closing_search *of);
