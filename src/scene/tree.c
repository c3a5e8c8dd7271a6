/* SPDX-License-Identifier: BSD-3-Clause */
/* tree.c -- the nodes of a tree: their memory, and changed copies of them. */
#include "scene/tree.h"

#include <stdalign.h>
#include <stdint.h>
#include <string.h>

/* Nodes are kept in blocks, and freed with them. */
struct weft__block {
    struct weft__block *next;
    size_t used, size; /* bytes of what follows */
    alignas(max_align_t) char bytes[];
};

enum { BLOCK_BYTES = 8 << 10 };

void *weft__tree_take(weft__tree *tree, size_t count, size_t size)
{
    const size_t unit = alignof(max_align_t);
    const size_t units = count > SIZE_MAX / 2 / size ? SIZE_MAX / 2 / unit
                                                     : (count * size + unit - 1) / unit;
    const size_t bytes = units * unit;
    struct weft__block *block = tree->blocks;
    if (block == NULL || bytes > block->size - block->used) {
        const size_t room = bytes > BLOCK_BYTES ? bytes : BLOCK_BYTES;
        block = weft__zeroed(tree->report->memory, 1, sizeof *block + room);
        if (block == NULL) {
            tree->report->no_memory = true;
            return NULL;
        }
        block->next = tree->blocks;
        block->size = room;
        tree->blocks = block;
    }
    block->used += bytes;
    return block->bytes + block->used - bytes;
}

char *weft__tree_text(weft__tree *tree, const char *text, size_t length)
{
    char *copy = weft__tree_take(tree, length + 1, 1);
    return copy == NULL ? NULL : memcpy(copy, text, length);
}

void weft__tree_free(weft__tree *tree, const weft_allocator *memory)
{
    while (tree->blocks != NULL) {
        struct weft__block *block = tree->blocks;
        tree->blocks = block->next;
        weft__free(memory, block);
    }
}

weft__node *weft__node_new(weft__tree *tree, weft__node like)
{
    weft__node *node = weft__tree_take(tree, 1, sizeof *node);
    if (node != NULL) {
        *node = like;
        node->entries = NULL;
        node->count = 0;
        node->size = 1;
        node->height = like.type != WEFT__SCALAR;
    }
    return node;
}

const weft__node *weft__scalar_new(weft__tree *tree, const char *text, size_t length,
                                   int style, weft__mark at)
{
    weft__node *node = weft__node_new(
        tree, (weft__node){ .type = WEFT__SCALAR, .style = style, .at = at });
    if (node != NULL) {
        node->text = weft__tree_text(tree, text, length);
        node->count = length;
    }
    return node == NULL || node->text == NULL ? NULL : node;
}

/* Room for one entry more, doubled where their number is a power of two. */
static bool grow(weft__tree *tree, weft__node *parent)
{
    const size_t count = parent->count;
    if ((count & (count - 1)) != 0) {
        return true;
    }
    weft__entry *entries
        = weft__tree_take(tree, count == 0 ? 1 : 2 * count, sizeof *entries);
    if (entries == NULL) {
        return false;
    }
    if (count > 0) {
        memcpy(entries, parent->entries, count * sizeof *entries);
    }
    parent->entries = entries;
    return true;
}

bool weft__node_add(weft__tree *tree, weft__node *parent, weft__entry entry)
{
    const weft__node *const parts[] = { entry.key, entry.value };
    if (!grow(tree, parent)) {
        return false;
    }
    parent->entries[parent->count++] = entry;
    for (size_t i = 0; i < 2; ++i) {
        if (parts[i] != NULL) {
            parent->size += parts[i]->size;
            parent->height = parts[i]->height < parent->height ? parent->height
                                                               : parts[i]->height + 1;
        }
    }
    if (parent->size > WEFT__MAX_NODES) {
        ERROR_AT(tree, parent, "anchors expand to more than 1000000 nodes");
    }
    return parent->size <= WEFT__MAX_NODES;
}

const weft__node *weft__node_with(weft__tree *tree, const weft__node *node, size_t slot,
                                  weft__entry entry)
{
    weft__node *copy = weft__node_new(tree, *node);
    for (size_t i = 0; copy != NULL && (i < node->count || i == slot); ++i) {
        const weft__entry one = i == slot ? entry : node->entries[i];
        const bool left_out = one.key == NULL && one.value == NULL;
        if (!left_out && !weft__node_add(tree, copy, one)) {
            return NULL;
        }
    }
    return copy;
}

size_t weft__find_key(const weft__node *map, const char *key, size_t length)
{
    size_t i = 0;
    for (; i < map->count; ++i) {
        const weft__node *name = map->entries[i].key;
        if (name->type == WEFT__SCALAR && name->count == length
            && memcmp(name->text, key, length) == 0) {
            break;
        }
    }
    return i;
}

const weft__node *weft__value_of(const weft__node *node, const char *key)
{
    const size_t slot = node->type == WEFT__MAP ? weft__find_key(node, key, strlen(key))
                                                : node->count;
    return slot < node->count ? node->entries[slot].value : NULL;
}
