/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_instance.c -- what an instance of each plugin begins with: its arguments
 * checked, its memory, a context that prints nothing; and how it reports. */
#include "sundials_shared.h"

#include <math.h>
#include <stdlib.h>

static bool positive(double x)
{
    return x > 0.0 && isfinite(x);
}

/* The fault of the numbers of error control, or NULL. NaN fails every comparison. */
static const char *adaptive_mistake(const weft_stepper_config *c)
{
    return c->norm != WEFT_NORM_MAX && c->norm != WEFT_NORM_RMS ? "unknown norm"
           : !(c->rtol >= 0.0 && isfinite(c->rtol))             ? "rtol must be >= 0"
           : !positive(c->atol_position)   ? "atol_position must be > 0 m"
           : !positive(c->atol_velocity)   ? "atol_velocity must be > 0 m/s"
           : !positive(c->first_step)      ? "first_step must be > 0 s"
           : !positive(c->min_step)        ? "min_step must be > 0 s"
           : !(c->max_step >= c->min_step) ? "max_step must be >= min_step"
                                           : NULL;
}

const char *weft__sun_mistake(const weft_stepper_type *type, const weft_ode *ode,
                              const weft_stepper_config *c)
{
    if (c->struct_size < WEFT_STEPPER_CONFIG_LEAST) {
        return "config of an older version";
    }
    const size_t half = weft_stepper_half(ode, c);
    const weft_structure *structure = weft_stepper_structure(c);
    const bool adaptive = c->fixed_step == 0.0;
    const char *alone = weft_stepper_agree_mistake(type->flags, c);
    return ode->rhs == NULL ? "no right-hand side"
           : half == 0      ? "dim less the quadratures must be even and > 0"
           : ode->dim > 2 * half && (type->flags & WEFT_STEPPER_QUADRATURES) == 0
               ? "takes no quadratures"
           : structure != NULL && structure->particles != half / 3
               ? "structure of another ode"
           : !adaptive && !positive(c->fixed_step)
               ? "fixed_step must be > 0 s, or 0 for adaptive steps"
           : !adaptive && (type->flags & WEFT_STEPPER_ADAPTIVE_ONLY) != 0
               ? "takes no fixed_step: it chooses every step by the tolerances"
           : adaptive && (type->flags & WEFT_STEPPER_FIXED_ONLY) != 0
               ? "has no error estimate: it needs fixed_step"
           : alone != NULL ? alone
           : adaptive      ? adaptive_mistake(c)
                           : NULL;
}

/* 32 KiB for tables and all else that does not grow with the state. Much of SUNDIALS
 * does not check the result of malloc, and without a solver it prints a message if
 * memory fails: the same amount is first allocated at once, and freed. A granted malloc
 * must not be optimised away. */
weft_status weft__sun_memory(const char *name, size_t dim, int vectors, weft_error *err)
{
    const double gib = 0x1p30;
    const double bytes = 0x1p15 + sizeof(double) * (double)dim * vectors;
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
void weft__sun_silent(int code, const char *module, const char *function, char *text,
                      void *data)
{
    (void)code, (void)module, (void)function, (void)text, (void)data;
}
#endif

SUNContext weft__sun_context(void)
{
    SUNContext context = NULL;
    if (SUNContext_Create(NO_COMM, &context) != 0) {
        return NULL;
    }
#if SUNV >= 700
    if (SUNContext_ClearErrHandlers(context) != 0
        || SUNContext_PushErrHandler(context, silent, NULL) != 0) {
        (void)SUNContext_Free(&context);
    }
#endif
    return context;
}

void weft__sun_stats(const weft_stepper_stats *stats, double next_step,
                     weft_stepper_stats *out)
{
    weft_stepper_stats whole = *stats;
    whole.struct_size = out->struct_size; /* an older caller's struct is shorter */
    whole.next_step = next_step;
    memcpy(out, &whole,
           out->struct_size < sizeof whole ? out->struct_size : sizeof whole);
}

void weft__sun_tell(weft_option_fn *tell, void *ctx, const char *name, double value)
{
    char text[32];
    int digits = 15;
    do {
        (void)snprintf(text, sizeof text, "%.*g", digits, value);
    } while (strtod(text, NULL) != value && ++digits <= 17);
    tell(ctx, name, text);
}
