/* SPDX-License-Identifier: BSD-3-Clause */
#include "spectrum.h"

#include <math.h>

enum {
    STEPS_KNOWN = 256,
    YOUNG = 128 /* steps for which what is known is not doubted */
};

#define MARGIN     1.05 /* of the largest eigenvalue, while the state changes */
#define CIRCLE     1.9  /* of 2.2 tau, for the same reason */
#define SLOW       0.5  /* h omega of modes that need no damping */
#define LEAST_ZETA 0.5

typedef double corner[2]; /* (omega^2 [1/s^2], damping rate [1/s]) */

const char *weft__structure_mistake(const weft_ode *ode,
                                    const weft_stepper_config *config)
{
    const weft_structure *of = weft_stepper_structure(config);
    return of == NULL || !WEFT_HAS(of, weft_structure, ctx)
               ? "needs the structure of the cloth, which a simulation gives it"
           : of->particles > SIZE_MAX / 64
                   || 3 * of->particles != weft_stepper_half(ode, config)
               ? "the structure is of another number of particles"
               : NULL;
}

static bool too_lightly_damped(const weft_structure *structure)
{
    corner corners[WEFT_MODES_CORNERS];
    const size_t count
        = structure->modes(0.0, NULL, corners, WEFT_MODES_CORNERS, structure->ctx);
    double w = 0.0, c = 0.0;
    for (size_t i = 0; i < count; ++i) {
        w = fmax(w, corners[i][0]);
        c = fmax(c, corners[i][1]);
    }
    return w > 0.0 && 0.5 * c < LEAST_ZETA * sqrt(w);
}

const char *weft__spectrum_mistake(const weft_ode *ode,
                                   const weft_stepper_config *config)
{
    const char *wrong = weft__structure_mistake(ode, config);
    return wrong != NULL                           ? wrong
           : too_lightly_damped(config->structure) ? "all modes are damped too lightly "
                                                     "(damping ratio < 0.5): use "
                                                     "velocity_verlet or dormand_prince"
                                                   : NULL;
}

/* Of the two roots of mu^2 + c mu + w = 0, the larger |mu|. */
static double magnitude(double w, double c)
{
    return c * c > 4.0 * w ? 0.5 * (c + sqrt(c * c - 4.0 * w)) : sqrt(w);
}

static void learn(weft__spectrum *self, corner *corners, size_t count)
{
    *self = (weft__spectrum){ .known = true, .cap = (double)INFINITY };
    for (size_t i = 0; i < count; ++i) {
        const double w = corners[i][0], c = corners[i][1];
        self->radius = fmax(self->radius, MARGIN * magnitude(w, c));
        if (w > 0.0) {
            self->cap = fmin(self->cap, fmax(CIRCLE * c / w, SLOW / sqrt(w)));
        }
    }
    const double most = (double)WEFT__STAGES_MOST - 1.0;
    self->cap = fmin(self->cap, (most * most - 1.0) / (WEFT__REACH * self->radius));
}

weft_status weft__spectrum_prepare(weft__spectrum *self, const char *name,
                                   const weft_structure *structure, double fixed_step,
                                   double t, const double *y, weft_error *err)
{
    if (!self->known || self->age >= STEPS_KNOWN) {
        corner corners[WEFT_MODES_CORNERS];
        const size_t count
            = structure->modes(t, y, corners, WEFT_MODES_CORNERS, structure->ctx);
        learn(self, corners, count);
        if (!isfinite(self->radius)) {
            self->known = false;
            return weft_error_set(err, WEFT_NOT_FINITE, "%s: the state is not finite",
                                  name);
        }
    }
    if (fixed_step > self->cap) {
        return weft_error_set(
            err, WEFT_UNSUPPORTED,
            "%s: a fixed_step of %.3g s is not stable: at most %.3g s", name,
            fixed_step, self->cap);
    }
    return WEFT_OK;
}

void weft__spectrum_doubt(weft__spectrum *self)
{
    self->known = self->known && self->age < YOUNG;
}
