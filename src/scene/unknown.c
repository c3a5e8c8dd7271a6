/* SPDX-License-Identifier: BSD-3-Clause */
/* unknown.c -- what to say of a key that is not in the table. */
#include <string.h>

#include "base/suggest.h"
#include "scene/keys.h"

enum { LISTED = 8 };

/* Puts "name." before a path, or the name alone if it is empty. */
static void prepend(const char *name, char *path, size_t size)
{
    const size_t length = strlen(name), rest = strlen(path), dot = rest > 0;
    if (length + dot + rest < size) {
        memmove(path + length + dot, path, rest + 1);
        memcpy(path, name, length);
        memset(path + length, '.', dot);
    }
}

/* The first section below `from`, other than `other`, that has a key of that name; its
 * path is written to out, from its end, as most names are nowhere. */
static bool find_elsewhere(const weft__section *from, const weft__section *other,
                           const char *name, char *out, size_t size)
{
    for (size_t i = 0; i < from->count; ++i) {
        if (from != other && from != &weft__root
            && strcmp(from->keys[i].name, name) == 0) {
            out[0] = '\0';
            return true;
        }
    }
    for (size_t i = 0; i < from->count; ++i) {
        const weft__key *key = &from->keys[i];
        if (key->kind == WEFT__MAPPING
            && find_elsewhere(key->section, other, name, out, size)) {
            prepend(key->name, out, size);
            return true;
        }
    }
    return false;
}

/* The nearest of the keys that are not listed yet. */
static size_t nearest(const double *unlikeness, const bool *listed, size_t count)
{
    size_t best = count;
    for (size_t i = 0; i < count; ++i) {
        if (!listed[i] && (best == count || unlikeness[i] < unlikeness[best])) {
            best = i;
        }
    }
    return best;
}

/* "; run has duration, fps, threads, checkpoint": in the order of the table, or of more
 * than fit the nearest ones. */
static void list_keys(const weft__section *section, const char *title, const char *name,
                      char *out, size_t size)
{
    bool listed[WEFT__MAX_KEYS] = { false };
    double unlikeness[WEFT__MAX_KEYS];
    for (size_t i = 0; i < section->count && section->count > LISTED; ++i) {
        unlikeness[i] = weft__unlikeness(name, section->keys[i].name);
    }
    size_t used = (size_t)snprintf(out, size, "; %s has", title);
    for (size_t n = 0; n < section->count && n < LISTED && used < size; ++n) {
        const size_t i
            = section->count > LISTED ? nearest(unlikeness, listed, section->count) : n;
        listed[i] = true;
        used += (size_t)snprintf(out + used, size - used, "%s %s", n == 0 ? "" : ",",
                                 section->keys[i].name);
    }
    if (section->count > LISTED && used < size) {
        (void)snprintf(out + used, size - used, ", ...");
    }
}

const char *weft__unknown_hint(const weft__section *section, const char *title,
                               const char *name, char *out, size_t size)
{
    weft__guess guess = { 0 };
    char path[120];
    size_t used = 0;
    for (size_t i = 0; i < section->count; ++i) {
        weft__guess_try(&guess, name, section->keys[i].name);
    }
    if (guess.name != NULL) {
        (void)weft__guess_text(&guess, out, size);
        return guess.name;
    }
    if (find_elsewhere(&weft__root, section, name, path, sizeof path)) {
        used = (size_t)snprintf(out, size, " (it is a key of %s)", path);
    }
    if (used < size) {
        list_keys(section, title, name, out + used, size - used);
    }
    return NULL;
}
