/* SPDX-License-Identifier: BSD-3-Clause */
/* stop.c -- quantities that end a run. */
#include <math.h>

#include "cloth/model.h"
#include "weft/sim.h"

const char *weft_stop_name(weft_stop_quantity quantity)
{
    static const char *const names[WEFT_STOPS]
        = { "", "max_strain", "min_gap", "kinetic", "at_rest" };
    return (unsigned)quantity < WEFT_STOPS ? names[quantity] : "";
}

static double above_rest(const weft_cloth *cloth, const double *y, double part)
{
    const size_t n = cloth->mesh.particles;
    double kinetic = 0.0, work = 0.0, start[3];
    for (size_t i = 0; i < n; ++i) {
        if (cloth->mesh.pin[i] == 0) {
            weft__start_position(&cloth->mesh, i, start);
            for (size_t k = 0; k < 3; ++k) {
                const double v = y[(3 + k) * n + i];
                kinetic += 0.5 * cloth->mesh.mass[i] * v * v;
                work += cloth->mesh.mass[i] * cloth->body.gravity[k]
                        * (y[k * n + i] - start[k]);
            }
        }
    }
    return kinetic - part * fabs(work);
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
    case WEFT_STOP_REST:
        return above_rest(cloth, y, at->bound);
    default:
        return (double)INFINITY;
    }
}
