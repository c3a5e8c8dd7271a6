/* SPDX-License-Identifier: BSD-3-Clause */
/* read.h -- read.c: mappings, and the values of keys, read by the table of keys. */
#pragma once

#include "scene/parsed.h"

typedef struct weft__reader {
    weft_scene *scene;
    weft__tree *tree;
    weft__report *report; /* of the tree */
    const weft_scene_def *def;
    const weft__section *root;
    weft__read_fn *const *readers; /* by kind */
    size_t shape;                  /* number of the one that is read */
} weft__reader;

/* A key of a section in a mapping. */
typedef struct weft__found {
    const weft__node *key, *value; /* NULL: absent */
    bool wrong;                    /* the value was refused, or a part of it */
    bool explained; /* absent, and a mistake that was reported may be the reason */
} weft__found;

/* A mapping and which of its section's keys it has. `faults` reports one of a field at
 * its key's value, or, if that is a default, at the value of the other one, unless a
 * value was refused before. */
typedef struct weft__match {
    weft__reader *reader;
    weft__faults faults;
    const weft__section *section;
    const char *title;
    const weft__node *map;
    weft__found found[WEFT__MAX_KEYS]; /* in the order of the section's keys */
    bool wrong;                        /* one of them is */
} weft__match;

/* Read a mapping by its section into base; NULL: the section is absent, and only its
 * defaults are put in place. */
void weft__read_section(weft__reader *reader, const weft__section *section,
                        const char *title, const weft__node *node, void *base);

/* Read the value of a key into base. */
void weft__read_value(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *base);

/* The text of a default as a value, in *plain or of the tree; NULL: no memory. */
const weft__node *weft__fallback_node(weft__tree *tree, const char *text,
                                      weft__node *plain);

/* A key by its name, which must be one of the section's. */
const weft__found *weft__found_in(const weft__match *match, const char *name);

/* Its node, and its value; NULL: it is absent. */
const weft__node *weft__key_in(const weft__match *match, const char *name);
const weft__node *weft__value_in(const weft__match *match, const char *name);

/* Whether a key is absent and no mistake explains it. */
bool weft__lacks(const weft__match *match, const char *name);

/* Reports "KEY must be TYPE, not VALUE (hint)". */
void weft__refuse_value(weft__reader *reader, const weft__key *key,
                        const weft__node *node);

/* The same with another name and type. */
void weft__refuse(weft__reader *reader, const weft__node *node, const char *name,
                  const char *wanted, bool number, const char *unit);

/* The index in key->names of the name that is the value; false: it is none of them,
 * which is reported. */
bool weft__find_name(weft__reader *reader, const weft__key *key, const weft__node *node,
                     size_t *index);

/* A number within the bounds of a key, or of a Butcher table; `name` in messages. */
bool weft__read_number(weft__reader *reader, const weft__key *key, const char *name,
                       const weft__node *node, double *out);

/* The numbers of a list, name[0], name[1], ...; false if one is wrong. */
bool weft__read_numbers(weft__reader *reader, const weft__key *key, const char *name,
                        const weft__node *list, double *out);

/* A list of lists of `width` numbers, which are called `row` ("a point [u, v] [m]"):
 * all numbers, of the tree, with room for one row more. NULL: one is wrong, or no
 * memory. */
double *weft__read_table(weft__reader *reader, const weft__key *key,
                         const weft__node *node, size_t width, const char *row);

/* Reports keys, NULL at their end, by a rule: "'mass' needs a grid". Whether there were
 * some. */
bool weft__report_excluded(weft__reader *reader, const weft__match *match,
                           const char *const *names, const char *rule);

/* Reports keys that exclude each other: names, NULL at their end. false: none of them
 * is there. Then the lack of all as well. */
bool weft__check_exclusive(weft__reader *reader, const weft__match *match,
                           const char *const *names);
void weft__check_one(weft__reader *reader, const weft__match *match,
                     const char *const *names);

/* The one of two nodes that stands behind the other; NULL stands before any. */
const weft__node *weft__later(const weft__node *a, const weft__node *b);

/* Two keys of one mapping that may not stand together: reported at the later one. */
void weft__report_exclusive(weft__report *report, const weft__node *a,
                            const weft__node *b);

/* Adds a note to the scene, or to the cloth that is read. */
WEFT_PRINTF(3, 4)
void weft__note_add(weft__reader *reader, const char *about, const char *format, ...);

/* Of each kind: in read.c, scene_*.c and butcher.c. */
#define WEFT__READER(kind, reader, text) extern weft__read_fn weft__read_##reader;
WEFT__KIND_LIST(WEFT__READER)
#undef WEFT__READER
