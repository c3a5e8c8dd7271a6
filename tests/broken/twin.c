/* SPDX-License-Identifier: BSD-3-Clause */
/* twin.c -- a method for cloth that stays where it is, which fails at t = 1 s if the
 * first particle is not at 0. */
#include "weft/stepper.h"

static weft_status make(const weft_stepper_type *type, const weft_ode *ode,
                        const weft_stepper_config *config, void **self, weft_error *err)
{
    static const char instance;
    (void)type;
    (void)ode;
    (void)config;
    (void)err;
    *self = (void *)&instance;
    return WEFT_OK;
}

static weft_status stay(void *self, double t_end, double *t, double *y, weft_error *err)
{
    (void)self;
    if (t_end >= 1.0 && y[0] != 0.0) {
        return weft_error_set(err, WEFT_SOLVER, "the twin fails");
    }
    *t = t_end;
    return WEFT_OK;
}

#define ID     "twin"
#define ENTRY  weft_plugin_twin
#define CREATE make
#define STEP   stay
#define ORDER  9
#include "good.c"
