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

/** Returns the plugin "verlet": symplectic methods of weft.
 * @return static data; any thread may call this at any time
 * @par Example
 * @snippet minimal.c create */
WEFT_API const weft_plugin *weft_plugin_verlet(void);

/** Returns the plugin "stiff": implicit methods of weft.
 * @return static data; any thread may call this at any time */
WEFT_API const weft_plugin *weft_plugin_stiff(void);

/** Returns the plugin "arkode": Runge-Kutta methods of SUNDIALS. Built where SUNDIALS
 * is.
 * @return static data; any thread may call this at any time */
WEFT_API const weft_plugin *weft_plugin_arkode(void);

/** Returns the plugin "cvode": multistep methods of SUNDIALS. Built where SUNDIALS is.
 * @return static data; any thread may call this at any time */
WEFT_API const weft_plugin *weft_plugin_cvode(void);

/** Returns the plugin "gsl": methods of GSL. Built where GSL is; a program that links
 * it is under GPL-3.0-or-later.
 * @return static data; any thread may call this at any time */
WEFT_API const weft_plugin *weft_plugin_gsl(void);

#ifdef __cplusplus
}
#endif

#endif
