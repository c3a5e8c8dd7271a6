/* SPDX-License-Identifier: BSD-3-Clause */
/* stiff_plugin.c -- the methods, and one instance. */
#include "stiff_plugin.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const weft_plugin *weft_plugin_stiff(void);

/* ---- creation -------------------------------------------------------------------- */

static bool solves(const stiff_method *method)
{
    return (method->type.flags & WEFT_STEPPER_LINEAR) != 0;
}

static const char *linear_mistake(const stiff_method *method,
                                  const weft_stepper_config *config)
{
    const weft_linear *l = weft_stepper_linear(config);
    if (l == NULL) {
        return NULL;
    }
    const char *wrong = weft__linear_mistake(config);
    return !WEFT_HAS(l, weft_linear, max_order) ? "linear of another version"
           : !solves(method)                    ? "solves no linear systems"
           : wrong != NULL                      ? wrong
           : l->jacobian > WEFT_JACOBIAN_STEP   ? "computes one Jacobian in every step"
           : l->max_order != 0                  ? "has one order"
                                                : NULL;
}

static weft_status check(const stiff_method *method, const weft_ode *ode,
                         const weft_stepper_config *config, weft_error *err)
{
    const char *wrong = weft_stepper_mistake(&method->type, ode, config);
    wrong = wrong == NULL && ode->dim > SIZE_MAX / 64 ? "dim is too large" : wrong;
    wrong = wrong != NULL ? wrong : linear_mistake(method, config);
    const char *lacks = wrong != NULL    ? NULL
                        : solves(method) ? weft__structure_mistake(ode, config)
                                         : weft__spectrum_mistake(ode, config);
    return wrong != NULL
               ? weft_error_set(err, WEFT_INVALID, "%s: %s", method->type.name, wrong)
           : lacks != NULL ? weft_error_set(err, WEFT_UNSUPPORTED, "%s: %s",
                                            method->type.name, lacks)
                           : WEFT_OK;
}

static void settle(stiff_stepper *self, const weft_ode *ode,
                   const weft_stepper_config *config)
{
    const bool fixed = config->fixed_step > 0.0;
    self->ode = *ode;
    self->structure = config->structure;
    self->agree = weft_stepper_agree(config);
    self->rms = solves(self->method) ? NULL : weft_stepper_rms(config);
    self->half = weft_stepper_half(ode, config);
    self->norm = config->norm;
    self->rtol = config->rtol;
    self->atol[0] = config->atol_position;
    self->atol[1] = config->atol_velocity;
    self->fixed_step = config->fixed_step;
    self->min_step = config->min_step;
    self->max_step = config->max_step;
    self->h = fixed
                  ? config->fixed_step
                  : fmin(fmax(config->first_step, config->min_step), config->max_step);
    self->settings = weft__linear_settings(config, weft__linear_residual(config));
}

static void destroy(void *instance)
{
    stiff_stepper *self = instance;
    if (self != NULL) {
        const weft_allocator memory = self->memory;
        weft__linear_destroy(self->linear);
        (void)memory.resize(memory.ctx, self, 0);
    }
}

static weft_status create(const weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **out,
                          weft_error *err)
{
    const stiff_method *method = (const stiff_method *)type;
    *out = NULL;
    weft_status status = check(method, ode, config, err);
    if (status != WEFT_OK) {
        return status;
    }
    const weft_allocator memory = weft_stepper_memory(config);
    const size_t arrays = ARRAYS * ode->dim * sizeof(double);
    stiff_stepper *self = memory.resize(memory.ctx, NULL, sizeof *self + arrays);
    if (self == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", type->name);
    }
    *self = (stiff_stepper){ .method = method, .memory = memory };
    settle(self, ode, config);
    double *array = (double *)(self + 1);
    double **const arrays_of[ARRAYS] = { &self->f,     &self->f_end,   &self->end,
                                         &self->error, &self->work[0], &self->work[1] };
    for (size_t i = 0; i < ARRAYS; ++i) {
        *arrays_of[i] = array + i * ode->dim;
    }
    if (solves(method)) {
        status = weft__linear_create(self->structure, self->settings.preconditioner,
                                     &memory, &self->linear, err);
    }
    if (status != WEFT_OK) {
        destroy(self);
        return status;
    }
    *out = self;
    return WEFT_OK;
}

/* ---- the other functions of the contract ----------------------------------------- */

static void state_changed(void *instance)
{
    stiff_stepper *self = instance;
    self->carries = self->fresh = false;
}

static void ode_changed(void *instance)
{
    stiff_stepper *self = instance;
    self->carries = self->fresh = self->spectrum.known = false;
}

static void stats(const void *instance, weft_stepper_stats *out)
{
    const stiff_stepper *self = instance;
    weft_stepper_stats all = self->stats;
    all.next_step = self->h;
    if (self->linear != NULL) {
        const weft__linear_counts counts = weft__linear_count(self->linear);
        all.linear_iterations = counts.iterations;
        all.factorisations = counts.refreshes;
        all.newton_failures = counts.failures;
    }
    weft_stepper_stats_copy(&all, out);
}

static void options(const void *instance, weft_option_fn *tell, void *ctx)
{
    const stiff_stepper *self = instance;
    if (self->linear != NULL) {
        weft__linear_tell(&self->settings, tell, ctx);
    }
}

enum {
    FLAGS = WEFT_STEPPER_QUADRATURES | WEFT_STEPPER_STRUCTURE,
    SOLVES = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_LINEAR | WEFT_STEPPER_COUPLINGS
};

#define METHOD(id, p, error_p, calls, more, before, source)                            \
    {                                                                                  \
        .type = { .abi = WEFT_STEPPER_ABI,                                             \
                  .struct_size = sizeof(weft_stepper_type),                            \
                  .name = #id,                                                         \
                  .reference = (source),                                               \
                  .license = "BSD-3-Clause",                                           \
                  .order = (p),                                                        \
                  .error_order = (error_p),                                            \
                  .stages = (calls),                                                   \
                  .flags = FLAGS | (more),                                             \
                  .create = create,                                                    \
                  .step = weft__stiff_step,                                            \
                  .state_changed = state_changed,                                      \
                  .stats = stats,                                                      \
                  .destroy = destroy,                                                  \
                  .options = options,                                                  \
                  .ode_changed = ode_changed },                                        \
        .prepare = (before), .attempt = weft__##id##_attempt                           \
    }

static const stiff_method methods[] = {
    METHOD(rkc2, 2, 2, 0, WEFT_STEPPER_FSAL | WEFT_STEPPER_DISTRIBUTED,
           weft__rkc2_prepare,
           "B. P. Sommeijer, L. F. Shampine, J. G. Verwer, J. Comput. Appl. Math. 88, "
           "1998"),
    METHOD(ros2, 2, 1, 2, SOLVES, NULL,
           "J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer, SIAM J. Sci. Comput. "
           "20, 1999"),
    METHOD(backward_euler, 1, 0, 1, SOLVES | WEFT_STEPPER_FIXED_ONLY, NULL,
           "D. Baraff, A. Witkin, SIGGRAPH 1998: one Newton step, for graphics"),
};

WEFT_API const weft_plugin *weft_plugin_stiff(void)
{
    static const weft_stepper_type *const types[]
        = { &methods[0].type, &methods[1].type, &methods[2].type, NULL };
    static const weft_plugin plugin = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_plugin),
        .id = "stiff",
        .version = WEFT_VERSION,
        .solver = "",
        .types = types,
    };
    return &plugin;
}
