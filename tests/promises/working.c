/* SPDX-License-Identifier: BSD-3-Clause */
/* working.c -- the explicit midpoint method, which keeps every promise. The others of
 * this folder are this one with one promise broken each: they set the macro of what
 * they spoil and include it. */
#include "weft/stepper.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef ID
#define ID    "working"
#define ENTRY weft_plugin_working
#endif
#ifndef ORDER
#define ORDER 2
#endif
#ifndef T_AFTER
#define T_AFTER(t, h, last, t_end) ((last) ? (t_end) : (t) + (h))
#endif
#ifndef STARTS_AT
#define STARTS_AT(self, t) (t)
#endif
#ifndef ACCEPTS
#define ACCEPTS(y, count) all_finite(y, count)
#endif
#ifndef BUFFER
#define BUFFER(self) ((self)->buffer)
#endif
#ifndef ON_ENTRY
#define ON_ENTRY() ((void)0)
#endif
#ifndef ON_CREATE
#define ON_CREATE(self, config) ((void)(config))
#endif
#ifndef ON_STEP
#define ON_STEP(self) ((void)(self))
#endif
#ifndef ON_FAILURE
#define ON_FAILURE(self, y) ((void)(y))
#endif
#ifndef ON_CHANGE
#define ON_CHANGE(self) ((void)(self))
#endif
#ifndef STATS_BYTES
#define STATS_BYTES(size)                                                              \
    ((size) < sizeof(weft_stepper_stats) ? (size) : sizeof(weft_stepper_stats))
#endif
#ifndef ON_REFUSAL
#define ON_REFUSAL(config) ((void)(config))
#endif
#ifndef ON_DESTROY
#define ON_DESTROY(self) free(self)
#endif
#ifndef MORE_FLAGS
#define MORE_FLAGS 0
#endif
#ifndef REFUSES
#define REFUSES(config)                                                                \
    (!((config)->fixed_step > 0.0) || !isfinite((config)->fixed_step))
#endif

enum { DIM_MOST = 16384 }; /* of the largest problem of the checks */

typedef struct stepper {
    weft_ode ode;
    double fixed_step; /* [s] */
    double clock;      /* [s] where the last step ended */
    weft_stepper_stats stats;
    double buffer[3 * DIM_MOST]; /* the state within a step, and two of f */
} stepper;

const weft_plugin *ENTRY(void);

static inline bool all_finite(const double *y, size_t count)
{
    while (count > 0 && isfinite(y[count - 1])) {
        --count;
    }
    return count == 0;
}

static weft_status create(const weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **self,
                          weft_error *err)
{
    *self = NULL;
    if (config->struct_size < WEFT_STEPPER_CONFIG_LEAST || config->butcher != NULL
        || weft_stepper_half(ode, config) == 0 || ode->dim > DIM_MOST
        || (WEFT_HAS(config, weft_stepper_config, quadratures)
            && config->quadratures > 0)
        || REFUSES(config)) {
        ON_REFUSAL(config);
        return weft_error_set(err, WEFT_INVALID, "%s: wrong numbers", type->name);
    }
    stepper *made = calloc(1, sizeof *made);
    if (made == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", type->name);
    }
    made->ode = *ode;
    made->fixed_step = config->fixed_step;
    ON_CREATE(made, config);
    *self = made;
    return WEFT_OK;
}

/* y + h f(t + h/2, y + (h/2) f) into the buffer */
static int midpoint(stepper *self, double t, double h, const double *y)
{
    const size_t dim = self->ode.dim;
    double *next = BUFFER(self), *f = next + dim, *g = f + dim;
    ++self->stats.rhs_calls;
    int failed = self->ode.rhs(t, y, f, self->ode.ctx);
    for (size_t i = 0; i < dim; ++i) {
        next[i] = y[i] + 0.5 * h * f[i];
    }
    if (failed == 0) {
        ++self->stats.rhs_calls;
        failed = self->ode.rhs(t + 0.5 * h, next, g, self->ode.ctx);
    }
    for (size_t i = 0; i < dim; ++i) {
        next[i] = y[i] + h * g[i];
    }
    return failed;
}

static weft_status step(void *instance, double t_end, double *t, double *y,
                        weft_error *err)
{
    stepper *self = instance;
    const double rest = t_end - *t;
    if (!(rest > 0.0)) {
        return weft_error_set(err, WEFT_INVALID, "not forward");
    }
    const bool last = self->fixed_step >= rest * (1.0 - 1e-6);
    const double h = last ? rest : self->fixed_step;
    ON_STEP(self);
    const int failed = midpoint(self, STARTS_AT(self, *t), h, y);
    if (failed < 0) {
        ON_FAILURE(self, y);
        return weft_error_set(err, WEFT_STOPPED, "stopped");
    }
    if (failed > 0 || !ACCEPTS(BUFFER(self), self->ode.dim)) {
        ON_FAILURE(self, y);
        return weft_error_set(err, WEFT_NOT_FINITE, "not finite");
    }
    memcpy(y, BUFFER(self), self->ode.dim * sizeof *y);
    *t = self->clock = T_AFTER(*t, h, last, t_end);
    ++self->stats.steps;
    self->stats.last_step = h;
    return WEFT_OK;
}

static void state_changed(void *instance)
{
    stepper *self = instance;
    ON_CHANGE(self);
}

static void stats(const void *instance, weft_stepper_stats *out)
{
    const stepper *self = instance;
    const uint32_t size = out->struct_size;
    memcpy(out, &self->stats, STATS_BYTES(size));
    out->struct_size = size;
}

static void destroy(void *instance)
{
    ON_DESTROY(instance);
}

WEFT_API const weft_plugin *ENTRY(void)
{
    static const weft_stepper_type type = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_stepper_type),
        .name = "midpoint",
        .reference = "C. Runge, Math. Ann. 46, 1895",
        .license = "BSD-3-Clause",
        .order = ORDER,
        .stages = 2,
        .flags
        = WEFT_STEPPER_FIXED_ONLY | 1 << 9 /* reserved, and accepted */ | (MORE_FLAGS),
        .create = create,
        .step = step,
        .state_changed = state_changed,
        .stats = stats,
        .destroy = destroy,
    };
    ON_ENTRY();
    static const weft_stepper_type *const types[] = { &type, NULL };
    static const weft_plugin plugin = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_plugin),
        .id = ID,
        .version = WEFT_VERSION,
        .solver = "",
        .types = types,
    };
    return &plugin;
}
