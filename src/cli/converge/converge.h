/* SPDX-License-Identifier: BSD-3-Clause */
/* converge.h -- weft converge: a scene on ever finer grids, and the order at which its
 * results converge. */
#ifndef WEFT_CLI_CONVERGE_CONVERGE_H
#define WEFT_CLI_CONVERGE_CONVERGE_H

#include "cli/cli.h"
#include "cli/converge/refine.h"
#include "cli/run/progress.h"

enum {
    CONVERGE_SIZES = 16,
    CONVERGE_LARGEST = 1000000,
    CONVERGE_QUANTITIES = 64,
    CONVERGE_NAME = 48
};

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

/* converge_quantity.c: reads the options --at; returns the exit code. */
int converge_add_quantities(converge *self);

/* converge_mesh.c: the cloth of a size, and where its quantities are; returns the exit
 * code. */
int converge_open_mesh(converge *self, converge_size *to);

/* converge_write.c: the results to stdout. */
void converge_print(const converge *self, bool csv);

#endif
