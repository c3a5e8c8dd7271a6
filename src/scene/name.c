/* SPDX-License-Identifier: BSD-3-Clause */
/* name.c -- the name of a scene that has none of its own. */
#include <string.h>

#include "scene/tree.h"

char *weft__name_of_file(const char *file, const weft_allocator *memory)
{
    static const char *const endings[] = { ".yaml", ".yml" };
    const char *slash = strrchr(file, '/');
    char *name = weft__copy_text(memory, slash == NULL ? file : slash + 1);
    const size_t length = name == NULL ? 0 : strlen(name);
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; ++i) {
        const size_t ending = strlen(endings[i]);
        if (length > ending && strcmp(name + length - ending, endings[i]) == 0) {
            name[length - ending] = '\0';
            break;
        }
    }
    if (name != NULL) {
        weft__one_line(name);
    }
    return name;
}

/* Where the text of a scene's first key begins, if it is that of a block mapping at the
 * margin, so that a line may come before it; NULL if not. */
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

bool weft__name_insert(const weft__node *root, const char *text, const char *name,
                       const weft_allocator *memory, char **out)
{
    const char *before = first_key(root, text);
    const size_t room = strlen(text) + 2 * strlen(name) + sizeof "name: \"\"\n";
    *out = before == NULL ? NULL : weft__alloc(memory, room, 1);
    if (*out == NULL) {
        return before == NULL;
    }
    char *to = *out + (before - text);
    memcpy(*out, text, (size_t)(before - text));
    to = stpcpy(to, "name: \"");
    for (; *name != '\0'; ++name) {
        if (*name == '"' || *name == '\\') {
            *to++ = '\\';
        }
        *to++ = *name;
    }
    (void)strcpy(stpcpy(to, "\"\n"), before);
    return true;
}
