/* SPDX-License-Identifier: BSD-3-Clause */
/* accuracy.c -- whether an adaptive method comes as near to the solution as its
 * tolerance makes one expect.
 *
 * The error of a step is kept below the tolerance, not that of a run. Where the
 * solution that is carried on is the one that is judged (no better one of a pair),
 * errors of up to a tolerance add up step by step, and a bound of 50 is fair for some
 * 50 to 100 steps only. So the scenes are cut short, methods of low order of that kind
 * are judged at a loose tolerance, of multistep ones looser still, and those of order 1
 * on few particles. That is still
 * 5 to 9 periods of a particle on one stretch spring of the shipped cloths. */
#include "verify/verify.h"

#define CURTAIN_PIN(col, z)                                                            \
    "{at: [0, " #col "], amplitude: [0.15, 0, " #z "], frequency: 0.5}"

static const verify_scene scenes[VERIFY_SCENES][2] = {
    { { "two-corners", { "run.duration=0.1" } },
      { "two-corners",
        { "run.duration=0.1", "cloth.grid.rows=5", "cloth.grid.cols=5",
          "cloth.grid.spacing=0.25" } } },
    { { "flag", { "run.duration=0.05" } },
      { "flag",
        { "run.duration=0.05", "cloth.grid.rows=5", "cloth.grid.cols=6",
          "cloth.grid.spacing=0.2" } } },
    { { "curtain", { "run.duration=0.1" } },
      { "curtain",
        { "run.duration=0.1", "cloth.grid.rows=5", "cloth.grid.cols=7",
          "cloth.grid.spacing=[0.25, 0.2]",
          "cloth.pins=[" CURTAIN_PIN(0, 0.05) ", " CURTAIN_PIN(
              3, -0.05) ", " CURTAIN_PIN(6, 0.05) "]" } } },
};

const verify_scene *verify_scene_at(size_t i, bool small)
{
    return &scenes[i][small ? 1 : 0];
}

bool verify_small(const weft_stepper_type *type)
{
    return type->order == 1 || (type->flags & WEFT_STEPPER_DENSE) != 0;
}

double verify_tolerance(const weft_stepper_type *type)
{
    const bool multistep = (type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    const bool low = type->order == 1 || type->order == 2;
    return multistep && low                                         ? 1e-2
           : multistep || (low && type->error_order >= type->order) ? 1e-3
                                                                    : 1e-5;
}

/* ---- the reference --------------------------------------------------------------- */

weft_status verify_reference_make(weft_registry *registry, const verify_scene *scene,
                                  verify_reference *out, weft_error *err)
{
    verify_frames other = { 0 };
    *out = (verify_reference){ 0 };
    for (int i = 0; i < 2; ++i) {
        out->by[i].tolerance = 1e-12;
        if (!method_best(registry, i == 0 ? NULL : &out->by[0].method,
                         &out->by[i].method)) {
            return weft_error_set(err, WEFT_UNSUPPORTED,
                                  "no two explicit methods with error control");
        }
    }
    weft_status status = verify_run(registry, scene, &out->by[0], &out->frames, err);
    if (status == WEFT_OK) {
        status = verify_run(registry, scene, &out->by[1], &other, err);
    }
    if (status == WEFT_OK) {
        out->apart = verify_distance(&out->frames, &other);
    }
    verify_frames_free(&other);
    return status;
}

void verify_reference_free(verify_reference *reference)
{
    verify_frames_free(&reference->frames);
}

/* ---- a method -------------------------------------------------------------------- */

weft_status verify_accuracy_of(weft_registry *registry, const verify_scene *scene,
                               const stepper_method *method,
                               const verify_reference *reference, verify_accuracy *out,
                               weft_error *err)
{
    const verify_stepper stepper
        = { .method = *method, .tolerance = verify_tolerance(method->type) };
    verify_frames frames;
    const weft_status status = verify_run(registry, scene, &stepper, &frames, err);
    *out = (verify_accuracy){ .stats = frames.stats };
    if (status == WEFT_OK) {
        out->error = verify_distance(&frames, &reference->frames) / stepper.tolerance;
    }
    verify_frames_free(&frames);
    return status;
}
