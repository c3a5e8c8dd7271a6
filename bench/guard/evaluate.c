/* SPDX-License-Identifier: BSD-3-Clause */
/* evaluate.c -- evaluates the forces of P(100) three times, for tools/checks/guard,
 * which counts instructions; prints how many springs that were. Argument: all, all
 * springs; undamped; stretch, that family alone and undamped; wind, the springs of
 * stretch and wind; bending, those and a rigidity; contact, those and a plane that all
 * particles touch; far, one that none does. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../problem.h"

enum { SIDE = 100, CALLS = 3 };

int main(int argc, char **argv)
{
    static double y[6 * SIDE * SIDE], dydt[6 * SIDE * SIDE];
    const char *what = argc > 1 ? argv[1] : "all";
    const bool all = strcmp(what, "all") == 0, undamped = strcmp(what, "undamped") == 0;
    weft_cloth_def def = problem(SIDE);
    weft_cloth *cloth;
    weft_error err;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f].damping *= all ? 1.0 : 0.0;
        def.springs[f].present = all || undamped || f == WEFT_STRETCH;
    }
    def.wind_drag = strcmp(what, "wind") == 0 ? 1.0 : 0.0;
    def.bending.rigidity[0] = strcmp(what, "bending") == 0 ? 1e-5 : 0.0;
    weft_shape plane = weft_shape_default(WEFT_PLANE);
    plane.at[1] = strcmp(what, "far") == 0 ? -0.1 : -0.003;
    def.contact.shapes = &plane;
    def.contact.shape_count = strcmp(what, "far") == 0 || strcmp(what, "contact") == 0;
    if (weft_cloth_create(&def, &cloth, &err) != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
        return 1;
    }
    weft_cloth_start(cloth, y);
    size_t springs = 0;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        springs += weft_cloth_springs(cloth, (weft_family)f);
    }
    for (int i = 0; i < CALLS; ++i) {
        (void)weft_cloth_rhs(cloth, 0.0, y, dydt);
    }
    printf("%zu %s\n", CALLS * springs, weft_cloth_isa(cloth));
    weft_cloth_destroy(cloth);
    return 0;
}
