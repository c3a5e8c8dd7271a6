/* SPDX-License-Identifier: BSD-3-Clause */
/* stop.c -- quantities that end a run. */
#include <math.h>

#include "weft/sim.h"

const char *weft_stop_name(weft_stop_quantity quantity)
{
    static const char *const names[WEFT_STOPS]
        = { "", "max_strain", "min_gap", "kinetic" };
    return (unsigned)quantity < WEFT_STOPS ? names[quantity] : "";
}

double weft_stop_event(void *stop, const weft_cloth *cloth, double t, const double *y)
{
    const weft_stop_def *at = stop;
    switch (at->quantity) {
    case WEFT_STOP_STRAIN:
        return at->bound - weft_cloth_worst_spring(cloth, y).strain;
    case WEFT_STOP_GAP:
        return weft_cloth_gap(cloth, t, y, NULL, NULL) - at->bound;
    case WEFT_STOP_KINETIC:
        return weft_cloth_energy(cloth, t, y).kinetic - at->bound;
    default:
        return (double)INFINITY;
    }
}
