/* SPDX-License-Identifier: BSD-3-Clause */
/* refine.h -- the same cloth with another number of particles. Extents, and the places
 * of pins and loads on the cloth, do not change. */
#ifndef WEFT_CLI_CONVERGE_REFINE_H
#define WEFT_CLI_CONVERGE_REFINE_H

#include "weft/scene.h"

/* The rows of a grid, or its columns. */
typedef struct refine_axis {
    size_t count;   /* of lines in the scene */
    size_t refined; /* and in the refined cloth */
    bool clamp;     /* the cloth begins midway between the first two lines */
} refine_axis;

typedef struct refinement {
    const weft_cloth_def *from; /* the scene's cloth */
    const weft_fabric *fabric;  /* NULL: none */
    weft_cloth_def cloth;       /* the refined one, with these: */
    weft_pin *pins;
    weft_load *loads;
    refine_axis axis[2]; /* rows, columns */
    size_t along;        /* the axis of the larger extent */
} refinement;

/* Begins with the scene's own size. End it also after an error. */
weft_status refine_begin(refinement *self, const weft_scene *scene, weft_error *err);
void refine_end(refinement *self);

/* Counts extents from midway between the first two rows, or columns, where pins hold
 * these two entirely and not the third. False: there are none. */
bool refine_clamp(refinement *self);

/* Puts `size` particles along the larger extent. WEFT_INVALID names what has no place
 * on that grid. */
weft_status refine_to(refinement *self, size_t size, weft_error *err);

/* The line of the refined grid at a place: twice a line of the scene's, so that odd
 * places are midway between two; false: there is none. */
bool refine_line(const refine_axis *axis, size_t place, size_t *line);

#endif
