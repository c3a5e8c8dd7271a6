/* SPDX-License-Identifier: BSD-3-Clause */
/* human.h -- numbers and foreign text as people read them. */
#pragma once

#include <inttypes.h>
#include <stdio.h>

#include "weft/cloth.h"

enum {
    SPRING = 96,     /* bytes that hold what weft_spring_text writes */
    HUMAN_SIZE = 64, /* and weft_cloth_text */
    PAGE_WIDTH = 80  /* characters of a line */
};

typedef struct human {
    char text[32];
} human;

/* "298 us", "5.74 s", "3 min 05 s", "2 h 07 min", "3 d 04 h" */
human human_time(double seconds);
human human_count(uint64_t count); /* "40,530" */

/* The number that is all of the text, or NAN. */
double option_real(const char *text);

/* Whether a text starts with a whole number, in digits alone, and `end`. */
bool option_count(const char *text, char end, size_t *count);

/* A text made of parts; start from { "" }. */
typedef struct sentence {
    char text[1024];
} sentence;

/* Appends to a sentence; text beyond its size is cut off. */
WEFT_PRINTF(2, 3) void say(sentence *out, const char *format, ...);

/* Text that came from a file or a command line: control characters, which a terminal
 * would execute, are written as \x1b; those in `keep` are left. */
void print_plain(FILE *stream, const char *text, const char *keep);

/* A line of at most 8 KiB with such text, and its newline. */
WEFT_PRINTF(2, 3) void print_line(FILE *stream, const char *format, ...);

/* As fprintf, of at most 8 KiB that may contain such text; newlines are left. */
WEFT_PRINTF(2, 3) void print_plainly(FILE *stream, const char *format, ...);

/* Prints such text in lines of at most `width` characters, broken at blanks, with a
 * newline at the end. The first line already has `used` characters; the others begin
 * with `indent` blanks. */
void print_wrapped(FILE *stream, size_t used, size_t indent, size_t width,
                   const char *text);

/* "  label      text" to stdout, in lines of 80 characters. */
WEFT_PRINTF(2, 3) void print_item(const char *label, const char *format, ...);

/* The help of a verb to stdout, its paragraphs and the texts beside its options filled
 * to lines that a manual page can indent by 5. */
void print_help(const char *text);
