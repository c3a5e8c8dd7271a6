/* SPDX-License-Identifier: BSD-3-Clause */
/* sweep.h -- `sweep`: one scene file that stands for many runs. */
#pragma once

#include "scene/tree.h"

#define WEFT__SWEEP_KEYS 16

/* A key that is varied, and the list of its values. */
typedef struct weft__axis {
    const weft__node *key, *list;
} weft__axis;

typedef struct weft__sweep {
    bool present, zip;
    weft__mark at;     /* of its key */
    size_t keys, runs; /* runs 1 without a sweep, 0 if something is wrong with it */
    weft__axis axis[WEFT__SWEEP_KEYS];
} weft__sweep;

/* Finds and checks the sweep of a tree whose root is a mapping, and takes it out of
 * there. Keys that one of set_count overrides sets as well are mistakes, and so are so
 * many runs that reading them all would take more than half a minute. */
void weft__sweep_take(weft__tree *tree, size_t set_count, weft__sweep *out);

/* Whether it varies the key at a path, or a part of its value. */
bool weft__sweep_varies(const weft__sweep *sweep, const char *path);

/* Which value of a list a run takes; the last key varies fastest. */
size_t weft__sweep_choice(const weft__sweep *sweep, size_t axis, size_t run);

/* Puts the values of one run, from 1, into its tree. */
void weft__sweep_apply(weft__tree *to, const weft__sweep *sweep, size_t run);
