/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_bounds.h -- what contact adds to the stiffness and damping of a particle;
 * derived in docs/physics.md. */
#ifndef WEFT_FORCES_CONTACT_CONTACT_BOUNDS_H
#define WEFT_FORCES_CONTACT_CONTACT_BOUNDS_H

#include "forces/bounds.h"
#include "forces/contact/contact.h"

/* In a state; at->y NULL: of any free particle that touches one shape at a time, with a
 * kinetic energy relative to it and a contact energy that together are at most m
 * stopping_speed^2 / 2. */
void weft__contact_grip(const void *own, const weft__state *at, size_t first,
                        size_t count, weft__grip *grips);

/* Without mass and without what turning normals and the coupling of friction to
 * pressure add. */
void weft__contact_multiply(const void *own, const weft__state *at, double a, double b,
                            const double *x, double *out);

/* Adds to *most, number by number, the largest of layers, `share` of the law, with
 * phi(s) up to `phi`. */
void weft__grip_most(const weft_contact_def *law, const weft__pose *pose, double share,
                     double phi, weft__grip *most);

#endif
