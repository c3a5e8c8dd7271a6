/* SPDX-License-Identifier: BSD-3-Clause */
/* source.c -- lines and columns of a text, counted as libyaml counts them. */
#include "scene/diagnostics.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Characters that an excerpt shows at most, in all and before its caret. */
#define EXCERPT_CHARS  160
#define EXCERPT_BEFORE 48

/* Stands for bytes that are not UTF-8. */
#define NONE 0xFFFFu

/* Bytes that the first byte of a character announces; 0 if it cannot be a first one. */
static size_t announced(char first)
{
    const unsigned char byte = (unsigned char)first;
    return byte < 0x80                   ? 1
           : byte >= 0xC2 && byte < 0xE0 ? 2
           : byte >= 0xE0 && byte < 0xF0 ? 3
           : byte >= 0xF0 && byte < 0xF5 ? 4
                                         : 0;
}

/* The character at text, NONE if there is none or it is written too long, and its
 * bytes: 1 where they make no character. */
static uint32_t decode(const char *text, size_t left, size_t *length)
{
    static const uint32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
    const size_t count = announced(text[0]);
    uint32_t code
        = count == 1 ? (uint32_t)text[0] : (uint32_t)text[0] & (0x7Fu >> count);
    *length = 1;
    if (count == 0 || count > left) {
        return NONE;
    }
    for (size_t i = 1; i < count; ++i) {
        if (((unsigned char)text[i] & 0xC0) != 0x80) {
            return NONE;
        }
        code = code << 6 | ((unsigned char)text[i] & 0x3Fu);
    }
    *length = count;
    return code >= least[count] ? code : NONE;
}

size_t weft__char_length(const char *text, size_t left)
{
    size_t length;
    (void)decode(text, left, &length);
    return length;
}

/* Bytes of the line break at text, 0 if there is none: LF, CR, CR LF, and U+0085,
 * U+2028, U+2029, which YAML 1.1 breaks lines at. */
static size_t break_length(const char *text, size_t left)
{
    size_t length;
    const uint32_t code = decode(text, left, &length);
    if (code == '\r' && left > 1 && text[1] == '\n') {
        return 2;
    }
    return code == '\n' || code == '\r' || code == 0x85 || code == 0x2028
                   || code == 0x2029
               ? length
               : 0;
}

weft__mark weft__source_mark(const weft__source *source, size_t offset)
{
    weft__mark mark = { .source = source->number };
    const size_t end = offset < source->length ? offset : source->length;
    for (size_t i = 0; i < end;) {
        const char *at = source->text + i;
        const size_t left = source->length - i;
        const size_t broken = source->number == 0 ? break_length(at, left) : 0;
        mark.line += broken > 0;
        mark.column = broken > 0 ? 0 : mark.column + 1;
        i += broken > 0 ? broken : weft__char_length(at, left);
    }
    return mark;
}

/* The bytes of a line; false if the text has fewer. */
static bool find_line(const weft__source *source, size_t line, size_t *begin,
                      size_t *end)
{
    size_t i = 0;
    for (size_t seen = 0; seen < line && i < source->length;) {
        const size_t broken = break_length(source->text + i, source->length - i);
        seen += broken > 0;
        i += broken > 0 ? broken : 1;
    }
    *begin = i;
    while (i < source->length
           && (source->number > 0
               || break_length(source->text + i, source->length - i) == 0)) {
        ++i;
    }
    *end = i;
    return *begin < *end;
}

/* Copies the character at text if it fits with room for "..."; returns its bytes. */
static size_t copy_char(const char *text, size_t left, char *out, size_t *used,
                        size_t size)
{
    size_t length;
    const uint32_t code = decode(text, left, &length);
    const bool shown = (code >= 0x20 || code == '\t') && code != 0x7F && code != NONE;
    if (*used + length + sizeof "..." > size) {
        return 0;
    }
    memcpy(out + *used, shown ? text : "?", shown ? length : 1);
    *used += shown ? length : 1;
    return length;
}

int weft__source_excerpt(const weft__source *source, weft__mark mark, char *out,
                         size_t size)
{
    size_t begin, end;
    out[0] = '\0';
    if (!find_line(source, mark.line, &begin, &end)) {
        return 0;
    }
    size_t skipped = 0; /* characters left out before the window */
    if (end - begin > EXCERPT_CHARS && mark.column > EXCERPT_BEFORE) {
        for (; skipped < mark.column - EXCERPT_BEFORE && begin < end; ++skipped) {
            begin += weft__char_length(source->text + begin, end - begin);
        }
    }
    size_t used = skipped > 0 ? 3 : 0;
    memcpy(out, "...", used);
    for (size_t chars = 0; begin < end && chars < EXCERPT_CHARS; ++chars) {
        const size_t step
            = copy_char(source->text + begin, end - begin, out, &used, size);
        if (step == 0) {
            break;
        }
        begin += step;
    }
    strcpy(out + used, begin < end ? "..." : "");
    return (int)((skipped > 0 ? 3 : 0) + mark.column - skipped + 1);
}

/* Whether YAML takes a character as it is and a terminal shows it within the line. */
static bool is_shown(uint32_t code)
{
    return code >= 0x20 && !(code >= 0x7F && code < 0xA0) && code != 0x2028
           && code != 0x2029 && !(code >= 0xD800 && code < 0xE000)
           && (code | 1) != 0xFFFF && code <= 0x10FFFF;
}

void weft__one_line(char *text)
{
    size_t used = 0;
    const size_t length = strlen(text);
    for (size_t i = 0, step; i < length && announced(text[i]) <= length - i;
         i += step) {
        const bool shown = is_shown(decode(text + i, length - i, &step));
        memmove(text + used, shown ? text + i : "?", shown ? step : 1);
        used += shown ? step : 1;
    }
    text[used] = '\0';
}
