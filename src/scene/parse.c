/* SPDX-License-Identifier: BSD-3-Clause */
/* parse.c -- a tree from the events of libyaml's parser, within limits. */
#include <string.h>

#include "scene/tree.h"

typedef struct tree_builder {
    weft__tree *tree;
    const weft__source *source;
    size_t skip;
    weft__mark start; /* of byte `skip` */
    yaml_parser_t parser;
    bool refused; /* although the text can be read on */
    size_t nodes, documents;
    weft__node anchors; /* a mapping of their names */
    weft__entry entries[WEFT__MAX_ANCHORS];
} tree_builder;

static weft__mark parse_place(const tree_builder *self, yaml_mark_t mark)
{
    if (self->source->number > 0) {
        return (weft__mark){ .source = self->source->number,
                             .column = self->start.column + mark.index };
    }
    return (weft__mark){ .line = mark.line, .column = mark.column };
}

/* ---- mistakes of syntax ------------------------------------------------------- */

/* Replaces libyaml's messages about tokens and contexts. */
static const char *explain(const tree_builder *self)
{
    const char *problem = self->parser.problem;
    char line[256];
    const weft__mark at = parse_place(self, self->parser.problem_mark);
    const int caret = weft__source_excerpt(self->source, at, line, sizeof line);
    if (strcmp(problem, "mapping values are not allowed in this context") == 0) {
        return "': ' is not allowed here: is a line indented by accident, or a text "
               "without quotes?";
    }
    if (strcmp(problem, "found character that cannot start any token") == 0) {
        return caret > 0 && line[caret - 1] == '\t'
                   ? "a tab is not allowed here: indent with spaces"
                   : "no value can begin with this character: a text needs quotes";
    }
    return problem;
}

/* A place in the text that is being read. */
static weft__words spot(const tree_builder *self, weft__mark at)
{
    weft__words out = weft__place_text(self->tree->report, at);
    if (at.source > 0) {
        (void)snprintf(out.text, sizeof out.text, "column %zu", at.column + 1);
    }
    return out;
}

/* Reports where libyaml stopped and where the surrounding mapping, list or text began:
 * the mistake is often there, and at the end of the text it is the only useful place.
 */
static void report_syntax(const tree_builder *self)
{
    weft__report *report = self->tree->report;
    const char *problem = explain(self), *context = self->parser.context;
    const weft__mark at = parse_place(self, self->parser.problem_mark);
    const weft__mark from = parse_place(self, self->parser.context_mark);
    if (context == NULL || !weft__mark_before(from, at)) {
        weft__report_error(report, at, "%s", problem);
    } else if (!weft__mark_before(
                   at, weft__source_mark(self->source, self->source->length))) {
        weft__report_error(report, from,
                           "%s (%s that begins here; the text ends at %s)", problem,
                           context, spot(self, at).text);
    } else {
        weft__report_error(report, at, "%s (%s that begins at %s)", problem, context,
                           spot(self, from).text);
    }
}

/* For bytes that are not text libyaml gives an offset instead of a mark, and for a
 * character that is cut short the offset of the next byte. */
static void report_reader(const tree_builder *self)
{
    const weft__source *source = self->source;
    const yaml_parser_t *parser = &self->parser;
    const bool control = strstr(parser->problem, "control") != NULL;
    size_t offset = self->skip + parser->problem_offset;
    if (strstr(parser->problem, "trailing") != NULL) {
        do {
            --offset;
        } while (((unsigned char)source->text[offset] & 0xC0) == 0x80);
    }
    weft__report_error(self->tree->report, weft__source_mark(source, offset),
                       control ? "control characters are not allowed (U+%04X)"
                               : "this is not UTF-8 (byte %02X)",
                       control ? (unsigned)parser->problem_value
                               : (unsigned)(unsigned char)source->text[offset]);
}

/* The next event; false if there is none, which is reported. */
static bool next_event(tree_builder *self, yaml_event_t *event)
{
    if (yaml_parser_parse(&self->parser, event)) {
        return true;
    }
    /* without memory, libyaml may report no error */
    if (self->parser.error == YAML_MEMORY_ERROR || self->parser.problem == NULL) {
        self->tree->report->no_memory = true;
    } else if (self->parser.error == YAML_READER_ERROR) {
        report_reader(self);
    } else {
        report_syntax(self);
    }
    return false;
}

/* ---- nodes -------------------------------------------------------------------- */

/* Reports a mistake at a place; returns NULL, as no node can be made. */
static const weft__node *fail(const tree_builder *self, weft__mark at,
                              const char *message)
{
    weft__report_error(self->tree->report, at, "%s", message);
    return NULL;
}

/* The node of an anchor; NULL: there is none of that name. */
static const weft__node *find_anchor(const tree_builder *self, const yaml_char_t *name)
{
    const size_t i = weft__find_key(&self->anchors, (const char *)name,
                                    strlen((const char *)name));
    return i < self->anchors.count ? self->entries[i].value : NULL;
}

/* The node of an alias; an invalid alias is reported and yields an empty scalar. */
static const weft__node *follow_alias(tree_builder *self, const yaml_event_t *event,
                                      size_t depth)
{
    static const weft__node nothing
        = { .style = YAML_PLAIN_SCALAR_STYLE, .text = "", .size = 1 };
    const weft__node *found = find_anchor(self, event->data.alias.anchor);
    if (found != NULL && !found->open && depth - 1 + found->height <= WEFT__MAX_DEPTH) {
        return found;
    }
    self->refused = true;
    (void)fail(self, found == NULL ? parse_place(self, event->start_mark) : found->at,
               found == NULL ? "found undefined alias"
               : found->open ? "this contains itself by an alias"
                             : "nested more than 32 deep");
    return &nothing;
}

/* Keeps the node of an anchor (NULL: none) for its aliases. false: there are too many,
 * or no memory. */
static bool keep_anchor(tree_builder *self, const yaml_char_t *name,
                        const weft__node *node)
{
    const weft__node *first = name == NULL ? NULL : find_anchor(self, name);
    if (first != NULL) {
        self->refused = true;
        ERROR_AT(self->tree, node, "duplicate anchor (the first is at %s)",
                 spot(self, first->at).text);
    }
    if (name == NULL || first != NULL) {
        return true;
    }
    if (self->anchors.count == WEFT__MAX_ANCHORS) {
        return fail(self, node->at, "more than 1000 anchors") != NULL;
    }
    const weft__node *key = weft__scalar_new(self->tree, (const char *)name,
                                             strlen((const char *)name), 0, node->at);
    self->entries[self->anchors.count++] = (weft__entry){ key, node };
    return key != NULL;
}

static void check_tag(const tree_builder *self, const yaml_char_t *tag,
                      const weft__node *node)
{
    static const struct {
        int type;
        const char *tag;
    } known[] = { { WEFT__SCALAR, YAML_STR_TAG },   { WEFT__SCALAR, YAML_INT_TAG },
                  { WEFT__SCALAR, YAML_FLOAT_TAG }, { WEFT__SCALAR, YAML_BOOL_TAG },
                  { WEFT__SCALAR, YAML_NULL_TAG },  { WEFT__LIST, YAML_SEQ_TAG },
                  { WEFT__MAP, YAML_MAP_TAG } };
    bool good = tag == NULL || strcmp((const char *)tag, "!") == 0;
    for (size_t i = 0; !good && i < sizeof known / sizeof known[0]; ++i) {
        good = (int)node->type == known[i].type
               && strcmp((const char *)tag, known[i].tag) == 0;
    }
    if (!good) {
        ERROR_AT(self->tree, node, "tag '%.60s' means nothing in a scene",
                 (const char *)tag);
    }
}

static const weft__node *build_scalar(tree_builder *self, const yaml_event_t *event)
{
    const char *tag = (const char *)event->data.scalar.tag;
    const bool is_text
        = tag != NULL && (strcmp(tag, "!") == 0 || strcmp(tag, YAML_STR_TAG) == 0);
    const yaml_scalar_style_t style = event->data.scalar.style;
    return weft__scalar_new(
        self->tree, (const char *)event->data.scalar.value, event->data.scalar.length,
        is_text && style == YAML_PLAIN_SCALAR_STYLE ? YAML_SINGLE_QUOTED_SCALAR_STYLE
                                                    : (int)style,
        parse_place(self, event->start_mark));
}

static const weft__node *build_node(tree_builder *self, yaml_event_t *event,
                                    size_t depth);

/* The entries of a mapping or list, up to its end. */
static bool build_entries(tree_builder *self, weft__node *parent, size_t depth)
{
    const weft__node *key = NULL;
    yaml_event_t event;
    while (next_event(self, &event)) {
        if (event.type == YAML_SEQUENCE_END_EVENT
            || event.type == YAML_MAPPING_END_EVENT) {
            parent->open = false;
            return true;
        }
        const weft__node *node = build_node(self, &event, depth + 1);
        if (node == NULL) {
            return false;
        }
        if (parent->type == WEFT__MAP && key == NULL) {
            key = node;
        } else if (weft__node_add(self->tree, parent, (weft__entry){ key, node })) {
            key = NULL;
        } else {
            return false;
        }
    }
    return false;
}

static weft__node *begin_parent(const tree_builder *self, const yaml_event_t *event,
                                size_t depth)
{
    const bool is_map = event->type == YAML_MAPPING_START_EVENT;
    const weft__mark at = parse_place(self, event->start_mark);
    if (depth > WEFT__MAX_DEPTH) {
        (void)fail(self, at, "nested more than 32 deep");
        return NULL;
    }
    return weft__node_new(
        self->tree,
        (weft__node){ .type = is_map ? WEFT__MAP : WEFT__LIST,
                      .style = is_map ? (int)event->data.mapping_start.style : 0,
                      .open = true,
                      .at = at });
}

/* The node that an event begins, which is deleted; NULL: the text is not read on. */
static const weft__node *build_node(tree_builder *self, yaml_event_t *event,
                                    size_t depth)
{
    const weft__node *node = NULL;
    weft__node *parent = NULL;
    const yaml_char_t *anchor = NULL, *tag = NULL;
    if (++self->nodes > WEFT__MAX_NODES) {
        (void)fail(self, parse_place(self, event->start_mark),
                   "more than 1000000 nodes");
    } else if (event->type == YAML_ALIAS_EVENT) {
        node = follow_alias(self, event, depth);
    } else if (event->type == YAML_SCALAR_EVENT) {
        node = build_scalar(self, event);
        anchor = event->data.scalar.anchor;
        tag = event->data.scalar.tag;
    } else {
        const bool is_map = event->type == YAML_MAPPING_START_EVENT;
        node = parent = begin_parent(self, event, depth);
        anchor = is_map ? event->data.mapping_start.anchor
                        : event->data.sequence_start.anchor;
        tag = is_map ? event->data.mapping_start.tag : event->data.sequence_start.tag;
    }
    const bool kept = node != NULL && keep_anchor(self, anchor, node);
    if (kept) {
        check_tag(self, tag, node);
    }
    yaml_event_delete(event);
    return kept && (parent == NULL || build_entries(self, parent, depth)) ? node : NULL;
}

/* ---- the document ------------------------------------------------------------- */

/* A second document is a mistake; the first is still read. */
static bool build_document(tree_builder *self, const weft__node **root)
{
    yaml_event_t event;
    while (next_event(self, &event)) {
        const yaml_event_type_t type = event.type;
        if (type >= YAML_ALIAS_EVENT) { /* it begins a node */
            *root = build_node(self, &event, 1);
            if (*root == NULL) {
                return false;
            }
            continue;
        }
        const bool second = type == YAML_DOCUMENT_START_EVENT && ++self->documents == 2;
        if (second) {
            (void)fail(self, parse_place(self, event.start_mark),
                       "a second document begins here; a scene is a single one");
        }
        yaml_event_delete(&event);
        if (second || type == YAML_STREAM_END_EVENT) {
            return !self->refused;
        }
    }
    return false;
}

/* With its encoding set, libyaml does not guess UTF-16, in which places are not counted
 * here. */
bool weft__tree_parse(weft__tree *tree, const weft__source *source, size_t skip,
                      const weft__node **root)
{
    tree_builder self = { .tree = tree,
                          .source = source,
                          .skip = skip,
                          .start = weft__source_mark(source, skip) };
    self.anchors.entries = self.entries;
    *root = NULL;
    if (!yaml_parser_initialize(&self.parser)) {
        tree->report->no_memory = true;
        return false;
    }
    yaml_parser_set_encoding(&self.parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&self.parser,
                                 (const unsigned char *)source->text + skip,
                                 source->length - skip);
    const bool good = build_document(&self, root);
    yaml_parser_delete(&self.parser);
    return good;
}
