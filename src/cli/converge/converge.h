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
    CONVERGE_LARGEST = 100000,
    CONVERGE_QUANTITIES = 64,
    CONVERGE_NAME = 48
};

/* A column of series.csv, or a coordinate of a particle of the scene. */
typedef struct converge_quantity {
    char name[CONVERGE_NAME];
    bool particle;
    bool half[2];    /* row, column: the middle of the extent, */
    size_t index[2]; /* or this line */
    size_t which;    /* the column, or 0, 1, 2: x, y, z */
} converge_quantity;

/* Of one size; shared by the processes. */
typedef struct converge_result {
    weft_error err;
    bool done;
    double values[CONVERGE_QUANTITIES];
} converge_result;

typedef struct converge {
    const weft_scene *scene;
    refinement grid; /* of the scene */
    size_t quantity_count;
    converge_quantity quantities[CONVERGE_QUANTITIES];
    size_t count; /* of sizes */
    size_t size[CONVERGE_SIZES];
    refinement grids[CONVERGE_SIZES];
    weft_scene *scenes[CONVERGE_SIZES];
    converge_result *results;
    size_t over;
    progress progress;
} converge;

/* converge_quantity.c: reads the options --at; returns the exit code. */
int converge_add_quantities(converge *self, const options *given);
/* The particle of a quantity in a refined grid; false: there is none. */
bool converge_particle(const refinement *grid, const converge_quantity *one,
                       size_t *particle);

/* converge_write.c: the results to stdout. */
void converge_print(const converge *self);
void converge_csv(const converge *self);

#endif
