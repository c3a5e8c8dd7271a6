/* SPDX-License-Identifier: BSD-3-Clause */
/* force.h -- what a force is to the rest of weft. Each is a folder src/forces/NAME with
 * a type weft__NAME, its part of a cloth, which begins with the mesh; a weft__force
 * weft__NAME_force; and its law, plain and fast. Sums over forces are taken in the
 * order of WEFT_FORCES (cloth/table.h), which is part of the result. */
#pragma once

#include "forces/force_checks.h"
#include "forces/roles.h"

/* The force itself. The first of the table starts a sum, the others add to it.
 * `change`: the derivative of add along at->along; for a linear force this is add
 * itself. `transposed`: its transpose, of the whole cloth; for a linear force this is
 * add with respect to x and to v apart, and of springs, weight and air that of the
 * springs. `swept`: the sweep over springs computes it too, also in products.
 * `piece`: narrows *to to the rows and keys of its tables next to t (mesh/track.h). */
typedef struct weft__force_law {
    bool linear, swept;
    weft__start_fn *start;
    weft__add_fn *add, *change;
    weft__transposed_fn *transposed;
    void (*piece)(const void *own, double t, weft__piece_bounds *to);
} weft__force_law;

typedef struct weft__force {
    const char *name;
    weft__force_tables tables;
    weft__force_grids grids;
    weft__force_changes changes;

    /* Whether a cloth has it, else all below is left out; NULL: always. */
    bool (*present)(const void *own);

    weft__force_law law;
    weft__force_measures measures;
    weft__force_bounds bounds;
    weft__force_couplings couplings;
    weft__force_space space;
    weft__force_whole whole;
    weft__force_checks checks;
} weft__force;
