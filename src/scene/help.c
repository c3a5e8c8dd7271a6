/* SPDX-License-Identifier: BSD-3-Clause */
/* help.c -- the table of keys as text. */
#include <string.h>

#include "scene/keys.h"

static const char *default_text(const weft__key *key)
{
    return key->fallback != NULL ? key->fallback
           : key->absent != NULL ? key->absent
           : key->required       ? "required"
                                 : "none";
}

/* Whether it has no default: it is required, always or under a condition that the text
 * states. */
static bool is_required(const weft__key *key)
{
    return strncmp(default_text(key), "required", strlen("required")) == 0;
}

/* The keys below a key; NULL: there are none, or they are told elsewhere. */
static const weft__section *below(const weft__key *key)
{
    return key->kind == WEFT__INSIDE || key->kind == WEFT__FABRICS
                   || key->kind == WEFT__CLOTHS || key->kind == WEFT__PATH
                   || key->kind == WEFT__PATHS
               ? NULL
               : key->section;
}

/* ---- plain text: a tree, in columns ----------------------------------------- */

typedef struct printer {
    void (*line)(void *ctx, const char *text);
    void *ctx;
} printer;

enum { KEY_WIDTH = 20, TEXT_WIDTH = 60 };

/* Moves as many words as fit into width characters from *text to out. */
static void take_words(const char **text, size_t width, char *out)
{
    const char *from = *text;
    size_t length = strlen(from);
    if (length > width) {
        length = width;
        while (length > 0 && from[length] != ' ') {
            --length;
        }
        length = length == 0 ? width : length;
    }
    memcpy(out, from, length);
    out[length] = '\0';
    from += length;
    *text = from + (*from == ' ');
}

/* A text in the second column, beside a name in the first. */
static void print_beside(const printer *to, const char *name, const char *text)
{
    char words[TEXT_WIDTH + 1], line[KEY_WIDTH + TEXT_WIDTH + 1];
    if (strlen(name) >= KEY_WIDTH) {
        to->line(to->ctx, name);
        name = "";
    }
    while (*text != '\0') {
        take_words(&text, TEXT_WIDTH, words);
        (void)snprintf(line, sizeof line, "%-*s%s", KEY_WIDTH, name, words);
        to->line(to->ctx, line);
        name = "";
    }
}

static void print_key(const printer *to, const weft__key *key, const char *name)
{
    char type[200], text[300];
    (void)snprintf(text, sizeof text, "%s; %s%s",
                   weft__wanted(key, true, true, type, sizeof type),
                   is_required(key) ? "" : "default ", default_text(key));
    print_beside(to, name, text);
    print_beside(to, "", key->meaning);
}

static void print_tree(const printer *to, const weft__section *section, int depth)
{
    for (size_t i = 0; section != NULL && i < section->count; ++i) {
        const weft__key *key = &section->keys[i];
        char name[40];
        if (depth == 0) {
            to->line(to->ctx, "");
        }
        (void)snprintf(name, sizeof name, "%*s%s", 2 * depth, "", key->name);
        print_key(to, key, name);
        print_tree(to, below(key), depth + 1);
    }
}

static void print_text(const printer *to)
{
    static const char *const places[] = {
        "",
        "A place is a corner (top-left, top-right, bottom-left, bottom-right), an",
        "edge (top, bottom, left, right), [row, column], or {rows: ..., cols: ...}",
        "with an index, an inclusive [first, last] or all for each. Negative indices",
        "count from the end. Units are SI, but for the sheets kes and fast, and are",
        "never written in a scene.",
    };
    print_beside(to, "key", "type [unit]; default");
    print_beside(to, "", "meaning");
    print_tree(to, &weft__root, 0);
    for (size_t i = 0; i < sizeof places / sizeof places[0]; ++i) {
        to->line(to->ctx, places[i]);
    }
}

/* ---- Markdown: a table for each part ---------------------------------------- */

static void print_row(const printer *to, const weft__key *key, const char *path)
{
    char type[200], line[600];
    const char *fallback = default_text(key);
    const char *tick = key->fallback != NULL ? "`" : "";
    const char *bold = is_required(key) ? "**" : "";
    (void)snprintf(line, sizeof line, "| `%s` | %s | %s%s%s%s%s | %s |", path,
                   weft__wanted(key, true, true, type, sizeof type), bold, tick,
                   fallback, tick, bold, key->meaning);
    to->line(to->ctx, line);
}

static void print_rows(const printer *to, const weft__section *section,
                       const char *above)
{
    for (size_t i = 0; i < section->count; ++i) {
        const weft__key *key = &section->keys[i];
        const bool list = key->kind == WEFT__ITEMS;
        char path[120];
        (void)snprintf(path, sizeof path, "%s%s", above, key->name);
        print_row(to, key, path);
        if (below(key) != NULL && above[0] != '\0') {
            (void)snprintf(path, sizeof path, "%s%s%s.", above, key->name,
                           list ? "[]" : "");
            print_rows(to, below(key), path);
        }
    }
}

static void print_markdown(const printer *to)
{
    const weft__section *root = &weft__root;
    for (size_t i = 0; i <= root->count; ++i) {
        char text[120];
        const weft__key *part = i == 0 ? NULL : &root->keys[i - 1];
        if (part != NULL && below(part) == NULL) {
            continue;
        }
        if (i > 0) {
            to->line(to->ctx, "");
        }
        (void)snprintf(text, sizeof text, "### %s", i == 0 ? "The scene" : part->name);
        to->line(to->ctx, text);
        to->line(to->ctx, "");
        to->line(to->ctx, "| key | type [unit] | default | meaning |");
        to->line(to->ctx, "|---|---|---|---|");
        (void)snprintf(text, sizeof text, "%s.", i == 0 ? "" : part->name);
        print_rows(to, i == 0 ? root : part->section, i == 0 ? "" : text);
    }
}

void weft_scene_help(weft_scene_help_format format,
                     void (*line)(void *ctx, const char *text), void *ctx)
{
    const printer to = { line, ctx };
    if (format == WEFT_HELP_MARKDOWN) {
        print_markdown(&to);
    } else {
        print_text(&to);
    }
}

/* The key of a section that a path begins with, up to its next dot; *path is moved
 * behind that and behind indices of lists. NULL: there is none of that name. */
static const weft__key *next_key(const weft__section *section, const char **path,
                                 char *name, size_t size)
{
    const size_t length = strcspn(*path, ".[");
    (void)snprintf(name, size, "%.*s", (int)length, *path);
    *path += length + strspn(*path + length, ".[]0123456789");
    return section == NULL ? NULL : weft__key_named(section, name);
}

weft_status weft_scene_help_key(const char *path,
                                void (*line)(void *ctx, const char *text), void *ctx,
                                weft_error *err)
{
    const printer to = { line, ctx };
    const weft__section *section = &weft__root;
    const char *title = weft__root.title, *rest = path;
    const weft__key *key = NULL;
    do {
        char name[64], hint[300] = "; it has no keys";
        key = next_key(section, &rest, name, sizeof name);
        if (key == NULL) {
            if (section != NULL) {
                (void)weft__unknown_hint(&weft__root, section, title, name, hint,
                                         sizeof hint);
            }
            return weft_error_set(err, WEFT_INVALID, "unknown key '%s' in %s%s", name,
                                  title, hint);
        }
        section = key->section;
        title = section != NULL && section->title != NULL ? section->title : key->name;
    } while (*rest != '\0');
    print_key(&to, key, path);
    print_tree(&to, below(key), 1);
    return WEFT_OK;
}
