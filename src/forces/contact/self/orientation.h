/* SPDX-License-Identifier: BSD-3-Clause */
/* orientation.h -- on which side of a plane a point lies, exactly, and what segments
 * and triangles have in common as decided by it. */
#pragma once

/* The sign of det(a - d, b - d, c - d): > 0 if d is below the plane of a, b, c, which
 * are counterclockwise from above; 0 if all four lie in one plane. Exact while products
 * of three coordinate differences, to their last bits, are within the range of doubles:
 * for coordinates that are multiples of 2^-300 below 2^300. Points must be finite.
 *
 * A double decides where it is beyond its error bound, else an expansion, a sum of
 * doubles without rounding: J. R. Shewchuk, Adaptive Precision Floating-Point
 * Arithmetic and Fast Robust Geometric Predicates, Discrete & Computational Geometry
 * 18, 1997. */
int weft__orientation(const double a[3], const double b[3], const double c[3],
                      const double d[3]);

/* What two closed sets share: a segment p q and a triangle or a segment, whatever their
 * shapes. */
typedef enum weft__meeting {
    WEFT__APART,
    WEFT__TOUCH, /* a side or an end of one of them, or a part of a plane or line */
    WEFT__PIERCE /* a point inside both, from one side of the triangle to the other */
} weft__meeting;

weft__meeting weft__segment_triangle(const double p[3], const double q[3],
                                     const double a[3], const double b[3],
                                     const double c[3]);

/* Whether they touch; they never pierce. */
weft__meeting weft__segment_segment(const double p[3], const double q[3],
                                    const double a[3], const double b[3]);
