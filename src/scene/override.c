/* SPDX-License-Identifier: BSD-3-Clause */
/* override.c -- "key.path=value", or a value of a sweep, put into a tree. An index of a
 * list is a part of the path, as in pins.0 or pins[0].
 *
 * New nodes have the override's place, and so has the key of a replaced pair: messages
 * about them name the override. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "scene/tree.h"

typedef struct graft {
    weft__tree *tree;
    const char *path, *end;
    weft__mark at;           /* of the path */
    const weft__node *value; /* NULL: removes the present value */
} graft;

typedef struct segment {
    const char *name;
    size_t length;
} segment;

/* The place of a byte of the path, which is in ASCII up to there. */
static weft__mark override_place(const graft *self, const char *at)
{
    weft__mark mark = self->at;
    mark.column += (size_t)(at - self->path);
    return mark;
}

static const char *past(const segment *part)
{
    return part->name + part->length;
}

static int shown_length(const segment *part)
{
    return (int)(part->length < 40 ? part->length : 40);
}

static bool is_index(const segment *part)
{
    const bool one_form = part->length == 1 || part->name[0] != '0'; /* no 00 */
    return part->length < 8 && one_form
           && strspn(part->name, "0123456789") >= part->length;
}

/* The next part of the path; false if it is empty or no key. */
static bool next_segment(const graft *self, const char *from, segment *part)
{
    *part = (segment){ .name = from };
    while (past(part) < self->end
           && (*past(part) == '\0' || strchr(".[]", *past(part)) == NULL)) {
        if (*past(part) <= ' ' || *past(part) > '~') {
            weft__report_error(self->tree->report, override_place(self, past(part)),
                               "no key has such a character");
            return false;
        }
        ++part->length;
    }
    if (part->length == 0) {
        weft__report_error(self->tree->report, override_place(self, from),
                           "a key is missing here: write key.path=value");
    }
    return part->length > 0;
}

/* Where the next part begins; NULL: there is none. */
static const char *behind(const graft *self, const segment *part)
{
    const char *at = past(part);
    at += at < self->end && *at == ']';
    return at < self->end ? at + 1 : NULL;
}

/* The entry of a part of the path; the index after the last item makes a new one.
 * false: there is no such entry. */
static bool find_slot(const graft *self, const weft__node *node, const segment *part,
                      size_t *slot)
{
    char free_one[64] = "";
    if (node->type == WEFT__MAP) {
        *slot = weft__find_key(node, part->name, part->length);
        return true;
    }
    *slot = is_index(part) ? strtoul(part->name, NULL, 10) : SIZE_MAX;
    if (*slot < node->count + (self->value != NULL)) {
        return true;
    }
    if (self->value != NULL) {
        (void)snprintf(free_one, sizeof free_one, ", the next free one %zu",
                       node->count);
    }
    weft__report_error(self->tree->report, override_place(self, part->name),
                       "'%.*s' is no element of this list of %zu; the first is 0%s",
                       shown_length(part), part->name, node->count, free_one);
    return false;
}

/* The node that a part of the path leads into: the one that is there, or else a new
 * list for an index and a new mapping for another key. NULL: it is a single value, or
 * no memory. */
static const weft__node *enter(const graft *self, const weft__node *there,
                               const segment *led, const segment *part)
{
    if (there == NULL || weft__is_null(there)) {
        return weft__node_new(
            self->tree, (weft__node){ .type = is_index(part) ? WEFT__LIST : WEFT__MAP,
                                      .at = override_place(self, led->name) });
    }
    if (there->type == WEFT__SCALAR) {
        weft__report_error(self->tree->report, override_place(self, part->name),
                           "'%.*s' is a single value: nothing can be set inside",
                           shown_length(led), led->name);
        return NULL;
    }
    return there;
}

/* A copy of the node that the part `led` of the path leads to (NULL: nothing is there),
 * with the value put at the rest of the path; the node itself where the path is wrong,
 * which is reported. NULL: there is no node, or no memory. */
static const weft__node *override_put(const graft *self, const weft__node *there,
                                      segment led, const char *rest, size_t depth)
{
    segment part;
    size_t slot;
    if (!next_segment(self, rest, &part)) {
        return NULL;
    }
    const weft__node *node = enter(self, there, &led, &part);
    if (node == NULL || !find_slot(self, node, &part, &slot)) {
        return node;
    }
    weft__entry entry = { NULL, slot < node->count ? node->entries[slot].value : NULL };
    const char *next = behind(self, &part);
    const bool is_last = next == NULL || (entry.value == NULL && self->value == NULL);
    const size_t height = is_last && self->value != NULL ? self->value->height : 0;
    if (depth + height > WEFT__MAX_DEPTH) {
        ERROR_AT(self->tree, height > 0 ? self->value : node,
                 "nested more than 32 deep");
        return node;
    }
    entry.value = is_last ? self->value
                          : override_put(self, entry.value, part, next, depth + 1);
    if (node->type == WEFT__MAP) {
        entry.key = weft__scalar_new(self->tree, part.name, part.length,
                                     YAML_PLAIN_SCALAR_STYLE,
                                     override_place(self, part.name));
    }
    const bool lacks = (entry.value == NULL && !is_last)
                       || (entry.key == NULL && node->type == WEFT__MAP);
    return lacks ? node : weft__node_with(self->tree, node, slot, entry);
}

void weft__tree_put(weft__tree *tree, const char *path, size_t length, weft__mark at,
                    const weft__node *value)
{
    const graft self
        = { tree, path, path + length, at, weft__is_null(value) ? NULL : value };
    const weft__node *root
        = override_put(&self, tree->root, (segment){ .name = path }, path, 1);
    tree->root = root == NULL ? tree->root : root;
}

size_t weft__override_path(const weft__source *source)
{
    const char *equals = memchr(source->text, '=', source->length);
    size_t length = equals == NULL ? 0 : (size_t)(equals - source->text);
    while (length > 0 && source->text[length - 1] == ' ') {
        --length;
    }
    return length;
}

void weft__override_apply(weft__tree *tree, const weft__source *source)
{
    const weft__mark start = weft__source_mark(source, 0);
    const char *equals = memchr(source->text, '=', source->length);
    const weft__node *root;
    if (equals == NULL) {
        weft__report_error(tree->report, start,
                           "there is no '=': write key.path=value");
        return;
    }
    const size_t value = (size_t)(equals - source->text) + 1;
    if (!weft__tree_parse(tree, source, value, &root)) {
        return;
    }
    if (root == NULL || (weft__is_null(root) && root->count == 0)) {
        weft__report_error(tree->report, weft__source_mark(source, value),
                           "there is no value; null would remove the key");
    } else {
        weft__tree_put(tree, source->text, weft__override_path(source), start, root);
    }
}
