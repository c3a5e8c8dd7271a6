/* SPDX-License-Identifier: BSD-3-Clause */
/* step_check.h -- no free particle gets into a shape or through it, and no part of the
 * cloth through another: what the forces check (forces/force_checks.h), on the threads
 * of a simulation. The functions look at the own rows of a band. */
#pragma once

#include "sim/forces.h"

/* On the threads; allocates nothing. */
bool weft__path_clear(const weft__forces *forces, const weft__path *path);

/* The first by particles, then shapes, for which a path is not clear, else the first
 * pair of primitives. */
weft__penetration weft__path_penetration(const weft__forces *forces,
                                         const weft__path *path);

/* The particle deepest in a shape: gap <= 0. A state that is not finite has none. */
weft__penetration weft__state_penetration(const weft_cloth *cloth, double t,
                                          const double *y);

/* That, else two primitives at the same place. */
weft__penetration weft__rhs_penetration(const weft__forces *forces, double t,
                                        const double *y);

/* Of one particle, free or not. */
weft__penetration weft__particle_penetration(const weft_cloth *cloth, double t,
                                             const double *y, size_t i);

/* Halves each particle's displacement from `from` to y until its straight path cannot
 * enter or cross a shape, nor the cloth itself. */
void weft__hold_back(const weft__forces *forces, double t, const double *from,
                     double *y);

/* "particle (3, 4) and shapes[1]", or both primitives, of the whole; returns text. */
enum { WEFT__PENETRATION_TEXT = 160 };
const char *weft__penetration_text(const weft__mesh *mesh,
                                   const weft__penetration *penetration,
                                   char text[WEFT__PENETRATION_TEXT]);

/* "particle (3, 4) is 2 mm inside shapes[1]", of the present or `would be`. */
weft_status weft__penetration_error(const weft_cloth *cloth,
                                    const weft__penetration *penetration,
                                    const char *what, weft_error *err);
