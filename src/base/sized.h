/* SPDX-License-Identifier: BSD-3-Clause */
/* sized.h -- structs of callers built against another version (weft/base.h, "growth").
 */
#pragma once

#include <string.h>

#include "weft/base.h"

/* No definition is larger: one that says so was not filled by its _default. */
enum { WEFT__DEF_MOST = 4096 };

/* Copies *from to *to as far as both reach; the rest of *to stays. Returns whether what
 * does not fit is 0. */
bool weft__sized_read(void *to, size_t size, const void *from, size_t given);

/* WEFT_INVALID of a struct for which weft__sized_read was false. */
weft_status weft__sized_unknown(const char *name, weft_error *err);

/* Copies a result to the caller's struct, whose rest becomes 0. */
void weft__sized_write(void *out, size_t size, const void *from, size_t known);

/* Completes the defaults at *def by the caller's definition, whose struct_size is at
 * most `most`. Errors: WEFT_INVALID (not from its _default; members that are unknown
 * here and not 0). */
weft_status weft__def_read(void *def, size_t size, const void *from, size_t most,
                           const char *name, weft_error *err);

#define WEFT__DEF_READ(type, def, from, most, err)                                     \
    (*(def) = type##_default(),                                                        \
     weft__def_read(def, sizeof(type), from, most, #type, err))

/* WEFT_INVALID for a public function without its definition, or a place for its result.
 */
static inline weft_status weft__given(const void *def, const void *out,
                                      const char *function, weft_error *err)
{
    return def != NULL && out != NULL
               ? WEFT_OK
               : weft_error_set(err, WEFT_INVALID, "%s: the %s is NULL", function,
                                def == NULL ? "definition" : "place for the result");
}
