/* SPDX-License-Identifier: BSD-3-Clause */
/* emit.c -- a tree as YAML text, for a scene that was changed by overrides, and the
 * default name in it.
 *
 * Numbers keep their text. A mapping has one line per key; a list of plain values is on
 * one line. */
#include <string.h>

#include "scene/tree.h"

typedef struct buffer {
    const weft_allocator *memory;
    char *text;
    size_t length, capacity;
} buffer;

static int append(void *ctx, unsigned char *text, size_t size)
{
    buffer *out = ctx;
    if (!weft__reserve(out->memory, &out->text, &out->capacity, out->length + size,
                       1)) {
        return 0;
    }
    memcpy(out->text + out->length, text, size);
    out->length += size;
    return 1;
}

/* `made`: whether the event could be initialized. */
static bool emit_event(yaml_emitter_t *to, yaml_event_t *event, int made)
{
    return made && yaml_emitter_emit(to, event);
}

static bool emit_node(yaml_emitter_t *to, const weft__node *node)
{
    const bool is_map = node->type == WEFT__MAP;
    yaml_event_t event;
    if (node->type == WEFT__SCALAR) {
        return emit_event(
            to, &event,
            yaml_scalar_event_initialize(&event, NULL, NULL, (yaml_char_t *)node->text,
                                         (int)node->count, 1, 1,
                                         (yaml_scalar_style_t)node->style));
    }
    bool good = emit_event(to, &event,
                           is_map ? yaml_mapping_start_event_initialize(
                               &event, NULL, NULL, 1, YAML_BLOCK_MAPPING_STYLE)
                                  : yaml_sequence_start_event_initialize(
                                      &event, NULL, NULL, 1,
                                      node->height > 1 ? YAML_BLOCK_SEQUENCE_STYLE
                                                       : YAML_FLOW_SEQUENCE_STYLE));
    for (size_t i = 0; i < node->count && good; ++i) {
        const weft__entry *entry = &node->entries[i];
        good = entry->value == NULL
               || ((entry->key == NULL || emit_node(to, entry->key))
                   && emit_node(to, entry->value));
    }
    return good
           && emit_event(to, &event,
                         is_map ? yaml_mapping_end_event_initialize(&event)
                                : yaml_sequence_end_event_initialize(&event));
}

static bool emit_tree(yaml_emitter_t *to, const weft__node *root)
{
    yaml_event_t event;
    yaml_emitter_set_unicode(to, 1);
    yaml_emitter_set_width(to, -1);
    return yaml_emitter_open(to)
           && emit_event(
               to, &event,
               yaml_document_start_event_initialize(&event, NULL, NULL, NULL, 1))
           && emit_node(to, root)
           && emit_event(to, &event, yaml_document_end_event_initialize(&event, 1))
           && yaml_emitter_close(to) && yaml_emitter_flush(to);
}

char *weft__tree_emit(weft__tree *tree)
{
    buffer out = { .memory = tree->report->memory };
    yaml_emitter_t to;
    char *text = NULL;
    if (yaml_emitter_initialize(&to)) {
        yaml_emitter_set_output(&to, append, &out);
        if (emit_tree(&to, tree->root)) {
            text = weft__tree_text(tree, out.text, out.length);
        }
        yaml_emitter_delete(&to);
    }
    weft__free(out.memory, out.text);
    return text;
}

/* ---- the default name -------------------------------------------------------- */

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
