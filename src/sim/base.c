/* SPDX-License-Identifier: BSD-3-Clause */
/* base.c -- texts of the status codes, version. */
#include "weft/base.h"

const char *weft_status_text(weft_status status)
{
    static const char *const texts[] = {
#define TEXT(name, text) [WEFT_##name] = (text),
        WEFT_STATUS_LIST(TEXT)
#undef TEXT
    };
    const size_t index = (size_t)status;
    return index < sizeof texts / sizeof texts[0] ? texts[index] : "unknown status";
}

const char *weft_version(void)
{
    return WEFT_VERSION;
}
