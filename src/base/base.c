/* SPDX-License-Identifier: BSD-3-Clause */
/* base.c -- texts of the status codes, version. */
#include "weft/base.h"

#include "base/log.h"
#include "base/stop.h"

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

void weft__log(const weft_log *log, weft_log_level level, const char *format, ...)
{
    if (log->write != NULL) {
        char text[1024];
        va_list args;
        va_start(args, format);
        (void)weft_text_format_list(text, sizeof text, format, args);
        va_end(args);
        log->write(log->ctx, level, text);
    }
}

weft_status weft__stopped(weft_error *err)
{
    return weft_error_set(err, WEFT_STOPPED, "asked to stop");
}
