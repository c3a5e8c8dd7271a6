/* SPDX-License-Identifier: BSD-3-Clause */
/* shape_mesh.h -- the shapes of a recorded run, from its scene.yaml, and their
 * surfaces. */
#ifndef WEFT_RECORD_SHAPE_MESH_H
#define WEFT_RECORD_SHAPE_MESH_H

#include "record/export/export.h"

/* DIR/scene.yaml, without the checks that need a plugin; NULL if it cannot be read: a
 * page or an export then has no shapes. */
weft_scene *record_scene(const char *directory);

enum { RECORD_SHAPE_ROWS = 25, RECORD_SHAPE_COLS = 49 };

/* The surface of shape k at time t [s], a grid that is closed at its poles and its
 * seam; of a plane a square near the cloth. Its points are in position[3 ROWS COLS]. */
record_surface record_shape_surface(const weft_cloth_def *cloth, size_t k, double t,
                                    double *position);

#endif
