/* SPDX-License-Identifier: BSD-3-Clause */
/* shipped.c -- whether a method runs the scenes that are shipped, to their ends.
 *
 * Over whole runs states need not agree: small differences grow. Energies do, if only
 * roughly, with a strain limit too; a method that is not stable gains energy without
 * bound or stops. */
#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "verify/verify.h"

static int by_name(const void *a, const void *b)
{
    return strcmp(a, b);
}

size_t verify_shipped(char names[VERIFY_SHIPPED_MOST][VERIFY_NAME])
{
    size_t count = 0;
    DIR *folder = opendir("scenes");
    for (struct dirent *item; folder != NULL && (item = readdir(folder)) != NULL;) {
        const char *dot = strrchr(item->d_name, '.');
        const size_t length = dot == NULL ? 0 : (size_t)(dot - item->d_name);
        if (length > 0 && length < VERIFY_NAME && strcmp(dot, ".yaml") == 0
            && count < VERIFY_SHIPPED_MOST) {
            memcpy(names[count], item->d_name, length);
            names[count++][length] = '\0';
        }
    }
    if (folder != NULL) {
        (void)closedir(folder);
    }
    qsort(names, count, VERIFY_NAME, by_name);
    return count;
}

bool verify_any_damping(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_STRUCTURE) == 0
           || (type->flags & WEFT_STEPPER_IMPLICIT) != 0;
}

bool verify_shipped_suits(const weft_stepper_type *type, const verify_frames *reference)
{
    return verify_any_damping(type) && (type->flags & WEFT_STEPPER_DENSE) == 0
           && ((type->flags & WEFT_STEPPER_MULTISTEP) == 0 || !reference->limited);
}

/* Largest difference in a frame, as part of what is at play in the reference: of the
 * range of its energy, or of its largest kinetic energy. */
static double energy_difference(const verify_frames *a, const verify_frames *reference)
{
    const double *e = reference->energy;
    double low = e[0], high = e[0], top = 0.0;
    for (size_t i = 0; i < reference->count; ++i) {
        const double apart = fabs(a->energy[i] - e[i]);
        low = fmin(low, e[i]), high = fmax(high, e[i]);
        top = apart <= top ? top : isfinite(apart) ? apart : (double)INFINITY;
    }
    return top / fmax(high - low, reference->kinetic);
}

/* [s] and as an override. The last is longer than every scene. */
static const struct {
    double duration;
    const char *set;
} cuts[] = { { 0.05, "run.duration=0.05" }, { 0.1, "run.duration=0.1" },
             { 0.2, "run.duration=0.2" },   { 0.4, "run.duration=0.4" },
             { 0.8, "run.duration=0.8" },   { 1.6, "run.duration=1.6" },
             { 3.2, "run.duration=3.2" },   { (double)INFINITY, NULL } };

/* Twice as long until it is the whole or took enough work, so that what all methods
 * take for a scene has a bound. */
static weft_status run_until_enough(weft_registry *registry, double whole,
                                    const verify_stepper *stepper, verify_scene *scene,
                                    verify_frames *out, weft_error *err)
{
    for (size_t i = 0;; ++i) {
        const bool cut = cuts[i].duration < whole;
        scene->sets[0] = cut ? cuts[i].set : NULL;
        const weft_status status = verify_run(registry, scene, stepper, out, err);
        const uint64_t work = out->stats.rhs_calls * (out->dim / 6);
        if (status != WEFT_OK || !cut || work > VERIFY_WORK_ENOUGH) {
            return status;
        }
        verify_frames_free(out);
    }
}

weft_status verify_shipped_reference(weft_registry *registry, const char *name,
                                     bool haste, verify_scene *scene,
                                     verify_frames *out, weft_error *err)
{
    verify_stepper stepper = { .tolerance = 0.01 * VERIFY_SHIPPED_TOLERANCE };
    *scene = (verify_scene){ .name = name };
    *out = (verify_frames){ 0 };
    if (!method_best(registry, NULL, &stepper.method)) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "no method with error control");
    }
    const verify_size size = verify_size_of(registry, scene, &stepper);
    if (!haste) {
        return run_until_enough(registry, size.duration, &stepper, scene, out, err);
    }
    scene->sets[0] = size.particles > VERIFY_PARTICLES_MANY ? "run.duration=0.01"
                                                            : "run.duration=0.05";
    return verify_run(registry, scene, &stepper, out, err);
}

static weft_status run(weft_registry *registry, const verify_scene *scene,
                       const verify_stepper *stepper, const verify_frames *reference,
                       verify_shipped_result *out, weft_error *err)
{
    verify_frames frames;
    const weft_status status = verify_run(registry, scene, stepper, &frames, err);
    if (status == WEFT_OK) {
        *out = (verify_shipped_result){ stepper->fixed_step, frames.stats.steps,
                                        energy_difference(&frames, reference) };
    }
    verify_frames_free(&frames);
    return status;
}

weft_status verify_shipped_run(weft_registry *registry, const verify_scene *scene,
                               const stepper_method *method,
                               const verify_frames *reference,
                               verify_shipped_result *out, weft_error *err)
{
    const bool rough = method->type->order == 1
                       || (method->type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    verify_stepper stepper
        = { .method = *method,
            .tolerance = VERIFY_SHIPPED_TOLERANCE * (rough ? 0.1 : 1.0) };
    if (method_adapts(method->type)) {
        return run(registry, scene, &stepper, reference, out, err);
    }
    weft_status status = WEFT_OK;
    for (stepper.fixed_step = 0x1p-8; stepper.fixed_step >= 0x1p-18;
         stepper.fixed_step /= 2.0) {
        status = run(registry, scene, &stepper, reference, out, err);
        if (status == WEFT_OK && out->energy <= VERIFY_ENERGY_BOUND) {
            return WEFT_OK;
        }
    }
    return status;
}
