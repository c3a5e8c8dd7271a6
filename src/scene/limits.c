/* SPDX-License-Identifier: BSD-3-Clause */
/* limits.c -- what aliases make of a document: cycles, and far more than was written.
 *
 * Every node is looked at once, however many ways lead to it; its size and height with
 * all aliases expanded are kept. */
#include <stdint.h>
#include <string.h>

#include "scene/document.h"

typedef struct extent {
    enum { NEW, ENTERED, DONE } state;
    uint32_t size;   /* nodes in all, up to WEFT__MAX_NODES + 1 */
    uint32_t height; /* mappings and lists inside one another */
} extent;

typedef struct walk {
    yaml_document_t *document;
    weft__report *report;
    extent *extents; /* of node i + 1 */
    bool good;
} walk;

static bool visit(walk *self, int id, uint32_t depth);

/* The number of child nodes, keys before values. */
static size_t child_count(const yaml_node_t *node)
{
    switch (node->type) {
    case YAML_SEQUENCE_NODE:
        return (size_t)(node->data.sequence.items.top
                        - node->data.sequence.items.start);
    case YAML_MAPPING_NODE:
        return 2
               * (size_t)(node->data.mapping.pairs.top
                          - node->data.mapping.pairs.start);
    default:
        return 0;
    }
}

static int child(const yaml_node_t *node, size_t i)
{
    if (node->type == YAML_SEQUENCE_NODE) {
        return node->data.sequence.items.start[i];
    }
    const yaml_node_pair_t *pair = &node->data.mapping.pairs.start[i / 2];
    return i % 2 == 0 ? pair->key : pair->value;
}

static void fail(walk *self, const yaml_node_t *node, const char *message)
{
    weft__report_error(self->report, node->start_mark, "%s", message);
    self->good = false;
}

static void check_tag(const walk *self, const yaml_node_t *node)
{
    static const char *const scalar_tags[]
        = { YAML_STR_TAG, YAML_INT_TAG, YAML_FLOAT_TAG, YAML_BOOL_TAG, YAML_NULL_TAG };
    const char *tag = (const char *)node->tag;
    bool known = false;
    if (node->type == YAML_SCALAR_NODE) {
        for (size_t i = 0; i < sizeof scalar_tags / sizeof scalar_tags[0]; ++i) {
            known = known || strcmp(tag, scalar_tags[i]) == 0;
        }
    } else {
        known
            = strcmp(tag, node->type == YAML_MAPPING_NODE ? YAML_MAP_TAG : YAML_SEQ_TAG)
              == 0;
    }
    if (!known) {
        weft__report_error(self->report, node->start_mark,
                           "tag '%.60s' means nothing in a scene", tag);
    }
}

static bool visit_children(walk *self, const yaml_node_t *node, extent *sum,
                           uint32_t depth)
{
    const size_t count = child_count(node);
    for (size_t i = 0; i < count; ++i) {
        const int id = child(node, i);
        if (id == 0) {
            continue; /* removed by an override */
        }
        if (!visit(self, id, depth + 1)) {
            return false;
        }
        const extent *part = &self->extents[id - 1];
        sum->size += part->size;
        sum->height = part->height + 1 > sum->height ? part->height + 1 : sum->height;
        if (sum->size > WEFT__MAX_NODES) {
            fail(self, node, "anchors expand to more than 1000000 nodes");
            return false;
        }
    }
    return true;
}

static bool visit(walk *self, int id, uint32_t depth)
{
    const yaml_node_t *node = yaml_document_get_node(self->document, id);
    extent *kept = &self->extents[id - 1];
    if (kept->state == ENTERED) {
        fail(self, node, "this contains itself by an alias");
        return false;
    }
    if (kept->state == NEW) {
        extent sum = { .size = 1, .height = node->type != YAML_SCALAR_NODE };
        kept->state = ENTERED;
        check_tag(self, node);
        if (depth <= WEFT__MAX_DEPTH && !visit_children(self, node, &sum, depth)) {
            return false;
        }
        *kept = sum;
        kept->state = DONE;
    }
    if (depth - 1 + kept->height > WEFT__MAX_DEPTH) {
        fail(self, node, "nested more than 32 deep");
        return false;
    }
    return true;
}

size_t weft__document_size(yaml_document_t *document, int id)
{
    const yaml_node_t *node = yaml_document_get_node(document, id);
    size_t size = 1;
    for (size_t i = 0; i < child_count(node); ++i) {
        const int part = child(node, i);
        size += part == 0 ? 0 : weft__document_size(document, part);
    }
    return size;
}

bool weft__document_check(yaml_document_t *document, weft__report *report)
{
    const size_t count = (size_t)(document->nodes.top - document->nodes.start);
    walk self
        = { .document = document,
            .report = report,
            .extents = weft__zeroed(report->memory, count + 1, sizeof *self.extents),
            .good = true };
    if (self.extents == NULL) {
        report->no_memory = true;
        return false;
    }
    (void)(count > 0 && visit(&self, 1, 1));
    weft__free(report->memory, self.extents);
    return self.good;
}
