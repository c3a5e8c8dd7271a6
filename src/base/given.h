/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef WEFT_BASE_GIVEN_H
#define WEFT_BASE_GIVEN_H

#include "weft/base.h"

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

#endif
