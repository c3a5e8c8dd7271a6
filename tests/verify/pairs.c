/* SPDX-License-Identifier: BSD-3-Clause */
/* pairs.c -- tables that two plugins have: with equal fixed steps they must agree as
 * far as roundoff allows. The time is short, for slack cloth makes much of roundoff
 * later: in 0.5 s, 3e-12 of it. */
#include <math.h>

#include "verify/verify.h"

static const verify_pair pairs[] = {
    { { { "gsl", "rkf45" }, { "arkode", "fehlberg45" } } },
    { { { "gsl", "rkck" }, { "arkode", "cash_karp" } } },
    { { { "verlet", "midpoint" }, { "arkode", "midpoint" } } },
    { { { "verlet", "euler" }, { "arkode", "euler" } } },
};

const verify_pair *verify_pair_at(size_t i)
{
    return i < sizeof pairs / sizeof pairs[0] ? &pairs[i] : NULL;
}

static weft_status run(weft_registry *registry, const char *const name[2],
                       verify_frames *out, weft_error *err)
{
    const verify_scene scene = { "two-corners",
                                 { "run.duration=0.2", "run.fps=5",
                                   "cloth.grid.rows=17", "cloth.grid.cols=17" } };
    verify_stepper stepper = { .fixed_step = 0.2 / VERIFY_PAIR_STEPS };
    *out = (verify_frames){ 0 };
    if (weft_registry_find(registry, name[0], &stepper.method.plugin, NULL)
        != WEFT_OK) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "no plugin %s", name[0]);
    }
    stepper.method.type = weft_plugin_method(stepper.method.plugin, name[1]);
    if (stepper.method.type == NULL) {
        return weft_error_set(err, WEFT_BAD_PLUGIN, "%s has no %s", name[0], name[1]);
    }
    weft_status status = verify_run(registry, &scene, &stepper, out, err);
    if (status == WEFT_OK && out->stats.steps != VERIFY_PAIR_STEPS) {
        status = weft_error_set(err, WEFT_SOLVER, "%s %s took %llu steps", name[0],
                                name[1], (unsigned long long)out->stats.steps);
    }
    return status;
}

weft_status verify_pair_apart(weft_registry *registry, const verify_pair *pair,
                              double *apart, weft_error *err)
{
    verify_frames a, b = { 0 };
    weft_status status = run(registry, pair->names[0], &a, err);
    if (status == WEFT_OK) {
        status = run(registry, pair->names[1], &b, err);
    }
    if (status == WEFT_OK) {
        double size = 0.0;
        for (size_t i = 0; i < a.count * a.dim; ++i) {
            size = fmax(size, fabs(a.y[i]));
        }
        *apart = verify_distance(&a, &b) / size;
    }
    verify_frames_free(&a);
    verify_frames_free(&b);
    return status;
}
