/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/page.h"

#include <stdint.h>
#include <string.h>

#include "base/bytes.h"

/* What a page may fetch by its own policy: nothing. */
#define FETCHES "connect-src 'none'"

void page_begin(FILE *stream, const char *page, bool live)
{
    const char *mark = strstr(page, PAGE_MARK);
    if (live) {
        const char *fetches = strstr(page, FETCHES);
        (void)fwrite(page, 1, (size_t)(fetches - page), stream);
        fputs("connect-src 'self'", stream);
        page = fetches + strlen(FETCHES);
    }
    (void)fwrite(page, 1, (size_t)(mark - page), stream);
}

void page_end(FILE *stream, const char *page)
{
    (void)fputs(strstr(page, PAGE_MARK) + strlen(PAGE_MARK), stream);
}

weft_status page_open(record_file *file, const char *path, weft_error *err)
{
    const char *slash = strrchr(path, '/');
    char directory[RECORD_PATH];
    (void)snprintf(directory, sizeof directory, "%.*s",
                   slash == NULL ? 1 : (int)(slash - path + (slash == path)),
                   slash == NULL ? "." : path);
    TRY(record_file_open(file, directory, slash == NULL ? path : slash + 1, err));
    page_begin(file->stream, weft__player_page, false);
    return WEFT_OK;
}

weft_status page_commit(record_file *file, weft_status written, weft_error *err)
{
    if (written != WEFT_OK) {
        record_file_discard(file);
        return written;
    }
    page_end(file->stream, weft__player_page);
    return record_file_commit(file, err);
}

static void put_character(FILE *stream, int c)
{
    if (c < 0x20 || c == '<' || c == '>' || c == '&' || c == 0x7f) {
        fprintf(stream, "\\u%04x", (unsigned)c);
        return;
    }
    fputs(c == '"' || c == '\\' ? "\\" : "", stream);
    putc(c, stream);
}

void page_characters(FILE *stream, const char *text)
{
    for (; *text != '\0'; ++text) {
        put_character(stream, (unsigned char)*text);
    }
}

void page_text(FILE *stream, const char *text)
{
    putc('"', stream);
    page_characters(stream, text);
    putc('"', stream);
}

void page_directory(FILE *stream, const char *path)
{
    size_t end = strlen(path);
    while (end > 1 && path[end - 1] == '/') {
        --end;
    }
    size_t begin = end;
    while (begin > 0 && path[begin - 1] != '/') {
        --begin;
    }
    char name[RECORD_PATH];
    (void)snprintf(name, sizeof name, "%.*s", (int)(end - begin), path + begin);
    page_text(stream, name);
}

void page_file(FILE *stream, const char *directory, const char *name)
{
    char path[RECORD_PATH];
    FILE *file = record_open(directory, name, path, NULL);
    if (file == NULL) {
        fputs("null", stream);
        return;
    }
    putc('"', stream);
    for (int c; (c = getc(file)) != EOF;) {
        put_character(stream, c);
    }
    putc('"', stream);
    (void)fclose(file);
}

void page_base64(FILE *stream, const unsigned char *bytes, size_t size)
{
    static const char digits[]
        = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const unsigned group = (unsigned)bytes[i] << 16
                               | (left > 1 ? (unsigned)bytes[i + 1] << 8 : 0u)
                               | (left > 2 ? bytes[i + 2] : 0u);
        const char four[4] = { digits[group >> 18], digits[group >> 12 & 63],
                               left > 1 ? digits[group >> 6 & 63] : '=',
                               left > 2 ? digits[group & 63] : '=' };
        (void)fwrite(four, 1, sizeof four, stream);
    }
}

void page_bytes(FILE *stream, const unsigned char *bytes, size_t size)
{
    fputs("<script type=\"weft/frame\">", stream);
    page_base64(stream, bytes, size);
    fputs("</script>\n", stream);
}

size_t page_block_size(size_t planes, size_t count)
{
    return planes * (2 * sizeof(float) + count * sizeof(uint16_t));
}

void page_plane(unsigned char *block, size_t planes, size_t plane, const double *values,
                size_t count)
{
    float lo = record_single(values[0]), hi = lo;
    for (size_t i = 1; i < count; ++i) {
        const float value = record_single(values[i]);
        lo = value < lo ? value : lo;
        hi = value > hi ? value : hi;
    }
    unsigned char *range = block + plane * 2 * sizeof lo;
    weft__single_put(range, lo);
    weft__single_put(range + sizeof lo, hi);
    const double scale = hi > lo ? UINT16_MAX / ((double)hi - (double)lo) : 0.0;
    unsigned char *codes = block + planes * 2 * sizeof lo + plane * count * 2;
    for (size_t i = 0; i < count; ++i) {
        const double code = (values[i] - (double)lo) * scale + 0.5;
        const uint16_t bits = code >= UINT16_MAX ? UINT16_MAX
                              : code > 0.0       ? (uint16_t)code
                                                 : 0u;
        codes[2 * i] = (unsigned char)(bits & 255);
        codes[2 * i + 1] = (unsigned char)(bits >> 8);
    }
}
