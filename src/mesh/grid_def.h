/* SPDX-License-Identifier: BSD-3-Clause */
/* grid_def.h -- rows and columns: the numbers of a grid, its pins and loads, their
 * checks, and what lies on its rim. */
#pragma once

#include "mesh/mesh.h"

WEFT__NUMBERS(weft__grid_numbers, rows, cols, spacing, origin, scale, mass, density,
              velocity);
WEFT__NUMBERS(weft__pin_numbers, velocity, amplitude, frequency);
extern const weft__number weft__load_mass;

/* Whether a definition is one of some of the rows or blocks of its cloth. */
static inline bool weft__is_band(const weft_cloth_def *def)
{
    return def->band_rows > 0 && def->band_rows < weft_cloth_def_blocks(def);
}

/* [m] `length` in a direction of `count` rows or columns; a single one counts as 1 m
 * wide. */
static inline double weft__width(size_t count, double length)
{
    return count > 1 ? length : 1.0;
}

/* Whether three particles of a row or column of `count` are centred at `at`. */
static inline bool weft__inner(size_t at, size_t count)
{
    return at > 0 && at + 1 < count;
}

/* The part of its stiffness, or width, that a strip of cloth has at the rim. */
static inline double weft__strip(size_t at, size_t count)
{
    return count == 1 || weft__inner(at, count) ? 1.0 : 0.5;
}

/* The size and plain values of a definition, directions made unit. */
void weft__grid_init(weft__mesh *mesh, const weft_cloth_def *def);

/* Masses, loads and pins. */
void weft__grid_fill(weft__mesh *mesh, const weft_cloth_def *def);

void weft__grid_rest(const weft__mesh *mesh, size_t i, double x[3]);
void weft__grid_start(const weft__mesh *mesh, size_t i, double x[3]);
double weft__grid_area(const weft__mesh *mesh, size_t i);

/* Checks the grid; compares neighbours in grids of up to `most` particles. Returns
 * false if the size is wrong. */
bool weft__grid_check(const weft_cloth_def *def, size_t most, const weft__faults *to);

void weft__ranges_check(const weft_cloth_def *def, const weft__faults *to,
                        const char *what, size_t index, weft_range rows,
                        weft_range cols);

/* As weft__pin_of. */
size_t weft__grid_pin_of(const weft_cloth_def *def, size_t r, size_t c);

/* A range of def with negative ends resolved; false if it leaves [0, count). */
bool weft__range_resolve(weft_range range, size_t count, size_t *first, size_t *last);
