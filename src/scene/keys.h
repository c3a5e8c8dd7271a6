/* SPDX-License-Identifier: BSD-3-Clause */
/* keys.h -- the table of all keys: what the parser accepts, what scene-help prints. */
#pragma once

#include "base/faults.h"
#include "scene/diagnostics.h"

/* X(kind, reader, type): the kinds of values, the function weft__read_... that reads
 * one to what the comment says, and the type as messages call it. */
#define WEFT__KIND_LIST(X)                                                             \
    X(MAPPING, mapping, "a mapping")        /* a section */                            \
    X(NUMBER, real, "a number")             /* double */                               \
    X(INTEGER, integer, "an integer")       /* of the type of its number */            \
    X(VECTOR, vector, "a vector [x, y, z]") /* double[3] */                            \
    X(TEXT, text, "text")                   /* char *, of the tree */                  \
    X(BOOLEAN, boolean, "true or false")    /* bool */                                 \
    X(CHOICE, choice, "")                   /* enum: one of names, from `first` on */  \
    X(EITHER, choice, "")                   /* bool: whether the second of names */    \
    X(NAMES, names, "a list of ")           /* bool of each of names */                \
    X(PAIR, vector, "a number")             /* double[2] */                            \
    X(WARP_WEFT, warp_weft, "a number")     /* of two weft_spring_def */               \
    X(CONDITION, condition,                                                            \
      "'max_strain > NUMBER', 'min_gap < NUMBER' or 'kinetic < NUMBER'")               \
    X(REST, rest, "true, false or a number > 0")          /* weft_stop_def */          \
    X(FACETS, facets, "true, false or a number > 0")      /* double: 0, -1 for true */ \
    X(PRESET, preset, "a name that 'weft fabrics' lists") /* weft_fabric */            \
    X(SHEET, sheet, "a mapping")                          /* the same */               \
    X(ARCSIM, arcsim, "the JSON file of an ARCSim material, or what it has")           \
    X(ATOL, atol, "a number")                         /* two doubles */                \
    X(INDEX, index, "an index, [first, last] or all") /* weft_range */                 \
    X(PLACE, place, "a corner, an edge, [row, column] or {rows, cols}")                \
    X(VERTEX_LIST, vertices, "a list of vertex indices") /* weft__vertices */          \
    X(GROUP, group, "the name of a group")               /* the same */                \
    X(NEAREST, near, "a point [x, y, z]")                /* the same */                \
    X(INSIDE, inside, "a mapping")                       /* the same */                \
    X(FABRICS, fabrics, "a mapping of up to 64 names to mappings as fabric")           \
    X(CLOTHS, cloths, "a list of 1 to 64 mappings {name, keys as cloth}")              \
    X(PATH, paths, "a list of points [u, v], or {disc: radius}")                       \
    X(PATHS, paths, "a list, each item points [[u, v], ...] or {disc: radius}")        \
    X(TRACK, track, "a list of rows [t, x, y, z], or their CSV file") /* weft_table */ \
    X(PATHS_OF_KEYS, keys, "a list of 1 to 16 keys of numbers")                        \
    X(ITEMS, items, "a list of ")    /* an array of the cloth's definition */          \
    X(ROW, row, "a list of numbers") /* weft__list: of a Butcher table */              \
    X(ROWS, rows, "a list of rows")  /* weft__list: its matrix */

typedef enum weft__kind {
#define WEFT__KIND(kind, reader, text) WEFT__##kind,
    WEFT__KIND_LIST(WEFT__KIND)
#undef WEFT__KIND
        WEFT__FRACTION, /* a number of a row, in messages */
    WEFT__SWEEP,        /* taken out of the tree before it is read */
    WEFT__KINDS
} weft__kind;

typedef struct weft__section weft__section;
struct weft__reader;
struct weft__match;

typedef struct weft__key {
    const char *name;
    weft__kind kind;
    bool required;
    bool some;                  /* a list must not be empty */
    const weft__number *number; /* of numbers: range and unit; NULL: any */
    const char *unit;           /* "N/m", if no number has it; NULL: none */
    const char *fallback;       /* the default, as a scene would say it; NULL: none */
    const char *absent; /* what holds without the key, in words, if no fallback */
    const char *meaning;
    const char *const *names; /* of a choice or a list; ends with NULL */
    unsigned first;
    unsigned of; /* a bit for each choice of the section's first key that it goes with;
                    0: with all */
    unsigned also;                /* the same, but where it is not required */
    const weft__section *section; /* of the kinds that are or hold mappings */
    const struct weft__items *items;
    size_t at; /* offset into what the section fills, beside the number's own */
} weft__key;

/* Called when all keys of a section were read into base. */
typedef void weft__check_fn(struct weft__reader *reader,
                            const struct weft__match *match, void *base);

struct weft__section {
    const char *title; /* in messages; NULL: the name of its key */
    const weft__key *keys;
    size_t count;
    const char *one[4];      /* keys of which exactly one is required */
    const char *together[2]; /* keys that have no effect without each other */
    weft__check_fn *check;   /* of other rules between the keys; NULL: none */
    weft__check_fn *late; /* of a section of the scene: once the whole scene, which is
                             matched, was read without errors; NULL: none */
    /* Keys of another mapping that are often put here, and the hint then. */
    const weft__section *beside;
    const char *beside_hint;
};

#define WEFT__MAX_KEYS 20 /* of a section */

extern const weft__section weft__root;

/* Reads a value of one kind to `to`. */
typedef void weft__read_fn(struct weft__reader *reader, const weft__key *key,
                           const weft__node *node, void *to);

/* keys.c: by kind; NULL: not read. */
extern weft__read_fn *const weft__readers[WEFT__KINDS];

/* The items of a list, whose key leads to the array. */
struct weft__items {
    size_t size;         /* [bytes] of one */
    size_t count;        /* offset of their number beside the array */
    weft__read_fn *read; /* one of them */
};

/* The type of a key: "a number >= 0 [N/m]", without its article if `bare`. */
const char *weft__wanted(const weft__key *key, bool unit, bool bare, char *out,
                         size_t size);

/* The offset into what its section fills. */
static inline size_t weft__offset_of(const weft__key *key)
{
    return key->at + (key->number == NULL ? 0 : key->number->at);
}

/* "N/m"; NULL: the key has no unit. */
const char *weft__unit_of(const weft__key *key);

/* " [N/m]"; "" of a key without a unit. */
weft__words weft__unit_text(const weft__key *key);

/* The key of a section with a name; NULL: there is none. */
const weft__key *weft__key_named(const weft__section *section, const char *name);

/* The hint for a name that is no key of a section: the key that may have been meant,
 * which is returned (NULL: none is near), or the path from the root of a section that
 * has such a key, and the keys of this one. */
const char *weft__unknown_hint(const weft__section *root, const weft__section *section,
                               const char *title, const char *name, char *out,
                               size_t size);

/* "stiffness, damping" */
const char *weft__key_names(const weft__section *section, char *out, size_t size);
