/* SPDX-License-Identifier: BSD-3-Clause */
/* emit.c -- a document as YAML text, for a scene that was changed by overrides.
 *
 * Numbers keep the text they were given in. Mappings are written a key a line, lists of
 * plain values in one line. */
#include <string.h>

#include "scene/document.h"

typedef struct buffer {
    const weft_allocator *memory;
    char *text;
    size_t length, capacity;
} buffer;

static int append(void *ctx, unsigned char *text, size_t size)
{
    buffer *out = ctx;
    if (size >= out->capacity - out->length) {
        const size_t capacity = 2 * out->capacity + size + 1;
        char *grown = weft__resize(out->memory, out->text, capacity, 1);
        if (grown == NULL) {
            return 0;
        }
        out->text = grown;
        out->capacity = capacity;
    }
    memcpy(out->text + out->length, text, size);
    out->length += size;
    out->text[out->length] = '\0';
    return 1;
}

static bool holds_scalars_only(yaml_document_t *document, const yaml_node_t *list)
{
    for (const int *item = list->data.sequence.items.start;
         item < list->data.sequence.items.top; ++item) {
        if (yaml_document_get_node(document, *item)->type != YAML_SCALAR_NODE) {
            return false;
        }
    }
    return true;
}

/* Drop the pairs that an override removed. */
static void drop_removed(yaml_node_t *mapping)
{
    yaml_node_pair_t *to = mapping->data.mapping.pairs.start;
    for (const yaml_node_pair_t *pair = to; pair < mapping->data.mapping.pairs.top;
         ++pair) {
        if (pair->value != 0) {
            *to++ = *pair;
        }
    }
    mapping->data.mapping.pairs.top = to;
}

static void set_styles(yaml_document_t *document)
{
    for (yaml_node_t *node = document->nodes.start; node < document->nodes.top;
         ++node) {
        if (node->type == YAML_MAPPING_NODE) {
            drop_removed(node);
            node->data.mapping.style = YAML_BLOCK_MAPPING_STYLE;
        } else if (node->type == YAML_SEQUENCE_NODE) {
            node->data.sequence.style = holds_scalars_only(document, node)
                                            ? YAML_FLOW_SEQUENCE_STYLE
                                            : YAML_BLOCK_SEQUENCE_STYLE;
        }
    }
}

char *weft__document_emit(yaml_document_t *document, const weft_allocator *memory)
{
    buffer out
        = { .memory = memory, .text = weft__zeroed(memory, 1, 1), .capacity = 1 };
    yaml_emitter_t emitter;
    if (out.text == NULL || !yaml_emitter_initialize(&emitter)) {
        weft__free(memory, out.text);
        yaml_document_delete(document);
        return NULL;
    }
    set_styles(document);
    yaml_emitter_set_output(&emitter, append, &out);
    yaml_emitter_set_unicode(&emitter, 1);
    yaml_emitter_set_width(&emitter, -1);
    const bool written = yaml_emitter_dump(&emitter, document)
                         && yaml_emitter_close(&emitter)
                         && yaml_emitter_flush(&emitter);
    yaml_emitter_delete(&emitter);
    if (!written) {
        weft__free(memory, out.text);
        return NULL;
    }
    return out.text;
}
