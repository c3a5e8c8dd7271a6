/* SPDX-License-Identifier: BSD-3-Clause */
/* missing.h -- what to do about a plugin that comes with weft and is not there: what to
 * install, and which method of another plugin does the same. */
#pragma once

#include "weft/registry.h"

/* The command that brings plugin `id` where weft was installed `by`: "source", "pip",
 * "debian" or "spack" (weft__installed_by). NULL: none does, or weft does not know the
 * plugin. */
const char *weft__plugin_advice(const char *by, const char *id);

/* "; arkode/cash_karp does the same", or comes closest, of a method that `find` finds
 * in place of that of a plugin that is not there; "": none is known or found. Returns
 * text. */
const char *weft__method_instead(const char *plugin, const char *method,
                                 const weft_plugin *(*find)(void *ctx, const char *id,
                                                            weft_error *err),
                                 void *ctx, char *text, size_t size);
