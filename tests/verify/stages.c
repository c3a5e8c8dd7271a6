/* SPDX-License-Identifier: BSD-3-Clause */
/* stages.c -- when a method evaluates the forces, in parts of the step that it takes:
 * a hanging chain whose own force notes the times. */
#include <math.h>

#include "study/conformance/oscillators.h"
#include "verify/verify.h"

#define DURATION 0.1  /* [s] */
#define STEP     0.01 /* [s] */

/* Of the attempt at a step. */
typedef struct noted {
    double least, largest; /* [s] */
} noted;

static int note(void *ctx, double t, const double *y, double *f)
{
    noted *to = ctx;
    (void)y, (void)f;
    to->least = fmin(to->least, t);
    to->largest = fmax(to->largest, t);
    return 0;
}

static weft_status chain(weft_cloth **out, weft_error *err)
{
    static const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = 4, def.cols = 1;
    def.spacing[0] = def.spacing[1] = 0.1;
    def.mass = 0.05, def.density = 0.0;
    def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 2.0, 0.3 };
    def.pins = &top, def.pin_count = 1;
    return weft_cloth_create(&def, out, err);
}

/* Steps that were not tried again widen the range. */
static weft_status take_steps(weft_sim *sim, noted *times, double range[2],
                              weft_error *err)
{
    weft_status status = WEFT_OK;
    while (status == WEFT_OK && weft_sim_time(sim) < DURATION) {
        const double before = weft_sim_time(sim);
        const uint64_t rejected = weft_sim_stats(sim).rejected;
        *times = (noted){ (double)INFINITY, -(double)INFINITY };
        status = weft_sim_step(sim, DURATION, err);
        if (status == WEFT_OK && weft_sim_stats(sim).rejected == rejected) {
            const double h = weft_sim_time(sim) - before;
            range[0] = fmin(range[0], (times->least - before) / h);
            range[1] = fmax(range[1], (times->largest - before) / h);
        }
    }
    return status;
}

weft_status verify_stages_of(const weft_stepper_type *type, double range[2],
                             weft_error *err)
{
    noted times;
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    const bool fixed = (type->flags & (uint32_t)WEFT_STEPPER_ADAPTIVE_ONLY) == 0;
    range[0] = 0.0, range[1] = 1.0;
    weft_status status = chain(&cloth, err);
    def.cloth = cloth, def.method = type;
    def.config = fixed ? weft__with_table(type, weft__fixed(STEP))
                       : weft_stepper_config_default();
    def.force = note, def.force_ctx = &times;
    status = status == WEFT_OK ? weft_sim_create(&def, &sim, err) : status;
    status = status == WEFT_OK ? take_steps(sim, &times, range, err) : status;
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status;
}

bool verify_stages_outside(const double range[2])
{
    return range[0] < -VERIFY_STAGES_ROUNDOFF
           || range[1] > 1.0 + VERIFY_STAGES_ROUNDOFF;
}
