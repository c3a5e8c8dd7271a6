/* SPDX-License-Identifier: BSD-3-Clause */
/* name.c -- the default name of a scene, from its file's name. */
#include <string.h>

#include "scene/tree.h"

char *weft__name_of_file(weft__tree *tree, const char *file)
{
    const char *slash = strrchr(file, '/');
    const char *base = slash == NULL ? file : slash + 1;
    char *name = weft__tree_text(tree, base, strlen(base));
    if (name == NULL) {
        return NULL;
    }
    char *dot = strrchr(name, '.');
    if (dot > name && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0)) {
        *dot = '\0';
    }
    weft__one_line(name);
    return name;
}

/* The start of a scene's first key, if it belongs to a block mapping at the margin, so
 * that a line can be inserted before it; NULL if not. */
static const char *first_key(const weft__node *root, const char *text)
{
    const weft__node *key = root->entries[0].key;
    for (size_t line = 0; text != NULL && line < key->at.line; ++line) {
        text = strchr(text, '\n');
        text = text == NULL ? NULL : text + 1;
    }
    const bool is_there = text != NULL && root->style == YAML_BLOCK_MAPPING_STYLE
                          && key->at.column == 0
                          && strncmp(text, key->text, key->count) == 0;
    return is_there ? text : NULL;
}

char *weft__name_insert(weft__tree *tree, const char *text, const char *name)
{
    const char *before = first_key(tree->root, text);
    const size_t room = strlen(text) + 2 * strlen(name) + sizeof "name: \"\"\n";
    char *made = before == NULL ? NULL : weft__tree_take(tree, room, 1);
    if (made == NULL) {
        return NULL;
    }
    memcpy(made, text, (size_t)(before - text));
    char *to = stpcpy(made + (before - text), "name: \"");
    for (; *name != '\0'; ++name) {
        if (*name == '"' || *name == '\\') {
            *to++ = '\\';
        }
        *to++ = *name;
    }
    (void)strcpy(stpcpy(to, "\"\n"), before);
    return made;
}
