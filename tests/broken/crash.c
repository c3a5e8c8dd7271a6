/* SPDX-License-Identifier: BSD-3-Clause */
/* crash.c -- nothing wrong to look at, but a method that ends its process. */
#include <signal.h>

#include "weft/stepper.h"

static weft_status crash(const weft_stepper_type *type, const weft_ode *ode,
                         const weft_stepper_config *config, void **self,
                         weft_error *err)
{
    (void)ode;
    (void)config;
    *self = NULL;
    (void)raise(SIGKILL);
    return weft_error_set(err, WEFT_SOLVER, "%s lives on", type->name);
}

#define ID     "crash"
#define ENTRY  weft_plugin_crash
#define CREATE crash
#include "good.c"
