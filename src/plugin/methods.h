/* SPDX-License-Identifier: BSD-3-Clause */
/* methods.h -- methods and plugins by their names, messages for unknown ones, and their
 * settings. */
#pragma once

#include "base/faults.h"
#include "weft/cloth.h"
#include "weft/registry.h"

WEFT__NUMBERS(weft__config_numbers, fixed_step, rtol, atol_position, atol_velocity,
              first_step, min_step, max_step);

/* Errors: WEFT_INVALID. */
weft_status weft__config_check(const weft_stepper_config *config, weft_error *err);

/* The names of a plugin's methods that have the flags, as many as fit. */
void weft__methods_list(const weft_plugin *plugin, uint32_t flags, char *out,
                        size_t size);

/* As weft_plugin_method; where it is NULL, *err lists the plugin's methods and names
 * the nearest one, or the one of the others, which NULL ends (NULL: there are none). */
const weft_stepper_type *weft__method_named(const weft_plugin *plugin, const char *name,
                                            const weft_plugin *const *others,
                                            weft_error *err);

/* For methods that are tried: the structure of one particle at rest, which has no
 * springs, on a cloth with these modes (NULL: none), which must outlive it; and its
 * equations. */
weft_structure weft__one_structure(const weft_stiffness *modes);
extern const weft_ode weft__one_ode;

/* [particles] Methods with dense matrices are meant for at most this many. */
enum { WEFT__DENSE_MOST = 36 };

/* The ids of weft's own plugins, NULL at their end. */
enum { WEFT__SHIPPED = 5 };
extern const char *const weft__shipped[WEFT__SHIPPED + 1];

/* " (did you mean 'gsl'?)" for an id that is near one of weft's own plugins; else "".
 */
const char *weft__plugin_guess(const char *id, char *out, size_t size);

/* "; arkode/cash_karp does the same", or comes closest, of a method that `find` finds
 * in place of that of a plugin that is not there; "": none is known or found. Returns
 * text. */
const char *weft__method_instead(const char *plugin, const char *method,
                                 const weft_plugin *(*find)(void *ctx, const char *id,
                                                            weft_error *err),
                                 void *ctx, char *text, size_t size);
