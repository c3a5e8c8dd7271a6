/* SPDX-License-Identifier: BSD-3-Clause */
/* sweep.h -- sweep.c, sample.c, sweep_runs.c: the text of a scene with its overrides,
 * and `sweep`, by which it stands for many runs. */
#pragma once

#include "scene/tree.h"

#define WEFT__SWEEP_KEYS 16

/* A key that is varied, and the list of its values. */
typedef struct weft__axis {
    const weft__node *key, *list;
    bool log; /* a sample has them in ratios */
} weft__axis;

typedef struct weft__sweep {
    bool present, zip;
    weft__mark at;         /* of its key */
    size_t keys, runs;     /* runs 1 without a sweep, 0 if something is wrong with it */
    size_t sample, seed;   /* how many values are drawn of each list; 0: its own */
    const weft__node *log; /* names of keys; NULL: none */
    weft__axis axis[WEFT__SWEEP_KEYS];
} weft__sweep;

/* Finds and checks the sweep of a tree whose root is a mapping, and takes it out of
 * there. Keys that one of set_count overrides sets as well are mistakes, and so are so
 * many runs that reading them all would take more than half a minute. */
void weft__sweep_take(weft__tree *tree, size_t set_count, weft__sweep *out);

/* sample.c: reports mistakes of `sample` and `log`; draws the values if they are asked
 * for, so that the sweep is one of zipped lists. */
void weft__sweep_sample(weft__tree *tree, weft__sweep *sweep);

/* Whether it varies the key at a path, or a part of its value. */
bool weft__sweep_varies(const weft__sweep *sweep, const char *path);

/* Which value of a list a run takes; the last key varies fastest. */
size_t weft__sweep_choice(const weft__sweep *sweep, size_t axis, size_t run);

/* Puts the values of one run, from 1, into its tree. */
void weft__sweep_apply(weft__tree *to, const weft__sweep *sweep, size_t run);

/* The source of scenes: a text, and its tree with the overrides applied. */
typedef struct weft__base {
    weft_scene_def def;
    weft_allocator memory;
    char *text;
    size_t length;
    weft__source *sources; /* the file, then the overrides */
    weft__tree tree;
    weft__sweep sweep;
    bool readable; /* the tree may be read as a scene */
    bool changed;  /* it is not what the text says */
} weft__base;

/* Mistakes are added to the report, which shares the base's allocator; the caller must
 * end it before closing the base. The base must be closed also after an error.
 * Errors: WEFT_INVALID, WEFT_IO, WEFT_NO_MEMORY. */
weft_status weft__base_open(const weft_scene_def *given, weft__base *out,
                            weft__report *report, weft_error *err);
void weft__base_close(weft__base *base);

/* Reads the scene of a run, from 1. WEFT_BAD_SCENE, also if the report had mistakes
 * before. */
weft_status weft__base_read(const weft__base *base, size_t run, weft__report *report,
                            weft_scene **out, weft_error *err);
