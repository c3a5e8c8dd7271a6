/* SPDX-License-Identifier: BSD-3-Clause */
/* override.c -- "key.path=value", or a value of a sweep, put into a document.
 *
 * Mappings and lists on the way are copied, as an alias may lead to the same node from
 * elsewhere, and only this path is to change. New nodes get the override's place; the
 * pair that is replaced gets a new key too, so that all that is said of it names the
 * override. */
#include <stdlib.h>
#include <string.h>

#include "scene/document.h"
#include "scene/scalar.h"

typedef struct graft {
    yaml_document_t *document;
    weft__report *report;
    const char *path;
    yaml_mark_t at; /* of the path */
    bool removes;   /* the value is null */
    int value;      /* node to put in */
} graft;

typedef struct segment {
    const char *name;
    size_t length;
    bool last;
} segment;

/* A path is in ASCII as far as it was walked. */
static yaml_mark_t place(const graft *self, const char *at)
{
    yaml_mark_t mark = self->at;
    mark.column += (size_t)(at - self->path);
    return mark;
}

/* Give a new node its place; 0, which libyaml returns when memory runs out, stays. */
static int placed(const graft *self, int id, yaml_mark_t at)
{
    if (id == 0) {
        self->report->no_memory = true;
    } else {
        yaml_document_get_node(self->document, id)->start_mark = at;
    }
    return id;
}

static bool kept(const graft *self, int added)
{
    self->report->no_memory = self->report->no_memory || added == 0;
    return added != 0;
}

/* libyaml takes no pair whose value is 0, a removed one: it is set afterwards. */
static bool add_pair(const graft *self, int mapping, int key, int value)
{
    yaml_document_t *document = self->document;
    if (!kept(self, yaml_document_append_mapping_pair(document, mapping, key,
                                                      value == 0 ? key : value))) {
        return false;
    }
    yaml_document_get_node(document, mapping)->data.mapping.pairs.top[-1].value = value;
    return true;
}

/* ---- copies -------------------------------------------------------------------- */

static int copy_tree(const graft *self, yaml_document_t *from, int id);

static bool copy_items(const graft *self, yaml_document_t *from,
                       const yaml_node_t *node, int copy)
{
    for (const int *item = node->data.sequence.items.start;
         item < node->data.sequence.items.top; ++item) {
        const int value = copy_tree(self, from, *item);
        if (value == 0
            || !kept(self,
                     yaml_document_append_sequence_item(self->document, copy, value))) {
            return false;
        }
    }
    return true;
}

static bool copy_pairs(const graft *self, yaml_document_t *from,
                       const yaml_node_t *node, int copy)
{
    for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start;
         pair < node->data.mapping.pairs.top; ++pair) {
        const int key = copy_tree(self, from, pair->key);
        const int value = key == 0 || pair->value == 0
                              ? 0 /* removed */
                              : copy_tree(self, from, pair->value);
        if (key == 0 || (value == 0 && pair->value != 0)
            || !add_pair(self, copy, key, value)) {
            return false;
        }
    }
    return true;
}

/* The node of another document, with all below it; 0 if memory ran out. */
static int copy_tree(const graft *self, yaml_document_t *from, int id)
{
    const yaml_node_t *node = yaml_document_get_node(from, id);
    int copy = 0;
    bool whole = true;
    if (node->type == YAML_SCALAR_NODE) {
        copy = yaml_document_add_scalar(
            self->document, node->tag, node->data.scalar.value,
            (int)node->data.scalar.length, node->data.scalar.style);
    } else if (node->type == YAML_SEQUENCE_NODE) {
        copy = yaml_document_add_sequence(self->document, node->tag,
                                          node->data.sequence.style);
        whole = copy == 0 || copy_items(self, from, node, copy);
    } else {
        copy = yaml_document_add_mapping(self->document, node->tag,
                                         node->data.mapping.style);
        whole = copy == 0 || copy_pairs(self, from, node, copy);
    }
    return whole ? placed(self, copy, node->start_mark) : 0;
}

/* A mapping or list with the same children; 0 if memory ran out. */
static int copy_shallow(const graft *self, int id)
{
    yaml_document_t *document = self->document;
    const yaml_node_t original = *yaml_document_get_node(document, id);
    int copy;
    if (original.type == YAML_SEQUENCE_NODE) {
        copy = yaml_document_add_sequence(document, original.tag,
                                          original.data.sequence.style);
        for (const int *item = original.data.sequence.items.start;
             copy != 0 && item < original.data.sequence.items.top; ++item) {
            copy = yaml_document_append_sequence_item(document, copy, *item) ? copy : 0;
        }
    } else {
        copy = yaml_document_add_mapping(document, original.tag,
                                         original.data.mapping.style);
        for (const yaml_node_pair_t *pair = original.data.mapping.pairs.start;
             copy != 0 && pair < original.data.mapping.pairs.top; ++pair) {
            copy = add_pair(self, copy, pair->key, pair->value) ? copy : 0;
        }
    }
    return placed(self, copy, original.start_mark);
}

/* ---- one step of the path ------------------------------------------------------ */

static bool is_index(const segment *part)
{
    return part->length > 0 && part->length < 8
           && strspn(part->name, "0123456789") >= part->length;
}

/* What the step leads to: `slot` is the pair or item, `id` the node there, 0 if none.
 * A list may be led past its end by one, where an item can be added. */
static bool find_slot(const graft *self, const yaml_node_t *parent, const segment *part,
                      ptrdiff_t *slot, int *id)
{
    *id = 0;
    if (parent->type == YAML_MAPPING_NODE) {
        *slot = weft__find_pair(self->document, parent, part->name, part->length);
        *id = *slot < 0 ? 0 : parent->data.mapping.pairs.start[*slot].value;
        return true;
    }
    const ptrdiff_t count
        = parent->data.sequence.items.top - parent->data.sequence.items.start;
    *slot = is_index(part) ? strtol(part->name, NULL, 10) : -1;
    if (*slot < 0 || *slot > count || (*slot == count && self->removes)) {
        char free_one[64] = "";
        if (!self->removes) {
            (void)snprintf(free_one, sizeof free_one, ", the next free one %td", count);
        }
        weft__report_error(self->report, place(self, part->name),
                           "'%.*s' is no element of this list of %td; the first is 0%s",
                           (int)(part->length < 40 ? part->length : 40), part->name,
                           count, free_one);
        return false;
    }
    *id = *slot == count ? 0 : parent->data.sequence.items.start[*slot];
    return true;
}

static bool put_pair(const graft *self, int parent, const segment *part, ptrdiff_t slot,
                     int value)
{
    yaml_document_t *document = self->document;
    const int key = placed(
        self,
        yaml_document_add_scalar(document, NULL, (const unsigned char *)part->name,
                                 (int)part->length, YAML_PLAIN_SCALAR_STYLE),
        place(self, part->name));
    if (key == 0) {
        return false;
    }
    if (slot < 0) {
        return add_pair(self, parent, key, value);
    }
    yaml_node_t *node = yaml_document_get_node(document, parent);
    node->data.mapping.pairs.start[slot] = (yaml_node_pair_t){ key, value };
    return true;
}

static bool put_item(const graft *self, int parent, ptrdiff_t slot, int value)
{
    yaml_node_t *node = yaml_document_get_node(self->document, parent);
    int *items = node->data.sequence.items.start;
    const ptrdiff_t count = node->data.sequence.items.top - items;
    if (value == 0) {
        memmove(items + slot, items + slot + 1,
                (size_t)(count - slot - 1) * sizeof *items);
        --node->data.sequence.items.top;
    } else if (slot < count) {
        items[slot] = value;
    } else {
        return kept(self,
                    yaml_document_append_sequence_item(self->document, parent, value));
    }
    return true;
}

static bool put(const graft *self, int parent, const segment *part, ptrdiff_t slot,
                int value)
{
    return yaml_document_get_node(self->document, parent)->type == YAML_MAPPING_NODE
               ? put_pair(self, parent, part, slot, value)
               : put_item(self, parent, slot, value);
}

/* What stands between the parent and the rest of the path: a copy of what is there, or
 * a new list if the next step is an index, else a new mapping. */
static int between(const graft *self, int id, const segment *part, const segment *next)
{
    yaml_document_t *document = self->document;
    const yaml_node_t *node = id == 0 ? NULL : yaml_document_get_node(document, id);
    if (node != NULL && !weft__is_null(node)) {
        if (node->type == YAML_SCALAR_NODE) {
            weft__report_error(self->report, place(self, next->name),
                               "'%.*s' is a single value: nothing can be set inside",
                               (int)(part->length < 40 ? part->length : 40),
                               part->name);
            return 0;
        }
        return copy_shallow(self, id);
    }
    const int made
        = is_index(next)
              ? yaml_document_add_sequence(document, NULL, YAML_FLOW_SEQUENCE_STYLE)
              : yaml_document_add_mapping(document, NULL, YAML_BLOCK_MAPPING_STYLE);
    return placed(self, made, place(self, part->name));
}

/* ---- the path ------------------------------------------------------------------ */

/* The next part of a path up to `end`; false if it is empty. */
static bool next_segment(const graft *self, const char *from, const char *end,
                         segment *part)
{
    part->name = from;
    part->length = 0;
    while (from + part->length < end && from[part->length] != '.') {
        ++part->length;
    }
    part->last = from + part->length == end;
    if (part->length == 0) {
        weft__report_error(self->report, place(self, from),
                           "a key is missing here: write key.path=value");
        return false;
    }
    for (size_t i = 0; i < part->length; ++i) {
        if (from[i] <= ' ' || from[i] > '~') {
            weft__report_error(self->report, place(self, from + i),
                               "no key has such a character");
            return false;
        }
    }
    return true;
}

static void walk_path(const graft *self, const char *end)
{
    segment part, next;
    int parent = 1;
    if (!next_segment(self, self->path, end, &part)) {
        return;
    }
    for (;; part = next) {
        ptrdiff_t slot;
        int id;
        if (!find_slot(self, yaml_document_get_node(self->document, parent), &part,
                       &slot, &id)) {
            return;
        }
        /* Nothing is to be removed inside what is not there. */
        if (part.last || (self->removes && id == 0)) {
            (void)put(self, parent, &part, slot, self->removes ? 0 : self->value);
            return;
        }
        if (!next_segment(self, part.name + part.length + 1, end, &next)) {
            return;
        }
        id = between(self, id, &part, &next);
        if (id == 0 || !put(self, parent, &part, slot, id)) {
            return;
        }
        parent = id;
    }
}

void weft__document_put(yaml_document_t *document, const char *path, yaml_mark_t at,
                        yaml_document_t *from, int value, weft__report *report)
{
    graft self = { .document = document,
                   .report = report,
                   .path = path,
                   .at = at,
                   .removes = weft__is_null(yaml_document_get_node(from, value)) };
    self.value = self.removes ? 0 : copy_tree(&self, from, value);
    if (self.removes || self.value != 0) {
        walk_path(&self, path + strlen(path));
    }
}

bool weft__document_copy(yaml_document_t *to, yaml_document_t *from,
                         weft__report *report)
{
    const graft self = { .document = to, .report = report };
    if (!yaml_document_initialize(to, NULL, NULL, NULL, 1, 1)) {
        report->no_memory = true;
        return false;
    }
    if (copy_tree(&self, from, 1) == 0) {
        yaml_document_delete(to);
        return false;
    }
    return true;
}

size_t weft__override_path(const weft__source *source)
{
    const char *equals = memchr(source->text, '=', source->length);
    const char *end = equals == NULL ? source->text : equals;
    while (end > source->text && end[-1] == ' ') {
        --end;
    }
    return (size_t)(end - source->text);
}

void weft__override_apply(yaml_document_t *document, const weft__source *source,
                          weft__report *report)
{
    graft self = { .document = document,
                   .report = report,
                   .path = source->text,
                   .at = weft__source_mark(source, 0) };
    const char *equals = memchr(source->text, '=', source->length);
    yaml_document_t given;
    if (equals == NULL) {
        weft__report_error(report, self.at, "there is no '=': write key.path=value");
        return;
    }
    const size_t value = (size_t)(equals - source->text) + 1;
    if (!weft__document_load(source, value, report, &given)) {
        return;
    }
    const yaml_node_t *root = yaml_document_get_root_node(&given);
    if (root == NULL
        || (root->type == YAML_SCALAR_NODE && weft__is_null(root)
            && root->data.scalar.length == 0)) {
        weft__report_error(report, weft__source_mark(source, value),
                           "there is no value; null would remove the key");
    } else if (weft__document_check(&given, report)) {
        self.removes = weft__is_null(root);
        self.value = self.removes ? 0 : copy_tree(&self, &given, 1);
        if (self.removes || self.value != 0) {
            walk_path(&self, source->text + weft__override_path(source));
        }
    }
    yaml_document_delete(&given);
}
