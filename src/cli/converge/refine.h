/* SPDX-License-Identifier: BSD-3-Clause */
/* refine.h -- the same cloth with another number of particles, as overrides of its
 * scene. Extents, and the places of pins and loads on the cloth, do not change. */
#ifndef WEFT_CLI_CONVERGE_REFINE_H
#define WEFT_CLI_CONVERGE_REFINE_H

#include "weft/scene.h"

/* The rows of a grid, or its columns. */
typedef struct refine_axis {
    size_t count;   /* of lines in the scene */
    size_t refined; /* and in the refined one */
    bool clamp[2];  /* the cloth begins, or ends, midway between two lines */
} refine_axis;

typedef struct refinement {
    const weft_cloth_def *cloth; /* of the scene */
    refine_axis axis[2];         /* rows, columns */
    size_t along;                /* the axis of the larger extent */
} refinement;

enum { REFINE_SETS = 6, REFINE_PLACE = 64 };

void refine_begin(refinement *self, const weft_cloth_def *cloth);

/* Counts extents from midway between the first two lines, or the last two, where pins
 * hold these two lines entirely and not the third. False: there are none. */
bool refine_clamp(refinement *self);

/* Puts `size` particles along the larger extent. False: writes to `what` the thing that
 * has no place on that grid. */
bool refine_to(refinement *self, size_t size, char what[REFINE_PLACE]);

/* The line of the refined grid at line i of the scene's, or, with `half`, in the middle
 * of the extent; false: there is none. */
bool refine_line(const refine_axis *axis, size_t i, bool half, size_t *out);

/* [m] between the lines of an axis of the refined grid. */
double refine_spacing(const refinement *self, size_t axis);

/* REFINE_SETS overrides "key.path=value" of the scene, one after another, each with a
 * zero at its end. The caller frees them. NULL: no memory. */
char *refine_sets(const refinement *self);

#endif
