/* SPDX-License-Identifier: BSD-3-Clause */
/* passage.h -- where the cloth enters a shape that is no mesh between its particles,
 * which alone touch it. */
#pragma once

#include "forces/contact/contact.h"
#include "mesh/triangles.h"

/* Whether a point between a and b has a gap < 0: exactly, but for the roundoff of the
 * gap. */
bool weft__edge_enters(const weft__pose *pose, const double a[3], const double b[3]);

/* The same of a triangle none of whose edges enters, and a shape that is no plane. */
bool weft__face_enters(const weft__pose *pose, double x[3][3]);

/* [m] How deep cloth between particles may lie in a shape before it passes through it:
 * a quarter of the thickness, by which triangles of edges sqrt(2 R thickness) lie below
 * the surface too, or of the radius or rounding R if that is less. */
double weft__shape_allows(const weft_contact_def *law, const weft__shape *shape);

/* For weft__force_checks. */
weft__passages weft__contact_passages(const void *own, const weft__state *at, size_t b,
                                      double rise);

/* [m] Half of how thick a sphere, capsule or box is where it is thinnest. */
double weft__shape_half(const weft_shape *shape);

/* [m] How far the middle of a chord of length a [m] lies below the surface that both of
 * its ends lie on: a^2 / (8 R) of a sphere or capsule. Of a box across an edge. */
double weft__shape_dip(const weft_shape *shape, double a);
