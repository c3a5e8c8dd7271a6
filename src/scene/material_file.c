/* SPDX-License-Identifier: BSD-3-Clause */
/* material_file.c -- a material of ARCSim, a JSON file, as nodes of the tree: it comes
 * in place of the file's name, so that the copy of a scene in a run's results has it.
 * Mistakes in it are reported at their line. Comments of // and of C are blanks, as
 * some of ARCSim's files have them. */
#include <string.h>

#include "base/file.h"
#include "scene/checks.h"

enum { MOST_BYTES = 1 << 20, DEEPEST = 16 };

/* The text that is being read. */
typedef struct json {
    weft__reader *reader;
    weft__mark at; /* where the scene names the file */
    weft__named_file *file;
    const char *next;
    size_t depth;
} json;

static weft__mark json_mark(const json *of, const char *text)
{
    weft__mark at = of->at;
    at.in = of->file;
    at.byte = (size_t)(text - of->file->text) + 1;
    return at;
}

static const weft__node *json_fail(const json *of, const char *wanted)
{
    weft__report_error(of->reader->report, json_mark(of, of->next),
                       "JSON needs %s here%s", wanted,
                       *of->next == '\0' ? ", not the end of the file" : "");
    return NULL;
}

static void skip_blanks(json *of)
{
    const char *p = of->next;
    for (const char *before = NULL; before != p;) {
        before = p;
        p += strspn(p, " \t\r\n");
        if (strncmp(p, "//", 2) == 0) {
            p += strcspn(p, "\n");
        } else if (strncmp(p, "/*", 2) == 0 && strstr(p, "*/") != NULL) {
            p = strstr(p, "*/") + 2;
        }
    }
    of->next = p;
}

/* Whether the next sign is this one, which is passed then. */
static bool takes(json *of, char sign)
{
    skip_blanks(of);
    const bool there = *of->next == sign;
    of->next += there;
    return there;
}

/* A text in quotes, with its escapes as they stand: no key of a material has any. */
static const weft__node *read_string(json *of)
{
    const char *begin = of->next + 1, *end = begin;
    while (*end != '"' && *end != '\0' && *end != '\n') {
        end += end[0] == '\\' && end[1] != '\0' ? 2 : 1;
    }
    if (*end != '"') {
        return json_fail(of, "a text with its closing quote");
    }
    const weft__mark at = json_mark(of, of->next);
    of->next = end + 1;
    return weft__scalar_new(of->reader->tree, begin, (size_t)(end - begin),
                            YAML_DOUBLE_QUOTED_SCALAR_STYLE, at);
}

static const weft__node *read_word(json *of)
{
    const size_t length = strspn(of->next, "+-.0123456789eEabcdfghijklmnopqrstuvwxyz");
    if (length == 0) {
        return json_fail(of, "a value");
    }
    const char *begin = of->next;
    of->next += length;
    return weft__scalar_new(of->reader->tree, begin, length, YAML_PLAIN_SCALAR_STYLE,
                            json_mark(of, begin));
}

static const weft__node *read_json(json *of);

/* An item of a list, or a pair of a mapping. */
static bool read_entry(json *of, weft__node *parent)
{
    weft__entry entry = { NULL, NULL };
    skip_blanks(of);
    if (parent->type == WEFT__MAP) {
        entry.key
            = *of->next == '"' ? read_string(of) : json_fail(of, "a key in quotes");
        if (entry.key == NULL) {
            return false;
        }
        if (!takes(of, ':')) {
            (void)json_fail(of, "':'");
            return false;
        }
    }
    entry.value = read_json(of);
    return entry.value != NULL && weft__node_add(of->reader->tree, parent, entry);
}

static const weft__node *read_entries(json *of, char end)
{
    const weft__mark at = json_mark(of, of->next++);
    weft__node *node = weft__node_new(
        of->reader->tree,
        (weft__node){ .type = end == '}' ? WEFT__MAP : WEFT__LIST, .at = at });
    if (node == NULL || of->depth == DEEPEST) {
        return node == NULL ? NULL : json_fail(of, "fewer levels of lists");
    }
    ++of->depth;
    for (bool more = !takes(of, end); more;) {
        if (!read_entry(of, node)) {
            return NULL;
        }
        more = takes(of, ',');
        if (!more && !takes(of, end)) {
            return json_fail(of, end == '}' ? "',' or '}'" : "',' or ']'");
        }
    }
    --of->depth;
    return node;
}

static const weft__node *read_json(json *of)
{
    skip_blanks(of);
    return *of->next == '{'   ? read_entries(of, '}')
           : *of->next == '[' ? read_entries(of, ']')
           : *of->next == '"' ? read_string(of)
                              : read_word(of);
}

/* The text of a file, of the tree. NULL: what is wrong was reported, or no memory. */
static weft__named_file *load_text(weft__reader *reader, const weft__node *node,
                                   const char *path)
{
    weft_error err;
    FILE *stream = weft__file_open(path, "r", &err);
    weft__named_file *file = weft__tree_take(reader->tree, 1, sizeof *file);
    char *text = weft__tree_take(reader->tree, MOST_BYTES + 1, 1);
    if (stream == NULL) {
        UNOPENED_AT(reader, node, err);
    }
    if (stream == NULL || file == NULL || text == NULL) {
        if (stream != NULL) {
            (void)fclose(stream);
        }
        return NULL;
    }
    *file = (weft__named_file){ .path = path, .text = text };
    file->length = fread(text, 1, MOST_BYTES, stream);
    const bool whole = file->length < MOST_BYTES && !ferror(stream);
    (void)fclose(stream);
    if (!whole || strlen(text) < file->length) {
        ERROR_AT(reader, node, "%.200s is no JSON text of less than %d bytes", path,
                 MOST_BYTES);
        return NULL;
    }
    return file;
}

const weft__node *weft__take_material(weft__reader *reader, const weft__node *node)
{
    const char *name = node->type == WEFT__SCALAR ? weft__text_of(node) : NULL;
    const char *path = name != NULL ? weft__mesh_path(reader, name, name) : NULL;
    json of = { .reader = reader, .at = node->at };
    of.file = path != NULL ? load_text(reader, node, path) : NULL;
    if (of.file == NULL) {
        return node;
    }
    of.next = of.file->text + weft__mark_length(of.file->text);
    const weft__node *made = read_json(&of);
    skip_blanks(&of);
    if (made != NULL && *of.next != '\0') {
        made = json_fail(&of, "the end of the file");
    }
    return made != NULL ? made : node;
}
