/* SPDX-License-Identifier: BSD-3-Clause */
/* moving_grid.h -- a cloth of a grid on which everything moves. */
#pragma once

#include "support.h"

/* All that an evaluation of a grid can have whose forces act within two rows: drag, and
 * besides 0, 1 or 2 pins (a column, and a particle on a path) and these. RIGID: a
 * rigidity instead of bend springs, and rims that carry half. */
enum {
    GRID_WIND = 4,
    GRID_SHAPES = 8,
    GRID_RIGID = 16,
    GRID_BARE = 32,
    GRID_UNDAMPED = 64,
    GRID_FULL = 2 + GRID_WIND + GRID_SHAPES
};

static inline weft_cloth *moving_grid(size_t rows, size_t cols, unsigned with)
{
    static const double path[] = { 0, 0, 0, 0, 0.01, 0, 0.001, 0 };
    static const double gust[] = { 0, 0, 0, 1, 0.02, 0, 0, 5 };
    static const weft_pin pins[] = { { .cols = { 0, 0 }, .rows = { 0, -1 } },
                                     { .rows = { -1, -1 },
                                       .cols = { -1, -1 },
                                       .velocity = { 0, 0, 1 },
                                       .amplitude = { 0.001, 0, 0 },
                                       .frequency = 5.0,
                                       .path = { path, 2 } } };
    weft_cloth_def def = weft_cloth_def_default();
    weft_shape shapes[]
        = { weft_shape_default(WEFT_PLANE), weft_shape_default(WEFT_SPHERE) };
    def.rows = rows, def.cols = cols;
    def.spacing[0] = def.spacing[1] = 0.01;
    def.scale = 1.02;
    def.pins = pins;
    def.pin_count = with % 4;
    def.damping = 1e-5;
    def.wind_drag = (with & GRID_WIND) != 0 ? 0.5 : 0.0;
    def.wind_table = (weft_table){ gust, 2 };
    shapes[0].normal[1] = 0.0, shapes[0].normal[2] = 1.0, shapes[0].at[2] = -3e-3;
    shapes[0].velocity[2] = 0.1, shapes[0].spin[2] = 1.0;
    shapes[1].at[0] = 0.3, shapes[1].at[1] = -0.3, shapes[1].at[2] = 0.104;
    shapes[1].radius = 0.1, shapes[1].velocity[0] = 0.5;
    def.contact.shapes = shapes;
    def.contact.shape_count = (with & GRID_SHAPES) != 0 ? 2 : 0;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f]
            = (weft_spring_def){ .present = (with & GRID_BARE) == 0,
                                 .stiffness = 20.0,
                                 .damping = (with & GRID_UNDAMPED) != 0 ? 0.0 : 0.001 };
    }
    if ((with & GRID_RIGID) != 0) {
        def.springs[WEFT_BEND].present = false;
        def.across[WEFT_STRETCH].present = true;
        def.across[WEFT_STRETCH].stiffness = 30.0;
        def.rim_half = true;
        def.bending = (weft_bending_def){ { 1e-4, 2e-4 }, -1.0, 1e-3 };
    }
    return test_cloth(&def);
}
