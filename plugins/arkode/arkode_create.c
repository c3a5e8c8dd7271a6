/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_create.c -- one instance: checks its arguments, then sets everything that
 * ARKODE would otherwise decide by the defaults of its version.
 *
 * Without a solver SUNDIALS prints messages to stderr, for example if memory fails
 * during creation. The plugin therefore first allocates the same amount once and frees
 * it. */
#include "arkode_plugin.h"

#include <math.h>
#include <stdlib.h>

static bool positive(double x)
{
    return x > 0.0 && isfinite(x);
}

/* The fault of the numbers, or NULL. NaN fails every comparison. */
static const char *mistake(const ark_method *method, const weft_ode *ode,
                           const weft_stepper_config *config)
{
    const weft_stepper_config *c = config;
    const weft_controller *control
        = WEFT_HAS(c, weft_stepper_config, controller) ? c->controller : NULL;
    const bool fixed_only = (method->type.flags & WEFT_STEPPER_FIXED_ONLY) != 0;
    const bool adaptive
        = c->struct_size >= WEFT_STEPPER_CONFIG_LEAST && c->fixed_step == 0.0;
    return c->struct_size < WEFT_STEPPER_CONFIG_LEAST ? "config of an older version"
           : ode->rhs == NULL                         ? "no right-hand side"
           : weft_stepper_half(ode, c) == 0
               ? "dim less the quadratures must be even and > 0"
           : !adaptive && !positive(c->fixed_step)
               ? "fixed_step must be > 0 s, or 0 for adaptive steps"
           : !adaptive  ? NULL
           : fixed_only ? "has no error estimate: it needs fixed_step"
           : c->norm != WEFT_NORM_MAX && c->norm != WEFT_NORM_RMS ? "unknown norm"
           : !(c->rtol >= 0.0 && isfinite(c->rtol))               ? "rtol must be >= 0"
           : !positive(c->atol_position)   ? "atol_position must be > 0 m"
           : !positive(c->atol_velocity)   ? "atol_velocity must be > 0 m/s"
           : !positive(c->first_step)      ? "first_step must be > 0 s"
           : !positive(c->min_step)        ? "min_step must be > 0 s"
           : !(c->max_step >= c->min_step) ? "max_step must be >= min_step"
           : control != NULL               ? weft__ark_control_mistake(control)
                                           : NULL;
}

/* The stages, ARKODE's other vectors and those of its interpolation; 32 KiB for tables
 * and all else that does not grow with the state. Much of SUNDIALS does not check the
 * result of malloc. A granted malloc must not be optimised away. */
static weft_status check_memory(const char *name, size_t dim, int stages,
                                weft_error *err)
{
    const double gib = 0x1p30;
    const double bytes = 0x1p15 + sizeof(double) * (double)dim * (stages + 12);
    const double most = sizeof(sunindextype) > 4 ? 0x1p60 : 0x1p31 - 1.0;
    void *volatile probe = NULL;
    if ((double)dim <= most && bytes <= 0x1p38) { /* 256 GiB */
        probe = malloc((size_t)bytes);
    }
    const bool there = probe != NULL;
    free(probe);
    return there ? WEFT_OK
                 : weft_error_set(err, WEFT_NO_MEMORY,
                                  "%s: no memory: %zu numbers need %.3g GiB", name, dim,
                                  bytes / gib);
}

#if SUNV >= 700
static void silent(int line, const char *function, const char *file, const char *text,
                   SUNErrCode code, void *data, SUNContext context)
{
    (void)line, (void)function, (void)file, (void)text, (void)code;
    (void)data, (void)context;
}
#else
static void silent(int code, const char *module, const char *function, char *text,
                   void *data)
{
    (void)code, (void)module, (void)function, (void)text, (void)data;
}
#endif

static bool make_context(arkode_stepper *self)
{
    if (SUNContext_Create(NO_COMM, &self->context) != 0) {
        return false;
    }
#if SUNV >= 700
    return SUNContext_ClearErrHandlers(self->context) == 0
           && SUNContext_PushErrHandler(self->context, silent, NULL) == 0;
#else
    return true;
#endif
}

/* What has another name or other arguments in each line of versions: messages, the
 * interpolation that is never asked for, the end of a step. */
static bool version_settings(arkode_stepper *self)
{
    void *s = self->solver;
    int bad = 0;
#if SUNV < 700
    bad |= ERKStepSetErrHandlerFn(s, silent, NULL);
#endif
#if SUNV >= 701
    bad |= ARKodeSetInterpolantType(s, ARK_INTERP_NONE);
#else
    bad |= ERKStepSetInterpolantType(s, ARK_INTERP_LAGRANGE);
    bad |= ERKStepSetInterpolantDegree(s, 0);
#endif
#if SUNV < 607
    if (!self->fsal) {
        bad |= ERKStepSetPostprocessStepFn(s, weft__ark_step_done);
    }
#endif
    return bad == 0;
}

/* With a fixed step the bounds of h and the control are ignored. */
static bool settings(arkode_stepper *self)
{
    void *s = self->solver;
    int bad = ARK(SetUserData)(s, self); /* first: others keep a copy of it */
    if (!version_settings(self)) {
        return false;
    }
    bad |= ARK(WFtolerances)(s, weft__ark_weights);
    bad |= ARK(SetMaxNumSteps)(s, -1);
    bad |= ARK(SetMaxHnilWarns)(s, -1);
    if (self->fixed_step > 0.0) {
        return bad == 0;
    }
    return bad == 0 && weft__ark_set_control(self) == 0;
}

/* SUNDIALS' side; takes the table. */
static bool make_solver(arkode_stepper *self, const weft_stepper_config *config,
                        ARKodeButcherTable table)
{
    const weft_team *team
        = WEFT_HAS(config, weft_stepper_config, team) ? config->team : NULL;
    bool made = make_context(self);
    if (made) {
        self->y = weft__ark_vector(self->ode.dim, team, self->context);
        made = self->y != NULL;
    }
    if (made) {
        if (self->fixed_step == 0.0) {
            weft__ark_judge_by(self->y, config->norm, 2 * self->half);
        }
        self->solver = ERKStepCreate(weft__ark_rhs, 0.0, self->y, self->context);
        made = self->solver != NULL && settings(self)
               && ERKStepSetTable(self->solver, table) == ARK_SUCCESS;
    }
    ARKodeButcherTable_Free(table);
    return made;
}

static arkode_stepper *allocate(const ark_method *method, const weft_ode *ode,
                                const weft_stepper_config *config,
                                ARKodeButcherTable table)
{
    arkode_stepper *self = calloc(1, sizeof *self);
    if (self == NULL) {
        return NULL;
    }
    const bool fixed = config->fixed_step > 0.0;
    self->method = method;
    self->ode = *ode;
    self->half = weft_stepper_half(ode, config);
    self->rtol = config->rtol;
    self->atol[0] = config->atol_position;
    self->atol[1] = config->atol_velocity;
    self->fixed_step = config->fixed_step;
    self->min_step = config->min_step;
    self->max_step = config->max_step;
    self->control = weft__ark_control(
        WEFT_HAS(config, weft_stepper_config, controller) ? config->controller : NULL);
    self->stages = table->stages;
    self->fsal = weft__ark_table_is_fsal(table);
    self->hidden = weft__ark_table_hides(table, !fixed);
    self->h = fixed
                  ? config->fixed_step
                  : fmin(fmax(config->first_step, config->min_step), config->max_step);
    self->own_h = self->restart = true;
    self->since_bad = INT32_MAX;
    return self;
}

weft_status weft__ark_create(const weft_stepper_type *type, const weft_ode *ode,
                             const weft_stepper_config *config, void **out,
                             weft_error *err)
{
    const ark_method *method = (const ark_method *)type;
    ARKodeButcherTable table = NULL;
    *out = NULL;
    const char *wrong = mistake(method, ode, config);
    if (wrong != NULL) {
        return weft_error_set(err, WEFT_INVALID, "%s: %s", type->name, wrong);
    }
    weft_status status = check_memory(type->name, ode->dim, 0, err);
    if (status == WEFT_OK) {
        status = weft__ark_table(method, config->butcher, &table, err);
    }
    if (status != WEFT_OK) {
        return status;
    }
    if (config->fixed_step == 0.0 && (table->p < 1 || table->d == NULL)) {
        status = weft_error_set(err, WEFT_INVALID,
                                "%s: a table without b_embedded needs fixed_step",
                                type->name);
    } else {
        status = check_memory(type->name, ode->dim, table->stages, err);
    }
    if (status != WEFT_OK) {
        ARKodeButcherTable_Free(table);
        return status;
    }
    arkode_stepper *self = allocate(method, ode, config, table);
    if (self == NULL) {
        ARKodeButcherTable_Free(table);
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", type->name);
    }
    if (!make_solver(self, config, table)) {
        weft__ark_destroy(self);
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory for ARKODE",
                              type->name);
    }
    *out = self;
    return WEFT_OK;
}

void weft__ark_destroy(void *instance)
{
    arkode_stepper *self = instance;
    if (self == NULL) {
        return;
    }
    if (self->solver != NULL) {
        ARK(Free)(&self->solver);
    }
#if SUNV >= 607
    if (self->controller != NULL) {
        (void)SUNAdaptController_Destroy(self->controller);
    }
#endif
    if (self->y != NULL) {
        N_VDestroy(self->y);
    }
    if (self->context != NULL) {
        (void)SUNContext_Free(&self->context);
    }
    free(self);
}
