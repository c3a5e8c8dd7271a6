/* SPDX-License-Identifier: BSD-3-Clause */
/* diagnostics.c -- the mistakes and warnings of a scene, in the order of their places.
 */
#include "scene/diagnostics.h"

#include <limits.h>
#include <string.h>

bool weft__mark_before(weft__mark a, weft__mark b)
{
    if (a.source != b.source) {
        return a.source < b.source;
    }
    if (a.line != b.line) {
        return a.line < b.line;
    }
    if (a.column != b.column) {
        return a.column < b.column;
    }
    return a.order != b.order ? a.order < b.order : a.byte < b.byte;
}

static void write_place(const weft__report *report, weft__mark at, char *out,
                        size_t size)
{
    if (at.source > 0) {
        const char *key = report->sources[at.source].text;
        (void)snprintf(out, size, "override %.*s", (int)strcspn(key, "="), key);
    } else {
        (void)snprintf(out, size, "line %zu, column %zu", at.line + 1, at.column + 1);
    }
}

weft__words weft__place_text(const weft__report *report, weft__mark at)
{
    weft__words out = { "" };
    write_place(report, at, out.text, sizeof out.text);
    return out;
}

static int as_int(size_t n)
{
    return n < INT_MAX ? (int)n : INT_MAX;
}

/* Whether the same message was reported at the same place, whose items end at `slot`: a
 * node is read once for each of its aliases, and for each run of a sweep. */
static bool is_known(weft__report *report, size_t slot, weft__mark at,
                     const char *message)
{
    while (slot-- > 0 && !weft__mark_before(report->origin[slot].at, at)) {
        weft__origin *origin = &report->origin[slot];
        if (strcmp(report->found->items[slot].message, message) == 0) {
            origin->runs += origin->latest != report->run;
            origin->latest = report->run;
            return true;
        }
    }
    return false;
}

/* The line of a byte, from 0. Diagnostics are mostly made in the order of the file, or
 * against it: lines are counted from the place before. */
static size_t line_of(weft__named_file *file, size_t byte)
{
    const bool back = byte < file->found.byte;
    const size_t end = back ? file->found.byte : byte;
    size_t lines = 0;
    for (size_t i = back ? byte : file->found.byte; i < end; ++i, ++lines) {
        const char *next = memchr(file->text + i, '\n', end - i);
        if (next == NULL) {
            break;
        }
        i = (size_t)(next - file->text);
    }
    file->found.line = back ? file->found.line - lines : file->found.line + lines;
    file->found.byte = byte;
    return file->found.line;
}

static void place_in_file(weft__named_file *file, size_t byte, weft_diagnostic *item)
{
    const char *at = file->text + byte, *begin = at;
    const char *end = memchr(at, '\n', file->length - byte);
    while (begin > file->text && begin[-1] != '\n') {
        --begin;
    }
    if (begin == file->text && byte >= weft__mark_length(begin)) {
        begin += weft__mark_length(begin);
    }
    end = end == NULL ? file->text + file->length : end;
    end -= end > begin && end[-1] == '\r';
    const weft__source line
        = { .text = begin, .length = (size_t)(end - begin), .number = 1 };
    const weft__mark mark = weft__source_mark(&line, (size_t)(at - begin));
    (void)snprintf(item->place, sizeof item->place, "%s", file->path);
    weft__one_line(item->place);
    item->line = as_int(line_of(file, byte) + 1);
    item->column = as_int(mark.column + 1);
    item->caret = weft__source_excerpt(&line, mark, item->source, sizeof item->source);
}

static void insert(weft__report *report, size_t slot, weft__mark at, bool warning,
                   const char *message)
{
    weft_diagnostics *found = report->found;
    if (found->count < WEFT_DIAGNOSTICS_MAX) {
        ++found->count;
    }
    for (size_t i = found->count - 1; i > slot; --i) {
        found->items[i] = found->items[i - 1];
        report->origin[i] = report->origin[i - 1];
    }
    weft_diagnostic *item = &found->items[slot];
    memset(item, 0, sizeof *item);
    item->warning = warning;
    strcpy(item->message, message);
    if (at.in != NULL) { /* the file is gone when the report ends */
        place_in_file(at.in, at.byte - 1, item);
        at.in = NULL;
    }
    report->origin[slot] = (weft__origin){
        .at = at, .runs = 1, .first = report->run, .latest = report->run
    };
}

void weft__fit(char *text, size_t size, int length)
{
    static const char more[] = " ...";
    if (length >= 0 && (size_t)length >= size) {
        char *end = text + size - sizeof more;
        while (end > text && *end != ' ') {
            --end;
        }
        strcpy(end > text ? end : text + size - sizeof more, more);
    }
}

void weft__report_add(weft__report *report, bool warning, weft__mark at,
                      const char *format, ...)
{
    char message[sizeof report->found->items[0].message];
    va_list args;
    size_t *count = warning ? &report->found->warnings : &report->found->errors;
    size_t slot = report->found->count; /* behind those before it or at its place */
    while (slot > 0 && weft__mark_before(at, report->origin[slot - 1].at)) {
        --slot;
    }
    report->mistakes += !warning;
    va_start(args, format);
    weft__fit(message, sizeof message,
              weft_text_format_list(message, sizeof message, format, args));
    va_end(args);
    weft__one_line(message);
    if (is_known(report, slot, at, message)) {
        return;
    }
    ++*count;
    if (slot < WEFT_DIAGNOSTICS_MAX) {
        insert(report, slot, at, warning, message);
    }
}

/* The first mistake, for callers that use only weft_error. */
static weft_status first_error(const weft_diagnostics *found, weft_error *err)
{
    const weft_diagnostic *item = NULL;
    for (size_t i = 0; i < found->count && item == NULL; ++i) {
        item = found->items[i].warning ? NULL : &found->items[i];
    }
    if (item == NULL) {
        return weft_error_set(err, WEFT_BAD_SCENE, "the scene has errors");
    }
    weft_error_set(err, WEFT_BAD_SCENE, "%s", item->message);
    if (err != NULL) {
        (void)snprintf(err->file, sizeof err->file, "%s", item->place);
        err->line = item->line;
        err->column = item->column;
    }
    return WEFT_BAD_SCENE;
}

void weft__report_place(const weft__report *report, weft__mark at,
                        weft_diagnostic *item)
{
    const weft__source *source = &report->sources[at.source];
    item->line = at.source > 0 ? 0 : as_int(at.line + 1);
    item->column = as_int(at.column + 1);
    if (source->number == 0) {
        (void)snprintf(item->place, sizeof item->place, "%s", source->file);
    } else {
        write_place(report, at, item->place, sizeof item->place);
    }
    weft__one_line(item->place);
    item->caret = weft__source_excerpt(source, at, item->source, sizeof item->source);
}

weft_status weft__report_end(weft__report *report, weft_error *err)
{
    for (size_t i = 0; i < report->found->count; ++i) {
        if (report->origin[i].at.byte == 0) {
            weft__report_place(report, report->origin[i].at, &report->found->items[i]);
        }
    }
    return report->found->errors > 0 ? first_error(report->found, err) : WEFT_OK;
}

/* Blanks up to the caret; tabs stay, so that the caret stands below its character. */
static void caret_line(const weft_diagnostic *item, char *out, size_t size)
{
    size_t used = 0;
    const char *text = item->source;
    const size_t length = strlen(text);
    size_t i = 0;
    for (int column = 1; column < item->caret && used + 2 < size; ++column) {
        out[used++] = i < length && text[i] == '\t' ? '\t' : ' ';
        i += i < length ? weft__char_length(text + i, length - i) : 0;
    }
    strcpy(out + used, "^");
}

int weft_diagnostic_format(const weft_diagnostic *diagnostic, char *text, size_t size)
{
    char where[64] = "", caret[sizeof diagnostic->source + 8], source[600] = "";
    if (diagnostic->line > 0) {
        (void)snprintf(where, sizeof where, ":%d:%d", diagnostic->line,
                       diagnostic->column);
    } else if (diagnostic->column > 0) {
        (void)snprintf(where, sizeof where, ":%d", diagnostic->column);
    }
    if (diagnostic->caret > 0) {
        caret_line(diagnostic, caret, sizeof caret);
        (void)snprintf(source, sizeof source, "\n%s\n%s", diagnostic->source, caret);
    }
    return snprintf(text, size, "%s%s: %s: %s%s", diagnostic->place, where,
                    diagnostic->warning ? "warning" : "error", diagnostic->message,
                    source);
}
