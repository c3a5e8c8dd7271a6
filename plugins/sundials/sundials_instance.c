/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_instance.c -- what an instance of each plugin begins with: its arguments
 * checked, its memory, a context that prints nothing; and how it reports. */
#include "sundials_shared.h"

#include <math.h>
#include <stdlib.h>

const char *weft__sun_mistake(const weft_stepper_type *type, const weft_ode *ode,
                              const weft_stepper_config *config)
{
    const char *wrong = weft_stepper_mistake(type, ode, config);
    const weft_structure *structure
        = wrong == NULL ? weft_stepper_structure(config) : NULL;
    return structure != NULL
                   && structure->particles != weft_stepper_half(ode, config) / 3
               ? "structure of another ode"
               : wrong;
}

/* 40 KiB for tables and all else that does not grow with the state. Much of SUNDIALS
 * does not check the result of malloc, and without a solver it prints a message if
 * memory fails: the same amount is first allocated at once, and freed. A granted malloc
 * must not be optimised away. */
weft_status weft__sun_memory(const char *name, size_t dim, int vectors, weft_error *err)
{
    const double gib = 0x1p30;
    const double bytes = 0xap12 + sizeof(double) * (double)dim * vectors;
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
    whole.next_step = next_step;
    weft_stepper_stats_copy(&whole, out);
}
