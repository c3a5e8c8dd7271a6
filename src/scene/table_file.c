/* SPDX-License-Identifier: BSD-3-Clause */
/* table_file.c -- tables of times that are CSV files: their rows come in place of the
 * file's name, so that all that follows, and the copy of a scene in a run's results,
 * has a list. */
#include <string.h>

#include "base/file.h"
#include "scene/checks.h"

#define HEADER "t,x,y,z"
enum { COLUMNS = 4, LONGEST = 512 };

/* What stands in place of a value: itself, if nothing changes. */
typedef const weft__node *change_fn(weft__reader *reader, const weft__node *node);

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
        ERROR_AT(reader, node, "%s", err.message);
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

/* A mapping whose value of `key` is changed. */
static const weft__node *with(weft__reader *reader, const weft__node *node,
                              const char *key, change_fn *change)
{
    const size_t slot
        = node->type == WEFT__MAP ? weft__find_key(node, key, strlen(key)) : SIZE_MAX;
    if (slot >= node->count || node->entries[slot].value == NULL) {
        return node;
    }
    const weft__entry *now = &node->entries[slot];
    const weft__node *value = change(reader, now->value);
    const weft__node *out = value == now->value
                                ? node
                                : weft__node_with(reader->tree, node, slot,
                                                  (weft__entry){ now->key, value });
    return out != NULL ? out : node;
}

/* A list whose items are changed. */
static const weft__node *each(weft__reader *reader, const weft__node *node,
                              change_fn *change)
{
    for (size_t i = 0; i < weft__item_count(node); ++i) {
        const weft__node *item = weft__item(node, i), *now = change(reader, item);
        const weft__node *out
            = now == item
                  ? node
                  : weft__node_with(reader->tree, node, i, (weft__entry){ NULL, now });
        node = out != NULL ? out : node;
    }
    return node;
}

static const weft__node *table(weft__reader *reader, const weft__node *node)
{
    return take_file(reader, with(reader, node, "rows", take_file));
}

static const weft__node *pin(weft__reader *reader, const weft__node *node)
{
    return with(reader, node, "path", table);
}

static const weft__node *pins(weft__reader *reader, const weft__node *node)
{
    return each(reader, node, pin);
}

static const weft__node *cloth(weft__reader *reader, const weft__node *node)
{
    return with(reader, node, "pins", pins);
}

static const weft__node *cloths(weft__reader *reader, const weft__node *node)
{
    return each(reader, node, cloth);
}

static const weft__node *wind(weft__reader *reader, const weft__node *node)
{
    return with(reader, node, "table", table);
}

static const weft__node *forces(weft__reader *reader, const weft__node *node)
{
    return with(reader, node, "wind", wind);
}

bool weft__take_tables(weft__reader *reader)
{
    const weft__node *before = reader->tree->root, *root = before;
    root = with(reader, root, "cloth", cloth);
    root = with(reader, root, "cloths", cloths);
    reader->tree->root = with(reader, root, "forces", forces);
    return reader->tree->root != before;
}
