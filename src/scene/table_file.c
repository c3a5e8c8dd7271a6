/* SPDX-License-Identifier: BSD-3-Clause */
/* table_file.c -- tables of times that are CSV files, and materials that are JSON files
 * (material_file.c): what they have comes in place of the file's name, so that all that
 * follows, and the copy of a scene in a run's results, has it. */
#include <string.h>

#include "base/file.h"
#include "scene/checks.h"

#define HEADER "t,x,y,z"
enum { COLUMNS = 4, LONGEST = 512 };

/* ---- a file ---------------------------------------------------------------------- */

/* One that is being read; `at`: its name in the scene. */
typedef struct csv {
    weft__reader *reader;
    const weft__node *at;
    const char *name;
    size_t line;
    char text[LONGEST];
} csv;

static bool refuse(csv *of, const char *wanted)
{
    ERROR_AT(of->reader, of->at, "%s, line %zu: %s, not '%.60s'", of->name, of->line,
             wanted, of->text);
    return false;
}

/* Takes spaces, and what ends a line, from both ends. */
static char *trimmed(char *text)
{
    static const char blank[] = " \t\r\n";
    text += strspn(text, blank);
    size_t length = strlen(text);
    while (length > 0 && strchr(blank, text[length - 1]) != NULL) {
        text[--length] = '\0';
    }
    return text;
}

/* The row of a line; NULL: it was refused, or no memory. */
static const weft__node *read_row(csv *of, const char *line)
{
    weft__tree *tree = of->reader->tree;
    weft__node *row
        = weft__node_new(tree, (weft__node){ .type = WEFT__LIST, .at = of->at->at });
    char copy[LONGEST];
    char *next = strcpy(copy, line);
    size_t count = 0;
    for (; next != NULL && row != NULL && count < COLUMNS; ++count) {
        char *part = next;
        double number;
        next = strchr(part, ',');
        if (next != NULL) {
            *next++ = '\0';
        }
        part = trimmed(part);
        const weft__node *value = weft__scalar_new(tree, part, strlen(part),
                                                   YAML_PLAIN_SCALAR_STYLE, of->at->at);
        if (value == NULL) {
            return NULL;
        }
        if (!weft__number_of(value, &number)) {
            break;
        }
        (void)weft__node_add(tree, row, (weft__entry){ NULL, value });
    }
    if (count != COLUMNS || next != NULL) {
        (void)refuse(of, "must be four numbers " HEADER);
        return NULL;
    }
    return row;
}

/* The header, or a row; empty lines count for nothing. */
static bool read_line(csv *of, weft__node *rows)
{
    const size_t skip
        = of->line == 1 && strncmp(of->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    const bool whole = strlen(of->text) < LONGEST - 1;
    const char *line = trimmed(of->text + skip);
    if (!whole) {
        return refuse(of, "must be four numbers " HEADER ", in one line");
    }
    if (of->line == 1) {
        return strcmp(line, HEADER) == 0 || refuse(of, "must be the header " HEADER);
    }
    const weft__node *row = line[0] != '\0' ? read_row(of, line) : rows;
    return row == rows
           || (row != NULL
               && weft__node_add(of->reader->tree, rows, (weft__entry){ NULL, row }));
}

/* A name that ends in .csv; NULL: the value is something else. */
static const char *file_name(const weft__node *node)
{
    const char *text = node->type == WEFT__SCALAR ? weft__text_of(node) : NULL;
    const size_t length = text != NULL ? strlen(text) : 0;
    return length > 4 && strcmp(text + length - 4, ".csv") == 0 ? text : NULL;
}

bool weft__is_table_file(const weft__node *node)
{
    return file_name(node) != NULL;
}

static const weft__node *take_file(weft__reader *reader, const weft__node *node)
{
    csv of = { .reader = reader, .at = node, .name = file_name(node) };
    weft_error err = { 0 };
    if (of.name == NULL) {
        return node;
    }
    const char *path = weft__mesh_path(reader, of.name, of.name);
    FILE *stream = path != NULL ? weft__file_open(path, "r", &err) : NULL;
    weft__node *rows
        = stream == NULL
              ? NULL
              : weft__node_new(reader->tree,
                               (weft__node){ .type = WEFT__LIST, .at = node->at });
    if (path != NULL && stream == NULL) {
        UNOPENED_AT(reader, node, err);
    }
    bool good = rows != NULL;
    while (good && fgets(of.text, sizeof of.text, stream) != NULL) {
        ++of.line;
        good = read_line(&of, rows);
    }
    if (good && rows->count == 0) {
        ++of.line;
        of.text[0] = '\0';
        good = refuse(&of, of.line == 1 ? "must be the header " HEADER
                                        : "must be four numbers " HEADER);
    }
    if (stream != NULL) {
        (void)fclose(stream);
    }
    return good ? rows : node;
}

/* ---- where tables are ------------------------------------------------------------ */

static const weft__node *take_section(weft__reader *reader, const weft__section *of,
                                      const weft__node *node);

/* A node with another value in a slot; itself, if that is the one it has, or there is
 * no memory. */
static const weft__node *with_value(weft__reader *reader, const weft__node *node,
                                    size_t slot, const weft__node *value)
{
    const weft__entry *now = &node->entries[slot];
    const weft__node *out = value == now->value
                                ? node
                                : weft__node_with(reader->tree, node, slot,
                                                  (weft__entry){ now->key, value });
    return out != NULL ? out : node;
}

static const weft__node *with_key(weft__reader *reader, const weft__node *node,
                                  const char *key, const weft__node *value)
{
    return with_value(reader, node, weft__find_key(node, key, strlen(key)), value);
}

/* Each section of a mapping from names to sections. */
static const weft__node *take_named(weft__reader *reader, const weft__section *of,
                                    const weft__node *node)
{
    for (size_t i = 0; node->type == WEFT__MAP && i < node->count; ++i) {
        if (node->entries[i].value != NULL) {
            node = with_value(reader, node, i,
                              take_section(reader, of, node->entries[i].value));
        }
    }
    return node;
}

/* What stands in place of a value, or of an item or a member of it: itself, if nothing
 * changes. */
static const weft__node *take_value(weft__reader *reader, const weft__key *key,
                                    const weft__node *node)
{
    const weft__node *rows
        = node->type == WEFT__MAP ? weft__value_of(node, "rows") : NULL;
    if (key->kind == WEFT__ARCSIM) {
        return weft__take_material(reader, node);
    }
    if (key->kind == WEFT__FABRICS) {
        return take_named(reader, key->section, node);
    }
    if (key->kind != WEFT__TRACK) {
        return take_section(reader, key->section, node);
    }
    return rows == NULL ? take_file(reader, node)
                        : with_key(reader, node, "rows", take_file(reader, rows));
}

/* All values of a mapping, or of each mapping of a list. */
static const weft__node *take_section(weft__reader *reader, const weft__section *of,
                                      const weft__node *node)
{
    for (size_t i = 0; node->type == WEFT__LIST && i < weft__item_count(node); ++i) {
        node = with_value(reader, node, i,
                          take_section(reader, of, weft__item(node, i)));
    }
    for (size_t i = 0; node->type == WEFT__MAP && i < of->count; ++i) {
        const weft__key *key = &of->keys[i];
        const bool may = key->kind == WEFT__TRACK || key->kind == WEFT__MAPPING
                         || key->kind == WEFT__ITEMS || key->kind == WEFT__CLOTHS
                         || key->kind == WEFT__FABRICS || key->kind == WEFT__ARCSIM;
        const weft__node *value = may ? weft__value_of(node, key->name) : NULL;
        if (value != NULL) {
            node = with_key(reader, node, key->name, take_value(reader, key, value));
        }
    }
    return node;
}

bool weft__take_tables(weft__reader *reader)
{
    const weft__node *before = reader->tree->root;
    reader->tree->root = take_section(reader, reader->root, before);
    return reader->tree->root != before;
}
