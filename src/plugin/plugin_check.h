/* SPDX-License-Identifier: BSD-3-Clause */
/* plugin_check.h -- what makes a plugin usable, and which ones there are. */
#pragma once

#include "base/log.h"
#include "base/try.h"
#include "weft/registry.h"

/* plugin_check.c: writes the fault of an unusable plugin to *err, with WEFT_BAD_PLUGIN.
 */
weft_status weft__plugin_check(const weft_plugin *plugin, weft_error *err);

/* The same of its method `index`, or of one that a program has without a plugin. */
weft_status weft__method_check(const weft_stepper_type *type, size_t index,
                               weft_error *err);

/* Visits the plugins that are loaded, then those that could be. */
typedef void weft__plugin_visit_fn(void *ctx, const char *id, const char *file);
void weft__registry_names(const weft_registry *registry, weft__plugin_visit_fn *visit,
                          void *ctx);
