/* SPDX-License-Identifier: BSD-3-Clause */
/* nomethods.c -- to be refused: an empty list of methods. */
#include "weft/stepper.h"

const weft_plugin *weft_plugin_nomethods(void);

WEFT_API const weft_plugin *weft_plugin_nomethods(void)
{
    static const weft_stepper_type *const types[] = { NULL };
    static const weft_plugin plugin = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_plugin),
        .id = "nomethods",
        .version = "1",
        .solver = "",
        .types = types,
    };
    return &plugin;
}
