/* SPDX-License-Identifier: BSD-3-Clause */
/* self_list.h -- the pairs of primitives of a cloth that are near each other, kept
 * while the cloth moves little. The list saves time alone: results have the bits that
 * cloth/self.h has without one, on any number of threads. */
#ifndef WEFT_FORCES_SELF_SELF_LIST_H
#define WEFT_FORCES_SELF_SELF_LIST_H

#include "base/team.h"
#include "forces/contact/passage.h"
#include "forces/self/self.h"

typedef struct weft__self_list weft__self_list;

/* team NULL: one thread. NULL: no memory. */
weft__self_list *weft__self_list_create(const weft__self *own, weft__team *team,
                                        const weft_allocator *memory);
void weft__self_list_destroy(weft__self_list *list); /* NULL is allowed */

/* For tests: the skin [m], how far beyond the thickness pairs are listed; a quarter of
 * the smaller spacing at first. */
void weft__self_list_set_skin(weft__self_list *list, double skin);

/* Makes room for the pairs that were too many since the last call: a list grows here
 * alone, between steps, and is done without until then. */
weft_status weft__self_list_grow(weft__self_list *list, weft_error *err);

/* As weft__self_add and weft__self_measure. */
int weft__self_list_add(weft__self_list *list, const weft__state *at, double *to);
void weft__self_list_measure(weft__self_list *list, const weft__state *at,
                             weft_measures *sum);

/* Whether all pairs are clear in a step or displacement, else the first that is not and
 * its gap [m] at the end. */
bool weft__self_list_clear(weft__self_list *list, const weft__stride *stride,
                           weft_primitive pair[2], double *gap);

/* Shortens displacements from y0 until they are clear: those of particles in pairs that
 * are not are halved, all six numbers. */
void weft__self_list_hold(weft__self_list *list, const double *y0, double *y1);

#endif
