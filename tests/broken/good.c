/* SPDX-License-Identifier: BSD-3-Clause */
/* good.c -- a plugin with nothing wrong, whose methods refuse to work. The others of
 * this folder are this one with one mistake each: they set the macro of what they
 * spoil and include it. */
#include "weft/stepper.h"

#ifndef ID
#define ID    "good"
#define ENTRY weft_plugin_good
#endif
#ifndef ABI
#define ABI WEFT_STEPPER_ABI
#endif
#ifndef SIZE
#define SIZE sizeof(weft_plugin)
#endif
#ifndef TYPE_ABI
#define TYPE_ABI WEFT_STEPPER_ABI
#endif
#ifndef TYPE_SIZE
#define TYPE_SIZE sizeof(weft_stepper_type)
#endif
#ifndef NAME
#define NAME "second"
#endif
#ifndef CREATE
#define CREATE create
#endif
#ifndef STEP
#define STEP step
#endif
#ifndef ORDER
#define ORDER 0
#endif

const weft_plugin *ENTRY(void);

static inline weft_status create(const weft_stepper_type *type, const weft_ode *ode,
                                 const weft_stepper_config *config, void **self,
                                 weft_error *err)
{
    (void)ode;
    (void)config;
    *self = NULL;
    return weft_error_set(err, WEFT_UNSUPPORTED, "%s only loads", type->name);
}

static inline weft_status step(void *self, double t_end, double *t, double *y,
                               weft_error *err)
{
    (void)self;
    (void)t_end;
    (void)t;
    (void)y;
    return weft_error_set(err, WEFT_UNSUPPORTED, "no step");
}

static void state_changed(void *self)
{
    (void)self;
}

static void stats(const void *self, weft_stepper_stats *out)
{
    (void)self;
    out->rhs_calls = 1;
}

static void destroy(void *self)
{
    (void)self;
}

static const weft_stepper_type first = {
    .abi = WEFT_STEPPER_ABI,
    .struct_size = sizeof(weft_stepper_type),
    .name = "first",
    .reference = "none",
    .license = "BSD-3-Clause",
    .create = create,
    .step = step,
    .state_changed = state_changed,
    .stats = stats,
    .destroy = destroy,
};

/* The one that is spoilt. */
static const weft_stepper_type second = {
    .abi = TYPE_ABI,
    .struct_size = TYPE_SIZE,
    .name = NAME,
    .order = ORDER,
    .reference = "none",
    .license = "BSD-3-Clause",
    .create = CREATE,
    .step = STEP,
    .state_changed = state_changed,
    .stats = stats,
    .destroy = destroy,
};

WEFT_API const weft_plugin *ENTRY(void)
{
    static const weft_stepper_type *const types[] = { &first, &second, NULL };
    static const weft_plugin plugin = {
        .abi = ABI,
        .struct_size = SIZE,
        .id = ID,
        .version = WEFT_VERSION,
        .solver = "",
        .types = types,
    };
    return &plugin;
}
