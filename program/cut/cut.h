/* SPDX-License-Identifier: BSD-3-Clause */
/* cut.h -- the mesher of cloth.cut: points inside an outline and its holes, and the
 * triangles between them. Part of the program, not of libweft. */
#pragma once

#include "weft/scene.h"

/* As weft_scene_def.mesh_cut; ctx is not used. Errors: WEFT_NO_MEMORY, WEFT_BAD_SCENE.
 */
weft_status cut_mesh(void *ctx, const weft_cut *cut, weft_cut_mesh *out,
                     weft_error *err);

#define CUT_NONE UINT32_MAX

/* delaunay.c: the three corners of each triangle, of malloc; at: u v of each point.
 * NULL: no memory, or all points lie on a line. */
uint32_t *cut_delaunay(size_t points, double *at, size_t *triangles);
