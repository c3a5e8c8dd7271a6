/* SPDX-License-Identifier: BSD-3-Clause */
/* methods.c -- every plugin that is found. */
#include "program/cli.h"
#include "verify/verify.h"

static void print_refused(void *ctx, const weft_error *why)
{
    (void)ctx;
    fprintf(stderr, "verify: refused: %s\n", why->message);
}

weft_registry *verify_registry(void)
{
    weft_error err = { 0 };
    weft_registry *registry = open_registry(BUILD_DIR "/plugins", true);
    if (registry != NULL
        && weft_registry_load_all(registry, print_refused, NULL, &err) != WEFT_OK) {
        (void)report_error(&err);
        weft_registry_destroy(registry);
        registry = NULL;
    }
    return registry;
}
