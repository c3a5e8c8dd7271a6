/* SPDX-License-Identifier: BSD-3-Clause */
/* delaunay.h -- the Delaunay triangulation of points in the plane. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define CUT_NONE UINT32_MAX

/* The three corners of each triangle, of malloc; at: u v of each point. NULL: no
 * memory, or all points lie on a line. */
uint32_t *cut_delaunay(size_t points, double *at, size_t *triangles);
