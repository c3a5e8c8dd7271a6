/* SPDX-License-Identifier: BSD-3-Clause */
/* cvode_plugin.c -- the methods: the two families of formulas of CVODE. */
#include "cvode_plugin.h"

WEFT_API const weft_plugin *weft_plugin_cvode(void);

/* CVODE chooses h and the order by powers of libm. */
enum {
    KIND = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_MULTISTEP | WEFT_STEPPER_LIBM
           | WEFT_STEPPER_ADAPTIVE_ONLY
};

#define TYPE(label, full, highest, more, source)                                       \
    .type = {                                                                          \
        .abi = WEFT_STEPPER_ABI,                                                       \
        .struct_size = sizeof(weft_stepper_type),                                      \
        .name = label,                                                                 \
        .reference = source,                                                           \
        .license = "BSD-3-Clause",                                                     \
        .order = highest,                                                              \
        .flags = KIND | (more),                                                        \
        .create = weft__cvode_create,                                                  \
        .step = weft__cvode_step,                                                      \
        .state_changed = weft__cvode_state_changed,                                    \
        .stats = weft__cvode_stats,                                                    \
        .destroy = weft__cvode_destroy,                                                \
        .full_name = full,                                                             \
        .options = weft__cvode_options,                                                \
    }

/* Of order 3 and more BDF is not A-stable: lightly damped modes bind the step. */
static const cvode_method bdf = {
    TYPE("bdf", "CV_BDF", 2, WEFT_STEPPER_LINEAR | WEFT_STEPPER_COUPLINGS,
         "A. C. Hindmarsh et al., SUNDIALS, ACM TOMS 31, 2005; C. W. Gear, "
         "Prentice-Hall, 1971"),
    .formulas = CV_BDF,
    .usual_order = 2,
};

static const cvode_method adams = {
    TYPE("adams", "CV_ADAMS", 0, 0,
         "A. C. Hindmarsh et al., SUNDIALS, ACM TOMS 31, 2005"),
    .formulas = CV_ADAMS,
    .usual_order = 12,
};

WEFT_API const weft_plugin *weft_plugin_cvode(void)
{
    static const weft_stepper_type *const types[] = { &bdf.type, &adams.type, NULL };
    static const weft_plugin plugin = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_plugin),
        .id = "cvode",
        .version = WEFT_VERSION,
        .solver = "SUNDIALS " SUNDIALS_VERSION,
        .types = types,
    };
    return &plugin;
}
