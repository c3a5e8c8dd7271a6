/* SPDX-License-Identifier: BSD-3-Clause */
/* document.h -- a text loaded by libyaml, within limits, and overrides put into it. */
#ifndef WEFT_SCENE_DOCUMENT_H
#define WEFT_SCENE_DOCUMENT_H

#include "scene/diagnostics.h"

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

/* The same of a default, without a parser if it is a plain value: parsing defaults
 * would be most of the time that a scene takes. */
bool weft__document_default(const char *text, weft__report *report,
                            yaml_document_t *out);

/* Looks for cycles, too many nodes, too much depth and foreign tags. */
bool weft__document_check(yaml_document_t *document, weft__report *report);

/* The nodes of a tree with anchors expanded, in a document that was checked. */
size_t weft__document_size(yaml_document_t *document, int id);

/* Puts an override "key.path=value" into a document whose root is a mapping. What is
 * wrong with it is added to the report. A pair of a mapping whose value is 0 was
 * removed: its key is to be known, no more. */
void weft__override_apply(yaml_document_t *document, const weft__source *source,
                          weft__report *report);

/* The bytes of its key.path. */
size_t weft__override_path(const weft__source *source);

/* Puts a copy of a node of another document at a path of dotted keys that stands at
 * `at`; a null removes what is there. */
void weft__document_put(yaml_document_t *document, const char *path, yaml_mark_t at,
                        yaml_document_t *from, int value, weft__report *report);

/* A copy without anchors; false if memory ran out: *to then needs no delete. */
bool weft__document_copy(yaml_document_t *to, yaml_document_t *from,
                         weft__report *report);

/* The document as YAML text, which is the caller's, or NULL if memory ran out. Deletes
 * the document. */
char *weft__document_emit(yaml_document_t *document, const weft_allocator *memory);

/* name.c: the file's name without folders and without .yaml, which is the caller's;
 * NULL if memory ran out. */
char *weft__name_of_file(const char *file, const weft_allocator *memory);

/* The text of a document with a line `name: ...` before its first key, which is the
 * caller's; *out is NULL if it is not written so that this can be done. false: memory
 * ran out. */
bool weft__name_insert(yaml_document_t *document, const char *text, const char *name,
                       const weft_allocator *memory, char **out);

/* The same in the document itself. false: memory ran out. */
bool weft__name_append(yaml_document_t *document, const char *name);

/* The index of a key's pair in a mapping; -1 if it is not there. */
ptrdiff_t weft__find_pair(yaml_document_t *document, const yaml_node_t *mapping,
                          const char *key, size_t length);

#endif
