/* SPDX-License-Identifier: BSD-3-Clause */
#pragma once

/* Returns the status of a call that fails. */
#define TRY(call)                                                                      \
    do {                                                                               \
        const weft_status tried = (call);                                              \
        if (tried != WEFT_OK) {                                                        \
            return tried;                                                              \
        }                                                                              \
    } while (0)
