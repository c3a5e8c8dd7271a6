/* SPDX-License-Identifier: BSD-3-Clause */
/* grids.h -- parts of a cloth that are grids, among others of triangles. */
#pragma once

#include "base/hash.h"
#include "cloth/model.h"

/* The definition of part k of a mesh, which is a grid, with what its forces have of the
 * whole: without pins, loads and contact. */
weft_cloth_def weft__grid_def_of(const weft_cloth_def *whole, size_t k);

/* Makes those of a definition, when the whole has its masses and pins; false: no
 * memory. Then the pointers to what they share with the whole, which has a copy of its
 * own or moved; the forms of its instruction set; and the grids of a copy. */
bool weft__grids_init(weft_cloth *whole, const weft_cloth_def *def);
void weft__grids_attach(weft_cloth *whole);
void weft__grids_choose(weft_cloth *whole);
bool weft__grids_copy(weft_cloth *copy);

/* As weft__sum_blocks, instead of what is there of their particles. */
weft__sum_fn weft__grids_sum;

/* The rows of grids that begin in block b of the whole, one after the other; begin with
 * zeros. */
typedef struct weft__grid_row {
    const weft_cloth *cloth; /* and the row's grid, its row, the state of it */
    size_t grid, row;
    weft__state at;
    bool begun;
} weft__grid_row;
bool weft__grids_next(const weft_cloth *whole, const weft__state *at, size_t b,
                      weft__grid_row *row);

/* Adds what the grids' own forces give to a weft__measure_fn of block b. */
typedef enum weft__grid_part {
    WEFT__GRID_ENERGY,
    WEFT__GRID_POWER,
    WEFT__GRID_WORST
} weft__grid_part;
void weft__grids_measure(const weft_cloth *whole, const weft__state *at, size_t b,
                         weft__grid_part what, weft_measures *sum);

uint64_t weft__grids_hash(const weft_cloth *whole, uint64_t hash);

/* The grid that has particle i; NULL: none. */
const weft_cloth *weft__grids_at(const weft_cloth *whole, size_t i);
