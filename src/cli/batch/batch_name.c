/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_name.c -- the directory of a run. */
#include <inttypes.h>
#include <string.h>

#include "base/hash.h"
#include "cli/batch/batch.h"

enum { NAME_MAX_CHARS = 120, HASH_DIGITS = 12 };

typedef struct namer {
    char text[NAME_MAX_CHARS + 1];
    size_t used;
    bool lossy;
    uint64_t hash; /* of the whole name */
} namer;

static void add_char(namer *self, char c, bool safe)
{
    self->hash = weft__hash_byte(self->hash, (unsigned char)c);
    /* a leading dot hides a directory, or is none; a leading '-' is an option */
    safe = safe && !(self->used == 0 && (c == '.' || c == '-'));
    self->lossy = self->lossy || !safe || self->used == NAME_MAX_CHARS;
    if (self->used < NAME_MAX_CHARS
        && (safe || self->used == 0 || self->text[self->used - 1] != '_')) {
        self->text[self->used++] = safe ? c : '_';
    }
}

/* The slash of plugin/method becomes a hyphen, and stays readable. */
static void add(namer *self, const char *text, bool method)
{
    static const char letters[]
        = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._+-";
    for (; *text != '\0'; ++text) {
        const char c = method && *text == '/' ? '-' : *text;
        add_char(self, c, strchr(letters, c) != NULL);
    }
}

/* The part of a path behind its last `parts` dots. */
static const char *tail(const char *path, size_t parts)
{
    const char *from = path + strlen(path);
    while (from > path && (from[-1] != '.' || --parts > 0)) {
        --from;
    }
    return from;
}

/* The shortest end of a key's path that no other key has. */
static const char *short_key(const weft_sweep *sweep, size_t key)
{
    const char *path = weft_sweep_key(sweep, key), *shown;
    for (size_t parts = 1; (shown = tail(path, parts)) != path; ++parts) {
        bool single = true;
        for (size_t i = 0; i < weft_sweep_keys(sweep); ++i) {
            single = single
                     && (i == key
                         || strcmp(tail(weft_sweep_key(sweep, i), parts), shown) != 0);
        }
        if (single) {
            break;
        }
    }
    return shown;
}

char *batch_name(const char *stem, const weft_sweep *sweep, size_t number)
{
    namer self = { .hash = WEFT__HASH_START };
    add(&self, stem, false);
    /* not the place of the summary */
    self.lossy = self.lossy || stem[0] == '\0' || strncmp(stem, "summary.csv", 11) == 0;
    for (size_t i = 0; i < weft_sweep_keys(sweep); ++i) {
        add_char(&self, '_', true);
        add(&self, short_key(sweep, i), false);
        add_char(&self, '=', true);
        add(&self, weft_sweep_value(sweep, i, number),
            strcmp(weft_sweep_key(sweep, i), "stepper.method") == 0);
    }
    if (self.lossy) {
        const size_t most = NAME_MAX_CHARS - HASH_DIGITS - 1;
        self.used = self.used < most ? self.used : most;
        self.used += (size_t)snprintf(self.text + self.used, HASH_DIGITS + 2,
                                      "~%012" PRIx64, self.hash >> 16);
    }
    self.text[self.used] = '\0';
    return strdup(self.text);
}
