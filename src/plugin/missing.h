/* SPDX-License-Identifier: BSD-3-Clause */
/* missing.h -- what to install for a plugin that comes with weft and is not there. */
#pragma once

#include "weft/registry.h"

/* The command that brings plugin `id` where weft was installed `by`: "source", "pip",
 * "debian" or "spack" (weft__installed_by). NULL: none does, or weft does not know the
 * plugin. */
const char *weft__plugin_advice(const char *by, const char *id);
