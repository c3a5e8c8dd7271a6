/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/plugins.h -- the plugins that come with weft, for linking: -lweft-plugin-ID, or
 * weft-plugin-ID with pkg-config. Pass them to weft_registry_add or to
 * weft_plugin_method. Plugins that a program loads need no declaration. */
#ifndef WEFT_PLUGINS_H
#define WEFT_PLUGINS_H

#include "weft/stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

WEFT_API const weft_plugin *weft_plugin_verlet(void);
WEFT_API const weft_plugin *weft_plugin_stiff(void);
/* Built where SUNDIALS is. */
WEFT_API const weft_plugin *weft_plugin_arkode(void);
WEFT_API const weft_plugin *weft_plugin_cvode(void);
/* Built where GSL is; GPL-3.0-or-later. */
WEFT_API const weft_plugin *weft_plugin_gsl(void);

#ifdef __cplusplus
}
#endif

#endif
