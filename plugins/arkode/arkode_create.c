/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_create.c -- one instance: checks its arguments, then sets everything that
 * ARKODE would otherwise decide by the defaults of its version. */
#include "arkode_plugin.h"

#include <math.h>
#include <stdlib.h>

/* With a fixed step the equations of an implicit stage are solved to this error: an
 * absolute one [m], [m/s], and a relative one. */
#define NEWTON_FIXED 1e-12

/* The fault of the config's numbers, or NULL. */
static const char *mistake(const weft_stepper_type *type, const weft_ode *ode,
                           const weft_stepper_config *config)
{
    const char *wrong = weft__sun_mistake(type, ode, config);
    const weft_controller *control
        = WEFT_HAS(config, weft_stepper_config, controller) ? config->controller : NULL;
    if (wrong == NULL && (type->flags & WEFT_STEPPER_IMPLICIT) != 0) {
        wrong = weft__linear_mistake(config);
    }
    return wrong != NULL || control == NULL || config->fixed_step > 0.0
               ? wrong
               : weft__ark_control_mistake(control);
}

/* The stages, ARKODE's other vectors and those of its interpolation. */
static weft_status check_memory(const ark_method *method, const weft_ode *ode,
                                const weft_stepper_config *config, int stages,
                                weft_error *err)
{
    const bool implicit = (method->type.flags & WEFT_STEPPER_IMPLICIT) != 0;
    const int more = implicit ? 5 + weft__sun_equations_vectors(ode->dim, config) : 0;
    return weft__sun_memory(method->type.name, ode->dim, stages + 12 + more, err);
}

/* What has another name or other arguments in each line of versions: messages, the
 * interpolation that is never asked for, the end of a step. */
static bool version_settings(arkode_stepper *self)
{
    void *s = self->solver;
    int bad = 0;
#if SUNV < 700
    bad |= ARK(SetErrHandlerFn)(s, weft__sun_silent, NULL);
#endif
#if SUNV >= 701
    bad |= ARKodeSetInterpolantType(s, ARK_INTERP_NONE);
#else
    bad |= ARK(SetInterpolantType)(s, ARK_INTERP_LAGRANGE);
    bad |= ARK(SetInterpolantDegree)(s, 0);
#endif
#if SUNV < 607
    if (!self->fsal) {
        bad |= ARK(SetPostprocessStepFn)(s, weft__ark_step_done);
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
    if (self->implicit && !weft__ark_set_newton(self)) {
        return false;
    }
    if (self->fixed_step > 0.0) {
        return bad == 0;
    }
    return bad == 0 && weft__ark_set_control(self) == 0;
}

static bool set_table(arkode_stepper *self, ARKodeButcherTable table)
{
    const int flag = self->implicit ? ARKStepSetTables(self->solver, table->q, table->p,
                                                       table, NULL)
                                    : ERKStepSetTable(self->solver, table);
    return flag == ARK_SUCCESS;
}

static bool make_module(arkode_stepper *self)
{
    if (self->method->stabilised) {
        return weft__ark_make_stabilised(self);
    }
    self->solver = self->implicit
                       ? ARKStepCreate(NULL, weft__ark_rhs, 0.0, self->y, self->context)
                       : ERKStepCreate(weft__ark_rhs, 0.0, self->y, self->context);
    return self->solver != NULL;
}

/* SUNDIALS' side; takes the table. */
static bool make_solver(arkode_stepper *self, const weft_stepper_config *config,
                        ARKodeButcherTable table)
{
    const weft_team *pool
        = WEFT_HAS(config, weft_stepper_config, team) ? config->team : NULL;
    self->context = weft__sun_context();
    bool made = self->context != NULL;
    if (made) {
        self->y = weft__sun_vector(self->ode.dim, pool, self->context);
        made = self->y != NULL;
    }
    if (made && !self->implicit) {
        weft__sun_agree(self->y, (weft_agree){ self, weft__ark_agree },
                        weft_stepper_rms(config));
    }
    if (made && self->fixed_step == 0.0) {
        weft__sun_judge_by(self->y, config->norm, 2 * self->half);
    } else if (made && self->implicit) {
        weft__sun_judge_by(self->y, WEFT_NORM_MAX, 2 * self->half);
    }
    const weft_pass *pass = weft_stepper_pass(config);
    const bool max = self->fixed_step > 0.0 || config->norm == WEFT_NORM_MAX;
    if (made && pass != NULL && max && table != NULL && !self->implicit
        && self->agree == NULL && self->ode.dim == 2 * self->half) {
        self->passes = true;
        weft__sun_pass(self->y, pass,
                       (weft__sun_stages){ self, weft__ark_stage, weft__ark_passed });
    }
    if (made && self->implicit) {
        made = weft__ark_equations(self, config, NULL) == WEFT_OK;
    }
    made = made && make_module(self) && settings(self)
           && (table == NULL || set_table(self, table));
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
    self->max_step = self->longest = config->max_step;
    self->control = weft__ark_control(
        method,
        WEFT_HAS(config, weft_stepper_config, controller) ? config->controller : NULL);
    self->agree = weft_stepper_agree(config);
    self->structure = weft_stepper_structure(config);
    self->stages = table == NULL ? 0 : table->stages;
    self->implicit = (method->type.flags & WEFT_STEPPER_IMPLICIT) != 0;
    self->fsal = table == NULL || (!self->implicit && weft__ark_table_is_fsal(table));
    self->hidden
        = table != NULL && (self->implicit || weft__ark_table_hides(table, !fixed));
    if (self->implicit && fixed) { /* of the equations of its stages */
        self->rtol = NEWTON_FIXED;
        self->atol[0] = self->atol[1] = NEWTON_FIXED;
    }
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
    const char *wrong = mistake(type, ode, config);
    if (wrong != NULL) {
        return weft_error_set(err, WEFT_INVALID, "%s: %s", type->name, wrong);
    }
    const char *lacks = method->stabilised ? weft__spectrum_mistake(ode, config) : NULL;
    if (lacks != NULL) {
        return weft_error_set(err, WEFT_UNSUPPORTED, "%s: %s", type->name, lacks);
    }
    weft_status status = check_memory(method, ode, config, 0, err);
    if (status == WEFT_OK) {
        status = weft__ark_table(method, config->butcher, &table, err);
    }
    if (status != WEFT_OK) {
        return status;
    }
    if (config->fixed_step == 0.0 && table != NULL
        && (table->p < 1 || table->d == NULL)) {
        status = weft_error_set(err, WEFT_INVALID,
                                "%s: a table without b_embedded needs fixed_step",
                                type->name);
    } else {
        status
            = check_memory(method, ode, config, table == NULL ? 0 : table->stages, err);
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
    weft__sun_equations_destroy(&self->equations);
    if (self->y != NULL) {
        N_VDestroy(self->y);
    }
    if (self->context != NULL) {
        (void)SUNContext_Free(&self->context);
    }
    free(self);
}
