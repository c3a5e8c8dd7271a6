/* SPDX-License-Identifier: BSD-3-Clause */
/* unknown.c -- hints for a key that is not in the table. */
#include <string.h>

#include "base/suggest.h"
#include "scene/keys.h"

const weft__key *weft__key_named(const weft__section *section, const char *name)
{
    for (size_t i = 0; i < section->count; ++i) {
        if (strcmp(section->keys[i].name, name) == 0) {
            return &section->keys[i];
        }
    }
    return NULL;
}

/* The first section below `from`, other than `other`, that has a key of that name; its
 * path, as ".cloth.grid", is written to out[size]. */
static bool find_elsewhere(const weft__section *from, const weft__section *other,
                           const char *name, char *out, size_t size)
{
    if (from != other && from != &weft__root && weft__key_named(from, name) != NULL) {
        return true;
    }
    for (size_t i = 0; i < from->count; ++i) {
        const weft__key *key = &from->keys[i];
        const size_t length = strlen(key->name) + 1;
        if (key->kind == WEFT__MAPPING && length < size) {
            (void)snprintf(out, size, ".%s", key->name);
            if (find_elsewhere(key->section, other, name, out + length,
                               size - length)) {
                return true;
            }
        }
    }
    return false;
}

const char *weft__unknown_hint(const weft__section *section, const char *title,
                               const char *name, char *out, size_t size)
{
    weft__guess guess = { 0 };
    char path[120], names[240], elsewhere[160] = "";
    for (size_t i = 0; i < section->count; ++i) {
        weft__guess_try(&guess, name, section->keys[i].name);
    }
    if (guess.name != NULL) {
        (void)weft__guess_text(&guess, out, size);
        return guess.name;
    }
    if (find_elsewhere(&weft__root, section, name, path, sizeof path)) {
        (void)snprintf(elsewhere, sizeof elsewhere, " (it is a key of %s)", path + 1);
    }
    const int used = snprintf(out, size, "%s; %s has %s", elsewhere, title,
                              weft__key_names(section, names, sizeof names));
    if (section->beside == &weft__place_section && (size_t)used < size) {
        (void)snprintf(out + used, size - (size_t)used, "; %s has %s",
                       weft__place_section.title,
                       weft__key_names(&weft__place_section, names, sizeof names));
    }
    return NULL;
}
