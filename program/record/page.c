/* SPDX-License-Identifier: BSD-3-Clause */
/* page.c -- writes data into an HTML page, and describes the runs of a page as JSON. */
#include "program/record/page.h"

#include <inttypes.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "program/record/export/export.h"
#include "program/record/sections.h"

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
    TRY(record_file_open(file, NULL, path, err));
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

/* ---- the description of runs ------------------------------------------------- */

const player_field player_fields[PLAYER_FIELDS] = {
    { "strain", WEFT_RECORD_STRAIN, 1 },
    { "speed", WEFT_RECORD_VELOCITY, 3 },
};

static const char *comma(size_t i)
{
    return i > 0 ? "," : "";
}

/* A pinned particle that is not shown marks the nearest one that is. */
static void write_pinned(const player_page *self)
{
    bool *marks = calloc(self->count, sizeof *marks);
    const size_t half = self->stride / 2;
    const uint8_t *pinned = self->runs[0].frames->pinned;
    const size_t n = pinned == NULL ? 0 : self->faces->particles;
    const size_t cols = self->faces->cols;
    size_t written = 0;
    for (size_t p = 0; marks != NULL && p < n; ++p) {
        const size_t at = cols == 0
                              ? p
                              : (p / cols + half) / self->stride * self->shown_cols
                                    + (p % cols + half) / self->stride;
        marks[at] |= pinned[p] != 0;
    }
    for (size_t i = 0; marks != NULL && i < self->count; ++i) {
        if (marks[i]) {
            fprintf(self->stream, "%s%zu", comma(written++), i);
        }
    }
    free(marks);
}

static void write_sections(FILE *stream, const char *directory)
{
    weft_scene *scene = record_scene(directory);
    for (size_t i = 0; i < RECORD_SECTIONS; ++i) {
        if (record_sections[i]->page != NULL) {
            record_sections[i]->page(stream,
                                     scene != NULL ? weft_scene_cloth(scene) : NULL);
        }
    }
    fprintf(stream, ",\"relative\":%s",
            scene == NULL || weft_scene_sensitivities(scene)->relative ? "true"
                                                                       : "false");
    weft_scene_destroy(scene);
}

/* series.csv, of a brief page the header and the rows of the frames shown. Returns the
 * bytes of its whole rows. */
static size_t write_rows(const player_page *self, const player_run *run)
{
    char path[RECORD_PATH], line[4096];
    FILE *series = record_open(run->directory, "series.csv", path, NULL);
    size_t shown = 0, bytes = 0;
    fputs(series == NULL ? "null" : "\"", self->stream);
    for (bool head = true; series != NULL && fgets(line, sizeof line, series) != NULL;
         head = false) {
        const double wanted
            = shown < self->shown ? run->frames->numbers[run->index[shown]] : -1.0;
        const bool kept = !head && strtod(line, NULL) == wanted;
        if (head || kept || !self->brief) {
            page_characters(self->stream, line);
        }
        shown += kept;
        bytes += strchr(line, '\n') == NULL ? 0 : strlen(line);
    }
    if (series != NULL) {
        putc('"', self->stream);
        (void)fclose(series);
    }
    return bytes;
}

/* Words of 32 bits, least significant byte first, as base64. */
static void write_words(FILE *stream, const char *name, const void *from, size_t count)
{
    enum { PART = 3 * 256 };
    unsigned char bytes[4 * PART];
    fprintf(stream, ",\"%s\":\"", name);
    for (size_t i = 0; i < count; i += PART) {
        const size_t some = count - i < PART ? count - i : PART;
        for (size_t b = 0; b < 4 * some; ++b) {
            uint32_t word;
            memcpy(&word, (const unsigned char *)from + 4 * (i + b / 4), sizeof word);
            bytes[b] = (unsigned char)(word >> (8 * (b % 4)));
        }
        page_base64(stream, bytes, 4 * some);
    }
    fputc('"', stream);
}

/* Without memory the rest shape is left out. */
static void write_triangles(FILE *stream, const record_faces *of)
{
    float *uv = malloc(2 * of->places * sizeof *uv);
    for (size_t i = 0; uv != NULL && i < 2 * of->places; ++i) {
        uv[i] = record_single(of->uv[i]);
    }
    fprintf(stream, ",\"mesh\":{\"vertices\":%zu,\"triangles\":%zu", of->particles,
            of->triangles);
    write_words(stream, "corners", of->corners, 3 * of->triangles);
    write_words(stream, "places", of->corner_uv, 3 * of->triangles);
    write_words(stream, "rest", uv, uv == NULL ? 0 : 2 * of->places);
    fputs(of->part_count > 0 ? ",\"cloths\":[" : "", stream);
    for (size_t k = 0; k < of->part_count; ++k) {
        fprintf(stream, "%s{\"name\":\"%s\",\"first\":%zu}", comma(k),
                of->parts[k].name, of->parts[k].first);
    }
    fputs(of->part_count > 0 ? "]}" : "}", stream);
    free(uv);
}

static void write_run(const player_page *self, const player_run *run)
{
    static const char *const files[] = { "scene", "manifest", "result" };
    FILE *stream = self->stream;
    fputs("{\"directory\":", stream);
    page_directory(stream, run->directory);
    fprintf(stream, ",\"frames\":%zu,\"index\":[", run->frames->count);
    for (size_t i = 0; i < self->shown; ++i) {
        fprintf(stream, "%s%zu", comma(i), run->index[i]);
    }
    fputs("],\"numbers\":[", stream);
    for (size_t i = 0; i < self->shown; ++i) {
        fprintf(stream, "%s%.0f", comma(i), run->frames->numbers[run->index[i]]);
    }
    fputc(']', stream);
    write_sections(stream, run->directory);
    for (size_t f = 0; f < sizeof files / sizeof files[0]; ++f) {
        char name[32];
        (void)snprintf(name, sizeof name, "%s.yaml", files[f]);
        fprintf(stream, ",\"%s\":", files[f]);
        page_file(stream, run->directory, name);
    }
    fputs(",\"series\":", stream);
    const size_t rows = write_rows(self, run);
    if (self->live) {
        fprintf(stream, ",\"live\":{\"frame\":%zu,\"series\":%zu}", run->frames->count,
                rows);
    }
    fputc('}', stream);
}

void player_page_describe(const player_page *self)
{
    FILE *stream = self->stream;
    size_t written = 0;
    fputs("<script id=\"weft-data\" type=\"application/json\">{\"weft\":", stream);
    page_text(stream, weft_version());
    if (self->faces->cols > 0) {
        fprintf(stream, ",\"grid\":[%zu,%zu],\"shown\":[%zu,%zu],\"stride\":%zu",
                self->faces->rows, self->faces->cols, self->shown_rows,
                self->shown_cols, self->stride);
    } else {
        write_triangles(stream, self->faces);
    }
    fprintf(stream, ",\"chosen\":%zu,\"fields\":[", self->chosen);
    for (size_t f = 0; f < PLAYER_FIELDS; ++f) {
        if (self->present[f]) {
            fprintf(stream, "%s\"%s\"", comma(written++), player_fields[f].name);
        }
    }
    for (size_t j = 0; j < self->sensitivities; ++j) {
        fputs(comma(written++), stream);
        fputs("\"s_", stream);
        page_characters(stream, self->runs[0].frames->keys[j]);
        fputs("\"", stream);
    }
    fputs("],\"times\":[", stream);
    for (size_t i = 0; i < self->shown; ++i) {
        fprintf(stream, "%s%.17g", comma(i),
                self->runs[0].frames->times[self->runs[0].index[i]]);
    }
    fputs("],\"pinned\":[", stream);
    write_pinned(self);
    fputs("],\"runs\":[", stream);
    for (size_t r = 0; r < self->run_count; ++r) {
        fputs(comma(r), stream);
        write_run(self, &self->runs[r]);
    }
    fputs("]}</script>\n", stream);
}
