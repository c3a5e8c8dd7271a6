/* SPDX-License-Identifier: BSD-3-Clause */
/* name.c -- the name of a scene that has none of its own. */
#include <string.h>

#include "scene/document.h"

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
static const char *first_key(yaml_document_t *document, const char *text)
{
    const yaml_node_t *root = yaml_document_get_root_node(document);
    const yaml_node_t *key
        = yaml_document_get_node(document, root->data.mapping.pairs.start->key);
    for (size_t line = 0; text != NULL && line < key->start_mark.line; ++line) {
        text = strchr(text, '\n');
        text = text == NULL ? NULL : text + 1;
    }
    const bool is_there = text != NULL
                          && root->data.mapping.style == YAML_BLOCK_MAPPING_STYLE
                          && key->start_mark.column == 0
                          && strncmp(text, (const char *)key->data.scalar.value,
                                     key->data.scalar.length)
                                 == 0;
    return is_there ? text : NULL;
}

bool weft__name_insert(yaml_document_t *document, const char *text, const char *name,
                       const weft_allocator *memory, char **out)
{
    const char *before = first_key(document, text);
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

bool weft__name_append(yaml_document_t *document, const char *name)
{
    const int key = yaml_document_add_scalar(
        document, NULL, (const yaml_char_t *)"name", 4, YAML_PLAIN_SCALAR_STYLE);
    const int value
        = yaml_document_add_scalar(document, NULL, (const yaml_char_t *)name,
                                   (int)strlen(name), YAML_DOUBLE_QUOTED_SCALAR_STYLE);
    const int root
        = (int)(yaml_document_get_root_node(document) - document->nodes.start) + 1;
    return key != 0 && value != 0
           && yaml_document_append_mapping_pair(document, root, key, value) != 0;
}
