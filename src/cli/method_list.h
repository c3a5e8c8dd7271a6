/* SPDX-License-Identifier: BSD-3-Clause */
/* method_list.h -- every method of every plugin of a registry. */
#ifndef WEFT_CLI_METHOD_LIST_H
#define WEFT_CLI_METHOD_LIST_H

#include "weft/sim.h"

typedef struct stepper_method {
    const weft_plugin *plugin;
    const weft_stepper_type *type;
} stepper_method;

/* The i-th method of all; false past the last. */
bool method_at(const weft_registry *registry, size_t i, stepper_method *out);
size_t method_count(const weft_registry *registry);
bool method_adapts(const weft_stepper_type *type);

/* The explicit one-step method of the highest order that can adapt, of a plugin other
 * than that of `but` where there is one (NULL: of any); false if there is none, or none
 * but `but`. */
bool method_best(const weft_registry *registry, const stepper_method *but,
                 stepper_method *out);

#endif
