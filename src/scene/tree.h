/* SPDX-License-Identifier: BSD-3-Clause */
/* tree.h -- YAML text as a tree of nodes, and changes of it.
 *
 * A node does not change once it is made, so that many parents may share it: an alias
 * is one pointer more, and a change copies the mappings and lists from the root to the
 * place of the change. A tree owns the nodes made for it; a tree made by changes to
 * another one shares the rest of that one's nodes. */
#pragma once

#include <yaml.h>

#include "scene/diagnostics.h"

#define WEFT__MAX_BYTES   ((size_t)16 << 20)
#define WEFT__MAX_NODES   1000000 /* aliases expanded */
#define WEFT__MAX_DEPTH   32      /* mappings and lists inside one another */
#define WEFT__MAX_ANCHORS 1000    /* each is compared with all the others */

/* A pair of a mapping, or an item of a list, which has no key. An override that removes
 * a pair leaves its key, with value NULL, as it must be a known one. */
typedef struct weft__entry {
    const weft__node *key, *value;
} weft__entry;

struct weft__node {
    enum { WEFT__SCALAR, WEFT__LIST, WEFT__MAP } type;
    int style;     /* libyaml's; a plain scalar with the tag !!str counts as quoted */
    bool open;     /* being built: an alias to it would be a cycle */
    weft__mark at; /* where it begins: its anchor or tag, if it has one */
    const char *text;     /* of a scalar */
    weft__entry *entries; /* of a mapping or list */
    size_t count;         /* entries, or bytes of text */
    size_t size, height; /* nodes, and levels of mappings and lists; aliases expanded */
};

typedef struct weft__tree {
    weft__report *report; /* takes mistakes; its allocator makes the nodes */
    const weft__node *root;
    struct weft__block *blocks;
} weft__tree;

void weft__tree_free(weft__tree *tree, const weft_allocator *memory);

/* Zeroed memory, and a copy of a text, that live as long as the tree; NULL: none. */
void *weft__tree_take(weft__tree *tree, size_t count, size_t size);
char *weft__tree_text(weft__tree *tree, const char *text, size_t length);

/* parse.c: reads the one document of a source, from byte `skip` on; NULL root: there is
 * none. false: it was refused, and a mistake reported, or memory ran out. */
bool weft__tree_parse(weft__tree *tree, const weft__source *source, size_t skip,
                      const weft__node **root);

/* A scalar, and an empty node that is like another; NULL: no memory. */
const weft__node *weft__scalar_new(weft__tree *tree, const char *text, size_t length,
                                   int style, weft__mark at);
weft__node *weft__node_new(weft__tree *tree, weft__node like);

/* Adds an entry to a node that is not shared yet. false: it would be too large, which
 * is reported, or memory ran out. */
bool weft__node_add(weft__tree *tree, weft__node *parent, weft__entry entry);

/* A copy with another entry in place of number `slot`, or behind the last; an item
 * without a value is left out. NULL as above. */
const weft__node *weft__node_with(weft__tree *tree, const weft__node *node, size_t slot,
                                  weft__entry entry);

/* The items of a list and their number; 0 of another node. */
static inline size_t weft__item_count(const weft__node *list)
{
    return list->type == WEFT__LIST ? list->count : 0;
}

static inline const weft__node *weft__item(const weft__node *list, size_t i)
{
    return list->entries[i].value;
}

/* The number of a key's first pair in a mapping; its count if it has none. */
size_t weft__find_key(const weft__node *map, const char *key, size_t length);

/* The value of a key of a node; NULL: it is no mapping, or has none. */
const weft__node *weft__value_of(const weft__node *node, const char *key);

/* override.c: puts an override "key.path=value" into a tree whose root is a mapping.
 * Mistakes in it are reported. */
void weft__override_apply(weft__tree *tree, const weft__source *source);

/* The bytes of its key.path. */
size_t weft__override_path(const weft__source *source);

/* Puts a value at a path of dotted keys; `at` is the place of the path. A null removes
 * the value. */
void weft__tree_put(weft__tree *tree, const char *path, size_t length, weft__mark at,
                    const weft__node *value);

/* emit.c: the tree as YAML text, which it owns. NULL: no memory. */
char *weft__tree_emit(weft__tree *tree);

/* The file's name without folders and without .yaml. NULL: no memory. */
char *weft__name_of_file(weft__tree *tree, const char *file);

/* The text of the tree with a line `name: ...` before its first key. NULL: it has no
 * place for one, or no memory. */
char *weft__name_insert(weft__tree *tree, const char *text, const char *name);

/* ---- scalar.c: plain values, close to the core schema of YAML 1.2 ---- */

/* Nothing, ~ or null. */
bool weft__is_null(const weft__node *node);

/* The text of a scalar that is not null and holds no NUL; else NULL. */
const char *weft__text_of(const weft__node *node);

/* A decimal number that is finite, or .inf with a sign or without: no leading zeros,
 * no '_', no 0x, no quotes. */
bool weft__number_of(const weft__node *node, double *out);

/* A number, or a fraction of two as 19/32, which may be quoted. */
bool weft__fraction_of(const weft__node *node, double *out);

/* An integer in decimal digits; one that is too large gives the largest there is. */
bool weft__integer_of(const weft__node *node, long long *out);

/* A spelling of true or false: of YAML 1.2 (`good`), or only of other formats. */
typedef struct weft__switch {
    const char *text;
    bool value, good;
} weft__switch;

/* NULL: the text is none of them. */
const weft__switch *weft__find_switch(const char *text);

/* A node as messages show it: 'text', the text 'text' if quoted, a mapping, ... */
weft__words weft__show(const weft__node *node);

/* The probable reason why a scalar has the wrong type, as " (remove the quotes)"; "" if
 * there is no guess. It names the unit (NULL: none) if the text seems to have one. */
const char *weft__hint(const weft__node *node, bool number, const char *unit, char *out,
                       size_t size);
