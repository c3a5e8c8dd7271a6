/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/plugins.h -- the plugins that weft comes with, to be linked in:
 * -lweft-plugin-ID, or by pkg-config weft-plugin-ID. For weft_registry_add, or
 * weft_plugin_method at once. Those that a program loads need no declaration. */
#ifndef WEFT_PLUGINS_H
#define WEFT_PLUGINS_H

#include "weft/stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

WEFT_API const weft_plugin *weft_plugin_verlet(void);
WEFT_API const weft_plugin *weft_plugin_arkode(void); /* where SUNDIALS was there */
WEFT_API const weft_plugin *weft_plugin_gsl(void); /* GPL-3.0-or-later; where GSL was */

#ifdef __cplusplus
}
#endif

#endif
