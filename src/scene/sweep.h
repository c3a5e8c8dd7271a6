/* SPDX-License-Identifier: BSD-3-Clause */
/* sweep.h -- `sweep`: one scene file that stands for many runs. */
#ifndef WEFT_SCENE_SWEEP_H
#define WEFT_SCENE_SWEEP_H

#include "scene/document.h"

#define WEFT__SWEEP_KEYS 16

/* A key that is varied, and the list of its values: nodes of the document. */
typedef struct weft__axis {
    int key, list;
    size_t count;
} weft__axis;

typedef struct weft__sweep {
    bool present, zip;
    yaml_mark_t at;    /* of its key */
    size_t keys, runs; /* runs 1 without a sweep, 0 if something is wrong with it */
    weft__axis axis[WEFT__SWEEP_KEYS];
} weft__sweep;

/* Finds and checks the sweep of a document whose root is a mapping, and takes it out of
 * there. Keys that one of set_count overrides sets as well are mistakes, and so are so
 * many runs that reading them all would take more than half a minute. */
void weft__sweep_take(yaml_document_t *document, size_t set_count, weft__report *report,
                      weft__sweep *out);

/* Whether it varies the key at a path, or a part of its value. */
bool weft__sweep_varies(const weft__sweep *sweep, yaml_document_t *document,
                        const char *path);

/* Puts the values of one run, from 1, into a copy of the document. */
void weft__sweep_apply(yaml_document_t *to, yaml_document_t *document,
                       const weft__sweep *sweep, size_t run, weft__report *report);

#endif
