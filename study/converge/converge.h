/* SPDX-License-Identifier: BSD-3-Clause */
/* converge.h -- weft converge: a scene on ever finer grids, and the order at which its
 * results converge. */
#pragma once

#include "program/cli.h"
#include "program/run/progress.h"

/* Those of this verb alone. */
typedef struct converge_options {
    const char *sizes;
    texts ats;
    bool clamp_midway;
    bool csv;
} converge_options;

static inline const converge_options *converge_own(const arguments *given)
{
    return given->own;
}

enum {
    CONVERGE_SIZES = 16,
    CONVERGE_LARGEST = 1000000,
    CONVERGE_QUANTITIES = 64,
    CONVERGE_NAME = 48
};

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

/* A column of series.csv, or a coordinate of a particle of the scene. */
typedef struct converge_quantity {
    char name[CONVERGE_NAME];
    bool particle;
    size_t place[2]; /* of it, for refine_line: row, column; of a mesh: vertex */
    size_t which;    /* the column, or 0, 1, 2: x, y, z */
} converge_quantity;

/* Of one size; shared by the processes. */
typedef struct converge_result {
    weft_error err;
    double values[CONVERGE_QUANTITIES]; /* NAN: the run failed */
} converge_result;

/* Places in a state, and what each counts: a particle, or a place in a triangle. */
typedef struct converge_probe {
    size_t particle[3];
    double share[3];
} converge_probe;

typedef struct converge_size {
    size_t size;
    double spacing;    /* [m] along the larger extent; of a mesh: of mean triangles */
    weft_scene *scene; /* of a mesh that is refined; NULL: the scene's own */
    weft_cloth *cloth;
    converge_probe probes[CONVERGE_QUANTITIES]; /* of the quantities that have one */
} converge_size;

typedef struct converge {
    const arguments *given;
    const weft_scene *scene;
    bool mesh; /* sizes divide edges; the grid is not used then */
    refinement grid;
    size_t quantity_count;
    converge_quantity quantities[CONVERGE_QUANTITIES];
    size_t count; /* of sizes */
    converge_size sizes[CONVERGE_SIZES];
    converge_result *results;
    size_t over; /* of sizes */
    int code;    /* EXIT_DONE, or of a run that failed */
    progress progress;
} converge;

/* ---- refine.c: the same grid with another number of particles. Extents, and the
 * places of pins and loads on the cloth, do not change ---- */

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

/* ---- the parts of the verb ---- */

/* converge_quantity.c: reads the options --at; returns the exit code. */
int converge_add_quantities(converge *self);

/* refine.c: the cloth of a size, and where its quantities are; returns the exit
 * code. */
int converge_open_mesh(converge *self, converge_size *to);

/* converge_write.c: the results to stdout. */
void converge_print(const converge *self, bool csv);
