/* SPDX-License-Identifier: BSD-3-Clause */
/* problem.h -- P(n), the cloth of the figures: n x n particles on a horizontal sheet of
 * 1 m, two corners pinned, 0.2 kg/m^2 with all masses equal, 100, 50 and 10 N/m,
 * damping 5e-4 s times stiffness. */
#pragma once

#include "weft/cloth.h"

static inline weft_cloth_def problem(size_t n)
{
    static const weft_pin pins[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                     { .rows = { 0, 0 }, .cols = { -1, -1 } } };
    static const double stiffness[WEFT_FAMILIES] = { 100.0, 50.0, 10.0 }; /* [N/m] */
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = def.cols = n;
    def.spacing[0] = def.spacing[1] = 1.0 / (double)(n - 1);
    def.down[1] = 0.0;
    def.down[2] = 1.0;
    def.density = 0.0;
    def.mass = 0.2 / (double)(n * n);
    def.pins = pins;
    def.pin_count = 2;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f] = (weft_spring_def){ .present = true,
                                            .stiffness = stiffness[f],
                                            .damping = 5e-4 * stiffness[f] };
    }
    return def;
}
