/* SPDX-License-Identifier: BSD-3-Clause */
/* document.h -- a text loaded by libyaml, within limits, and overrides put into it. */
#ifndef WEFT_SCENE_DOCUMENT_H
#define WEFT_SCENE_DOCUMENT_H

#include "scene/report.h"

#define WEFT__MAX_BYTES   ((size_t)16 << 20)
#define WEFT__MAX_NODES   1000000 /* anchors expanded */
#define WEFT__MAX_DEPTH   32      /* mappings and lists inside one another */
#define WEFT__MAX_ANCHORS 1000    /* libyaml compares each with all the others */

/* Loads the one document of a source, from byte `skip` on. false if that failed: a
 * mistake was added to the report, or report->no_memory set; *out then needs no delete.
 * Every node's start_mark.index holds the number of the source, and a scalar tagged
 * !!str has lost its plain style, as the quoted text it stands for. */
bool weft__document_load(const weft__source *source, size_t skip, weft__report *report,
                         yaml_document_t *out);

/* Looks for cycles, too many nodes, too much depth and foreign tags. */
bool weft__document_check(yaml_document_t *document, weft__report *report);

/* Puts an override "key.path=value" into a document whose root is a mapping. What is
 * wrong with it is added to the report. A pair of a mapping whose value is 0 was
 * removed: its key is to be known, no more. */
void weft__override_apply(yaml_document_t *document, const weft__source *source,
                          weft__report *report);

/* The document as YAML text, which is the caller's, or NULL if memory ran out. Deletes
 * the document. */
char *weft__document_emit(yaml_document_t *document, const weft_allocator *memory);

/* The index of a key's pair in a mapping; -1 if it is not there. */
ptrdiff_t weft__find_pair(yaml_document_t *document, const yaml_node_t *mapping,
                          const char *key, size_t length);

#endif
