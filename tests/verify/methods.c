/* SPDX-License-Identifier: BSD-3-Clause */
/* methods.c -- every method of every plugin that is found. */
#include "cli/cli.h"
#include "verify/verify.h"

static void print_refused(void *ctx, const weft_error *why)
{
    (void)ctx;
    fprintf(stderr, "verify: refused: %s\n", why->message);
}

weft_registry *verify_registry(void)
{
    weft_error err = { 0 };
    weft_registry *registry = open_registry(BUILD_DIR "/plugins");
    if (registry != NULL
        && weft_registry_load_all(registry, print_refused, NULL, &err) != WEFT_OK) {
        (void)report_error(&err);
        weft_registry_destroy(registry);
        registry = NULL;
    }
    return registry;
}

bool verify_method_at(const weft_registry *registry, size_t i, verify_method *out)
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

bool verify_adapts(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_FIXED_ONLY) == 0;
}
