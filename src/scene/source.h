/* SPDX-License-Identifier: BSD-3-Clause */
/* source.h -- the texts a scene comes from: its file, and one for each override. */
#pragma once

#include <stddef.h>

typedef struct weft__source {
    const char *file; /* name in messages; unused for an override */
    const char *text; /* UTF-8, without a byte order mark; ends with NUL */
    size_t length;    /* bytes */
    size_t number;    /* 0: the file; n: the n-th override */
} weft__source;

/* A place in one of the sources. Line and column, in characters, count from 0 as
 * libyaml does. An override is a single line, whatever it holds. */
typedef struct weft__mark {
    size_t source, line, column;
    size_t byte; /* 1 + that of a file which the scene names at this place (obj.h),
                    whose place a message gets; 0: none */
} weft__mark;

/* The place of a byte. */
weft__mark weft__source_mark(const weft__source *source, size_t offset);

/* The line of a place, clipped around its column, into out[size]; returns the column
 * of out to point at, from 1, or 0 if there is no such line or nothing on it. */
int weft__source_excerpt(const weft__source *source, weft__mark mark, char *out,
                         size_t size);

/* Bytes of the character at text, which is not at the end; one for a byte that is not
 * UTF-8. */
size_t weft__char_length(const char *text, size_t left);

/* Makes a text fit for one line of a message: control characters become '?', and a
 * character that was cut at the end goes. */
void weft__one_line(char *text);
