/* SPDX-License-Identifier: BSD-3-Clause */
/* nullplugin.c -- to be refused: its entry function returns nothing. */
#include "weft/stepper.h"

const weft_plugin *weft_plugin_nullplugin(void);

WEFT_API const weft_plugin *weft_plugin_nullplugin(void)
{
    return NULL;
}
