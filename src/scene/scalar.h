/* SPDX-License-Identifier: BSD-3-Clause */
/* scalar.h -- the types of plain values, close to the core schema of YAML 1.2. */
#pragma once

#include "scene/tree.h"

/* Nothing, ~ or null. */
bool weft__is_null(const weft__node *node);

/* The text of a scalar that is not null and holds no NUL; else NULL. */
const char *weft__text_of(const weft__node *node);

/* A decimal number that is finite, or .inf with a sign or without: no leading zeros,
 * no '_', no 0x, no quotes. */
bool weft__number_of(const weft__node *node, double *out);

/* A number, or a fraction of two as 19/32, which may be quoted. */
bool weft__fraction_of(const weft__node *node, double *out);

/* An integer in decimal digits; one that is too large gives the largest there is. */
bool weft__integer_of(const weft__node *node, long long *out);

/* A spelling of true or false: of YAML 1.2 (`good`), or only of other formats. */
typedef struct weft__switch {
    const char *text;
    bool value, good;
} weft__switch;

/* NULL: the text is none of them. */
const weft__switch *weft__find_switch(const char *text);

/* A node as messages show it: 'text', the text 'text' if quoted, a mapping, ... */
const char *weft__show(const weft__node *node, char *out, size_t size);

/* The probable reason why a scalar has the wrong type, as " (remove the quotes)"; "" if
 * there is no guess. It names the unit (NULL: none) if the text seems to have one. */
const char *weft__hint(const weft__node *node, bool number, const char *unit, char *out,
                       size_t size);
