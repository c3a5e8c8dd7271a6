/* SPDX-License-Identifier: BSD-3-Clause */
/* source.c -- lines and columns of a text, counted as libyaml counts them. */
#include "scene/source.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* An excerpt shows at most so many characters, and so many of them before its caret. */
#define EXCERPT_CHARS  160
#define EXCERPT_BEFORE 48

/* Bytes that the first byte of a character announces; 0 if it cannot be a first one. */
static size_t announced(unsigned char first)
{
    return first < 0x80                    ? 1
           : first >= 0xC2 && first < 0xE0 ? 2
           : first >= 0xE0 && first < 0xF0 ? 3
           : first >= 0xF0 && first < 0xF5 ? 4
                                           : 0;
}

static bool is_utf8(const char *text, size_t left)
{
    const size_t length = announced((unsigned char)text[0]);
    if (length == 0 || length > left) {
        return false;
    }
    for (size_t i = 1; i < length; ++i) {
        if (((unsigned char)text[i] & 0xC0) != 0x80) {
            return false;
        }
    }
    return true;
}

size_t weft__char_length(const char *text, size_t left)
{
    return is_utf8(text, left) ? announced((unsigned char)text[0]) : 1;
}

/* Bytes of the line break at text, 0 if there is none: LF, CR, CR LF, and U+0085,
 * U+2028, U+2029, which YAML 1.1 breaks lines at. */
static size_t break_length(const char *text, size_t left)
{
    if (left >= 2 && text[0] == '\r' && text[1] == '\n') {
        return 2;
    }
    if (text[0] == '\n' || text[0] == '\r') {
        return 1;
    }
    if (left >= 2 && memcmp(text, "\xC2\x85", 2) == 0) {
        return 2;
    }
    return left >= 3
                   && (memcmp(text, "\xE2\x80\xA8", 3) == 0
                       || memcmp(text, "\xE2\x80\xA9", 3) == 0)
               ? 3
               : 0;
}

yaml_mark_t weft__source_mark(const weft__source *source, size_t offset)
{
    yaml_mark_t mark = { .index = source->number };
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

yaml_mark_t weft__source_mark_from(const weft__source *source, size_t skip,
                                   yaml_mark_t mark)
{
    const yaml_mark_t start = weft__source_mark(source, skip);
    if (source->number > 0) {
        return (yaml_mark_t){ .index = source->number,
                              .column = start.column + mark.index };
    }
    mark.index = 0;
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
    const size_t length = weft__char_length(text, left);
    const bool shown = is_utf8(text, left)
                       && ((unsigned char)text[0] >= 0x20 || text[0] == '\t')
                       && text[0] != 0x7F;
    if (*used + length + sizeof "..." > size) {
        return 0;
    }
    memcpy(out + *used, shown ? text : "?", shown ? length : 1);
    *used += shown ? length : 1;
    return length;
}

int weft__source_excerpt(const weft__source *source, yaml_mark_t mark, char *out,
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

/* The code point of a character in UTF-8; 0 if it is written too long. */
static uint32_t code_point(const char *text, size_t length)
{
    static const uint32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
    const unsigned char *bytes = (const unsigned char *)text;
    uint32_t code = length == 1 ? bytes[0] : bytes[0] & (0x7Fu >> length);
    for (size_t i = 1; i < length; ++i) {
        code = code << 6 | (bytes[i] & 0x3Fu);
    }
    return code >= least[length] ? code : 0;
}

/* What YAML takes as it is and a terminal shows within the line. */
static bool is_shown(const char *text, size_t left)
{
    if (!is_utf8(text, left) || break_length(text, left) > 0) {
        return false;
    }
    const uint32_t code = code_point(text, announced((unsigned char)text[0]));
    return code >= 0x20 && !(code >= 0x7F && code < 0xA0)
           && !(code >= 0xD800 && code < 0xE000) && (code | 1) != 0xFFFF
           && code <= 0x10FFFF;
}

void weft__one_line(char *text)
{
    size_t used = 0;
    const size_t length = strlen(text);
    for (size_t i = 0; i < length;) {
        const size_t step = weft__char_length(text + i, length - i);
        const bool cut = announced((unsigned char)text[i]) > length - i;
        const bool shown = is_shown(text + i, length - i);
        if (cut) {
            break;
        }
        memmove(text + used, shown ? text + i : "?", shown ? step : 1);
        used += shown ? step : 1;
        i += step;
    }
    text[used] = '\0';
}
