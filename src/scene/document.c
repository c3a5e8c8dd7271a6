/* SPDX-License-Identifier: BSD-3-Clause */
/* document.c -- a text loaded by libyaml, within limits.
 *
 * Two passes. The first goes over libyaml's events and stops at the first sign of a
 * text that is too much: libyaml's loader takes quadratic time over deep nesting and
 * many anchors, and 200 bytes a node. It also finds the second document, and every
 * mistake of syntax. The second pass is libyaml's own loader. */
#include "scene/document.h"

#include <stdlib.h>
#include <string.h>

typedef struct scan {
    const weft__source *source;
    size_t skip;
    weft__report *report;
    size_t documents, nodes, depth, anchors;
} scan;

static yaml_mark_t place(const scan *self, yaml_mark_t mark)
{
    return weft__source_mark_from(self->source, self->skip, mark);
}

/* What libyaml says of these is about tokens and contexts. */
static const char *explain(const scan *self, const yaml_parser_t *parser)
{
    const char *problem = parser->problem;
    char line[256];
    const yaml_mark_t at = place(self, parser->problem_mark);
    const int caret = weft__source_excerpt(self->source, at, line, sizeof line);
    if (strcmp(problem, "mapping values are not allowed in this context") == 0) {
        return "': ' is not allowed here: is a line indented by mistake, or a text "
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
static const char *spot(yaml_mark_t at, char *out, size_t size)
{
    if (at.index == 0) {
        return weft__place_text(at, out, size);
    }
    (void)snprintf(out, size, "column %zu", at.column + 1);
    return out;
}

/* Tells where libyaml stopped and also what it was about when it did, which is often
 * where the mistake is. Where it ran to the end of the text only the latter is of use.
 */
static void report_syntax(const scan *self, const yaml_parser_t *parser)
{
    const yaml_mark_t at = place(self, parser->problem_mark);
    const yaml_mark_t from = place(self, parser->context_mark);
    const yaml_mark_t end = weft__source_mark(self->source, self->source->length);
    const char *problem = explain(self, parser);
    char where[64];
    if (parser->context == NULL || !weft__mark_before(from, at)) {
        weft__report_error(self->report, at, "%s", problem);
    } else if (strncmp(parser->context, "found duplicate anchor", 22) == 0) {
        weft__report_error(self->report, at, "duplicate anchor (the first is at %s)",
                           spot(from, where, sizeof where));
    } else if (!weft__mark_before(at, end)) {
        weft__report_error(self->report, from,
                           "%s (%s that begins here; the text ends at %s)", problem,
                           parser->context, spot(at, where, sizeof where));
    } else {
        weft__report_error(self->report, at, "%s (%s that begins at %s)", problem,
                           parser->context, spot(from, where, sizeof where));
    }
}

/* libyaml gives no mark to what is not text, but a byte, and of a character that is cut
 * short the byte after. */
static void report_reader(const scan *self, const yaml_parser_t *parser)
{
    size_t offset = self->skip + parser->problem_offset;
    if (strstr(parser->problem, "control") != NULL) {
        weft__report_error(self->report, weft__source_mark(self->source, offset),
                           "control characters are not allowed (U+%04X)",
                           (unsigned)parser->problem_value);
        return;
    }
    if (strstr(parser->problem, "trailing") != NULL) {
        do {
            --offset;
        } while (((unsigned char)self->source->text[offset] & 0xC0) == 0x80);
    }
    weft__report_error(self->report, weft__source_mark(self->source, offset),
                       "this is not UTF-8 (byte %02X)",
                       (unsigned)(unsigned char)self->source->text[offset]);
}

static void report_failure(const scan *self, const yaml_parser_t *parser)
{
    /* libyaml forgets to say so at times when memory ran out */
    if (parser->error == YAML_MEMORY_ERROR || parser->problem == NULL) {
        self->report->no_memory = true;
    } else if (parser->error == YAML_READER_ERROR) {
        report_reader(self, parser);
    } else {
        report_syntax(self, parser);
    }
}

/* Counts an event; says what is wrong if there are too many of its kind. */
static const char *count_event(scan *self, const yaml_event_t *event)
{
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        return ++self->documents > 1
                   ? "a second document begins here; a scene is a single one"
                   : NULL;
    case YAML_SCALAR_EVENT:
        self->anchors += event->data.scalar.anchor != NULL;
        ++self->nodes;
        break;
    case YAML_SEQUENCE_START_EVENT:
        self->anchors += event->data.sequence_start.anchor != NULL;
        ++self->nodes;
        ++self->depth;
        break;
    case YAML_MAPPING_START_EVENT:
        self->anchors += event->data.mapping_start.anchor != NULL;
        ++self->nodes;
        ++self->depth;
        break;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        --self->depth;
        break;
    case YAML_ALIAS_EVENT:
        ++self->nodes;
        break;
    default:
        break;
    }
    return self->depth > WEFT__MAX_DEPTH       ? "nested more than 32 deep"
           : self->nodes > WEFT__MAX_NODES     ? "more than 1000000 nodes"
           : self->anchors > WEFT__MAX_ANCHORS ? "more than 1000 anchors"
                                               : NULL;
}

/* Over one event; false at the end or if the scan must stop. */
static bool scan_event(scan *self, yaml_parser_t *parser, bool *good)
{
    yaml_event_t event;
    if (!yaml_parser_parse(parser, &event)) {
        report_failure(self, parser);
        *good = false;
        return false;
    }
    const char *wrong = count_event(self, &event);
    const bool go_on = wrong == NULL && event.type != YAML_STREAM_END_EVENT;
    if (wrong != NULL) {
        weft__report_error(self->report, place(self, event.start_mark), "%s", wrong);
        *good = self->documents > 1; /* the first one can still be read */
    }
    yaml_event_delete(&event);
    return go_on;
}

/* Saying UTF-8 keeps libyaml from guessing UTF-16, for which no places could be told.
 */
static bool open_parser(const scan *self, yaml_parser_t *parser)
{
    if (!yaml_parser_initialize(parser)) {
        self->report->no_memory = true;
        return false;
    }
    yaml_parser_set_encoding(parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(parser,
                                 (const unsigned char *)self->source->text + self->skip,
                                 self->source->length - self->skip);
    return true;
}

static bool scan_text(scan *self)
{
    yaml_parser_t parser;
    bool good = true;
    if (!open_parser(self, &parser)) {
        return false;
    }
    while (scan_event(self, &parser, &good)) {
    }
    yaml_parser_delete(&parser);
    return good;
}

/* Whether the node at text, behind an anchor perhaps, has a tag written out. */
static bool has_tag(const char *text, const char *end)
{
    while (text < end && *text == '&') {
        while (text < end && strchr(" \t\r\n", *text) == NULL) {
            ++text;
        }
        while (text < end && strchr(" \t\r\n", *text) != NULL) {
            ++text;
        }
    }
    return text < end && *text == '!';
}

/* Give each node its place in the source. libyaml makes no difference between plain
 * text and !!str, so that is looked up in the text; nodes come in its order. */
static void finish_nodes(const scan *self, yaml_document_t *document)
{
    const char *text = self->source->text + self->skip;
    const char *end = self->source->text + self->source->length;
    size_t index = 0;
    const yaml_mark_t start = weft__source_mark(self->source, self->skip);
    for (yaml_node_t *node = document->nodes.start; node < document->nodes.top;
         ++node) {
        for (; index < node->start_mark.index && text < end; ++index) {
            text += weft__char_length(text, (size_t)(end - text));
        }
        if (node->type == YAML_SCALAR_NODE && has_tag(text, end)
            && strcmp((const char *)node->tag, YAML_STR_TAG) == 0
            && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE) {
            node->data.scalar.style = YAML_SINGLE_QUOTED_SCALAR_STYLE;
        }
        if (self->source->number > 0) {
            node->start_mark.line = 0;
            node->start_mark.column = start.column + node->start_mark.index;
        }
        node->start_mark.index = self->source->number;
    }
}

bool weft__document_load(const weft__source *source, size_t skip, weft__report *report,
                         yaml_document_t *out)
{
    scan self = { .source = source, .skip = skip, .report = report };
    yaml_parser_t parser;
    if (!scan_text(&self) || !open_parser(&self, &parser)) {
        return false;
    }
    const bool loaded = yaml_parser_load(&parser, out) != 0;
    if (loaded) {
        finish_nodes(&self, out);
    } else {
        report_failure(&self, &parser);
    }
    yaml_parser_delete(&parser);
    return loaded;
}

bool weft__document_default(const char *text, weft__report *report,
                            yaml_document_t *out)
{
    const weft__source source = { .file = "", .text = text, .length = strlen(text) };
    if (text[0] == '[') {
        return weft__document_load(&source, 0, report, out);
    }
    if (!yaml_document_initialize(out, NULL, NULL, NULL, 1, 1)) {
        report->no_memory = true;
        return false;
    }
    if (yaml_document_add_scalar(out, NULL, (const unsigned char *)text, -1,
                                 YAML_PLAIN_SCALAR_STYLE)
        == 0) {
        report->no_memory = true;
        yaml_document_delete(out);
        return false;
    }
    return true;
}

ptrdiff_t weft__find_pair(yaml_document_t *document, const yaml_node_t *mapping,
                          const char *key, size_t length)
{
    const yaml_node_pair_t *pairs = mapping->data.mapping.pairs.start;
    const ptrdiff_t count = mapping->data.mapping.pairs.top - pairs;
    for (ptrdiff_t i = 0; i < count; ++i) {
        const yaml_node_t *node = yaml_document_get_node(document, pairs[i].key);
        if (node->type == YAML_SCALAR_NODE && node->data.scalar.length == length
            && memcmp(node->data.scalar.value, key, length) == 0) {
            return i;
        }
    }
    return -1;
}
