/* SPDX-License-Identifier: BSD-3-Clause */
/* name.h -- names that go into paths and files as they are. */
#pragma once

#include <stdbool.h>
#include <string.h>

/* Whether a text is 1 to `most` letters, digits and characters of `more`. */
static inline bool weft__is_name(const char *text, const char *more, size_t most)
{
    static const char allowed[]
        = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    size_t length = 0;
    while (text != NULL && text[length] != '\0'
           && (strchr(allowed, text[length]) != NULL
               || strchr(more, text[length]) != NULL)) {
        ++length;
    }
    return length > 0 && length <= most && text[length] == '\0';
}

/* An id becomes part of a file's name and of a function's. */
#define WEFT__IS_PLUGIN_ID(text)  weft__is_name((text), "_", 48)
#define WEFT__IS_CLOTH_NAME(text) weft__is_name((text), "_-", WEFT_CLOTH_NAME_MAX)
