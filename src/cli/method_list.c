/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/cli.h"

bool method_at(const weft_registry *registry, size_t i, stepper_method *out)
{
    for (size_t p = 0; p < weft_registry_count(registry); ++p) {
        out->plugin = weft_registry_at(registry, p);
        for (size_t m = 0; out->plugin->types[m] != NULL; ++m) {
            if (i-- == 0) {
                out->type = out->plugin->types[m];
                return true;
            }
        }
    }
    return false;
}

size_t method_count(const weft_registry *registry)
{
    stepper_method m;
    size_t count = 0;
    while (method_at(registry, count, &m)) {
        ++count;
    }
    return count;
}

bool method_adapts(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_FIXED_ONLY) == 0;
}

bool method_best(const weft_registry *registry, const stepper_method *but,
                 stepper_method *out)
{
    const uint32_t unfit = WEFT_STEPPER_FIXED_ONLY | WEFT_STEPPER_MULTISTEP
                           | WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_DENSE;
    stepper_method m;
    int best = 0;
    for (size_t i = 0; method_at(registry, i, &m); ++i) {
        const bool other = but == NULL || m.plugin != but->plugin;
        const int rank = m.type->order + (other ? 100 : 0);
        if ((m.type->flags & unfit) == 0 && m.type->order > 0 && rank > best
            && (but == NULL || m.type != but->type)) {
            best = rank;
            *out = m;
        }
    }
    return best > 0;
}
