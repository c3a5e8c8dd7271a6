/* SPDX-License-Identifier: BSD-3-Clause */
/* methods.h -- methods and plugins by their names, and what to say of one that is not
 * there. */
#ifndef WEFT_SIM_METHODS_H
#define WEFT_SIM_METHODS_H

#include "weft/sim.h"

/* The names of a plugin's methods that have the flags, as many as fit. */
void weft__methods_list(const weft_plugin *plugin, uint32_t flags, char *out,
                        size_t size);

/* As weft_plugin_method; where it is NULL, *err tells what there is, and which other
 * plugin has it (NULL: none is known). */
const weft_stepper_type *weft__method_named(const weft_plugin *plugin, const char *name,
                                            const char *other, weft_error *err);

/* The ids of weft's own plugins, NULL at their end. */
extern const char *const weft__shipped[];

/* " (did you mean 'gsl'?)" of an id that weft's own plugins do not have; else "". */
const char *weft__plugin_guess(const char *id, char *out, size_t size);

#endif
