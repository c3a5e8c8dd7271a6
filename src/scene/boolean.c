/* SPDX-License-Identifier: BSD-3-Clause */
/* boolean.c -- true or false, and what YAML 1.1 and people write for them. */
#include <string.h>

#include "scene/read.h"
#include "scene/scalar.h"

/* What stands for a value, in YAML 1.2 or only elsewhere. */
typedef struct spelling {
    const char *text;
    bool value, good;
} spelling;

static const spelling spellings[] = {
    { "true", true, true },   { "True", true, true },   { "TRUE", true, true },
    { "false", false, true }, { "False", false, true }, { "FALSE", false, true },
    { "yes", true, false },   { "Yes", true, false },   { "YES", true, false },
    { "no", false, false },   { "No", false, false },   { "NO", false, false },
    { "on", true, false },    { "On", true, false },    { "ON", true, false },
    { "off", false, false },  { "Off", false, false },  { "OFF", false, false },
    { "1", true, false },     { "0", false, false },
};

static const spelling *find_spelling(const char *text)
{
    for (size_t i = 0; text != NULL && i < sizeof spellings / sizeof spellings[0];
         ++i) {
        if (strcmp(text, spellings[i].text) == 0) {
            return &spellings[i];
        }
    }
    return NULL;
}

void weft__read_boolean(weft__reader *reader, const weft__key *key,
                        const weft__node *node, void *to)
{
    const spelling *found = find_spelling(weft__text_of(node));
    char value[64];
    if (found == NULL) {
        weft__refuse(reader, node, key->name, "true or false", false, NULL);
        return;
    }
    const bool quoted = node->style != YAML_PLAIN_SCALAR_STYLE;
    if (found->good && !quoted) {
        *(bool *)to = found->value;
        return;
    }
    weft__report_error(reader->report, node->at,
                       "%s must be true or false, not %s (%s)", key->name,
                       weft__show(node, value, sizeof value),
                       quoted && found->good ? "remove the quotes"
                       : found->value        ? "write true"
                                             : "write false");
}
