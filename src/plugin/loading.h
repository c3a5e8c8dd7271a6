/* SPDX-License-Identifier: BSD-3-Clause */
/* loading.h -- plugins as code: those in files, and those that the library was built
 * with. A platform without dlopen has its own loading.c. */
#pragma once

#include "weft/registry.h"

/* The i-th plugin that is part of the library; NULL: there are no more. */
const weft_plugin *weft__plugin_built_in(size_t i);

/* Where a plugin was searched for if there is no search path, for a message. */
extern const char weft__no_search_path[];

/* By what weft was installed, for weft__plugin_advice; "": it has all its plugins. */
extern const char weft__installed_by[];

/* The directory of the installed plugins; "": there is none. */
void weft__installed_plugins(char *directory, size_t size);

/* The plugin of a file weft-<id>.so. On failure too, the caller closes *handle unless
 * it is NULL. */
weft_status weft__plugin_open(const char *file, const char *id, void **handle,
                              const weft_plugin **plugin, weft_error *err);
void weft__plugin_close(void *handle);
