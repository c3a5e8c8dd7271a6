/* SPDX-License-Identifier: BSD-3-Clause */
/* diagnostics.h -- the mistakes and warnings of a scene, in the order of their places.
 */
#pragma once

#include <string.h>

#include "base/grow.h"
#include "weft/scene.h"

/* ---- source.c: the texts of a scene: its file, and one for each override ---- */

typedef struct weft__source {
    const char *file; /* name in messages; unused for an override */
    const char *text; /* UTF-8, without a byte order mark; ends with NUL */
    size_t length;    /* bytes */
    size_t number;    /* 0: the file; n: the n-th override */
} weft__source;

/* A file that the scene names, such as that of a mesh, while it is read. */
typedef struct weft__named_file {
    const char *path; /* as messages name it */
    char *text;       /* ends with NUL */
    size_t length;    /* bytes */
    size_t order;     /* of several files that the scene names at one place */
    struct {
        size_t byte, line;
    } found; /* the place that was looked up last, from which lines are counted */
} weft__named_file;

/* A place in one of the sources. Line and column, in characters, count from 0 as
 * libyaml does. An override is a single line, whatever it holds. */
typedef struct weft__mark {
    size_t source, line, column;
    weft__named_file *in; /* the file named there in which the place is; NULL: none. It
                             is read when the diagnostic is made, and never later */
    size_t order;         /* that file's */
    size_t byte;          /* 1 + that of its text; 0: no such file */
} weft__mark;

/* The place of a byte. */
weft__mark weft__source_mark(const weft__source *source, size_t offset);

/* The line of a place, clipped around its column, into out[size]; returns the column
 * of out to point at, from 1, or 0 if there is no such line or nothing on it. */
int weft__source_excerpt(const weft__source *source, weft__mark mark, char *out,
                         size_t size);

/* Bytes of a byte order mark at the beginning of a text that ends with NUL. */
static inline size_t weft__mark_length(const char *text)
{
    return strncmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
}

/* Bytes of the character at text, which is not at the end; one for a byte that is not
 * UTF-8. */
size_t weft__char_length(const char *text, size_t left);

/* Makes a text fit for one line of a message: control characters become '?', and a
 * character that was cut at the end goes. */
void weft__one_line(char *text);

/* ---- diagnostics.c ---- */

/* A part of a message. */
typedef struct weft__words {
    char text[64];
} weft__words;

typedef struct weft__node weft__node; /* tree.h */

/* The place of an item, and the runs of a sweep that have it. */
typedef struct weft__origin {
    weft__mark at;
    size_t runs, first, latest;
} weft__origin;

typedef struct weft__report {
    weft_diagnostics *found;
    const weft__source *sources; /* [0] is the file, [n] the n-th override */
    weft__origin origin[WEFT_DIAGNOSTICS_MAX]; /* of found->items */
    size_t run;                                /* of a sweep, the one being read */
    size_t mistakes; /* of that run, including repeated ones */
    bool no_memory;  /* an allocation failed: the mistakes do not count */
    bool stopped;    /* by weft_scene_def.stop: likewise */
    const weft_allocator *memory;
} weft__report;

/* Add a mistake, or a warning, at a place. The first WEFT_DIAGNOSTICS_MAX in the order
 * of the places are kept. */
WEFT_PRINTF(4, 5)
void weft__report_add(weft__report *report, bool warning, weft__mark at,
                      const char *format, ...);
#define weft__report_error(report, ...)   weft__report_add((report), false, __VA_ARGS__)
#define weft__report_warning(report, ...) weft__report_add((report), true, __VA_ARGS__)

/* The same, to the report of whoever has one, at a node. */
#define ERROR_AT(owner, node, ...)                                                     \
    weft__report_error((owner)->report, (node)->at, __VA_ARGS__)
#define WARNING_AT(owner, node, ...)                                                   \
    weft__report_warning((owner)->report, (node)->at, __VA_ARGS__)

/* weft__reserve; the report knows then that memory ran out. */
static inline bool weft__report_reserve(weft__report *report, void *to, size_t *room,
                                        size_t count, size_t size)
{
    const bool made = weft__reserve(report->memory, to, room, count, size);
    report->no_memory = report->no_memory || !made;
    return made;
}

/* Reports at a node that a file could not be opened, unless memory ran out. */
#define UNOPENED_AT(owner, node, err)                                                  \
    do {                                                                               \
        if ((err).status == WEFT_NO_MEMORY) {                                          \
            (owner)->report->no_memory = true;                                         \
        } else {                                                                       \
            ERROR_AT(owner, node, "%s", (err).message);                                \
        }                                                                              \
    } while (0)

/* weft__zeroed, likewise. */
static inline void *weft__report_take(weft__report *report, size_t count, size_t size)
{
    void *block = weft__zeroed(report->memory, count, size);
    report->no_memory = report->no_memory || block == NULL;
    return block;
}

/* Fills in the place of an item. */
void weft__report_place(const weft__report *report, weft__mark at,
                        weft_diagnostic *item);

/* Ends text[size] with " ..." behind its last whole word if it was cut: its full length
 * is `length`, as snprintf returns it. */
void weft__fit(char *text, size_t size, int length);

/* "line 3, column 7" or "override run.fps", which may be cut. */
weft__words weft__place_text(const weft__report *report, weft__mark at);

/* Whether a stands before b. */
bool weft__mark_before(weft__mark a, weft__mark b);

/* Fill in the places and source lines of the items. WEFT_BAD_SCENE and the first
 * mistake in *err if there is one. */
weft_status weft__report_end(weft__report *report, weft_error *err);
